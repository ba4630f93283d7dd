// The methods of a shared library as rows and Methods: the pipeline's side of algorithms/plugin.h.
//
// Loading a library and calling its methods runs the code of others in this process. Whoever does not trust it does so
// in a child process.
#pragma once
#include <string>
#include <vector>

#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

/// The rows of the library at `path`, an absolute path, which stays loaded for ever. Their methods work in this
/// process; `make` throws std::invalid_argument with the library's own reason, a method std::runtime_error. Throws
/// std::invalid_argument with the rule that the library breaks and the remedy: "exports no ...; write one".
std::vector<Algorithm> plugin_rows(const std::string& path);

}  // namespace algorithms
