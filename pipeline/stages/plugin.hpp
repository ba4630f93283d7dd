// Shared libraries of others ([[plugin]], --plugin): their rows join the table of algorithms, their code stays outside.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/foreign/foreign.hpp"
#include "pipeline/system/child.hpp"

namespace pipeline {

/// A library whose rows are in the table.
struct Plugin {
  std::string written;  // its path as the user wrote it
  std::filesystem::path path;
  std::string sha256;  // of its bytes
};

/// What reading a table may take: a library that starts an engine needs a moment, one that hangs has none.
constexpr ChildLimits kPluginLimits{.processor_seconds = 10, .wall_seconds = 10};

/// Adds the rows of a library to the table. They are read in a child process, so that nothing of its code is ever
/// loaded here; `make` of such a row loads it, and is for a child process too. A relative path is one of `folder`. The
/// same file again changes nothing. Throws Error(kInput) for a library that breaks a rule of algorithms/plugin.h or
/// that clashes with another; `place` begins the line.
Plugin add_plugin(const std::string& written, const std::filesystem::path& folder, const std::string& place,
                  const ChildLimits& limits = kPluginLimits);

/// What a row of algorithms::missing() needs and how to get it, as algorithms::remedy; empty when its plug-in lies
/// beside the program and could be added, which is done here.
std::string lacking(const algorithms::Algorithm& missing);

/// Those of the command line (--plugin), relative to the current folder.
std::vector<Plugin> add_plugins(const std::vector<std::string>& libraries);

/// How the methods of a row of a library are asked: each in a child process of its own.
Foreign library(const algorithms::Algorithm& row, const algorithms::Knobs& knobs, const Budget& budget);

}  // namespace pipeline
