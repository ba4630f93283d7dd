// exact_cold: `exact` without a memory of the step before: what an exact answer costs where bodies jump, or are asked
// about once.
//
// Source  geometry/decision/meet.hpp, the decision of the truth stage.
// Cost    A sweep of the bodies' boxes and a descent of two hierarchies per near pair.
// Misses  Nothing, as `exact`.
// Extra   Nothing.
#pragma once
#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

Algorithm exact_cold();

}  // namespace algorithms
