#include "pipeline/scene/solid_body.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/decision/contain.hpp"
#include "geometry/decision/inscribed.hpp"
#include "geometry/mass.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/print.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

/// The facets with corners of equal coordinates as one, and without those that are none.
std::vector<geometry::Facet> joined_facets(const geometry::Mesh& mesh, const geometry::Solid& solid) {
  const std::vector<std::uint32_t> first = geometry::joined_by_coordinates(mesh.vertices);
  std::vector<geometry::Facet> out = solid.surface ? solid.surface->mesh.triangles : mesh.triangles;
  for (geometry::Facet& facet : out)
    for (std::uint32_t& corner : facet) corner = first[corner];
  std::erase_if(out, [](const geometry::Facet& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; });
  return out;
}

}  // namespace

void place_contact_spheres(geometry::Mesh& mesh, std::int64_t most, double closed_within, const std::string& place,
                           const std::string& what) {
  const auto fail = [&](const std::string& why) {
    throw Error(kInput, place + " must be a solid body, not " + what + ": " + why);
  };
  const geometry::Solid solid = geometry::solid_of(mesh, closed_within);
  if (!solid.closed)
    fail("the surface is open, " + geometry::open_text(solid) + "; close it, or raise truth.closed_within");
  const std::vector<geometry::Facet> facets = joined_facets(mesh, solid);
  if (!geometry::face_one_way(facets)) fail("its facets face both ways; turn those that face inward");
  const double volume = geometry::mass_properties(mesh.vertices, facets).volume;
  const geometry::Vec3 size = 2 * geometry::local_box(mesh).half_size();
  constexpr double kNone = 1e-9;  // of its box
  if (!(std::abs(volume) > kNone * (size.x() * size.y() * size.z()))) fail("it has no volume; give it some thickness");
  if (volume < 0) fail("its facets face inward; turn them all");

  const geometry::InscribedBalls found = geometry::inscribed_balls(mesh, solid, std::size_t(most));
  if (found.balls.empty()) fail("no contact sphere finds place in it; it may cross itself, or be too thin");
  // As far as that a body would sink by a good part of itself.
  constexpr double kFarthest = 0.25;  // of the greatest side
  if (found.deviation > kFarthest * size.maxCoeff())
    fail(print("%zu contact spheres inside it leave its surface up to %.3g m away, more than a quarter of its size; ",
               found.balls.size(), found.deviation) +
         "raise contact_spheres, or make it thicker");
  mesh.contact_spheres = found.balls;
  mesh.contact_deviation = found.deviation;
}

RigidBody solid_body(const geometry::Mesh& mesh, double density, double closed_within) {
  const geometry::MassProperties of =
      geometry::mass_properties(mesh.vertices, joined_facets(mesh, geometry::solid_of(mesh, closed_within)));
  RigidBody body;
  body.mass = density * of.volume;
  body.centre_of_mass = {of.centre.x(), of.centre.y(), of.centre.z()};
  for (std::size_t i = 0; i < 6; ++i) body.inertia_matrix[i] = density * of.inertia[i];
  body.radius = 0;
  for (const geometry::ContactBall& ball : mesh.contact_spheres) {
    const geometry::Vec3& c = ball.centre;
    body.spheres.push_back({{c.x(), c.y(), c.z()}, ball.radius});
    body.radius = std::max(body.radius, std::sqrt((c.x() * c.x() + c.y() * c.y()) + c.z() * c.z()) + ball.radius);
  }
  return body;
}

}  // namespace pipeline
