#include "geometry/bodies.hpp"
