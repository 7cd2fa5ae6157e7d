namespace psf {}
