#include "geometry/bvh.hpp"
