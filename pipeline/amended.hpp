// A result that gets more answers: read whole, and replaced by one that has them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/config.hpp"
#include "pipeline/result/output_file.hpp"
#include "pipeline/result/products/passes.hpp"
#include "pipeline/result/result.hpp"
#include "pipeline/scene/script.hpp"

namespace pipeline {

/// The result of a scene and its place, which is taken: a kill never harms the file, and one that changes meanwhile is
/// not replaced.
struct Amended {
  /// Throws Error(kFile) when the file cannot be read or replaced, is no scene's, or holds what would be lost.
  Amended(const std::filesystem::path& file, bool unsealed);

  /// Throws Error(kFile) when there are answers of that label; `option` says how another is given.
  void refuse_label(const std::string& label, const std::string& option) const;

  /// The passes of the result's scene, of which it holds `rows`: where the hero was at its samples the file says, where
  /// it was between them its configuration. Throws Error(kFile) when the two differ.
  std::vector<Pass> passes(const Config& config, const std::vector<PassRow>& rows) const;

  /// Puts answers, scored, into the place of those of the same label, or after all; with what algorithm `i` of
  /// `products` said.
  void put(Answers answers, Products& products, std::size_t i);

  /// Files that were read for it: name -> SHA-256, a JSON object.
  void add_inputs(const std::string& files);

  std::filesystem::path file;  // as the user named it
  OutputFile target;
  Result result;

 private:
  std::size_t place_of(const std::string& label) const;

  std::optional<std::uint64_t> pairs_;  // that are judged
};

/// Those products that follow from the rest of the result.
void make_products(Result& result);

}  // namespace pipeline
