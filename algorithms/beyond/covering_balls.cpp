// Why the balls cover. Everything is computed in the unit frame (|coordinates| <= 1), u = 2^-53.
//
// Cells. The cells of a cut share its plane x_k = c and together are the whole box: every point of the mesh is in one.
//
// Facets. A cell keeps polygons whose points are within d of every point that a facet has in the cell. A cut keeps what
// is within a margin s of its side: a point of the facet in the cell is on its side, what is within d <= s of it is
// kept. A corner that the cut makes is p + (c - p_k) / (q_k - p_k) (q - p), computed to within 16 u; so d grows by 16 u
// a cut. With at most n cuts one after another
//   d <= 16 u n = 2^-49 n = s                                                                                       (1)
//
// Inside. What is in a cell is in the hull of its facets and of those corners that are inside (cells.hpp). Which these
// are is decided exactly for the vertices in the unit frame, which differ from the mesh's by 2 u: a corner for which
// that tells otherwise is within 4 u of a facet, hence of a polygon that is kept. So what is in the cell is within
// d + 4 u of the ball's points, and
//   radius += 2^-49 (n + 1)                                                                                         (2)
// covers it. Where corners were taken for one to close the mesh (geometry/decision/contain.hpp), the closed surface has
// facets that are up to sqrt(3) closed_within from those as read: so much more.
#include "algorithms/beyond/covering_balls.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "algorithms/beyond/cells.hpp"

namespace algorithms {
namespace {

using geometry::Box;
using geometry::Mesh;
using geometry::Vec3;

struct Cell {
  Box box;
  Polygons facets;
  Ball ball;
};

std::optional<Cell> cell_of(const Box& box, Polygons facets, const Inside& inside) {
  Cell out{box, std::move(facets), {}};
  const std::vector<Vec3> points = points_in(box, out.facets, inside);
  if (points.empty()) return std::nullopt;
  out.ball = enclosing_ball(points);
  return out;
}

/// The two cells of a cut, without those in which there is nothing.
std::vector<Cell> cut(const Cell& cell, int k, double at, double margin, const Inside& inside) {
  std::vector<Cell> out;
  for (const double side : {1.0, -1.0}) {
    Box box = cell.box;
    (side > 0 ? box.max : box.min)[k] = at;
    if (auto part = cell_of(box, clipped(cell.facets, k, at + side * margin, side), inside))
      out.push_back(std::move(*part));
  }
  return out;
}

double cube(double x) { return x * x * x; }

/// The cut that leaves the least volume of balls; across the longest side where others are hardly better: of a ring the
/// halves have balls as large as the whole's, and cuts across the thickness, hardly better, would never end.
std::vector<Cell> best_cut(const Cell& cell, double margin, const Inside& inside) {
  constexpr double kHardly = 0.9;
  const Box box = geometry::bounds(cell.facets.points);
  int longest = 0;
  if (!cell.facets.points.empty()) (box.max - box.min).maxCoeff(&longest);
  std::vector<Cell> best;
  double least = 0;
  for (int k = 0; k < 3; ++k) {
    const double at = 0.5 * (std::fmax(box.min[k], cell.box.min[k]) + std::fmin(box.max[k], cell.box.max[k]));
    if (!(at > cell.box.min[k] && at < cell.box.max[k])) continue;
    std::vector<Cell> parts = cut(cell, k, at, margin, inside);
    double volume = 0;
    for (const Cell& part : parts) volume += cube(part.ball.radius);
    if (k == longest) volume *= kHardly;
    if (best.empty() || volume < least) best = std::move(parts), least = volume;
  }
  return best;
}

/// Of the balls together, by counting the points of a grid.
double volume(std::span<const Ball> balls) {
  constexpr int kGrid = 32;
  Box box;
  for (const Ball& ball : balls) {
    box.add(ball.centre - Vec3::Constant(ball.radius));
    box.add(ball.centre + Vec3::Constant(ball.radius));
  }
  const Vec3 step = (box.max - box.min) / kGrid;
  int count = 0;
  std::vector<Ball> row;
  for (int z = 0; z < kGrid; ++z)
    for (int y = 0; y < kGrid; ++y) {
      const double py = box.min.y() + (y + 0.5) * step.y(), pz = box.min.z() + (z + 0.5) * step.z();
      row.clear();
      for (const Ball& ball : balls) {
        const double dy = py - ball.centre.y(), dz = pz - ball.centre.z(),
                     square = ball.radius * ball.radius - (dy * dy + dz * dz);
        if (square >= 0) row.push_back({ball.centre, std::sqrt(square)});
      }
      for (int x = 0; x < kGrid && !row.empty(); ++x) {
        const double px = box.min.x() + (x + 0.5) * step.x();
        count += std::ranges::any_of(row, [&](const Ball& b) { return std::fabs(px - b.centre.x()) <= b.radius; });
      }
    }
  return (step.x() * step.y()) * (step.z() * count);
}

/// Numbers of balls that are looked at: 1, 2, 3, 4, 6, 8, 12, … and the greatest.
bool is_looked_at(std::size_t n, std::size_t count) {
  while (n % 2 == 0 && n > 3) n /= 2;
  return n <= 3 || n == count;
}

}  // namespace

Covering covering_balls(const Mesh& mesh, std::size_t count, double closed_within) {
  const UnitFrame frame(mesh.vertices);
  std::vector<Vec3> unit = frame.to_unit(mesh.vertices);
  const Ball whole = enclosing_ball(unit);
  Covering out{.whole = frame.from_unit(whole), .balls = {}};
  out.balls = {out.whole};
  if (count == 1 || !(whole.radius > 0)) return out;

  const geometry::Solid solid = geometry::solid_of(mesh, closed_within);
  const std::size_t most_cuts = 2 * count;  // some leave one cell only
  const double margin = 0x1p-49 * double(most_cuts);
  const Box box = geometry::bounds(unit);
  Polygons facets = polygons_of(mesh, unit);
  const Inside inside(mesh, solid, std::move(unit));
  std::vector<Cell> cells;
  if (auto all = cell_of(box, std::move(facets), inside)) cells.push_back(std::move(*all));

  std::vector<Ball> best = {whole};
  double least = volume(best);
  for (std::size_t cuts = 0; cuts < most_cuts && cells.size() < count; ++cuts) {
    const auto greatest = std::ranges::max_element(cells, {}, [](const Cell& cell) { return cell.ball.radius; });
    std::vector<Cell> parts = best_cut(*greatest, margin, inside);
    if (parts.empty()) break;  // it is a point
    *greatest = std::move(parts.front());
    if (parts.size() == 1) continue;
    cells.push_back(std::move(parts.back()));
    if (!is_looked_at(cells.size(), count)) continue;
    std::vector<Ball> balls;
    for (const Cell& cell : cells) balls.push_back(cell.ball);
    if (const double now = volume(balls); now < least) best = std::move(balls), least = now;
  }
  if (best.size() == 1) return out;
  const double more = 0x1p-49 * double(most_cuts + 1);  // (2)
  const double joined = solid.surface ? 1.7321 * solid.closed_within : 0;
  out.balls.clear();
  for (const Ball& ball : best) {
    out.balls.push_back(frame.from_unit(ball, more));
    out.balls.back().radius += joined;
  }
  return out;
}

}  // namespace algorithms
