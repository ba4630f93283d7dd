#include "algorithms/algorithm.hpp"
