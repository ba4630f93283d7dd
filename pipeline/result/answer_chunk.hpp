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

/// The machine that made a chunk, at its end; and the counterpart.
void put_machine(const Machine& machine, ChunkWriter& out);
Machine get_machine(ChunkReader& in);

/// Notes that `machine` made the chunk that comes after `steps` steps: the first in `first`, all in `each` when they
/// are not one host's and processor's.
void note_machine(const Machine& machine, std::size_t steps, Machine& first, std::vector<Machine>& each);

/// The steps of `more` after those of `answers`.
void append_steps(const Answers& more, Answers& answers);

/// The same of a whole chunk, with the machine that timed it. Of a method of others that had failed before nothing more
/// is known: that another worker asked it again changes nothing.
void append_chunk(const Answers& more, const Machine& machine, Answers& answers);

/// A step of which nothing is known, as its method has failed. `counts_contained`: hits on contained pairs are counted.
void leave_out_step(bool counts_contained, Answers& answers);

}  // namespace pipeline
