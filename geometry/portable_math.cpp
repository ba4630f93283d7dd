// The bodies of portable_math.hpp: SLEEF's plain C functions, by name, so that no dispatch by processor takes place.
#include "geometry/portable_math.hpp"

#include <sleef.h>

namespace geometry::portable {

double sin(double radians) { return Sleef_cinz_sind1_u10purec(radians); }
double cos(double radians) { return Sleef_cinz_cosd1_u10purec(radians); }
double asin(double sine) { return Sleef_cinz_asind1_u10purec(sine); }
double atan2(double y, double x) { return Sleef_cinz_atan2d1_u10purec(y, x); }

}  // namespace geometry::portable
