// exact: the answer by which the others are judged, as an algorithm with a time of its own. Remembers the step before.
//
// Source  geometry/decision/meet.hpp, the decision of the truth stage.
// Cost    A sweep of the bodies' boxes; per near pair, where the step before still tells, the triangles that met or the
//         direction that parted the bodies; else a descent of two hierarchies. One set of hierarchies per distinct
//         mesh.
// Misses  Nothing: closed triangles of world vertices as README's "Truth" rounds them. A body wholly inside another has
//         no common surface point with it: a hit only with `containment`, and where the other's mesh is closed.
// Extra   Nothing.
//
// Its promise is judged on the truth that scores, and a knob `containment` that is not given follows it: true beside
// truth.containment = "meet", else false. Given, it holds beside "meet" with true, beside "ignore" with false; beside
// "record" both are right.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm exact();

}  // namespace algorithms
