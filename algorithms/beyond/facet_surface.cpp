#include "algorithms/beyond/facet_surface.hpp"

#include <algorithm>
#include <cmath>

#include "algorithms/contract/prefilter.hpp"
#include "algorithms/parts/convex.hpp"
#include "algorithms/parts/facet_knobs.hpp"
#include "algorithms/parts/simplified.hpp"
#include "geometry/decision/meet.hpp"
#include "geometry/vec.hpp"

namespace algorithms {
namespace {

using geometry::Mesh;
using geometry::Vec3;

constexpr std::size_t kLeastFacets = 32;
constexpr double kConvex = 0.98;  // a body that fills so much of its hull is taken for convex

/// Six times the volume within a closed surface; of an open one, of what it and rays to the middle enclose.
double volume(const Mesh& mesh) {
  const Vec3 middle = geometry::local_box(mesh).centre();
  double sum = 0;
  for (const auto& [i, j, k] : mesh.triangles)
    sum +=
        geometry::dot(mesh.vertices[i] - middle, geometry::cross(mesh.vertices[j] - middle, mesh.vertices[k] - middle));
  return sum;
}

std::size_t facets_wanted(const Mesh& mesh, const Knobs& knobs) {
  const auto stride = static_cast<std::size_t>(value_of<std::int64_t>(knobs, "stride"));
  return std::max(kLeastFacets, mesh.triangles.size() / stride);
}

/// What stands for a mesh.
struct Envelope {
  Mesh surface;
  geometry::Convex hull;  // of its corners
  bool convex = false;    // the hull is the surface
  double volume = 0;      // of the hull, six times
};

Envelope envelope(const Mesh& mesh, const Knobs& knobs) {
  Envelope out;
  out.surface = geometry::simplified(mesh, facets_wanted(mesh, knobs));
  if (out.surface.triangles.empty()) out.surface = mesh;  // nothing but facets without area
  if (out.surface.triangles.size() < mesh.triangles.size())
    for (Vec3& v : out.surface.vertices) v *= value_of<double>(knobs, "inflate");
  out.hull = geometry::convex_of(out.surface.vertices);
  out.volume = volume(out.hull.surface);
  out.convex = out.hull.dimension == 3 && volume(out.surface) >= kConvex * out.volume;
  if (out.convex) out.surface = out.hull.surface;
  return out;
}

Bodies bodies_of(const Bodies& bodies, const std::vector<Envelope>& envelopes) {
  Bodies out = bodies;
  for (std::size_t i = 0; i < envelopes.size(); ++i) out.meshes[i] = envelopes[i].surface;
  return out;
}

struct FacetSurface {
  FacetSurface(const Bodies& bodies, const Knobs& knobs) : placed(bodies.size()), is(bodies.size()) {
    envelopes.reserve(bodies.meshes.size());
    for (const Mesh& mesh : bodies.meshes) envelopes.push_back(envelope(mesh, knobs));
    surfaces = bodies_of(bodies, envelopes);
    bvhs = geometry::build_bvhs(surfaces);
    decision.emplace(surfaces, bvhs);
  }

  static Memory memory(const Bodies& bodies, const Knobs& knobs) {
    constexpr std::uint64_t kMaking = 330;  // bytes a facet while edges collapse: 260 to 410 were measured
    Memory out = memory_by_body(
        bodies, sizeof(geometry::PlacedConvex) + 1 + sizeof(std::uint32_t) + 2 + sizeof(std::string) + 16);
    out.held += geometry::broad_phase_bytes(bodies) / 2;
    for (const Mesh& mesh : bodies.meshes) {
      const std::uint64_t facets = std::min(mesh.triangles.size(), facets_wanted(mesh, knobs)),
                          corners = facets / 2 + 2;
      const std::uint64_t surface = corners * sizeof(Vec3) + facets * sizeof(geometry::Facet);
      out.greatest = std::max(out.greatest, out.held + kMaking * mesh.triangles.size());
      out.held += sizeof(Envelope) + 2 * surface + geometry::convex_bytes(corners) + geometry::bvh_bytes(facets);
    }
    out.greatest = std::max(out.greatest, out.held);
    return out;
  }

  void prepare(std::span<const Pose> now, double) {
    poses = now;
    std::fill(is.begin(), is.end(), std::uint8_t{0});
  }

  const geometry::PlacedConvex& place(std::uint32_t body) {
    if (!is[body]) placed[body] = geometry::placed(of(body).hull, poses[body]);
    is[body] = 1;
    return placed[body];
  }

  const Envelope& of(std::uint32_t body) const { return envelopes[surfaces.mesh[body]]; }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) {
    std::uint64_t corners = 0;
    const bool met = meet(a, b, corners);
    count += corners;
    return met;
  }

  bool meet(std::uint32_t a, std::uint32_t b, std::uint64_t& operations) {
    const geometry::PlacedConvex &p = place(a), &q = place(b);
    if (!geometry::convex_meet(p, q, operations)) return false;
    if (!of(a).convex || !of(b).convex) {
      const std::uint64_t before = decision->operations();
      const bool met = decision->meet(poses, {a, b});
      operations += decision->operations() - before;
      return met;
    }
    // Convex surfaces meet when their solids do and the smaller is not inside the larger.
    const double x = of(a).volume, y = of(b).volume;
    return !(x < y && geometry::convex_inside(p, q, operations)) &&
           !(y < x && geometry::convex_inside(q, p, operations));
  }

  std::vector<Envelope> envelopes;  // per distinct mesh
  Bodies surfaces;                  // the bodies with them as meshes
  std::vector<geometry::Bvh> bvhs;  // of those
  std::optional<geometry::Decision> decision;
  std::span<const Pose> poses;                 // of the step
  std::vector<geometry::PlacedConvex> placed;  // hulls, when `is` has 1
  std::vector<std::uint8_t> is;
};

std::vector<Proxy> proxies(const Bodies& bodies, const Knobs& knobs) {
  std::vector<Proxy> out;
  for (const Mesh& mesh : bodies.meshes)
    out.push_back({.kind = Proxy::Kind::solids, .balls = {}, .solids = {envelope(mesh, knobs).surface}});
  return out;
}

}  // namespace

Algorithm facet_surface() {
  Knob inflate = inflate_knob();
  inflate.preset = 1.03;
  inflate.what = "factor on the surface, about the body's origin; not where it is the mesh itself";
  return {.name = "facet_surface",
          .what = "closed surfaces of about one stride-th of the facets meet",
          .operations_unit = with_prefilter("corners, pairs of nodes and of triangles"),
          .promise = Promise::none,
          .knobs = {stride_knob(), inflate, prefilter_knob()},
          .make = make_filtered<FacetSurface>,
          .memory = filtered_memory<FacetSurface>,
          .proxies = proxies};
}

}  // namespace algorithms
