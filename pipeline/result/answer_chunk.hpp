// Steps of one algorithm's answers, as chunks of a checkpoint hold them.
#pragma once
#include <cstdint>

#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/result.hpp"

namespace pipeline {

/// Pairs, columns and, of a method of others, what it said of itself: of steps `first` up to, not including, `last`.
void put_steps(const Answers& answers, std::int64_t first, std::int64_t last, ChunkWriter& out);

/// The counterpart: so many steps and, of a method of others, what it said of itself; nothing else of the answers.
Answers get_steps(ChunkReader& in, std::int64_t steps, std::uint64_t bodies);

/// The steps of `more` after those of `answers`.
void append_steps(const Answers& more, Answers& answers);

}  // namespace pipeline
