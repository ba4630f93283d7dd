#include "pipeline/config.hpp"
