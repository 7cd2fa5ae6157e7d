// Numbers as text for people; what all verbs share stands in core.
#pragma once

#include "core/text.h"

namespace psf::tools {

using core::counted;
using core::in_mebibytes;
using core::with_commas;

}  // namespace psf::tools
