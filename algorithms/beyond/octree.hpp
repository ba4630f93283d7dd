// octree: bodies in a tree of cells; pairs that share a leaf go to another method, each once.
//
// Source  Příbyl 2022, section 2.1: the scene's box is cut into eight, again and again, until a cell holds at most
//         `capacity` bodies or the depth is reached. A body stands in every leaf that its world box touches.
// Cost    Rebuilt every step: of each body some comparisons per level and cell; of each leaf its pairs; and `then` for
//         those pairs alone.
// Misses  What `then` misses; nothing else: bodies that share a point share the leaf that it is in.
// Extra   What `then` reports falsely, but for pairs that share no leaf. Its promise is that of `then`.
//
// A cell that cutting would not thin stays a leaf: one whose children would hold four times as many bodies together,
// as they do when bodies are larger than cells. So the tree stays small where many bodies overlap.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm octree();

}  // namespace algorithms
