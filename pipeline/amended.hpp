// A result that gets more answers: read whole, and replaced by one that has them.
#pragma once
#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "pipeline/config.hpp"
#include "pipeline/result/output_file.hpp"
#include "pipeline/result/result.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/evaluate.hpp"

namespace pipeline {

/// The result of a scene and its place, which is taken: a kill never harms the file, and one that changes meanwhile is
/// not replaced. Throws Error(kFile) when the file cannot be read or replaced, is no scene's, or holds what would be
/// lost.
struct Amended {
  Amended(const std::filesystem::path& file, bool unsealed);

  OutputFile target;
  Result result;
};

/// The place of a label, or one behind the last.
std::size_t place_of(const std::string& label, const Result& result);

/// What a file's scene holds besides its poses: the file has where the hero was at its samples; where it was between
/// them, and how far cases were moved, its configuration says. Throws Error(kFile) when that tells otherwise.
Scene recorded_scene(const Result& result, const Config& config, const std::string& file);

/// Adds what was said, or puts it in the place of what the same labels said before; and what follows from it.
void add(Evaluation found, Result& result);

/// Adds files that were read: name -> SHA-256.
void add_inputs(const nlohmann::json& files, Result& result);

/// Those products that follow from the rest of the result.
void make_products(Result& result);

}  // namespace pipeline
