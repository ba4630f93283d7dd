#include "geometry/mesh.hpp"
