// What the library shows of itself.
#pragma once

#define PSF_API [[gnu::visibility("default")]]
