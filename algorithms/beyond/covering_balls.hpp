// Balls that cover a mesh: every vertex, every facet and, of a closed mesh, everything inside it.
//
// The box around the mesh is cut into cells by planes, one cut after another: always the cell with the greatest ball,
// across the axis that leaves the least. What of the mesh is in a cell lies in the convex hull of its clipped facets
// and of those corners of the cell that are inside the mesh: so does the ball around these. Of the numbers of balls on
// the way that with the least volume in all is taken: more balls are not better where they stick out more, as on a
// sphere.
#pragma once
#include <vector>

#include "algorithms/parts/enclosing_ball.hpp"

namespace algorithms {

struct Covering {
  Ball whole;               // the smallest around all vertices
  std::vector<Ball> balls;  // 1 to `count`; one is `whole`
};

/// The covering of a mesh with at least one vertex. `closed_within` as in geometry::Bodies.
Covering covering_balls(const geometry::Mesh& mesh, std::size_t count, double closed_within);

}  // namespace algorithms
