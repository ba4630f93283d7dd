// all_triangles: every facet of one body against every facet of the other, by a published triangle test.
//
// Source  Příbyl 2022, section 2.1, per-triangle detection with no facet left out. The tests: that of facet_triangles
//         (algorithms/parts/eleven_axes.hpp), Möller's and Guigue and Devillers' (algorithms/beyond/triangle_tests.hpp).
// Cost    Of each body that the prefilter leaves, its vertices turned and its tree of boxes made anew, once per step.
// Per
//         pair O(log) boxes and the facets whose boxes touch; by `exhaustive` all of them.
// Misses  What the test misses by rounding: touching, slivers, far from the origin. A body inside another: it asks
// surfaces. Extra   What the test reports falsely by rounding, and facets of one plane (eleven_axes: all whose boxes
// touch).
//
// Plain floating point: `single` rounds pose and vertices to floats and computes in floats. Before the test stand the
// boxes of the two facets, in the same precision, as in every hierarchy of boxes: `tree` and `exhaustive` ask the same
// pairs of facets and so answer the same. `bare` puts nothing before the test, so that its errors show wherever facets
// are: the coplanar facets that eleven_axes reports however far apart.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm all_triangles();

}  // namespace algorithms
