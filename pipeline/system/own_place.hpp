// What belongs to the program and lies beside it, found by the program's own place: where it was built
// (TREE/build/pipeline) or where it is installed (PREFIX/bin/pipeline, with PREFIX/share/collision_benchmark laid out
// as the tree is).
#pragma once
#include <filesystem>
#include <string>

namespace pipeline {

/// A folder of the project, such as "configs"; empty when it is not there.
std::filesystem::path own_folder(const std::string& name);

/// `written`, or where there is no such file and it is but a name, the configuration of that name that lies beside the
/// program, "padani" or "padani.toml".
std::string own_config(const std::string& written);

}  // namespace pipeline
