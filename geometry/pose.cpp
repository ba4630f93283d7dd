#include "geometry/pose.hpp"
