#include "geometry/box.hpp"
