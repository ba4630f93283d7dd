// What is certain. For corners v of a body, R and t of its pose, S the sum of both reaches and L that of both |t|, the
// gap along a direction d, |d| <= 1 + 2^-20,
//   d . (t_b - t_a) - (max (R_a^T d) . v_a + max (-R_b^T d) . v_b)                                              (1)
//
// as computed here is wrong by less than 18 u (S + L), u = 2^-53, the rounding of the world vertices included: (7) of
// geometry/decision/frames.cpp, which bounds these very sums. Underflow adds less than 2^-1060. Both are covered by
//   margin_a + margin_b,   margin = 2^-45 (reach + |t|) + 2^-1060                                               (2)
//
// which also covers bounding balls, (4) there. Everything else only finds the direction: it decides how fast, and
// whether what is apart by little more than the margin is seen to be.
#include "algorithms/parts/convex.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "geometry/decision/hull.hpp"
#include "geometry/processor_clones.hpp"
#include "geometry/vec.hpp"

namespace geometry {
namespace {

Vec3 turned_back(const Mat3& r, const Vec3& d) { return {dot(r.col(0), d), dot(r.col(1), d), dot(r.col(2), d)}; }

Vec3 turned(const Mat3& r, const Vec3& v) { return to_world(r, Vec3::Zero(), v); }

/// The cell of a direction: the side of the cube that it leaves through, and where.
std::uint32_t cell(const Vec3& d) {
  const double x = std::fabs(d.x()), y = std::fabs(d.y()), z = std::fabs(d.z());
  const int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
  const double half = 0.5 * Convex::kGrid / std::fabs(d[axis]);
  const auto along = [&](int k) {
    const double place = d[(axis + k) % 3] * half + 0.5 * Convex::kGrid;
    return static_cast<std::uint32_t>(std::fmin(std::fmax(place, 0), Convex::kGrid - 1));
  };
  const std::uint32_t side = 2 * axis + (d[axis] > 0);
  return (side * Convex::kGrid + along(1)) * Convex::kGrid + along(2);
}

/// The middle of a cell.
Vec3 direction(std::uint32_t cell) {
  const std::uint32_t side = cell / (Convex::kGrid * Convex::kGrid), axis = side / 2;
  const auto along = [](std::uint32_t k) { return (2.0 * k + 1) / Convex::kGrid - 1; };
  Vec3 out;
  out[axis] = side % 2 ? 1 : -1;
  out[(axis + 1) % 3] = along(cell / Convex::kGrid % Convex::kGrid);
  out[(axis + 2) % 3] = along(cell % Convex::kGrid);
  return out;
}

/// Walks uphill along the edges. On a hull no neighbour is higher than a corner that is highest, but for rounding.
std::uint32_t climb(const Convex& solid, const Vec3& d, std::uint32_t from, std::uint64_t& operations) {
  const std::vector<Vec3>& corners = solid.surface.vertices;
  double top = dot(d, corners[from]);
  for (std::uint32_t at = from;;) {
    operations += solid.first[at + 1] - solid.first[at];
    std::uint32_t best = at;
    for (std::uint32_t k = solid.first[at]; k < solid.first[at + 1]; ++k)
      if (const double height = dot(d, corners[solid.beside[k]]); height > top) best = solid.beside[k], top = height;
    if (best == at) return at;
    at = best;
  }
}

/// The corner that is highest of all as computed.
std::uint32_t highest(const Convex& solid, const Vec3& d, std::uint64_t& operations) {
  const std::vector<Vec3>& corners = solid.surface.vertices;
  operations += corners.size();
  std::uint32_t best = 0;
  for (std::uint32_t i = 1; i < corners.size(); ++i)
    if (dot(d, corners[i]) > dot(d, corners[best])) best = i;
  return best;
}

/// The greatest dot product of d with a corner. `size` is a multiple of kLanes.
PROCESSOR_CLONES double height(const double* x, const double* y, const double* z, std::size_t size, double dx,
                               double dy, double dz) {
  double top[Convex::kLanes];
  for (int l = 0; l < Convex::kLanes; ++l) top[l] = (dx * x[l] + dy * y[l]) + dz * z[l];
  for (std::size_t i = Convex::kLanes; i < size; i += Convex::kLanes)
    for (int l = 0; l < Convex::kLanes; ++l) {
      const double p = (dx * x[i + l] + dy * y[i + l]) + dz * z[i + l];
      top[l] = p > top[l] ? p : top[l];
    }
  return *std::max_element(top, top + Convex::kLanes);
}

double height(const Convex& solid, const Vec3& d, std::uint64_t& operations) {
  operations += solid.surface.vertices.size();
  return height(solid.columns.x.data(), solid.columns.y.data(), solid.columns.z.data(), solid.columns.size(), d.x(),
                d.y(), d.z());
}

/// True when (1) says that the solids are certainly apart along d, a unit vector to rounding.
bool certainly_apart(const PlacedConvex& a, const PlacedConvex& b, const Vec3& d, std::uint64_t& operations) {
  const double tops =
      height(*a.solid, turned_back(a.at.r, d), operations) + height(*b.solid, turned_back(b.at.r, -d), operations);
  return dot(d, b.at.t - a.at.t) - tops > a.margin + b.margin;
}

/// From p to the nearest point of the solid's box: 0 inside.
Vec3 to_box(const Vec3& p, const PlacedConvex& to) {
  const Vec3 local = turned_back(to.at.r, p - to.at.middle), &half = to.solid->around.half;
  return turned(to.at.r, local.cwiseMax(-half).cwiseMin(half) - local);
}

/// A guess at the way from a to b: from middle to middle, but of a small body beside a large one straight to it.
Vec3 first_way(const PlacedConvex& a, const PlacedConvex& b, const Vec3& between) {
  const Vec3 there = to_box(a.at.middle, b), back = to_box(b.at.middle, a);
  const double from_a = dot(there, there), from_b = dot(back, back), least = 0.25 * dot(between, between);
  if (from_a > 0 && from_a < from_b && from_a < least) return there;
  if (from_b > 0 && from_b < from_a && from_b < least) return -back;
  return between;
}

/// The point of a simplex that is nearest to the origin, and which corners carry it (bits).
struct Nearest {
  Vec3 at;
  double square;
  unsigned kept;
};

Nearest corner(const Vec3& p, unsigned bit) { return {p, dot(p, p), bit}; }

/// Corrected once: near touching the first difference is mostly rounding, and its part along the edge counts most.
Nearest segment(const Vec3& p, const Vec3& q, unsigned p_bit, unsigned q_bit) {
  const Vec3 e = q - p;
  const double length = dot(e, e), along = -dot(p, e);
  if (!(along > 0)) return corner(p, p_bit);
  if (!(along < length)) return corner(q, q_bit);
  Vec3 at = p + (along / length) * e;
  at -= (dot(at, e) / length) * e;
  return {at, dot(at, at), p_bit | q_bit};
}

Nearest nearer(const Nearest& a, const Nearest& b) { return b.square < a.square ? b : a; }

/// By the regions of the plane (C. Ericson, "Real-time collision detection", 2005, 5.1.5). Inside, the direction is the
/// normal's, which near touching is better than that of a difference.
Nearest triangle(const Vec3& p, const Vec3& q, const Vec3& r, unsigned p_bit, unsigned q_bit, unsigned r_bit) {
  const Vec3 n = cross(q - p, r - p);
  const double square = dot(n, n);
  const bool beyond_pq = dot(cross(q - p, n), p) < 0, beyond_qr = dot(cross(r - q, n), q) < 0,
             beyond_rp = dot(cross(p - r, n), r) < 0;
  if (square > 0 && !beyond_pq && !beyond_qr && !beyond_rp) {
    const Vec3 at = (dot(n, p) / square) * n;
    return {at, dot(at, at), p_bit | q_bit | r_bit};
  }
  Nearest best{Vec3::Zero(), std::numeric_limits<double>::infinity(), 0};
  const bool flat = !(square > 0);
  if (beyond_pq || flat) best = nearer(best, segment(p, q, p_bit, q_bit));
  if (beyond_qr || flat) best = nearer(best, segment(q, r, q_bit, r_bit));
  if (beyond_rp || flat) best = nearer(best, segment(r, p, r_bit, p_bit));
  return best;
}

/// A corner of B - A.
struct Difference {
  Vec3 at;
  std::uint32_t a, b;  // corners of the solids
};

/// The simplex that holds the nearest point found, of corners of B - A; the last corner is the newest.
struct Simplex {
  std::array<Difference, 4> corner;
  int size = 0;

  bool holds(const Difference& one) const {
    return std::any_of(corner.begin(), corner.begin() + size,
                       [&](const Difference& other) { return other.a == one.a && other.b == one.b; });
  }

  /// Nearest of all its corners; kept is 15 when the origin is inside.
  Nearest nearest() const {
    const auto& c = corner;
    if (size == 1) return geometry::corner(c[0].at, 1);
    if (size == 2) return segment(c[0].at, c[1].at, 1, 2);
    if (size == 3) return triangle(c[0].at, c[1].at, c[2].at, 1, 2, 4);
    // The origin is on the newest corner's side of the old triangle: three faces may part it from the inside.
    Nearest best{Vec3::Zero(), std::numeric_limits<double>::infinity(), 15};
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, opposite = (i + 2) % 3;
      const Vec3 &p = c[i].at, &q = c[j].at, &r = c[3].at;
      const Vec3 n = cross(q - p, r - p);
      const double origin = -dot(n, p), inside = dot(n, c[opposite].at - p);
      // A face of no height tells nothing.
      constexpr double kFlat = 1e-14;
      if (origin * inside > 0 && std::fabs(inside) > kFlat * std::sqrt(dot(n, n))) continue;
      best = nearer(best, triangle(p, q, r, 1u << i, 1u << j, 8));
    }
    return best;
  }

  void keep(unsigned bits) {
    int kept = 0;
    for (int i = 0; i < size; ++i)
      if (bits >> i & 1) corner[kept++] = corner[i];
    size = kept;
  }
};

}  // namespace

Convex convex_of(std::span<const Vec3> points) {
  assert(!points.empty() && "a hull of no points");
  Hull hull = convex_hull(points);
  Convex out;
  out.dimension = hull.dimension;
  out.surface.vertices.reserve(hull.corners.size());
  for (const std::uint32_t i : hull.corners) out.surface.vertices.push_back(points[i]);
  out.surface.triangles = std::move(hull.triangles);
  const std::vector<Vec3>& corners = out.surface.vertices;
  out.around = enclosure(out.surface);
  if (out.dimension == 3) {
    Mesh centred = out.surface;
    for (Vec3& v : centred.vertices) v -= out.around.centre;
    out.inner = inscribed_radius(centred) * (1 - 0x1p-30);  // the differences round
  }

  out.normal.reserve(out.surface.triangles.size());
  for (const auto& [i, j, k] : out.surface.triangles) {
    const Vec3 n = cross(corners[j] - corners[i], corners[k] - corners[i]);
    const double length = std::sqrt(dot(n, n));
    out.normal.push_back(length > 0 ? Vec3(n / length) : Vec3::Zero());
  }

  // Every edge of a closed surface has a facet on either side: each of its ends learns of the other once.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const Facet& f : out.surface.triangles)
    for (int k = 0; k < 3; ++k) edges.emplace_back(f[k], f[(k + 1) % 3]);
  if (out.dimension == 1) edges = {{0, 1}, {1, 0}};
  std::ranges::sort(edges);
  const auto [same, end] = std::ranges::unique(edges);
  edges.erase(same, end);
  out.first.assign(corners.size() + 1, 0);
  out.beside.reserve(edges.size());
  for (const auto& [from, to] : edges) {
    ++out.first[from + 1];
    out.beside.push_back(to);
  }
  for (std::size_t i = 0; i < corners.size(); ++i) out.first[i + 1] += out.first[i];

  const std::size_t padded = (corners.size() + Convex::kLanes - 1) / Convex::kLanes * Convex::kLanes;
  out.columns.resize(padded);
  for (std::size_t i = 0; i < padded; ++i) out.columns.set(i, corners[std::min(i, corners.size() - 1)]);
  std::uint64_t unused = 0;
  for (std::uint32_t k = 0; k < out.start.size(); ++k)
    out.start[k] = climb(out, direction(k), k ? out.start[k - 1] : 0, unused);
  return out;
}

Mesh surface_with_facets(Convex solid) {
  const auto last = static_cast<std::uint32_t>(solid.surface.vertices.size() - 1);
  if (solid.surface.triangles.empty()) solid.surface.triangles = {{0, last, last}};
  return std::move(solid.surface);
}

std::uint64_t convex_bytes(std::uint64_t corners) {
  constexpr std::uint64_t kEdges = 6;  // of a corner, but for twelve in all, by Euler's formula
  return sizeof(Convex) + corners * (4 * sizeof(Vec3) + 2 * sizeof(Facet) + (1 + kEdges) * sizeof(std::uint32_t));
}

std::uint64_t convex_making_bytes(std::uint64_t corners) {
  constexpr std::uint64_t kFaces = 8, kFace = 56;  // faces made for a corner: measured; while hull.cpp is at work
  return corners * kFaces * kFace;
}

PlacedConvex placed(const Convex& solid, const Pose& pose, double enlarge) {
  PlacedConvex out{&solid, placement(solid.around, pose), 0};
  const double size = solid.around.reach + out.at.length;
  out.margin = 0x1p-45 * size + 0x1p-1060 + enlarge * size;  // (2)
  return out;
}

bool convex_meet(const PlacedConvex& a, const PlacedConvex& b, std::uint64_t& operations) {
  // The order of all sums is such that (b, a) gives the same numbers or their negatives.
  const Convex &s = *a.solid, &t = *b.solid;
  const double margin = a.margin + b.margin;
  const Vec3 between = b.at.middle - a.at.middle, offset = b.at.t - a.at.t;
  const double square = dot(between, between), reach = (s.around.radius + t.around.radius) + margin;
  ++operations;
  if (square > reach * reach * (1 + 0x1p-48)) return false;
  const double inner = (s.inner + t.inner) - margin;
  if (inner > 0 && inner * inner > square) return true;
  if (!a.at.rigid || !b.at.rigid) return true;  // the margin is not proved

  // In units of about the pair's size: no square over- or underflows.
  const double size =
      s.around.reach + t.around.reach + (std::fabs(offset.x()) + std::fabs(offset.y()) + std::fabs(offset.z()));
  if (!(size > 0x1p-1000 && size < 0x1p1000)) return true;
  const double unit = std::ldexp(1, -std::ilogb(size)), least = margin * unit;
  Simplex simplex;
  Vec3 v = unit * first_way(a, b, between);  // nearest to the origin of what is known of B - A; at first a guess
  if (!(dot(v, v) > 0)) v = Vec3::UnitX();
  bool climbs = true;
  constexpr int kMost = 64;  // a dozen is much; what never ends touches
  for (int round = 0; round < kMost; ++round) {
    const Vec3 a_way = turned_back(a.at.r, v), b_way = turned_back(b.at.r, -v);
    Difference next;
    next.a = climbs ? climb(s, a_way, s.start[cell(a_way)], operations) : highest(s, a_way, operations);
    next.b = climbs ? climb(t, b_way, t.start[cell(b_way)], operations) : highest(t, b_way, operations);
    next.at =
        unit * ((turned(b.at.r, t.surface.vertices[next.b]) - turned(a.at.r, s.surface.vertices[next.a])) + offset);
    const double length = std::sqrt(dot(v, v)), along = dot(v, next.at);
    if (along > least * length) {
      if (certainly_apart(a, b, v / length, operations)) return false;
      if (climbs) {  // rounding led it astray, or the gap is the margin
        climbs = false;
        continue;
      }
    }
    if (simplex.holds(next)) return true;
    simplex.corner[simplex.size++] = next;
    const Nearest nearest = simplex.nearest();
    if (nearest.kept == 15 || nearest.square <= least * least) return true;
    simplex.keep(nearest.kept);
    v = nearest.at;
  }
  return true;
}

bool convex_inside(const PlacedConvex& a, const PlacedConvex& b, std::uint64_t& operations) {
  const Convex &s = *a.solid, &t = *b.solid;
  if (t.dimension < 3) return false;
  const Vec3 offset = b.at.t - a.at.t;
  // The facet that a is most likely to be in front of comes first.
  const Vec3 way = turned_back(b.at.r, a.at.middle - b.at.middle);
  std::size_t first = 0;
  for (std::size_t f = 1; f < t.normal.size(); ++f)
    if (dot(t.normal[f], way) > dot(t.normal[first], way)) first = f;
  operations += t.normal.size();
  for (std::size_t k = 0; k < t.normal.size(); ++k) {
    const std::size_t f = (first + k) % t.normal.size();
    const Vec3 n = turned(b.at.r, t.normal[f]), d = turned_back(a.at.r, n);
    if (!(dot(d, d) > 0)) continue;
    const Vec3& top = s.surface.vertices[climb(s, d, s.start[cell(d)], operations)];
    if (dot(d, top) - dot(n, offset) > dot(t.normal[f], t.surface.vertices[t.surface.triangles[f][0]])) return false;
  }
  return true;
}

}  // namespace geometry
