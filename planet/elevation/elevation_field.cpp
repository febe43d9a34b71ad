#include "planet/elevation/elevation_field.h"

namespace planet {

std::string_view name_of(VerticalDatum datum) {
    return datum == VerticalDatum::ellipsoid ? "ellipsoid" : "egm96";
}

}  // namespace planet
