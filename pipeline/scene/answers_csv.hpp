// Answers that were made elsewhere, by an engine that cannot run here, and what it took for them.
//
//   step,a,b      a pair that is reported at a step. Rows and the two bodies come in any order; a and b are names of
//                 bodies, or their numbers from 0; a step without a row reports nothing.
//   step,ns       the time of every step, above 0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/bodies.hpp"
#include "pipeline/result/result.hpp"

namespace pipeline {

/// The pairs of every step of `poses` (S x B). `text` is the content of `file` (csv.hpp). Throws Error(kInput), one
/// line "file:line: ...", for a pair that no method is asked about (of a body with itself, of two fixed ones, with one
/// that is not there yet, with none of the chosen), a pair that is there twice, an unknown body or step.
PairLists parse_answers(std::string_view text, const std::string& file, const geometry::Bodies& bodies,
                        const std::vector<std::vector<geometry::Pose>>& poses);

/// The time of each of so many steps, ns. Throws Error(kInput) also for a step that is there twice or not at all.
std::vector<std::int64_t> parse_times(std::string_view text, const std::string& file, std::size_t steps);

}  // namespace pipeline
