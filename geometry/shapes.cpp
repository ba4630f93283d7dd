#include "geometry/shapes.hpp"
