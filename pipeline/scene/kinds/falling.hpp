// The keys of kind = "falling".
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/scene/scene.hpp"
#include "pipeline/scene/shape_keys.hpp"

namespace pipeline {

/// A body of the falling scene as its configuration writes it: a built-in shape or a mesh file.
struct FallingBody {
  std::string mesh;            // file as written; empty: a shape
  std::optional<Shape> shape;  // else the mesh
  double density = 0;          // kg/m^3
  std::int64_t contact_spheres = 0;
  std::string place;  // of mesh or shape, for messages
};

/// What stands in the falling scene beside the plate, and never moves.
struct FallingObstacle {
  std::string name;
  FallingBody body;
  std::array<double, 3> position{};               // m
  std::array<double, 4> orientation{1, 0, 0, 0};  // w x y z, as written
};

/// One set of the falling scene: bodies lying on the plate and others above them.
struct FallingSet {
  std::array<std::int64_t, 2> lying{1, 1};     // counts along x and z
  std::array<std::int64_t, 3> above{1, 1, 1};  // counts along x, y and z
  std::array<double, 2> corner{0, 0};          // x and z of the first sphere, m
  double spacing = 2.1;                        // m
  double height = 5;                           // y of the lowest sphere above, m
  std::vector<FallingBody> shapes;             // that its bodies have in turn; empty: the scene's sphere
  bool turned = false;                         // those above are turned at random
};

/// What is foretold of a set, m.
struct Fall {
  double radius = 0;   // of its spheres; of other bodies half their side, on average
  double drop = 0;     // that the lowest of those above falls freely
  double pressed = 0;  // that it would, were they pressed together
  double most = 0;     // that the highest falls, onto those below it
};

/// kind = "falling": a fixed plate with its top at y = 0, obstacles, and sets of spheres or other bodies.
struct FallingScene {
  std::int64_t segments = 16;              // of the sphere's mesh
  double radius = 1;                       // m
  double density = 1000;                   // kg/m^3
  std::array<double, 3> plate{60, 2, 60};  // size, m
  double shift = 0.15;                     // m, of the spheres above in x and z, or all balances on points
  double jitter = 0;                       // m, of the spheres above along each axis at most, drawn from the seed
  std::int64_t contact_spheres = 32;       // at most, of a mesh that is no sphere
  std::vector<FallingSet> sets;            // the thesis's three when the configuration names none
  std::vector<FallingObstacle> obstacles;
  // Of a scene that names files, what is known of them once they were read (SceneKind::complete):
  std::optional<SceneSize> size;
  std::vector<Fall> falls;  // #sets
};

SceneKind falling_kind();

}  // namespace pipeline
