#include "geometry/meet.hpp"
