// Reading a file in a child process before the program reads it itself.
#pragma once
#include <filesystem>
#include <string>

#include "pipeline/result/seal.hpp"
#include "pipeline/system/input_file.hpp"
#include "pipeline/terminal/error.hpp"

namespace pipeline {

/// HDF5 1.10.8 crashes, loops or asks for all memory on some damaged files, and such a file may well have a seal that
/// somebody made. Throws what reading it here would throw.
void try_reading(const InputFile& file, const std::filesystem::path& path, Seal seal, bool unsealed);

Error too_little_memory(const std::string& place);

}  // namespace pipeline
