// facet_gjk: hulls of sampled facet points are nearer than the sampling distance.
//
// Source  Příbyl 2022, section 6.1, wishes for better vectors: facet_vectors asks whether the differences of facet
// points
//         face all four ways in a plane, a guess at "the origin lies in their convex hull". This is asked here, by GJK
//         (algorithms/parts/convex.hpp): of whole bodies, and where these are concave of the pieces that their facets
//         fall into.
// Cost    Once per mesh the hulls. Per pair that the prefilter leaves some dozens of corners per direction tried, of
// each two
//         pieces whose balls touch.
//         Without a filter a ball and a box around each body, pieces and reach included, reject what is far.
// Misses  Contact beyond reach of the points, by little; what the prefilter misses.
// Extra   Bodies nearer than the reach, the hollows of a piece; bodies inside another.
//
// Pieces: a body is cut in two halves of its facets across its longest side as long as some facet lies deeper in the
// hull of its piece than 0.1 of half the piece's longest side, three times at most. Of a piece as many corners of
// facets are taken as it has facets by `stride`, 16 to 64: those that stick out most, one after the other. Its sampling
// distance is how far the next one sticks out; `reach` is in units of the greatest of the body's. algorithms/README.md
// has what else was tried.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm facet_gjk();

}  // namespace algorithms
