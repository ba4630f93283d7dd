// What a method tests in place of a mesh, as data: made once per mesh, stored, measured and drawn by others.
#pragma once
#include <string>
#include <vector>

#include "geometry/mesh.hpp"

namespace algorithms {

/// In the frame of the mesh, metres.
struct Proxy {
  enum class Kind {
    balls,    // the balls together
    capsule,  // two balls of one radius and everything between them
    solids    // the insides and surfaces of closed meshes together; a flat one is its surface alone
  };
  Kind kind = Kind::balls;
  std::vector<geometry::ContactBall> balls;
  std::vector<geometry::Mesh> solids;  // vertices and triangles
};

}  // namespace algorithms
