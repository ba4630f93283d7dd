// What exact and exact_cold share: a Method over the decision that the truth is made by (geometry/decision/meet.hpp).
#pragma once
#include <string_view>

#include "algorithms/contract/algorithm.hpp"

namespace algorithms {

/// The knob `containment`: whether pairs of which one body lies wholly inside the other are reported too.
Knob containment_knob();

/// What their `count` counts.
inline constexpr std::string_view kDecidingUnit = "pairs of nodes and of triangles, and supports";

/// A Method that answers exactly. Where it does not remember, every step starts from an empty memory. `knobs` has
/// containment; throws std::invalid_argument when it is wanted and every mesh is open.
std::unique_ptr<Method> make_deciding(const Bodies& bodies, const Knobs& knobs, bool remembers);

/// What that takes, told from sizes; of a mesh that is open it does not know.
Memory deciding_memory(const Bodies& bodies, const Knobs& knobs);

}  // namespace algorithms
