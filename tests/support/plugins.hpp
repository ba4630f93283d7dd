// The libraries that are built for the tests: the examples of algorithms/plugin/, and odd_plugin.cpp.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "algorithms/contract/plugin_rows.hpp"

namespace plugins {

inline std::string path_of(const std::string& name) { return std::string(PLUGIN_FOLDER "/lib") + name + ".so"; }

/// The examples by name, as row and library are called. Without the one in Rust where no compiler for it was found.
inline std::vector<std::string> examples() {
  std::vector<std::string> names = {"bounding_spheres_c", "bounding_spheres_cpp"};
  if (std::filesystem::exists(path_of("bounding_spheres_rust"))) names.push_back("bounding_spheres_rust");
  return names;
}

/// The rows of the examples in the table, loaded into this process.
inline void add_examples() {
  for (const std::string& name : examples())
    if (!algorithms::find(name)) algorithms::add(algorithms::plugin_rows(path_of(name)).front());
}

}  // namespace plugins
