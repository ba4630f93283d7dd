// A result that gets more answers: read whole, and replaced by one that has them.
#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/config.hpp"
#include "pipeline/result/output_file.hpp"
#include "pipeline/result/result.hpp"
#include "pipeline/scene/script.hpp"

namespace pipeline {

/// The result of a scene and its place, which is taken: a kill never harms the file, and one that changes meanwhile is
/// not replaced.
struct Amended {
  /// Throws Error(kFile) when the file cannot be read or replaced, is a study, or holds what would be lost.
  Amended(const std::filesystem::path& file, bool unsealed);

  /// Throws Error(kFile) when there are answers of that label; `option` says how another is given.
  void refuse_label(const std::string& label, const std::string& option) const;

  /// The passes of the result's scene: the file holds where the hero was at its samples, and where it was between them
  /// its configuration says. Throws Error(kFile) when the two differ.
  std::vector<Pass> passes(const Config& config) const;

  /// Puts answers, scored, into the place of those of the same label, or after all. `passes` and `cases`: of scenes
  /// that have some.
  void put(Answers answers, std::optional<PassAnswers> passes, std::optional<ExtremeAnswers> cases);

  std::filesystem::path file;  // as the user named it
  OutputFile target;
  Result result;

 private:
  std::size_t place_of(const std::string& label) const;

  std::optional<std::uint64_t> pairs_;  // that are judged
};

}  // namespace pipeline
