// What a scene says of its size before it is made, against the scene.
#pragma once
#include <gtest/gtest.h>

#include "pipeline/scene/scene.hpp"

namespace tests {

inline void expect_size(const pipeline::SceneSize& size, const pipeline::Scene& scene) {
  std::uint64_t vertices = 0, triangles = 0, body_vertices = 0;
  for (const auto& mesh : scene.bodies.meshes) vertices += mesh.vertices.size(), triangles += mesh.triangles.size();
  for (std::uint32_t b = 0; b < scene.bodies.size(); ++b) body_vertices += scene.bodies.mesh_of(b).vertices.size();
  EXPECT_EQ(size.bodies, scene.bodies.size());
  EXPECT_EQ(size.meshes, scene.bodies.meshes.size());
  EXPECT_EQ(size.mesh_vertices, vertices);
  EXPECT_EQ(size.mesh_triangles, triangles);
  EXPECT_EQ(size.body_vertices, body_vertices);
}

}  // namespace tests
