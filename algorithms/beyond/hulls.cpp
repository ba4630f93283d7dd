#include "algorithms/beyond/hulls.hpp"

#include <algorithm>

#include "algorithms/beyond/cells.hpp"
#include "algorithms/beyond/convex_pieces.hpp"
#include "algorithms/contract/pairwise.hpp"
#include "algorithms/parts/convex.hpp"
#include "algorithms/parts/touching_balls.hpp"

namespace algorithms {
namespace {

constexpr std::int64_t kMostPieces = 256;

std::vector<geometry::Convex> pieces_of(const geometry::Mesh& mesh, const Bodies& bodies, const Knobs& knobs) {
  std::vector<geometry::Convex> out;
  for (const auto& points : convex_pieces(mesh, static_cast<std::size_t>(value_of<std::int64_t>(knobs, "count")),
                                          value_of<double>(knobs, "concavity"), bodies.closed_within))
    out.push_back(geometry::convex_of(points));
  return out;
}

struct Hulls {
  Hulls(const Bodies& bodies, const Knobs& knobs) : bodies(bodies), whole(bodies), first(bodies.size() + 1) {
    for (const geometry::Mesh& mesh : bodies.meshes) pieces.push_back(pieces_of(mesh, bodies, knobs));
    for (std::uint32_t body = 0; body < bodies.size(); ++body)
      first[body + 1] = first[body] + pieces[bodies.mesh[body]].size();
    placed.resize(first.back());
    placed_at.resize(bodies.size());
  }

  /// Whether a mesh is cut, and into how many pieces, is not known from sizes: as if it stayed whole. Cutting takes
  /// about half as much again as finding that it need not be, measured on spheres and knots: in between.
  static Memory memory(const Bodies& bodies, const Knobs&) {
    Memory out = memory_by_body(
        bodies, touching_balls_bytes() + sizeof(geometry::PlacedConvex) + sizeof(std::size_t) + sizeof(std::uint64_t));
    std::uint64_t most = 0;
    for (const geometry::Mesh& mesh : bodies.meshes) {
      out.held += geometry::convex_bytes(mesh.vertices.size());
      most = std::max(most, cutting_bytes(mesh) * 3 / 5);
    }
    out.greatest = out.held + most;
    return out;
  }

  void prepare(std::span<const Pose> poses, double enlarge) {
    whole.prepare(poses, enlarge);
    at = poses;
    more = enlarge;
    ++step;
  }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) {
    count += 1;
    return whole.touch(a, b) && pieces_meet(a, b, count);
  }

  void row(std::uint32_t a, std::uint32_t from, std::uint32_t to, std::uint8_t* out) {
    whole.row(a, from, to, out);
    NoCount none;
    for (std::uint32_t b = from; b < to; ++b)
      if (out[b - from]) out[b - from] = pieces_meet(a, b, none);
  }

  template <class Count>
  bool pieces_meet(std::uint32_t a, std::uint32_t b, Count& count) {
    place(a);
    place(b);
    std::uint64_t operations = 0;
    bool met = false;
    for (std::size_t i = first[a]; i < first[a + 1] && !met; ++i)
      for (std::size_t k = first[b]; k < first[b + 1] && !met; ++k)
        met = geometry::convex_meet(placed[i], placed[k], operations);
    count += operations;
    return met;
  }

  void place(std::uint32_t body) {
    if (placed_at[body] == step) return;
    placed_at[body] = step;
    std::size_t i = first[body];
    for (const geometry::Convex& piece : pieces[bodies.mesh[body]])
      placed[i++] = geometry::placed(piece, at[body], more);
  }

  const Bodies& bodies;
  TouchingBalls whole;
  std::vector<std::vector<geometry::Convex>> pieces;  // of each distinct mesh
  std::vector<std::size_t> first;                     // #bodies + 1, into `placed`
  std::vector<geometry::PlacedConvex> placed;         // of the step
  std::vector<std::uint64_t> placed_at;               // the step at which a body's pieces were placed
  std::uint64_t step = 0;
  std::span<const Pose> at;
  double more = 0;
};

std::vector<Proxy> proxies(const Bodies& bodies, const Knobs& knobs) {
  std::vector<Proxy> out;
  for (const geometry::Mesh& mesh : bodies.meshes) {
    Proxy& proxy = out.emplace_back(Proxy{.kind = Proxy::Kind::solids, .balls = {}, .solids = {}});
    for (geometry::Convex& piece : pieces_of(mesh, bodies, knobs))
      proxy.solids.push_back(geometry::surface_with_facets(std::move(piece)));
  }
  return out;
}

}  // namespace

Algorithm hulls() {
  return {.name = "hulls",
          .what = "convex pieces of the bodies share a point",
          .operations_unit = "distances and corners",
          .knobs = {{.name = "count",
                     .preset = std::int64_t{16},
                     .unit = "1",
                     .what = "at most this many pieces; 1: the convex hull",
                     .least = 1,
                     .most = kMostPieces},
                    {.name = "concavity",
                     .preset = 0.02,
                     .unit = "1",
                     .what = "enough when the pieces hold no more beyond the mesh, of its volume",
                     .least = 0,
                     .most = 1e6}},
          .make = make_pairwise<Hulls>,
          .fits_all = true,
          .memory = Hulls::memory,
          .proxies = proxies};
}

}  // namespace algorithms
