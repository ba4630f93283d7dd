#include "algorithms/beyond/convex_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "algorithms/beyond/cells.hpp"
#include "algorithms/parts/enclosing_ball.hpp"
#include "geometry/decision/hull.hpp"
#include "geometry/mass.hpp"

namespace algorithms {
namespace {

using geometry::Box;
using geometry::Mesh;
using geometry::Vec3;

/// Points of a grid over the box around a mesh that are inside it.
class Samples {
 public:
  Samples(const Box& box, const Inside& inside) {
    constexpr int kGrid = 20;
    const Vec3 step = (box.max - box.min) / kGrid;
    each_ = (step.x() * step.y()) * step.z();
    for (int x = 0; x < kGrid; ++x)
      for (int y = 0; y < kGrid; ++y)
        for (int z = 0; z < kGrid; ++z) {
          const Vec3 p(box.min.x() + (x + 0.5) * step.x(), box.min.y() + (y + 0.5) * step.y(),
                       box.min.z() + (z + 0.5) * step.z());
          if (inside(p)) points_.push_back(p);
        }
  }
  /// What of the mesh's volume is in the box, about.
  double volume(const Box& box) const {
    const auto in = [&](const Vec3& p) {
      return (p.array() >= box.min.array()).all() && (p.array() < box.max.array()).all();
    };
    return each_ * double(std::ranges::count_if(points_, in));
  }

 private:
  std::vector<Vec3> points_;
  double each_ = 0;
};

/// The half of a cell below or above a plane.
struct Half {
  int k;            // axis
  double at;        // of the plane
  double side;      // 1: what is below it, -1: above
  bool takes_flat;  // what lies in the plane is its
};

/// What of the mesh is in a cell.
struct Piece {
  Box box;  // the cell
  Polygons facets;
  std::vector<Half> halves;       // of the whole, one after another
  double volume = 0, beyond = 0;  // of the hull; what of it is not the mesh, about
};

double hull_volume(std::span<const Vec3> points) {
  const geometry::Hull hull = geometry::convex_hull(points);
  if (hull.dimension < 3) return 0;
  std::vector<Vec3> corners;
  for (const std::uint32_t i : hull.corners) corners.push_back(points[i]);
  return geometry::mass_properties(corners, hull.triangles).volume;
}

/// The points of polygons in a cell and those of its corners near which it is inside the mesh. A corner on the surface
/// is asked a little within the cell: the mesh may only touch it there.
std::vector<Vec3> points_within(const Box& box, const Polygons& facets, const Inside& inside) {
  constexpr double kLittle = 0x1p-30;
  const Vec3 little = kLittle * (box.max - box.min);
  const Box within{box.min + little, box.max - little};
  std::vector<Vec3> out = facets.points;
  for (int i = 0; i < 8; ++i)
    if (inside(corner(within, i))) out.push_back(corner(box, i));
  return out;
}

void cut_box(Box& box, int k, double at, double side) { (side > 0 ? box.max : box.min)[k] = at; }

/// All that a cut needs to know.
struct Cutting {
  const Inside& inside;
  Samples samples;
  double margin;

  std::optional<Piece> piece(const Box& box, Polygons facets, std::vector<Half> halves) const {
    const std::vector<Vec3> points = points_within(box, facets, inside);
    if (points.empty()) return std::nullopt;
    Piece out{box, std::move(facets), std::move(halves), hull_volume(points), 0};
    out.beyond = out.volume - samples.volume(box);
    return out;
  }

  /// What lies in the plane goes below or above it.
  std::vector<Piece> cut(const Piece& piece, int k, double at, bool flat_below) const {
    std::vector<Piece> out;
    for (const double side : {1.0, -1.0}) {
      const Half half{k, at, side, (side > 0) == flat_below};
      Box box = piece.box;
      cut_box(box, k, at, side);
      std::vector<Half> halves = piece.halves;
      halves.push_back(half);
      if (auto part = this->piece(box, parted(piece.facets, k, at, side, margin, half.takes_flat), std::move(halves)))
        out.push_back(std::move(*part));
    }
    return out;
  }
};

/// Where a piece may be cut along axis k: at its few vertices, or at quarters.
std::vector<double> places(const Piece& piece, int k) {
  constexpr std::size_t kFew = 8;
  std::vector<double> out;
  for (const Vec3& p : piece.facets.points) out.push_back(p[k]);
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end(), [](double a, double b) { return b - a < 0x1p-30; }), out.end());
  if (out.empty()) return out;
  const double low = std::fmax(out.front(), piece.box.min[k]), high = std::fmin(out.back(), piece.box.max[k]);
  std::erase_if(out, [&](double at) { return !(at > low + 0x1p-30 && at < high - 0x1p-30); });
  if (out.size() <= kFew && !out.empty()) return out;
  out.clear();
  if (high - low > 0x1p-20)
    for (const double part : {0.25, 0.5, 0.75}) out.push_back(low + part * (high - low));
  return out;
}

/// Whether some polygon may lie in the plane.
bool is_flat_at(const Piece& piece, int k, double at, double margin) {
  return std::ranges::any_of(piece.facets.points, [&](const Vec3& p) { return std::fabs(p[k] - at) <= margin; });
}

/// Across the longest side where other cuts are hardly better: the hulls of half a ring hold as much as that of the
/// whole.
std::vector<Piece> best_cut(const Piece& piece, const Cutting& cutting) {
  constexpr double kHardly = 0.95;
  const Box box = geometry::bounds(piece.facets.points);
  int longest = 0;
  if (!piece.facets.points.empty()) (box.max - box.min).maxCoeff(&longest);
  std::vector<Piece> best;
  double least = 0;
  for (int k = 0; k < 3; ++k)
    for (const double at : places(piece, k))
      for (const bool flat_below : {true, false}) {
        const bool flat = is_flat_at(piece, k, at, cutting.margin);
        if (!flat && !flat_below) continue;
        std::vector<Piece> parts = cutting.cut(piece, k, at, flat_below);
        double volume = 0;
        for (const Piece& part : parts) volume += part.volume;
        if (k == longest) volume *= kHardly;
        if (best.empty() || volume < least) best = std::move(parts), least = volume;
      }
  return best;
}

/// Of each piece how it is cut out of the whole, in the unit frame.
std::vector<std::vector<Half>> cuts_of(const Mesh& mesh, const geometry::Solid& solid, const std::vector<Vec3>& unit,
                                       std::size_t count, double concavity) {
  const Box box = geometry::bounds(unit);
  const bool has_volume = solid.closed && !solid.surface && geometry::face_one_way(mesh.triangles);
  const double volume = has_volume ? std::fabs(geometry::mass_properties(unit, mesh.triangles).volume) : 0;
  if (count == 1 || hull_volume(unit) - volume <= concavity * volume) return {{}};

  const Inside inside(mesh, solid, unit);
  const Cutting cutting{inside, Samples(box, inside), 0x1p-49 * double(2 * count)};
  std::vector<Piece> pieces;
  if (auto all = cutting.piece(box, polygons_of(mesh, unit), {})) pieces.push_back(std::move(*all));
  for (std::size_t cuts = 0; cuts < 2 * count && pieces.size() < count; ++cuts) {
    double held = 0;
    for (const Piece& piece : pieces) held += piece.volume;
    if (held - volume <= concavity * volume) break;
    const auto worst = std::ranges::max_element(pieces, {}, &Piece::beyond);
    std::vector<Piece> parts = best_cut(*worst, cutting);
    if (parts.empty()) break;
    *worst = std::move(parts.front());
    if (parts.size() > 1) pieces.push_back(std::move(parts.back()));
  }
  std::vector<std::vector<Half>> out;
  for (Piece& piece : pieces) out.push_back(std::move(piece.halves));
  return out;
}

}  // namespace

std::vector<std::vector<Vec3>> convex_pieces(const Mesh& mesh, std::size_t count, double concavity,
                                             double closed_within) {
  const UnitFrame frame(mesh.vertices);
  const std::vector<Vec3> unit = frame.to_unit(mesh.vertices);
  const geometry::Solid solid = geometry::solid_of(mesh, closed_within);
  const std::vector<std::vector<Half>> cuts = cuts_of(mesh, solid, unit, count, concavity);
  if (cuts.size() <= 1) return {mesh.vertices};
  // Once more in the mesh's frame, so that its vertices stay as they are. The margin is the rounding of the planes.
  const Inside inside(mesh, solid, mesh.vertices);
  const Polygons all = polygons_of(mesh, mesh.vertices);
  const double margin = 16 * frame.slack();
  std::vector<std::vector<Vec3>> out;
  for (const std::vector<Half>& halves : cuts) {
    Box box = geometry::bounds(mesh.vertices);
    Polygons facets = all;
    for (const Half& half : halves) {
      const double at = frame.from_unit(Vec3::Constant(half.at))[half.k];
      facets = parted(facets, half.k, at, half.side, margin, half.takes_flat);
      cut_box(box, half.k, at, half.side);
    }
    if (std::vector<Vec3> points = points_within(box, facets, inside); !points.empty())
      out.push_back(std::move(points));
  }
  return out;
}

}  // namespace algorithms
