// psf::Error. An installed library has the file itself in this place.
#pragma once

#include "core/error.h"
