// Answers that were made elsewhere, scored by the truth of a result and put into it.
#pragma once
#include <filesystem>
#include <string>

#include "pipeline/result/result.hpp"

namespace pipeline {

struct ImportOptions {
  std::filesystem::path answers;  // step,a,b (pipeline/scene/answers_csv.hpp)
  std::filesystem::path times;    // step,ns; empty: not timed
  std::string label;
  std::string language;          // of the method, by the user's word; with times it says that they are this machine's
  std::string promise = "none";  // or conservative, exact
  std::string scope = "pair";    // or scene
  bool force = false;            // replaces answers of that label
  bool unsealed = false;
};

/// Reads, scores and stores. Throws Error: kInput for what the files hold, kFile for the result.
Result import_answers(const std::filesystem::path& file, const ImportOptions& options);

}  // namespace pipeline
