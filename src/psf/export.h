// What the library shows of itself.
#pragma once

// Marks a class or a function that programs outside of the library may use.
#define PSF_API [[gnu::visibility("default")]]
