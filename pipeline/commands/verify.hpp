// `pipeline verify`: the truth of a result file, rechecked by the oracle (geometry/decision/oracle.hpp).
//
// First the world extents of all bodies at all the steps asked for are compared: pairs whose extents do not touch are
// thereby proved apart, all of them. What remains are three classes: pairs listed as meeting, pairs listed as
// contained, and pairs listed as neither though their extents touch. Of these the oracle is asked about a sample, drawn
// in equal shares (what a small class leaves goes to the others) by a fixed sequence: the same file and number give the
// same pairs.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "pipeline/result/result.hpp"
#include "pipeline/terminal/step_range.hpp"

namespace pipeline {

/// What two bodies are to each other. a_inside: a lies inside b; contained: one inside the other, as files older than
/// /truth/contained_inside say it; no_pair: one is not born, both are fixed, or neither is among the chosen.
enum class Relation { apart, meet, contained, a_inside, b_inside, no_pair };
std::string text_of(Relation relation);

struct Difference {
  std::uint64_t step = 0;
  Pair pair;
  Relation truth = Relation::apart, oracle = Relation::apart;
};

struct Verified {
  struct Class {
    std::uint64_t pairs = 0, checked = 0;
  };
  StepRange steps;
  Class meet, contained, near;           // checked by the oracle
  std::uint64_t far = 0;                 // proved apart by comparing coordinates
  std::optional<Difference> difference;  // the first, in order of step, a, b

  std::uint64_t pairs() const { return meet.pairs + contained.pairs + near.pairs + far; }
  std::uint64_t checked() const { return meet.checked + contained.checked + near.checked; }
};

/// Asks about `pairs` pairs, or all; on `threads` threads, which change nothing but the time. When there is a
/// difference, `checked` counts up to and with it. Throws Error(kFailed) for world coordinates that are not finite.
Verified verify(const Result& result, StepRange steps, std::optional<std::uint64_t> pairs, int threads, bool quiet);

std::string verified_text(const Verified& verified, const Result& result);
std::string verified_json(const Verified& verified, const Result& result, const std::string& path);

/// The difference in one line; `verified` has one.
std::string difference_text(const Verified& verified, const Result& result);

}  // namespace pipeline
