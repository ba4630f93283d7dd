// facet_triangles: a hit when triangles spanned between inflated facet points pass the 11-axis test.
//
// Source  Příbyl 2022, sections 3.1 and 4.1, "FaceT and per triangle" (key I).
// Cost    At worst m n triangle tests of 11 axes for m and n sampled triangles; less where a plane misses a body.
// Misses  Contact in the holes of the envelope, most bodies inside another, bodies with fewer than 3 sampled facets.
// Extra   Near misses, as the envelope is inflated; coplanar triangles, however far apart (the test's own error);
//         bodies inside another that one of its triangles, cutting across it, meets.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm facet_triangles();

}  // namespace algorithms
