// The margins, and the tests that use them.
//
// The letters. u = 2^-53 and f = 2^-24. R, t: w = R v + t + e is the world vertex of v with its rounding error e. |v|
// <= reach, |v - c| <= radius. R^T R = 1 + E with |E| <= kDefect = 128 u for rigid bodies
// (geometry/decision/broad_phase.cpp), so that |R v| <= (1 + 64 u) |v|, and the rows and columns of R have that length
// too. Every body has its own: R_a, R_b and so on; S = reach_a + reach_b, L = |t_a| + |t_b|.
//
// Where a margin is useful reach > 2^-62, and no length exceeds 2^60: underflow, 2^-149 even in floats, is lost in the
// margins, the least of which is 2^-17 x 2^-62, and nothing overflows or becomes NaN, which a comparison may take for
// either answer.
//
// World vertices. From (1) of broad_phase.cpp, and along any d:
//   |e_i| <= 4.01 u (sum |r_k| |v_k| + |t_i|) <= 4.02 u (reach + |t_i|)                                         (1)
//   |d . e| <= |d| |e| <= |d| (6.97 u reach + 4.02 u |t|)                                                       (2)
//
// Spheres. The middle of the box may lie farther out than any vertex, but no coordinate of it does: |c| <= sqrt(3)
// reach (1 + 2^-50). m = to_world(c) has an error like a vertex's, and radius <= 2.74 reach, so
//   |w - m| <= (1 + 64 u) radius + 20 u reach + 8.1 u |t| <= radius + 196 u reach + 8.1 u |t|                   (3)
//
// of which this covers both bodies:
//   fine = 2^-45 (S + L) = 256 u (S + L)                                                                        (4)
//
// |m_a - m_b|^2 as computed has a relative error of 6 u, the square of the sum of radii one of 5 u, which are covered
// by
//   1 + 2^-48 = 1 + 32 u                                                                                        (5)
//
// Planes. Along d, |d| <= 1 + 2^-20:
//   d . w = (R^T d) . v + d . t + d . e                                                                         (6)
//
// The computed R^T d is off by 3.01 u |R|^T |d| per component, in length by 3.01 u sqrt(3) |d| (1 + 64 u) < 5.3 u |d|;
// the dot product with v by 3.01 u |d| |v|. With (2) the error of a support is below 15.4 u reach + 4.1 u |t|. d . (t_b
// - t_a) is off by 4.1 u L at most and the last two sums by 2.1 u (S + L). In all
//   |error of b's bottom above a's top| < 18 u (S + L) < fine / 14                                              (7)
//
// Supports. A vertex v lies in its node's box: v = c + x, |m_k . x| <= h_k + 16 u reach (bvh.cpp), M = [m_0 m_1 m_2],
// M^T M = 1 + F, |F| <= 4 f. |c| <= 1.75 reach, as its coordinates along the axes are means of such of vertices, h_k <=
// 1.01 reach and |x| <= 2.75 reach. For any g, with y = M^T x,
//   g . x = (M^T g) . (1 + F)^-1 y,   so |g . x| <= sum |m_k . g| h_k + 11.2 f |g| reach                        (8)
//
// The rounding of g to floats, of its four dot products and of their sum is below 34 f |g| reach, with (8) 46 f:
//   pad = 2^-17 reach = 128 f reach                                                                             (9)
//
// Nodes. D = S + |T|, T = R_a^T (t_b - t_a), C = R_a^T R_b. For a vector e of a's frame, |e| <= 1.01, and d = R_a e,
//   d . (w_b - w_a) = e . (C v_b + T - v_a) + less than 130 u reach_a + 8 u S + 5 u L                          (10)
//
// The two hulls are apart when this is positive for all vertices of two nodes. With z = C c_b + T - c_a, |z| <= 1.75 D,
//   e . (C v_b + T - v_a) = e . z + (C^T e) . x_b - e . x_a                                                    (11)
//
// the last two terms bounded by (8). Written with B = M_a^T C M_b and t = M_a^T z, up to the defects F of both:
//   e = m_k of a:    e . z = t_k,                     h_k of a,            sum_l |B_kl| h_l of b               (12)
//   e = C m_l of b:  e . z = sum_k B_kl t_k,          sum_k |B_kl| h_k,    h_l                                 (13)
//   e = m_k x C m_l: e . z = B_k'l t_k" - B_k"l t_k', h_k' |B_k"l| + h_k" |B_k'l|, h_l' |B_kl"| + h_l" |B_kl'|  (14)
//
// where k, k', k" and l, l', l" are 0, 1, 2 in cyclic order. The signs of (14) are those of right-handed axes; in
// left-handed ones all turn at once, which the absolute values taken of them do not see.
//
// Defects. (13) takes C^T C for 1, wrong by 270 u, and R_a R_a^T for 1 (128 u L): its left side is d . (w_b - w_a) for
// d = R_b m_l. (14) takes M^T (m_k x p) for e_k x M^T p: M is within 2.01 f of an orthonormal matrix, hence the
// components are within 6.1 f of it; and C^T (p x C q) for C^T p x q, wrong by 540 u |x|. In doubles all this stays
// below
//   2500 u (S + L)                                                                                             (15)
//
// Through F, in (13) and in (14), the latter with 6.1 f (|t_k'| + |t_k"|) <= 15.1 f D and 6.1 f (h' + h") <= 12.4 f
// reach for each body:
//   4 f |z| + 11.2 f S <= 18.2 f D                                                                             (16)
//   4 f |z| + 11.2 f S + 15.1 f D + 12.4 f S <= 46 f D                                                         (17)
//
// Rounding. C and T are rounded to floats, products with three terms add 3 f of their absolute values: B_kl is off by
// 10 f, z by 15.2 f D, t_k by 20.5 f D and as a vector by 24.4 f D. In (12), (13) and (14):
//   20.5 f D + 10 f (h_0 + h_1 + h_2) <= 51 f D                                                                (18)
//   24.4 f D + 10 f (|t_0| + |t_1| + |t_2|) + 30.3 f S <= 86 f D                                               (19)
//   24.4 f D + 10 f (|t_k'| + |t_k"|) + 20.3 f S <= 70 f D                                                     (20)
//
// The last sums of numbers below 1.8 D: less than 16 f D. In all 51 + 16, 18.2 + 86 + 16 and 46 + 70 + 16 = 132 f D in
// the three lines at most, and (15), covered by
//   coarse = 2^-16 D + 2^-41 (S + L) = 256 f D + 4096 u (S + L), rounded up                                    (21)
#include "geometry/decision/frames.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "geometry/processor_clones.hpp"
#include "geometry/vec.hpp"

namespace geometry {
namespace {

Vec3 transposed_times(const Mat3& r, const Vec3& d) { return {dot(r.col(0), d), dot(r.col(1), d), dot(r.col(2), d)}; }

/// Four floats.
using Four = float __attribute__((vector_size(16)));
using FourBits = std::int32_t __attribute__((vector_size(16)));

Four load(const float* four) {
  Four out;
  std::memcpy(&out, four, sizeof out);
  return out;
}

/// Two times four, for two tests side by side. Never passed but in line: no two compilers' ways of passing them can
/// meet.
#pragma GCC diagnostic ignored "-Wpsabi"
using Lanes = float __attribute__((vector_size(32)));
using Bits = std::int32_t __attribute__((vector_size(32)));

// In line, or AVX2 could not be used in them.
#define IN_LINE [[gnu::always_inline]] inline

IN_LINE Lanes load(const float* first, const float* second) {
  return __builtin_shufflevector(load(first), load(second), 0, 1, 2, 3, 4, 5, 6, 7);
}
IN_LINE Lanes absolute(Lanes x) { return reinterpret_cast<Lanes>(reinterpret_cast<Bits>(x) & 0x7fffffff); }
IN_LINE Lanes least(Lanes x, Lanes y) { return x < y ? x : y; }

/// Four lanes of each half: 0 to 3 are those of x, 4 to 7 those of y.
template <int i, int j, int k, int l>
IN_LINE Lanes pick(Lanes x, Lanes y) {
  constexpr auto lane = [](int n, int half) { return n % 4 + n / 4 * 8 + half * 4; };
  return __builtin_shufflevector(x, y, lane(i, 0), lane(j, 0), lane(k, 0), lane(l, 0), lane(i, 1), lane(j, 1),
                                 lane(k, 1), lane(l, 1));
}
template <int k>
IN_LINE Lanes all(Lanes x) {
  return pick<k, k, k, k>(x, x);
}
/// The first three lanes turned: lane l becomes that of l + 1.
IN_LINE Lanes next(Lanes x) { return pick<1, 2, 0, 3>(x, x); }

}  // namespace

Margin margin(const Body& a, const Body& b) {
  const double reach = a.around.reach + b.around.reach, far = a.at.length + b.at.length;
  const double least = std::min(a.around.radius, b.around.radius);
  Margin out;
  out.fine = 0x1p-45 * (reach + far);  // (4)
  out.useful =
      a.at.rigid && b.at.rigid && least >= 0x1p-60 && reach <= 0x1p60 && far <= 0x1p60 && out.fine <= 0x1p-24 * least;
  if (!out.useful) return out;
  // Not less than |T|: the sum of the parts is never below the length, but for roundings that `coarse` has room for.
  const double between =
      std::fabs(b.at.t.x() - a.at.t.x()) + std::fabs(b.at.t.y() - a.at.t.y()) + std::fabs(b.at.t.z() - a.at.t.z());
  // (21)
  out.coarse = static_cast<float>((0x1p-16 * (reach + between) + 0x1p-41 * (reach + far)) * (1 + 0x1p-20));
  out.useful = out.coarse <= least;  // or nearly no two nodes would be apart, and all facets be asked against all
  return out;
}

bool spheres_apart(const Body& a, const Body& b, const Margin& margin) {
  const Vec3 between = b.at.middle - a.at.middle;
  const double reach = (a.around.radius + b.around.radius) + margin.fine;
  return dot(between, between) > reach * reach * (1 + 0x1p-48);  // (5)
}

Support support(const Body& body, const Vec3& direction, std::uint64_t& operations) {
  const Four x = Four{} + static_cast<float>(direction.x()), y = Four{} + static_cast<float>(direction.y()),
             z = Four{} + static_cast<float>(direction.z());
  const float pad = static_cast<float>(0x1p-17 * body.around.reach);  // (9)
  const auto top = [&](std::uint32_t node) {
    const Bvh::Bound& bound = body.bvh.bounds[node];
    const Four along = (x * load(bound.row[0]) + y * load(bound.row[1])) + z * load(bound.row[2]);
    const Four extent = reinterpret_cast<Four>(reinterpret_cast<FourBits>(along) & 0x7fffffff) * load(bound.half);
    return (along[3] + ((extent[0] + extent[1]) + extent[2])) + pad;
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
  out.apart = out.gap > margin.fine;  // (7)
  out.from = to_world(a.at.r, a.at.t, a.mesh.vertices[top.vertex]);
  out.to = to_world(b.at.r, b.at.t, b.mesh.vertices[bottom.vertex]);
  return out;
}

Relative::Relative(const Body& a, const Body& b, const Margin& margin)
    : a_(a.bvh.bounds.data()), b_(b.bvh.bounds.data()), margin_(margin.coarse) {
  const Vec3 offset = transposed_times(a.at.r, b.at.t - a.at.t);
  for (int k = 0; k < 3; ++k) {
    const Vec3 column = transposed_times(a.at.r, b.at.r.col(k));
    for (int i = 0; i < 3; ++i) c_[i][k] = static_cast<float>(column[i]);
    offset_[k] = static_cast<float>(offset[k]);
  }
}

// S. Gottschalk, "Collision queries using oriented bounding boxes", 2000: three axes of either box and their nine cross
// products. The letters are those of the proof; in a name, 0 to 2 stand for k, lanes for l.
PROCESSOR_CLONES std::array<float, 2> Relative::overlap(const std::array<NodePair, 2>& pairs) const {
  const Bvh::Bound &a = a_[pairs[0].a], &b = b_[pairs[0].b], &other_a = a_[pairs[1].a], &other_b = b_[pairs[1].b];
  // Coordinate i in a's frame: of b's axes, and in the fourth lane of z.
  constexpr Bits kFourth = {0, 0, 0, -1, 0, 0, 0, -1};
  const Lanes q0 = load(b.row[0], other_b.row[0]), q1 = load(b.row[1], other_b.row[1]),
              q2 = load(b.row[2], other_b.row[2]);
  Lanes m[3], x[3];
  for (int i = 0; i < 3; ++i) {
    m[i] = load(a.row[i], other_a.row[i]);
    x[i] = ((c_[i][0] * q0 + c_[i][1] * q1) + c_[i][2] * q2) +
           reinterpret_cast<Lanes>(reinterpret_cast<Bits>(offset_[i] - m[i]) & kFourth);
  }
  // Row k of B, and in the fourth lane t_k.
  const Lanes b0 = (all<0>(m[0]) * x[0] + all<0>(m[1]) * x[1]) + all<0>(m[2]) * x[2];
  const Lanes b1 = (all<1>(m[0]) * x[0] + all<1>(m[1]) * x[1]) + all<1>(m[2]) * x[2];
  const Lanes b2 = (all<2>(m[0]) * x[0] + all<2>(m[1]) * x[1]) + all<2>(m[2]) * x[2];
  const Lanes size0 = absolute(b0), size1 = absolute(b1), size2 = absolute(b2);
  const Lanes t0 = all<3>(b0), t1 = all<3>(b1), t2 = all<3>(b2);
  const Lanes a_half = load(a.half, other_a.half), b_half = load(b.half, other_b.half);
  const Lanes h0 = all<0>(a_half), h1 = all<1>(a_half), h2 = all<2>(a_half);
  const Lanes margin = Lanes{} + margin_;

  // Along a's axes, one in each lane, (12): B transposed.
  const Lanes low = pick<0, 4, 1, 5>(size0, size1), high = pick<2, 6, 3, 7>(size0, size1);
  const Lanes column0 = pick<0, 1, 4, 4>(low, size2), column1 = pick<2, 3, 5, 5>(low, size2);
  const Lanes column2 = pick<0, 1, 6, 6>(high, size2), t = pick<2, 3, 7, 7>(high, size2);
  const Lanes by_a =
      (a_half + ((column0 * all<0>(b_half) + column1 * all<1>(b_half)) + column2 * all<2>(b_half))) + (margin - t);
  // Along b's, (13).
  const Lanes by_b =
      (b_half + ((size0 * h0 + size1 * h1) + size2 * h2)) + (margin - absolute((b0 * t0 + b1 * t1) + b2 * t2));
  // Along their cross products, (14).
  const Lanes b_next = next(b_half), b_last = next(b_next);
  const auto of_b = [&](Lanes size) __attribute__((always_inline)) {
    return b_next * next(next(size)) + b_last * next(size);
  };
  const Lanes by_0 = (((h1 * size2 + h2 * size1) + of_b(size0)) + margin) - absolute(b1 * t2 - b2 * t1);
  const Lanes by_1 = (((h2 * size0 + h0 * size2) + of_b(size1)) + margin) - absolute(b2 * t0 - b0 * t2);
  const Lanes by_2 = (((h0 * size1 + h1 * size0) + of_b(size2)) + margin) - absolute(b0 * t1 - b1 * t0);

  const Lanes depth = least(least(by_a, by_b), least(least(by_0, by_1), by_2));
  return {std::min(std::min(depth[0], depth[1]), depth[2]), std::min(std::min(depth[4], depth[5]), depth[6])};
}

}  // namespace geometry
