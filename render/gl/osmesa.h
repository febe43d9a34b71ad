#pragma once
// OSMesa: Mesa's software renderer as one plain library. Opened at run time; Mesa 25.1 removed it.

#include "render/gl/native_context.h"

namespace render {

/// A core 4.5 context of libOSMesa.so.8 or .6, or of the library that OCTAGLOBE_OSMESA_LIBRARY names.
Attempt open_osmesa();

}  // namespace render
