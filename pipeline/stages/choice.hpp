// An algorithm as a run asks it: which, with what knobs, under what name.
#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "algorithms/contract/algorithm.hpp"
#include "pipeline/foreign/foreign.hpp"

namespace pipeline {

/// A file that stands for a mesh, as a knob of Role::files names it.
struct FileOfMesh {
  std::string mesh, written;  // as written, relative to `folder` of the choice
  std::string place;          // where it was named, and by which key
};

/// One [[algorithm]].
struct AlgorithmChoice {
  std::string name;
  std::string label;                                 // defaults to the name
  algorithms::Knobs knobs;                           // all of them, presets filled in
  std::shared_ptr<const Foreign> foreign = nullptr;  // of a method of others; null: a row of the table
  bool optional = false;                             // a program that is not here is left out
  // Of a row with a knob of Role::files:
  std::vector<FileOfMesh> files = {};
  std::filesystem::path folder = {};
  std::string place = {};                                        // where they were named
  std::shared_ptr<const algorithms::Algorithm> bound = nullptr;  // the row with what is in them, once that was read
  std::map<std::string, std::string> inputs = {};                // as written -> SHA-256
};

/// "algorithm 'label': ", with the place of its files.
std::string whose(const AlgorithmChoice& choice);

/// The row of a choice.
const algorithms::Algorithm& row_of(const AlgorithmChoice& choice);

/// The method of a choice, set up for these bodies, which must outlive it. Throws what its row's `make` throws; of a
/// method of others, whose process it starts, Fault.
std::unique_ptr<algorithms::Method> make_method(const AlgorithmChoice& choice, const geometry::Bodies& bodies);

/// Knobs as a JSON object, keys sorted.
std::string knobs_json(const algorithms::Knobs& knobs);

}  // namespace pipeline
