// The margins, and the tests that use them.
//
// The letters: u = 2^-53 and f = 2^-24; R, t, w = R v + t + e the world vertex of v with its rounding error e; |v| <=
// reach, |v - c| <= radius; R^T R = 1 + E with |E| <= kDefect = 128 u for rigid bodies (geometry/broad_phase.cpp), so
// that |R v| <= (1 + 64 u) |v| and the rows and columns of R have that length too. Every body has its own: R_a, R_b,
// ... and S = reach_a + reach_b, L = |t_a| + |t_b|. All lengths lie between 2^-60 and 2^60 where a margin is useful, so
// underflow, 2^-149 even in floats, is lost in the margins, the least of which is 2^-18 x 2^-60.
//
// World vertices. From broad_phase.cpp, |e_i| <= 4.01 u (sum |r_k| |v_k| + |t_i|) <= 4.02 u (reach + |t_i|); along any
// d |d . e| <= |d| |e| <= |d| (6.97 u reach + 4.02 u |t|).                                                         (1)
//
// Spheres. The middle of the box may lie farther out than any vertex, but no coordinate of it does: |c| <= sqrt(3) reach
// (1 + 2^-50). m = to_world(c) has an error like a vertex's, so |w - m| <= (1 + 64 u) radius + 20 u reach + 8.1 u |t|,
// and with radius <= 2.74 reach that is below radius + 196 u reach + 8.1 u |t|. `fine` = 256 u (S + L) covers both
// bodies. |m_a - m_b|^2 as computed has a relative
// error of 6 u, the square of the sum one of 5 u: the factor 1 + 2^-48 = 1 + 32 u covers them.
//
// Planes. Along d, |d| <= 1 + 2^-20: d . w = (R^T d) . v + d . t + d . e. The computed R^T d is off by 3.01 u |R|^T |d|
// per component, in length by 3.01 u sqrt(3) |d| (1 + 64 u) < 5.3 u |d|; the dot product with v by 3.01 u |d| |v|. With
// (1) the error of a support is below 15.4 u reach + 4.1 u |t|; d . (t_b - t_a) is off by 4.1 u L at most and the last
// two sums by 2.1 u (S + L): in all less than 18 u (S + L), of which `fine` is 14 times as much.
//
// Nodes. Take d = column k of R_a. Then d . w_a = v_k + (E_a v)_k + d . t_a + d . e_a, and d . w_b = (C v)_k + d . t_b
// + d . e_b with C = R_a^T R_b. So with T = R_a^T (t_b - t_a) the hulls of two sets are apart when all v_k of one are
// on one side of all (C v)_k + T_k of the other by more than 128 u reach_a + 7 u S + 4.1 u L. The same holds for b's
// columns with C^T (v - T) where T stands for R_b^T (t_b - t_a) = C^T T up to the defect of R_a, another 128 u L (1 +
// 2^-40); and for a unit normal n of a node of a, along d = R_a n: n . v against n . (C v + T). The normals are unit up
// to 2^-22 and known exactly, the bounds on n . v to 4 u reach. C and T are computed in doubles with errors of 3.1 u
// per entry (Cauchy-Schwarz over unit columns) and 4.2 u L. C^T C differs from 1 by |E_a| + |E_b| + ...: 270 u, which
// matters where a vector goes to a's frame and back. Together: less than 1000 u (S + L). In floats, all of it happens
// among numbers below M = S + |T|: C and T are rounded (f each), a product with C takes four roundings more, the
// subtraction of a centre one, and going back with C^T five more of numbers below sqrt(3) times as much; node bounds
// hold |centre| + |half| <= 1.01 reach per coordinate. The longest chain, T or a centre through C and through C^T or a
// normal and to the comparison, passes fewer than 20 roundings, each of a sum of absolute values below 1.8 x 1.8 M: an
// error under 65 f M. `coarse` = 128 f M + 2048 u (S + L), rounded up, is about twice what is needed.
#include "geometry/frames.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace geometry {
namespace {

double dot(const Vec3& d, const Vec3& p) { return (d.x() * p.x() + d.y() * p.y()) + d.z() * p.z(); }

Vec3 transposed_times(const Mat3& r, const Vec3& d) { return {dot(r.col(0), d), dot(r.col(1), d), dot(r.col(2), d)}; }

using Bits = std::int32_t __attribute__((vector_size(16)));

Lanes absolute(Lanes x) { return reinterpret_cast<Lanes>(reinterpret_cast<Bits>(x) & 0x7fffffff); }
Lanes lanes(const Vec3& v) { return Lanes{float(v.x()), float(v.y()), float(v.z()), 0}; }
Lanes load(const float* four) {
  Lanes out;
  std::memcpy(&out, four, sizeof out);
  return out;
}
Lanes least(Lanes x, Lanes y) { return x < y ? x : y; }
float sum(Lanes x) { return (x[0] + x[1]) + x[2]; }

float size(const Bvh::Bound& bound) { return std::max(std::max(bound.half[0], bound.half[1]), bound.half[2]); }

/// The columns times the first three lanes of x.
Lanes times(const Lanes (&column)[3], Lanes x) { return (column[0] * x[0] + column[1] * x[1]) + column[2] * x[2]; }
Lanes absolute_times(const Lanes (&column)[3], Lanes x) {
  return (absolute(column[0]) * x[0] + absolute(column[1]) * x[1]) + absolute(column[2]) * x[2];
}

/// Where a set can be along a direction.
struct Interval {
  float low, high;
};

/// Along g, of the vertices of a node: by its box, and by its slab and the box across it, whichever is tighter.
/// `alpha` = g . normal.
Interval along(Lanes g, float alpha, Lanes centre, Lanes half, Lanes normal) {
  const float by_box = sum(g * centre), box = sum(absolute(g) * half);
  const Lanes across = g - alpha * normal;
  const float by_slab = alpha * centre[3] + sum(across * centre);
  const float slab = std::fabs(alpha) * half[3] + sum(absolute(across) * half);
  return {std::max(by_box - box, by_slab - slab), std::min(by_box + box, by_slab + slab)};
}

}  // namespace

Margin margin(const Body& a, const Body& b) {
  const double reach = a.around.reach + b.around.reach, far = a.at.length + b.at.length;
  const double least = std::min(a.around.radius, b.around.radius);
  Margin out;
  out.fine = 0x1p-45 * (reach + far);
  out.useful =
      a.at.rigid && b.at.rigid && least >= 0x1p-60 && reach <= 0x1p60 && far <= 0x1p60 && out.fine <= 0x1p-24 * least;
  if (!out.useful) return out;
  // Not less than |T|: the sum of the parts is never below the length, but for roundings that `coarse` has room for.
  const double between =
      std::fabs(b.at.t.x() - a.at.t.x()) + std::fabs(b.at.t.y() - a.at.t.y()) + std::fabs(b.at.t.z() - a.at.t.z());
  out.coarse = static_cast<float>((0x1p-17 * (reach + between) + 0x1p-42 * (reach + far)) * (1 + 0x1p-20));
  return out;
}

bool spheres_apart(const Body& a, const Body& b, const Margin& margin) {
  const Vec3 between = b.at.middle - a.at.middle;
  const double reach = (a.around.radius + b.around.radius) + margin.fine;
  return dot(between, between) > reach * reach * (1 + 0x1p-48);
}

Support support(const Body& body, const Vec3& direction, std::uint64_t& operations) {
  // In floats a node's bound is off by less than 16 f reach.
  const Lanes d = lanes(direction), absolute_d = absolute(d);
  const float pad = static_cast<float>(0x1p-19 * body.around.reach);
  const auto top = [&](std::uint32_t node) {
    const Bvh::Bound& bound = body.bvh.bounds[node];
    return sum(d * load(bound.centre) + absolute_d * load(bound.half)) + pad;
  };
  struct Open {
    std::uint32_t node;
    float top;
  };
  Open stack[Bvh::kMostDepth];
  std::size_t open = 0;
  Support best{-std::numeric_limits<double>::infinity(), 0};
  stack[open++] = {0, std::numeric_limits<float>::infinity()};
  while (open > 0) {
    const Open next = stack[--open];
    if (next.top <= best.dot) continue;
    ++operations;
    std::uint32_t i = next.node;
    while (body.bvh.nodes[i].count == 0) {
      Open near{i + 1, top(i + 1)}, far{body.bvh.nodes[i].second, top(body.bvh.nodes[i].second)};
      if (far.top > near.top) std::swap(near, far);
      operations += 2;
      if (far.top > best.dot) stack[open++] = far;
      i = near.node;
      if (near.top <= best.dot) break;
    }
    const Bvh::Node& leaf = body.bvh.nodes[i];
    for (std::uint32_t k = leaf.first; k < leaf.first + leaf.count; ++k)
      for (const std::uint32_t v : body.mesh.triangles[body.bvh.order[k]])
        if (const double along = dot(direction, body.mesh.vertices[v]); along > best.dot) best = {along, v};
  }
  return best;
}

Slab find_slab(const Body& a, const Body& b, const Vec3& direction, const Margin& margin, std::uint64_t& operations) {
  const Support top = support(a, transposed_times(a.at.r, direction), operations);
  const Support bottom = support(b, transposed_times(b.at.r, -direction), operations);
  Slab out;
  out.gap = dot(direction, b.at.t - a.at.t) - (top.dot + bottom.dot);
  out.apart = out.gap > margin.fine;
  out.from = to_world(a.at.r, a.at.t, a.mesh.vertices[top.vertex]);
  out.to = to_world(b.at.r, b.at.t, b.mesh.vertices[bottom.vertex]);
  return out;
}

Relative::Relative(const Body& a, const Body& b, const Margin& margin) : coarse_(margin.coarse) {
  const Vec3 between = b.at.t - a.at.t;
  Mat3 c;
  for (int k = 0; k < 3; ++k) c.col(k) = transposed_times(a.at.r, b.at.r.col(k));
  for (int k = 0; k < 3; ++k) column_[k] = lanes(c.col(k)), row_[k] = lanes(c.row(k));
  offset_ = lanes(transposed_times(a.at.r, between));
  offset_in_b_ = lanes(transposed_times(b.at.r, between));
  margin_ = Lanes{coarse_, coarse_, coarse_, std::numeric_limits<float>::infinity()};
}

float Relative::overlap(const Bvh::Bound& a, const Bvh::Bound& b) const {
  const Lanes a_centre = load(a.centre), a_half = load(a.half), b_centre = load(b.centre), b_half = load(b.half);
  // Along the axes of a, then along those of b.
  const Lanes b_in_a = times(column_, b_centre) + offset_;
  const Lanes between = b_in_a - a_centre;
  const Lanes by_a = (a_half + absolute_times(column_, b_half) + margin_) - absolute(between);
  const Lanes by_b = (b_half + absolute_times(row_, a_half) + margin_) - absolute(times(row_, between));
  const Lanes depths = least(by_a, by_b);
  const float depth = std::min(std::min(depths[0], depths[1]), depths[2]);
  if (depth < 0) return depth;
  // Along the normals of both, unless neither surface is thin across its own: then the boxes say as much.
  if (2 * a.thickness > size(a) && 2 * b.thickness > size(b)) return depth;
  const Lanes a_normal = load(a.normal), b_normal = load(b.normal);
  const Lanes n = times(row_, a_normal), m = times(column_, b_normal);  // in the other's frame
  const float alpha = sum(n * b_normal);
  const float n_offset = sum(a_normal * offset_), m_offset = sum(b_normal * offset_in_b_);
  const Interval of_b = along(n, alpha, b_centre, b_half, b_normal);
  const Interval of_a = along(m, alpha, a_centre, a_half, a_normal);
  const float a_low = a.middle - a.thickness - n_offset, a_high = a.middle + a.thickness - n_offset;
  const float b_low = b.middle - b.thickness + m_offset, b_high = b.middle + b.thickness + m_offset;
  const float by_n = std::min(a_high - of_b.low, of_b.high - a_low) + coarse_;
  const float by_m = std::min(b_high - of_a.low, of_a.high - b_low) + coarse_;
  return std::min(depth, std::min(by_n, by_m));
}

}  // namespace geometry
