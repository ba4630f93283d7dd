#include "pipeline/simulate.hpp"
