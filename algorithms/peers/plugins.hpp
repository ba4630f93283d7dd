// Other people's libraries that answer from plug-ins of this project (algorithms/peers/libraries/): what is known of
// them whether or not this build has them.
#pragma once
#include <vector>

#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

/// Their rows, without `make` and knobs: the plug-in has them. Each is lib<name>.so of its folder.
std::vector<Algorithm> plugin_peers();

}  // namespace algorithms
