// facet_triangles: a hit when triangles spanned between inflated facet points pass the 11-axis test.
//
// Source  Příbyl 2022, sections 3.1 and 4.1, "FaceT and per triangle" (key I).
// Cost    At worst m n triangle tests of 11 axes for m and n sampled triangles; less where a plane misses a body.
// Misses  Contact in the holes of the envelope, most bodies inside another, bodies with fewer than three sampled
// facets. Extra   Near misses, as the envelope is inflated; bodies inside that a triangle across the body meets;
// coplanar triangles, however far apart (the test's own error).
#pragma once
#include "algorithms/algorithm.hpp"

namespace algorithms {

Algorithm facet_triangles();

}  // namespace algorithms
