// All of the library.
#pragma once

#include "psf/dump.h"
#include "psf/error.h"
#include "psf/explain.h"
#include "psf/filter.h"
#include "psf/flicker.h"
#include "psf/interrupt.h"
#include "psf/parameters.h"
#include "psf/passes.h"
#include "psf/picture.h"
#include "psf/sequence.h"
#include "psf/study.h"
#include "psf/version.h"
