// Branch and bound over two hierarchies; at the leaves, two triangles with a certificate for each bound.
//
// Nothing that finds a bound need be exact. The upper bound is the distance of two points that lie on the triangles;
// the lower one is how far the triangles are apart along a direction, whichever it is. A bad guess at the points or at
// the direction makes bounds loose, never wrong, so slivers and degenerate triangles need no cases of their own. Only
// what evaluates a guess has its rounding bounded.
//
// Rounding. Two triangles are moved by a corner of the first and scaled by a power of two so that every coordinate is
// at most 2 in magnitude (Frame below). u = 2^-53, and all is in that frame. A corner has the error of one difference;
// scaling is exact but for what underflows, 2^-1075:
//   |error of a coordinate of a corner| <= 2 u                                                                  (1)
//
// upper() takes points p = c0 + (s (c1 - c0) + t (c2 - c0)) with s, t >= 0 whose computed sum is at most 1. Edges are
// at most 4 per coordinate: 2 x 4 u for their rounding, 2 x 4 u for the products, 8 u and 10 u for the sums, 2 u by
// (1), and 8 u because a true sum s + t of up to 1 + u puts p beside the triangle:
//   |error of a coordinate of p| <= 8 u + 8 u + 8 u + 10 u + 2 u + 8 u < 64 u                                   (2)
//
// g = q - p is at most 4 per coordinate up to rounding and has 128 u + 5 u, hence |g| has 133 sqrt(3) u, and 7 x 3 u
// for its own computation:
//   |error of |g|| < 133 sqrt(3) u + 21 u < 2^8 u                                                               (3)
//
// lower() divides n by its computed length, so |n| is 1 within 5 u and coordinates are at most 1 + u. A dot product
// with a corner has 3 x 2 u for products, 4 u and 6 u for the sums and 3 x 2 u by (1): 22 u. A difference of two is at
// most 12 and rounds by 12 u; |n| takes 12 x 5 u more:
//   |error of the distance along n| < 2 x 22 u + 12 u + 60 u < 2^7 u                                            (4)
//
// Each bound is moved outwards by what covers (3) and (4) twice, and the rounding of that very sum:
//   kError = 2^9 u = 2^-44                                                                                      (5)
//
// Where the frame overflows, its coordinates are not finite, no comparison below is true and the bounds are 0 and
// infinity.
#include "geometry/decision/gap.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>

#include "geometry/vec.hpp"

namespace geometry {
namespace {

using geometry::cross;  // beside those of other numbers below
using geometry::dot;

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kError = 0x1p-44;  // in the frame of two triangles: (5)
// Bounds are wanted this near to each other, of the bodies' joint extent: above 2 kError, below 1e-12.
constexpr double kWidth = 0x1p-42;

/// Two triangles in their own frame: corners 0 to 2 are a's, 3 to 5 b's.
struct Frame {
  Vec3 corner[6];
  int exponent = 0;  // metres = frame 2^exponent

  Frame(const Triangle& a, const Triangle& b) {
    double greatest = 0;
    for (int i = 0; i < 6; ++i) {
      corner[i] = (i < 3 ? a[i] : b[i - 3]) - a[0];
      greatest = std::fmax(greatest, corner[i].cwiseAbs().maxCoeff());
    }
    // From 2^-900 upwards what comes back is no denormal; infinity has no exponent, and stays.
    if (greatest > 0 && greatest < kInfinity) exponent = std::max(std::ilogb(greatest), -900);
    const double scale = std::ldexp(1.0, -exponent);
    for (Vec3& c : corner) c *= scale;
  }
  double metres(double length) const { return std::ldexp(length, exponent); }
};

/// A guess at the nearest points, by their weights of the second and third corner, and at the direction between them.
struct Guess {
  double a[2] = {}, b[2] = {};
  Vec3 direction = Vec3::Zero();
};

/// The distance of two points of the triangles, in the frame, never too small.
double upper(const Frame& f, const Guess& guess) {
  const auto point = [](const Vec3* c, const double* w) -> Vec3 {
    return c[0] + (w[0] * (c[1] - c[0]) + w[1] * (c[2] - c[0]));
  };
  const Vec3 g = point(f.corner + 3, guess.b) - point(f.corner, guess.a);
  const double length = std::sqrt(dot(g, g));
  return length < kInfinity ? length + kError : kInfinity;
}

/// How far b is beyond a along n, in the frame, never too great; 0 when it is not certainly beyond.
double lower(const Frame& f, const Vec3& n) {
  const double length = std::sqrt(dot(n, n));
  if (!(length > 0x1p-400 && length < 0x1p400)) return 0;  // squares neither underflow nor overflow
  const Vec3 unit = n / length;
  const auto along = [&](int i) { return dot(unit, f.corner[i]); };
  const double a_top = std::max({along(0), along(1), along(2)}), b_bottom = std::min({along(3), along(4), along(5)});
  const double apart = (b_bottom - a_top) - kError;
  return apart > 0 ? apart : 0;
}

// ---- Guesses, in doubles or in the 113 bits of __float128 ---------------------------------------------------------

template <class Real>
struct V {
  Real x, y, z;
  V operator-(const V& o) const { return {x - o.x, y - o.y, z - o.z}; }
  V operator+(const V& o) const { return {x + o.x, y + o.y, z + o.z}; }
  V operator*(Real k) const { return {k * x, k * y, k * z}; }
};
template <class Real>
Real dot(const V<Real>& a, const V<Real>& b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
template <class Real>
V<Real> cross(const V<Real>& a, const V<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class Real>
Real clamped(Real x) {
  return x > 0 ? (x < 1 ? x : Real(1)) : Real(0);  // NaN becomes 0
}

/// A direction as doubles, its greatest coordinate 1 in magnitude; zero when it has none.
template <class Real>
Vec3 direction(const V<Real>& d) {
  const auto magnitude = [](Real x) { return x < 0 ? -x : x; };
  const Real greatest = std::max({magnitude(d.x), magnitude(d.y), magnitude(d.z)});
  if (!(greatest > 0)) return Vec3::Zero();
  return {double(d.x / greatest), double(d.y / greatest), double(d.z / greatest)};
}

/// The corners with their edges: edge i leads from corner i to corner (i + 1) % 3 of its triangle.
template <class Real>
struct Corners {
  V<Real> at[6], edge[6], normal[2];

  explicit Corners(const Frame& f) {
    for (int i = 0; i < 6; ++i) at[i] = {f.corner[i].x(), f.corner[i].y(), f.corner[i].z()};
    for (int i = 0; i < 6; ++i) edge[i] = at[next(i)] - at[i];
    for (int side = 0; side < 2; ++side) normal[side] = cross(edge[3 * side], edge[3 * side + 1]);
  }
  static int next(int i) { return i % 3 == 2 ? i - 2 : i + 1; }
};

/// The nearest of: a corner and an edge, a corner and the inside of a face, two insides of edges.
template <class Real>
Guess nearest(const Corners<Real>& c) {
  struct Place {  // on a triangle: a corner, and how far along which edge; or weights of a face
    int corner = 0;
    Real along = 0;
    bool face = false;
    Real weights[2] = {};
  };
  Real best = std::numeric_limits<double>::max();
  Place best_place[2];
  V<Real> gap{};
  const auto offer = [&](const V<Real>& from, const V<Real>& to, const Place& at_from, const Place& at_to) {
    const V<Real> g = to - from;
    const Real square = dot(g, g);
    if (!(square < best)) return;
    best = square;
    const bool a_first = at_from.corner < 3;
    best_place[0] = a_first ? at_from : at_to;
    best_place[1] = a_first ? at_to : at_from;
    gap = a_first ? g : g * Real(-1);
  };

  for (int side = 0; side < 2; ++side)
    for (int i = 3 * side; i < 3 * side + 3; ++i) {
      const V<Real>& p = c.at[i];
      const Place at_corner{.corner = i};
      const int other = 3 - 3 * side;
      for (int k = other; k < other + 3; ++k) {
        const Real along = clamped(dot(p - c.at[k], c.edge[k]) / dot(c.edge[k], c.edge[k]));
        offer(p, c.at[k] + c.edge[k] * along, at_corner, {.corner = k, .along = along});
      }
      // Inside the face: the areas that the foot of the perpendicular cuts off, over the whole.
      const V<Real>& n = c.normal[1 - side];
      const V<Real> r = p - c.at[other];
      const V<Real> e = c.edge[other], f = c.at[other + 2] - c.at[other];
      const Real area = dot(n, n), s = dot(cross(r, f), n) / area, t = dot(cross(e, r), n) / area;
      if (s >= 0 && t >= 0 && s + t <= 1)
        offer(p, c.at[other] + (e * s + f * t), at_corner, {.corner = other, .face = true, .weights = {s, t}});
    }
  for (int i = 0; i < 3; ++i)
    for (int k = 3; k < 6; ++k) {
      const V<Real> n = cross(c.edge[i], c.edge[k]), r = c.at[k] - c.at[i];
      const Real square = dot(n, n), s = dot(cross(r, c.edge[k]), n) / square, t = dot(cross(r, c.edge[i]), n) / square;
      if (s >= 0 && s <= 1 && t >= 0 && t <= 1)
        offer(c.at[i] + c.edge[i] * s, c.at[k] + c.edge[k] * t, {.corner = i, .along = s}, {.corner = k, .along = t});
    }

  Guess out;
  out.direction = direction(gap);
  for (int side = 0; side < 2; ++side) {
    const Place& place = best_place[side];
    double* w = side == 0 ? out.a : out.b;
    if (place.face) {
      w[0] = double(place.weights[0]), w[1] = double(place.weights[1]);
    } else {
      double of[3] = {};
      const int i = place.corner % 3;
      of[i] = double(1 - place.along);
      of[(i + 1) % 3] += double(place.along);
      w[0] = of[1], w[1] = of[2];
    }
    // The computed sum is at most 1: where rounding made it more, the second weight gives way.
    if (w[0] + w[1] > 1) w[1] = 1 - w[0];
  }
  return out;
}

/// What a pair of triangles has shown so far, in its frame.
struct Found {
  double lower = 0, upper = kInfinity;
  Vec3 direction = Vec3::Zero();  // of the lower bound

  void raise(const Frame& f, const Vec3& n) {
    const double found = geometry::lower(f, n);
    if (found > lower) lower = found, direction = n;
  }
};

/// The directions that no two points give well when they nearly touch: normals of faces and of two edges.
template <class Real>
void raise_by_normals(const Frame& f, const Corners<Real>& c, Found& found) {
  const auto offer = [&](const V<Real>& n) {
    const Vec3 d = direction(n);
    found.raise(f, d);
    found.raise(f, -d);
  };
  offer(c.normal[0]);
  offer(c.normal[1]);
  for (int i = 0; i < 3; ++i)
    for (int k = 3; k < 6; ++k) offer(cross(c.edge[i], c.edge[k]));
}

/// Bounds that are `width` apart or less, in the frame, where guesses can be had as good; done as soon as the lower one
/// reaches `enough`.
Found bound(const Frame& f, double width, double enough) {
  Found out;
  const auto done = [&] { return out.lower >= enough || out.upper - out.lower <= width; };
  const Corners<double> corners(f);
  const Guess guess = nearest(corners);
  out.upper = upper(f, guess);
  out.raise(f, guess.direction);
  if (done()) return out;
  raise_by_normals(f, corners, out);
  if (done()) return out;
  // Slivers, edges all but parallel, triangles that all but touch: once more with twice the digits.
  __extension__ typedef __float128 Quad;
  const Corners<Quad> exact(f);
  const Guess better = nearest(exact);
  out.upper = std::fmin(out.upper, upper(f, better));
  out.raise(f, better.direction);
  if (!done()) raise_by_normals(f, exact, out);
  return out;
}

// ---- Boxes --------------------------------------------------------------------------------------------------------

/// A lower bound on the distance of what is in the boxes. Differences, squares and their sum are within 2^-50 of true
/// in all, squares that underflow below 1e-160. Where squares overflow the widest axis alone is a bound.
double box_gap(const Box& a, const Box& b) {
  const Vec3 d = (b.min - a.max).cwiseMax(a.min - b.max).cwiseMax(0);
  const double square = dot(d, d), length = square < kInfinity ? std::sqrt(square) : d.maxCoeff();
  return std::fmax(0, length * (1 - 0x1p-50) - 1e-160);
}

double size(const Box& box) { return (box.max - box.min).sum(); }

double centre_distance_squared(const Box& a, const Box& b) {
  const Vec3 d = (a.min + a.max) - (b.min + b.max);
  return dot(d, d);
}

/// True when some axis shows that the boxes are more than `margin` apart, or a coordinate is not finite. A difference
/// rounds monotonically, and `margin` is a double: one that is truly no greater is never computed greater.
bool beyond(const Box& a, const Box& b, double margin) {
  for (int k = 0; k < 3; ++k)
    if (!(b.min[k] - a.max[k] <= margin && a.min[k] - b.max[k] <= margin)) return true;
  return false;
}

Box box_of(const Triangle& t) { return {t[0].cwiseMin(t[1]).cwiseMin(t[2]), t[0].cwiseMax(t[1]).cwiseMax(t[2])}; }

bool finite(const Box& box) {
  return (box.min.array() > -kInfinity).all() && (box.max.array() < kInfinity).all();  // false for NaN
}

bool asked(std::span<const PairRun> runs, Pair pair) {
  const auto after = std::ranges::upper_bound(runs, std::tuple(pair.a, pair.b), {},
                                              [](const PairRun& run) { return std::tuple(run.a, run.first); });
  return after != runs.begin() && std::prev(after)->a == pair.a && pair.b < std::prev(after)->last;
}

struct Swept {
  Box box;
  std::uint32_t body;
};

}  // namespace

GapBounds triangle_gap(const Triangle& a, const Triangle& b) {
  const Frame frame(a, b);
  const Found found = bound(frame, 2 * kError + 0x1p-50, kInfinity);
  return {std::fmax(frame.metres(found.lower), box_gap(box_of(a), box_of(b))), frame.metres(found.upper)};
}

GapSearch::GapSearch(const Bodies& bodies, std::span<const Bvh> bvhs)
    : bodies_(bodies), bvhs_(bvhs), slot_(bodies.size(), kNone) {
  assert(bvhs.size() == bodies.meshes.size() && "one hierarchy per distinct mesh");
}

const GapSearch::Placed& GapSearch::place(std::span<const Pose> poses, std::uint32_t body) {
  if (slot_[body] == kNone) {
    slot_[body] = static_cast<std::uint32_t>(used_);
    if (used_++ == placed_.size()) placed_.emplace_back();
    const Mesh& mesh = bodies_.mesh_of(body);
    const Bvh& bvh = bvhs_[bodies_.mesh[body]];
    Placed& placed = placed_[slot_[body]];
    placed.world.resize(mesh.vertices.size());
    placed.boxes.resize(bvh.nodes.size());
    to_world(poses[body], mesh.vertices, placed.world);
    refit(bvh, mesh, placed.world, placed.boxes);
  }
  return placed_[slot_[body]];
}

/// Descends both hierarchies, the nearer children first. What is left out is farther than the margin, or no nearer than
/// the upper bound less `width`; the lower bound remembers the least of the latter.
GapBounds GapSearch::between(std::uint32_t a, std::uint32_t b, double margin) {
  const Mesh &a_mesh = bodies_.mesh_of(a), &b_mesh = bodies_.mesh_of(b);
  const Bvh &a_bvh = bvhs_[bodies_.mesh[a]], &b_bvh = bvhs_[bodies_.mesh[b]];
  const Placed &s = placed_[slot_[a]], &t = placed_[slot_[b]];
  const auto facet = [](const Mesh& mesh, const Bvh& bvh, const Placed& placed, std::uint32_t k) -> Triangle {
    const Facet& f = mesh.triangles[bvh.order[k]];
    return {placed.world[f[0]], placed.world[f[1]], placed.world[f[2]]};
  };
  Box joint = s.boxes[0];
  joint.add(t.boxes[0]);
  const double width = kWidth * (joint.max - joint.min).maxCoeff();
  GapBounds out{kInfinity, kInfinity};
  Vec3 direction = Vec3::Zero();  // the best so far: it shows most other triangles to be farther
  const auto left_out = [&](double least) {
    if (least > margin) return true;
    if (!(least >= out.upper - width)) return false;
    out.lower = std::fmin(out.lower, least);
    return true;
  };
  const auto compare = [&](const Triangle& f, const Triangle& g, double least) {
    const Frame frame(f, g);
    if (left_out(std::fmax(least, frame.metres(lower(frame, direction))))) return;
    const double scale = std::ldexp(1.0, -frame.exponent);
    const Found found = bound(frame, width * scale, (out.upper - width) * scale);
    const double low = std::fmax(least, frame.metres(found.lower)), high = frame.metres(found.upper);
    if (high < out.upper) out.upper = high, direction = found.direction;
    out.lower = std::fmin(out.lower, low);
  };

  stack_.assign(1, {0, 0, box_gap(s.boxes[0], t.boxes[0])});
  while (!stack_.empty()) {
    const Visit at = stack_.back();
    stack_.pop_back();
    if (left_out(at.least)) continue;
    const Bvh::Node &m = a_bvh.nodes[at.i], &n = b_bvh.nodes[at.j];
    if (m.count && n.count) {
      for (std::uint32_t k = m.first; k < m.first + m.count; ++k) {
        const Triangle f = facet(a_mesh, a_bvh, s, k);
        const Box f_box = box_of(f);
        for (std::uint32_t l = n.first; l < n.first + n.count; ++l) {
          const Triangle g = facet(b_mesh, b_bvh, t, l);
          const double least = box_gap(f_box, box_of(g));
          if (!left_out(least)) compare(f, g, least);
        }
      }
      continue;
    }
    const bool open_a = n.count || (!m.count && size(s.boxes[at.i]) >= size(t.boxes[at.j]));
    const auto child = [&](std::uint32_t node) -> Visit {
      const std::uint32_t i = open_a ? node : at.i, j = open_a ? at.j : node;
      return {i, j, box_gap(s.boxes[i], t.boxes[j])};
    };
    Visit near = child(open_a ? at.i + 1 : at.j + 1), far = child(open_a ? m.second : n.second);
    const auto order = [&](const Visit& v) {
      return std::pair(v.least, centre_distance_squared(s.boxes[v.i], t.boxes[v.j]));
    };
    if (order(far) < order(near)) std::swap(near, far);
    stack_.push_back(far);
    stack_.push_back(near);
  }
  out.lower = std::fmin(out.lower, out.upper);
  return out;
}

std::vector<Gap> GapSearch::near(std::span<const Pose> poses, std::span<const PairRun> runs, double margin,
                                 std::span<const Pair> met) {
  assert(poses.size() == bodies_.size() && "one pose per body");
  std::vector<std::int64_t> change(bodies_.size() + 1);  // of how many runs hold the body
  for (const PairRun& run : runs) {
    ++change[run.a], --change[run.a + 1];
    ++change[run.first], --change[run.last];
  }
  std::vector<Swept> sweep;
  std::int64_t held = 0;
  for (std::uint32_t body = 0; body < bodies_.size(); ++body) {
    if ((held += change[body]) == 0) continue;
    const std::vector<Vec3>& vertices = bodies_.mesh_of(body).vertices;
    scratch_.resize(vertices.size());
    to_world(poses[body], vertices, scratch_);
    Box box;
    for (const Vec3& v : scratch_) box.add(v);
    if (finite(box)) sweep.push_back({box, body});
  }
  // Along x: boxes come by their least coordinate and leave when they are more than the margin behind.
  std::ranges::sort(sweep, {}, [](const Swept& s) { return std::pair(s.box.min.x(), s.body); });
  std::vector<Gap> out;
  std::vector<const Swept*> active;
  for (const Swept& next : sweep) {
    std::erase_if(active, [&](const Swept* other) { return next.box.min.x() - other->box.max.x() > margin; });
    for (const Swept* other : active) {
      if (beyond(other->box, next.box, margin) || box_gap(other->box, next.box) > margin) continue;
      const Pair pair{std::min(other->body, next.body), std::max(other->body, next.body)};
      if (!asked(runs, pair) || std::ranges::binary_search(met, pair)) continue;
      place(poses, pair.a);
      place(poses, pair.b);
      const GapBounds bounds = between(pair.a, pair.b, margin);
      if (bounds.lower <= margin) out.push_back({pair, bounds});
    }
    active.push_back(&next);
  }
  for (const Swept& s : sweep) slot_[s.body] = kNone;
  used_ = 0;
  std::ranges::sort(out, {}, &Gap::pair);
  return out;
}

}  // namespace geometry
