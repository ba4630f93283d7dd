// Distances of near pairs that do not meet, within /truth: columns for whoever holds some of them.
#pragma once
#include "pipeline/result/columns.hpp"

namespace pipeline {

inline constexpr Column<GapLists, std::vector<double>> kGapReals[] = {
    {"gap_lower", &GapLists::lower, "m", "the distance of the pair's surfaces is at least this, certified"},
    {"gap_upper", &GapLists::upper, "m", "the distance of the pair's surfaces is at most this, certified"}};

/// Tells `each` both.
template <typename Each>
void each_gap_column(const Each& each) {
  for (const auto& column : kGapReals) each(column);
}

}  // namespace pipeline
