// spheres: tests whether one of the balls that cover a body overlaps one of those that cover the other.
//
// Source  The bounding ball and its hierarchies of section 2.1 of the thesis, as engines have them: a few balls in
// place
//         of a mesh. Knob count: at most that many; 1: the tightest ball around the vertices.
// Cost    1 distance per pair; of pairs whose tightest balls overlap up to 2 count + count^2 more. The balls of a body
//         are placed when its first such pair comes. Made once per mesh.
// Misses  Nothing that meets, nor a body inside a closed one: what is inside is covered too. Touching is a hit, and
//         balls are larger than they need to be by about 2^-40 of the body's size and 2^-45 of its distance.
// Extra   Everything in the balls and outside the mesh. Fewer balls than `count` where more would fill more space: of a
//         sphere there is one.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm spheres();

}  // namespace algorithms
