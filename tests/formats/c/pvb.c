// The code of the C header, compiled as C99.
#define PVB_IMPLEMENTATION
#include "formats/pvb.h"
