// Balls inside a closed mesh that stand for it where bodies touch: few, and together near the surface everywhere.
//
// Every ball is proved to hold no point of the surface and to have its centre inside. They are chosen from the
// greatest balls that touch the surface at points spread over it (balls of the medial axis): as few as come within some
// distance of every such point, greedily, and the distance as small as the wanted number allows. The same bits on every
// machine.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/bodies.hpp"
#include "geometry/decision/contain.hpp"
#include "geometry/mesh.hpp"

namespace geometry {

struct InscribedBalls {
  std::vector<ContactBall> balls;  // none when there is none to be had
  double deviation = 0;  // m: no point of the surface is further from the nearest ball; at most 0.1 % more than needed
};

/// At most `most` (at least 1) balls. `solid` is the mesh's, and closed.
InscribedBalls inscribed_balls(const Mesh& mesh, const Solid& solid, std::size_t most);

/// Bytes that inscribed_balls takes for that, about.
std::uint64_t inscribed_balls_bytes(std::size_t facets, std::size_t most);

}  // namespace geometry
