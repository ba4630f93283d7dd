#include "geometry/portable_math.hpp"
