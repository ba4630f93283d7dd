#include "geometry/exact.hpp"
