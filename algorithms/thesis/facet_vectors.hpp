// facet_vectors: a hit when the vectors between facet points face all four ways in a plane and are short across it.
//
// Source  Příbyl 2022, sections 3.1 and 4.1, "FaceT and vectors" (key P).
// Cost    A few vectors per pair when bounds decide; at worst 5 m n per plane for m and n sampled facets.
// Misses  Bodies whose few sampled points (a box has one) cannot face all ways, however deep they are in each other.
// Extra   It is early on turned bodies: the four ways and the short third may come from different vectors.
//
// The thesis repeats the test from b to a. Negation maps the quadrants onto each other and keeps the magnitudes, so
// the repetition cannot change an answer, but for a component that is exactly zero, and it is left out.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm facet_vectors();

}  // namespace algorithms
