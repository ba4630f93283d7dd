// The only file of this folder that sees Simbody; C++17, assertions on, as Debian's library is built.
#include "algorithms/peers/libraries/simbody_meshes.hpp"

#include <simmath/internal/CollisionDetectionAlgorithm.h>
#include <simmath/internal/ContactGeometry.h>

namespace peers {

using SimTK::ContactGeometry;
using SimTK::Vec3;

struct SimbodyMeshes::Held {
  std::vector<ContactGeometry::TriangleMesh> meshes;
  SimTK::CollisionDetectionAlgorithm::TriangleMeshTriangleMesh test;
};

SimbodyMeshes::SimbodyMeshes() : held_(std::make_unique<Held>()) {}
SimbodyMeshes::~SimbodyMeshes() = default;

void SimbodyMeshes::add(const double* vertices, std::size_t vertex_count, const std::uint32_t* triangles,
                        std::size_t triangle_count) {
  SimTK::Array_<Vec3> points;
  for (std::size_t i = 0; i < vertex_count; ++i)
    points.push_back(Vec3(vertices[3 * i], vertices[3 * i + 1], vertices[3 * i + 2]));
  SimTK::Array_<int> corners;
  for (std::size_t i = 0; i < 3 * triangle_count; ++i) corners.push_back(int(triangles[i]));
  held_->meshes.emplace_back(points, corners);
}

bool SimbodyMeshes::meet(std::size_t a, const double* rotation_a, const double* position_a, std::size_t b,
                         const double* rotation_b, const double* position_b) const {
  const auto place = [](const double* r, const double* p) {
    const SimTK::Mat33 rows(r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8]);
    return SimTK::Transform(SimTK::Rotation(rows, true), Vec3(p[0], p[1], p[2]));
  };
  SimTK::Array_<SimTK::Contact> contacts;
  held_->test.processObjects(SimTK::ContactSurfaceIndex(0), held_->meshes[a], place(rotation_a, position_a),
                             SimTK::ContactSurfaceIndex(1), held_->meshes[b], place(rotation_b, position_b), contacts);
  return !contacts.empty();
}

}  // namespace peers
