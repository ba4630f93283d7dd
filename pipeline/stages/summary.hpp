// The score stage: from answers per step to one row of the summary.
#pragma once
#include <cstdint>
#include <vector>

#include "pipeline/result/result.hpp"

namespace pipeline {

/// The summary of one algorithm over all pairs and steps. `pairs` is the number of pairs that are judged (below): what
/// is neither reported nor true among them is a true negative.
///
///     error = (FP + FN) / (TP + FP + FN)      0 when the denominator is 0
///
/// Times are over the steps' fastest repeats; the 95th percentile is the nearest rank.
Summary summarise(const Answers& answers, std::uint64_t pairs);

/// Born pairs that count, over all steps, less those that are contained and only recorded: these are neither true nor
/// false, whether reported or not.
std::uint64_t judged_pairs(const geometry::Bodies& bodies, const std::vector<std::vector<geometry::Pose>>& poses,
                           const Truth& truth);

}  // namespace pipeline
