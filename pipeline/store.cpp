#include "pipeline/store.hpp"
