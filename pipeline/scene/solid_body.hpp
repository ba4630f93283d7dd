// The physical side of bodies of any closed mesh: mass and inertia of what it encloses, and the spheres by which it is
// touched.
#pragma once
#include <cstdint>
#include <string>

#include "geometry/mesh.hpp"
#include "pipeline/physics/simulate.hpp"

namespace pipeline {

constexpr std::int64_t kMostContactSpheres = 10000;  // of a mesh

/// Gives the mesh, `what` at `place`, at most `most` contact spheres. Throws Error(kInput) for a mesh that is open,
/// faces both ways, has no volume, or in which no spheres find place that come near its surface everywhere.
/// `closed_within` as in Bodies.
void place_contact_spheres(geometry::Mesh& mesh, std::int64_t most, double closed_within, const std::string& place,
                           const std::string& what);

/// A body of such a mesh. Its position is that of the mesh's origin.
RigidBody solid_body(const geometry::Mesh& mesh, double density, double closed_within);

}  // namespace pipeline
