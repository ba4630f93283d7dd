#include "geometry/decision/gap.hpp"

#include <CGAL/Gmpq.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "geometry/decision/meet.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/setting.hpp"

using namespace geometry;
using setting::Setting;

namespace {

using Rational = CGAL::Gmpq;
using Exact = oracle::Vec<Rational>;

Exact exact(const Vec3& v) { return {Rational(v.x()), Rational(v.y()), Rational(v.z())}; }

template <class N>
oracle::Vec<N> plus(const oracle::Vec<N>& p, const N& k, const oracle::Vec<N>& d) {
  return {p.x + k * d.x, p.y + k * d.y, p.z + k * d.z};
}

template <class N>
N clamp01(const N& x) {
  return x < 0 ? N(0) : x > 1 ? N(1) : x;
}

/// Two segments, the squared distance; C. Ericson, "Real-Time Collision Detection", 2005, 5.1.9.
template <class N>
N segments(const oracle::Vec<N>& p, const oracle::Vec<N>& d, const oracle::Vec<N>& q, const oracle::Vec<N>& f) {
  const auto r = p - q;
  const N a = dot(d, d), e = dot(f, f), b = dot(d, f), c = dot(d, r), g = dot(f, r), denominator = a * e - b * b;
  N s = 0, t = 0;
  if (a > 0 && denominator > 0) s = clamp01<N>((b * g - c * e) / denominator);
  if (e > 0) t = (b * s + g) / e;
  if (t < 0 || e == 0)
    t = 0, s = a > 0 ? clamp01<N>(-c / a) : N(0);
  else if (t > 1)
    t = 1, s = a > 0 ? clamp01<N>((b - c) / a) : N(0);
  const auto gap = plus<N>(p, s, d) - plus<N>(q, t, f);
  return dot(gap, gap);
}

/// The squared distance of two triangles that do not meet: of their edges, or of a corner over a face.
template <class N>
N squared_distance(const std::array<oracle::Vec<N>, 3>& a, const std::array<oracle::Vec<N>, 3>& b) {
  N best = dot(a[0] - b[0], a[0] - b[0]);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      best = std::min(best, segments<N>(a[i], a[(i + 1) % 3] - a[i], b[k], b[(k + 1) % 3] - b[k]));
  for (const auto& [points, face] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    const auto& f = *face;
    const auto n = cross(f[1] - f[0], f[2] - f[0]);
    if (n.zero()) continue;
    for (const auto& p : *points) {
      bool over = true;
      for (int k = 0; k < 3; ++k) over &= dot(cross(f[(k + 1) % 3] - f[k], p - f[k]), n) >= 0;
      const N height = dot(p - f[0], n);
      if (over) best = std::min<N>(best, height * height / dot(n, n));
    }
  }
  return best;
}

Rational squared_distance(const Triangle& a, const Triangle& b) {
  if (oracle::triangles_meet(a, b)) return 0;
  return squared_distance<Rational>({exact(a[0]), exact(a[1]), exact(a[2])}, {exact(b[0]), exact(b[1]), exact(b[2])});
}

void expect_holds(const GapBounds& bounds, const Rational& square) {
  ASSERT_GE(bounds.lower, 0);
  ASSERT_LT(bounds.upper, std::numeric_limits<double>::infinity());
  EXPECT_LE(Rational(bounds.lower) * Rational(bounds.lower), square) << bounds.lower;
  EXPECT_GE(Rational(bounds.upper) * Rational(bounds.upper), square) << bounds.upper;
}

double extent(const Triangle& a, const Triangle& b) {
  Box box;
  for (int i = 0; i < 3; ++i) box.add(a[i]), box.add(b[i]);
  return (box.max - box.min).maxCoeff();
}

std::vector<Gap> gaps(const Setting& s, double margin) {
  const std::vector<Bvh> bvhs = build_bvhs(s.bodies);
  const std::vector<Pair> met = Decision(s.bodies, bvhs).hits(s.poses, s.runs());
  return GapSearch(s.bodies, bvhs).near(s.poses, s.runs(), margin, met);
}

/// The distance of two bodies that do not meet.
GapBounds gap(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b, double margin = 1e300) {
  const auto found = gaps(Setting().add(a, at_a).add(b, at_b), margin);
  if (found.size() == 1) return found[0].metres;
  ADD_FAILURE() << found.size() << " pairs";
  return {};
}

void expect_near(const GapBounds& bounds, double distance, double coordinates) {
  EXPECT_LE(bounds.lower, distance * (1 + 1e-15));
  EXPECT_GE(bounds.upper, distance * (1 - 1e-15));
  EXPECT_LE(bounds.upper - bounds.lower, 1e-12 * coordinates);
}

/// Every kind of trouble: general, slivers, needles, points, edges all but parallel, nearly coplanar, small integers.
Triangle any_triangle(std::mt19937& random, int kind) {
  const auto point = [&](double size) { return setting::uniform_point(random, size); };
  const double tiny = std::ldexp(1.0, -int(random() % 60));
  Triangle t{point(1), point(1), point(1)};
  switch (kind) {
    case 1:  // sliver
      t[2] = t[0] + (0.5 + 0.5 * setting::uniform(random)) * (t[1] - t[0]) + tiny * point(1);
      break;
    case 2:  // needle
      t[2] = t[0] + tiny * point(1);
      break;
    case 3:  // segment
      t[2] = t[random() % 2];
      break;
    case 4:  // point
      t[1] = t[2] = t[0];
      break;
    case 5:  // nearly in the plane z = 0
      for (Vec3& v : t) v.z() *= tiny;
      break;
    case 6:  // small integers
      for (Vec3& v : t) v = Vec3(int(random() % 5), int(random() % 5), int(random() % 5));
      break;
    case 7:  // an edge nearly along x
      t[1] = t[0] + Vec3(1, tiny * setting::uniform(random), tiny * setting::uniform(random));
      break;
  }
  return t;
}

}  // namespace

TEST(TriangleGap, HoldsTheExactDistanceWhateverTheTriangles) {
  const unsigned seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  double widest = 0;
  for (int i = 0; i < 1000; ++i) {
    const Triangle a = any_triangle(random, i % 8);
    Triangle b = any_triangle(random, i / 8 % 8);
    const double near = std::ldexp(1.0, -int(random() % 55));  // from far to all but touching
    const Vec3 by = setting::uniform_point(random, 2);
    if (random() % 2) {
      const Vec3 to = a[random() % 3] - b[random() % 3] + near * by;
      for (Vec3& v : b) v += to;
    } else {
      for (Vec3& v : b) v += by;
    }
    const GapBounds bounds = triangle_gap(a, b);
    const Rational square = squared_distance(a, b);
    expect_holds(bounds, square);
    if (square > 0) widest = std::max(widest, (bounds.upper - bounds.lower) / extent(a, b));
  }
  EXPECT_LE(widest, 1e-12);
}

TEST(TriangleGap, HoldsAtEveryScaleAndOffset) {
  const unsigned seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (const double scale : {1e-250, 1e-160, 1e-9, 1.0, 1e9, 1e160, 1e290})
    for (const double offset : {0.0, 1e3, 1e6, 1e9})
      for (int i = 0; i < 10; ++i) {
        Triangle a = any_triangle(random, i % 8), b = any_triangle(random, 0);
        for (Vec3& v : a) v = scale * (v + Vec3(offset, -offset, offset));
        for (Vec3& v : b) v = scale * (v + Vec3(offset + 1, -offset, offset));
        const GapBounds bounds = triangle_gap(a, b);
        const Rational square = squared_distance(a, b);
        expect_holds(bounds, square);
        if (square > 0) {
          EXPECT_LE(bounds.upper - bounds.lower, 1e-12 * scale * std::max(offset, 4.0));
        }
      }
}

TEST(TriangleGap, IsTheSameUpToItsWidthWhenSwapped) {
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    const Triangle a = any_triangle(random, i % 8), b = any_triangle(random, i / 8 % 8);
    const GapBounds one = triangle_gap(a, b), other = triangle_gap(b, a);
    EXPECT_LE(one.lower, other.upper);
    EXPECT_LE(other.lower, one.upper);
  }
}

TEST(TriangleGap, OfTrianglesThatMeetIsNothing) {
  const Triangle a{Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0, 2, 0)},
      across{Vec3(.5, .5, -1), Vec3(.5, .5, 1), Vec3(.6, .5, 1)};
  EXPECT_EQ(triangle_gap(a, across).lower, 0);
  EXPECT_EQ(triangle_gap(a, a).lower, 0);
  EXPECT_LE(triangle_gap(a, a).upper, 1e-12);
}

TEST(Gap, OfBoxesFaceEdgeAndCorner) {
  const Mesh cube = box("cube", {2, 2, 2});
  const auto at = [](double x, double y, double z) { return Pose{{}, {x, y, z}}; };
  expect_near(gap(cube, at(0, 0, 0), cube, at(2.25, 0.3, -0.2)), 0.25, 4);
  expect_near(gap(cube, at(0, 0, 0), cube, at(0.3, -5, -0.2)), 3, 7);
  expect_near(gap(cube, at(0, 0, 0), cube, at(5, 6, 0.5)), 5, 8);  // 3, 4
  expect_near(gap(cube, at(0, 0, 0), cube, at(4, 5, -8)), 7, 10);  // 2, 3, 6
  expect_near(gap(cube, at(0, 0, 0), cube, at(2 + 1e-7, 0, 0)), (2 + 1e-7) - 2, 4);
  // An edge over an edge, crossed: one turned by 45 degrees about x, the other about y.
  const Pose edge_up{setting::turn_deg({1, 0, 0}, 45), {0, 0, 0}};
  const Pose edge_down{setting::turn_deg({0, 1, 0}, 45), {0, 0, 2 * std::numbers::sqrt2 + 0.5}};
  expect_near(gap(cube, edge_up, cube, edge_down), 0.5, 5);
  // Inside: surfaces.
  expect_near(gap(box("room", {10, 10, 10}), at(0, 0, 0), cube, at(3, 0, 0)), 1, 10);
}

TEST(Gap, OfScaledAndFarBoxes) {
  for (const double scale : {1e-9, 1e-3, 1.0, 1e6, 1e9})
    for (const double offset : {0.0, 1e3, 1e9}) {
      if (offset > 0x1p40 * scale) continue;
      const Mesh cube = box("cube", Vec3::Constant(scale));
      const Pose at{{}, {offset, 0, 0}}, beside{{}, {offset + 1.5 * scale, 0, 0}};
      // The world vertices are rounded: the distance is that of what the sums became.
      const double distance = (beside.t.x() - 0.5 * scale) - (at.t.x() + 0.5 * scale);
      expect_near(gap(cube, at, cube, beside), distance, std::max(offset, 4 * scale));
    }
}

TEST(Gap, OfMeshesHoldsWhatAllPairsOfTrianglesSay) {
  const unsigned seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const std::vector<Mesh> meshes = {sphere("ball", 1, 4), setting::ring(1.2, 0.3, 8), box("slab", {3, 0.2, 2}),
                                    torus_knot("knot", 1, 0.3, 12, 4, 2, 3)};
  int compared = 0;
  for (int i = 0; compared < 14; ++i) {
    const Mesh &a = meshes[i % 4], &b = meshes[i / 4 % 4];
    Pose at_a{setting::uniform_turn(random), Vec3::Zero()}, at_b{setting::uniform_turn(random), Vec3::Zero()};
    at_b.t = (1.5 + setting::uniform(random)) * Vec3(2, setting::uniform(random), setting::uniform(random));
    if (setting::truly_meet(a, at_a, b, at_b)) continue;
    const auto s = oracle::world_triangles(a, at_a), t = oracle::world_triangles(b, at_b);
    // All pairs in extended precision; the nearest of them exactly.
    using Long = long double;
    std::vector<std::pair<Long, std::pair<std::size_t, std::size_t>>> all;
    Long least = 1e30L;
    for (std::size_t f = 0; f < s.size(); ++f)
      for (std::size_t g = 0; g < t.size(); ++g) {
        const Long square = squared_distance<Long>(oracle::corners<Long>(s[f]), oracle::corners<Long>(t[g]));
        least = std::min(least, square);
        if (square <= least + 1e-9L) all.push_back({square, {f, g}});
      }
    Rational square = Rational(1e30);
    for (const auto& [about, at] : all)
      if (about <= least + 1e-9L) square = std::min(square, squared_distance(s[at.first], t[at.second]));
    const GapBounds bounds = gap(a, at_a, b, at_b);
    expect_holds(bounds, square);
    EXPECT_LE(bounds.upper - bounds.lower, 1e-12 * 8);
    ++compared;
  }
}

// Bodies a few units in the last place apart: the gap of axis-parallel faces is one difference of doubles.
TEST(Gap, WithinUlpsOfTouchingIsStillAboveNothing) {
  const Mesh cube = box("cube", {1, 1, 1});
  for (const double offset : {0.0, 1e3, 1e9})
    for (const int ulps : {1, 10, 1000}) {
      double x = offset + 1;
      for (int i = 0; i < ulps; ++i) x = std::nextafter(x, 1e300);
      const Pose at{{}, {offset, 0, 0}}, beside{{}, {x, 0.2, 0.1}};
      if (setting::truly_meet(cube, at, cube, beside)) continue;  // the face's own rounding swallowed them
      const double distance = (x - 0.5) - (offset + 0.5);
      const GapBounds bounds = gap(cube, at, cube, beside);
      EXPECT_GT(bounds.lower, 0.999 * distance);
      EXPECT_LE(bounds.lower, distance);
      EXPECT_GE(bounds.upper, distance);
      EXPECT_LE(bounds.upper, distance + 1e-12);
    }
}

TEST(Gap, OnlyPairsWithinTheMarginThatDoNotMeet) {
  const Mesh cube = box("cube", {1, 1, 1});
  Setting s;
  for (const double x : {0.0, 1.25, 2.5, 3.5, 9.0}) s.add(cube, {{}, {x, 0, 0}});
  const auto pairs = [&](double margin) {
    std::vector<Pair> out;
    for (const Gap& gap : gaps(s, margin)) out.push_back(gap.pair);
    return out;
  };
  EXPECT_EQ(pairs(0.2), (std::vector<Pair>{}));
  EXPECT_EQ(pairs(0.25), (std::vector<Pair>{{0, 1}, {1, 2}}));  // at the margin itself; 2 and 3 touch
  EXPECT_EQ(pairs(1.5), (std::vector<Pair>{{0, 1}, {0, 2}, {1, 2}, {1, 3}}));
  EXPECT_EQ(pairs(4.5), (std::vector<Pair>{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {3, 4}}));
}

TEST(Gap, BoundsOnBothSidesOfTheMarginKeepThePair) {
  const Mesh cube = box("cube", {1, 1, 1});
  const Pose at{setting::turn_deg({1, 2, 3}, 40), Vec3::Zero()},
      beside{setting::turn_deg({3, 1, 2}, 70), {1.9, 0.3, 0.2}};
  const GapBounds wide = gap(cube, at, cube, beside);
  ASSERT_LT(wide.lower, wide.upper);
  const Setting s = Setting().add(cube, at).add(cube, beside);
  EXPECT_EQ(gaps(s, wide.lower).size(), 1u);
  EXPECT_EQ(gaps(s, std::nextafter(wide.lower, 0) * (1 - 1e-11)).size(), 0u);
}

TEST(Gap, UnbornInfiniteFixedAndCoincidentBodies) {
  const Mesh cube = box("cube", {1, 1, 1});
  Setting s;
  s.add(cube, {{}, {0, 0, 0}}).add(cube, {{}, {0, 0, 0}}).add(cube, unborn());
  s.add(cube, {{}, {std::numeric_limits<double>::infinity(), 0, 0}}).add(cube, {{}, {1.5, 0, 0}}, true);
  s.add(cube, {{}, {3, 0, 0}}, true).add(cube, {{}, {1e200, 0, 0}});
  std::vector<Pair> found;
  for (const Gap& gap : gaps(s, 1)) found.push_back(gap.pair);
  EXPECT_EQ(found, (std::vector<Pair>{{0, 4}, {1, 4}}));  // 0 and 1 meet, 4 and 5 are fixed
}

// The sweep and the caches leave nothing out: every pair alone says the same, bit for bit.
TEST(Gap, OfACrowdIsThatOfItsPairs) {
  const unsigned seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  Setting s = setting::crowd(random, 14, 4);
  s.add(box("plate", {40, 1, 40}), {{}, {0, -5, 0}}, true);
  const std::vector<Bvh> bvhs = build_bvhs(s.bodies);
  const std::vector<Pair> met = Decision(s.bodies, bvhs).hits(s.poses, s.runs());
  GapSearch search(s.bodies, bvhs);
  const std::vector<Gap> all = search.near(s.poses, s.runs(), 1.5, met);
  EXPECT_GT(all.size(), 5u);
  std::vector<Gap> one_by_one;
  for (const PairRun& run : s.runs())
    for (std::uint32_t b = run.first; b < run.last; ++b) {
      const PairRun alone{run.a, b, b + 1};
      for (const Gap& gap : search.near(s.poses, {&alone, 1}, 1.5, met)) one_by_one.push_back(gap);
    }
  ASSERT_EQ(all.size(), one_by_one.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].pair, one_by_one[i].pair);
    EXPECT_EQ(all[i].metres.lower, one_by_one[i].metres.lower);
    EXPECT_EQ(all[i].metres.upper, one_by_one[i].metres.upper);
  }
}
