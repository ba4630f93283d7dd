// Triangle pairs against an oracle of another method and another arithmetic (tests/support/oracle.hpp).
#include "geometry/decision/exact.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cfloat>
#include <cmath>
#include <functional>
#include <limits>
#include <sstream>
#include <string>

#include "tests/support/oracle.hpp"
#include "tests/support/programming.hpp"
#include "tests/support/random.hpp"

namespace {

using geometry::is_degenerate;
using geometry::Triangle;
using geometry::triangles_meet;
using geometry::Vec3;
using tests::kSeed;
using tests::Random;

std::string text(const Triangle& a, const Triangle& b) {
  std::ostringstream out;
  out << std::hexfloat;
  for (const auto* t : {&a, &b})
    for (const auto& p : *t) out << "\n  {" << p.x() << ", " << p.y() << ", " << p.z() << "}";
  return out.str();
}

/// Compares both orders of the pair, and one turn of the corners, with the oracle; counts what it saw.
class Comparison {
 public:
  void add(const Triangle& a, const Triangle& b) {
    const bool expected = oracle::triangles_meet(a, b);
    meeting_ += expected;
    ++pairs_;
    const Triangle turned{a[1], a[2], a[0]}, mirrored{b[1], b[0], b[2]};
    if (triangles_meet(a, b) != expected || triangles_meet(b, a) != expected ||
        triangles_meet(turned, mirrored) != expected)
      if (++wrong_ <= 3) ADD_FAILURE() << "seed " << kSeed << ", the oracle says " << expected << text(a, b);
  }
  /// Fails when the cases were so one-sided that the comparison means nothing.
  void expect_both_answers(double least_share = 0.02) const {
    EXPECT_EQ(wrong_, 0u) << "of " << pairs_;
    EXPECT_GE(meeting_, least_share * pairs_);
    EXPECT_LE(meeting_, (1 - least_share) * pairs_);
  }
  std::size_t pairs() const { return pairs_; }
  std::size_t meeting() const { return meeting_; }
  std::size_t wrong() const { return wrong_; }

 private:
  std::size_t pairs_ = 0, meeting_ = 0, wrong_ = 0;
};

Triangle map(const Triangle& t, const std::function<Vec3(const Vec3&)>& f) { return {f(t[0]), f(t[1]), f(t[2])}; }

double ulps_away(double x, int ulps) {
  for (; ulps > 0; --ulps) x = std::nextafter(x, DBL_MAX);
  for (; ulps < 0; ++ulps) x = std::nextafter(x, -DBL_MAX);
  return x;
}

const Triangle kFloor{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};

struct Case {
  const char* fact;
  Triangle a, b;
  bool meet;
};

const std::vector<Case> kCases{
    {"identical", kFloor, kFloor, true},
    {"crossing through the interior", kFloor, {Vec3(1, 1, -1), Vec3(1, 1, 1), Vec3(3, 3, 1)}, true},
    {"parallel above", kFloor, {Vec3(0, 0, 1), Vec3(4, 0, 1), Vec3(0, 4, 1)}, false},
    {"a corner on the face", kFloor, {Vec3(1, 1, 0), Vec3(1, 1, 1), Vec3(2, 1, 1)}, true},
    {"a corner one denormal above the face", kFloor, {Vec3(1, 1, 0x1p-1074), Vec3(1, 1, 1), Vec3(2, 1, 1)}, false},
    {"a corner on a corner", kFloor, {Vec3(4, 0, 0), Vec3(5, 0, 1), Vec3(5, 1, 1)}, true},
    {"a corner on an edge", kFloor, {Vec3(2, 2, 0), Vec3(3, 3, 1), Vec3(3, 3, -1)}, true},
    {"edges cross in a point", kFloor, {Vec3(2, 0, -1), Vec3(2, 0, 1), Vec3(2, -2, 0)}, true},
    {"edges pass one ulp apart", kFloor, {Vec3(2, -0x1p-52, -1), Vec3(2, -0x1p-52, 1), Vec3(2, -2, 0)}, false},
    {"a common edge", kFloor, {Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 0, 4)}, true},
    {"coplanar overlapping", kFloor, {Vec3(1, 1, 0), Vec3(5, 1, 0), Vec3(1, 5, 0)}, true},
    {"coplanar, one inside the other", kFloor, {Vec3(1, 1, 0), Vec3(2, 1, 0), Vec3(1, 2, 0)}, true},
    {"coplanar apart", kFloor, {Vec3(3, 3, 0), Vec3(4, 3, 0), Vec3(3, 4, 0)}, false},
    {"coplanar, a corner on an edge", kFloor, {Vec3(2, 2, 0), Vec3(4, 3, 0), Vec3(3, 4, 0)}, true},
    {"coplanar, crossing without corners inside",
     {Vec3(0, 0, 0), Vec3(6, 0, 0), Vec3(3, 6, 0)},
     {Vec3(0, 4, 0), Vec3(6, 4, 0), Vec3(3, -2, 0)},
     true},
    {"planes cross, intervals apart", kFloor, {Vec3(9, 9, -1), Vec3(9, 9, 1), Vec3(10, 9, 1)}, false},
    {"a segment through the face", kFloor, {Vec3(1, 1, -1), Vec3(1, 1, 1), Vec3(1, 1, 0)}, true},
    {"a segment beside the face", kFloor, {Vec3(3, 3, -1), Vec3(3, 3, 1), Vec3(3, 3, 0)}, false},
    {"a segment lying in the face", kFloor, {Vec3(1, 1, 0), Vec3(2, 1, 0), Vec3(3, 1, 0)}, true},
    {"a segment in the plane, outside", kFloor, {Vec3(3, 3, 0), Vec3(4, 4, 0), Vec3(5, 5, 0)}, false},
    {"a point on the face", kFloor, {Vec3(1, 1, 0), Vec3(1, 1, 0), Vec3(1, 1, 0)}, true},
    {"a point above the face", kFloor, {Vec3(1, 1, 1), Vec3(1, 1, 1), Vec3(1, 1, 1)}, false},
    {"segments cross",
     {Vec3(0, 0, 0), Vec3(2, 2, 2), Vec3(1, 1, 1)},
     {Vec3(0, 2, 1), Vec3(2, 0, 1), Vec3(0, 2, 1)},
     true},
    {"skew segments",
     {Vec3(0, 0, 0), Vec3(2, 2, 0), Vec3(1, 1, 0)},
     {Vec3(0, 2, 1), Vec3(2, 0, 1), Vec3(0, 2, 1)},
     false},
    {"collinear segments with a gap",
     {Vec3(0, 0, 0), Vec3(1, 1, 1), Vec3(0, 0, 0)},
     {Vec3(2, 2, 2), Vec3(3, 3, 3), Vec3(3, 3, 3)},
     false},
    {"collinear segments end to end",
     {Vec3(0, 0, 0), Vec3(1, 1, 1), Vec3(0, 0, 0)},
     {Vec3(1, 1, 1), Vec3(3, 3, 3), Vec3(3, 3, 3)},
     true},
    {"a point on a segment",
     {Vec3(0, 0, 0), Vec3(2, 4, 6), Vec3(1, 2, 3)},
     {Vec3(1, 2, 3), Vec3(1, 2, 3), Vec3(1, 2, 3)},
     true},
    {"a point beside a segment",
     {Vec3(0, 0, 0), Vec3(2, 4, 6), Vec3(1, 2, 3)},
     {Vec3(1, 2, 4), Vec3(1, 2, 4), Vec3(1, 2, 4)},
     false},
    {"equal points",
     {Vec3(1, 2, 3), Vec3(1, 2, 3), Vec3(1, 2, 3)},
     {Vec3(1, 2, 3), Vec3(1, 2, 3), Vec3(1, 2, 3)},
     true},
    {"zeros of either sign",
     {Vec3(0., 0., 0.), Vec3(0., 0., 0.), Vec3(0., 0., 0.)},
     {Vec3(-0., -0., -0.), Vec3(-0., -0., -0.), Vec3(-0., -0., -0.)},
     true},
    {"different points",
     {Vec3(1, 2, 3), Vec3(1, 2, 3), Vec3(1, 2, 3)},
     {Vec3(1, 2, 4), Vec3(1, 2, 4), Vec3(1, 2, 4)},
     false},
};

TEST(ExactTriangles, AnswersByHand) {
  for (const auto& c : kCases) {
    EXPECT_EQ(triangles_meet(c.a, c.b), c.meet) << c.fact;
    EXPECT_EQ(triangles_meet(c.b, c.a), c.meet) << c.fact << ", swapped";
  }
}

TEST(Oracle, AnswersByHand) {
  for (const auto& c : kCases) {
    EXPECT_EQ(oracle::triangles_meet(c.a, c.b), c.meet) << c.fact;
    EXPECT_EQ(programming::hulls_meet(c.b, c.a), c.meet) << c.fact << ", swapped, as rationals";
  }
}

// The hand-made cases keep their answer under every exact motion of the grid: this asks the oracle's lesser dimensions
// in all directions.
TEST(Oracle, AgreesWithItselfUnderShearsAndPermutations) {
  Random random;
  for (const auto& c : kCases) {
    if (c.b[0].z() == 0x1p-1074 || c.b[0].y() == -0x1p-52) continue;  // a shear would round them
    for (int i = 0; i < 20; ++i) {
      const int k = random.integer(-3, 3), l = random.integer(-3, 3), m = random.integer(-3, 3);
      const auto f = [=](const Vec3& p) -> Vec3 {  // determinant 1
        const double x = p.x() + k * p.y() + l * p.z(), y = p.y() + m * p.z();
        return {p.z() + 2 * x, x, y};
      };
      EXPECT_EQ(oracle::triangles_meet(map(c.a, f), map(c.b, f)), c.meet) << c.fact;
    }
  }
}

TEST(ExactTriangles, IsDegenerateExactly) {
  EXPECT_FALSE(is_degenerate(kFloor));
  EXPECT_TRUE(is_degenerate({Vec3(1, 2, 3), Vec3(1, 2, 3), Vec3(1, 2, 3)}));
  EXPECT_TRUE(is_degenerate({Vec3(0, 0, 0), Vec3(1, 2, 3), Vec3(3, 6, 9)}));
  EXPECT_FALSE(is_degenerate({Vec3(0, 0, 0), Vec3(1, 2, 3), Vec3(3, 6, ulps_away(9, 1))}));
  // 0.1 + 0.2 is not 0.3: nearly collinear corners are not collinear.
  EXPECT_FALSE(is_degenerate({Vec3(0, 0, 0), Vec3(0.1, 0.2, 0.3), Vec3(0.3, 0.6, 0.9)}));
  EXPECT_FALSE(is_degenerate({Vec3(0, 0, 0), Vec3(0x1p-1074, 0, 0), Vec3(0, 0x1p-1074, 0)}));
  EXPECT_TRUE(is_degenerate({Vec3(0, 0, 0), Vec3(0x1p-1074, 0, 0), Vec3(0x1p-1073, 0, 0)}));
  EXPECT_FALSE(is_degenerate({Vec3(-DBL_MAX, 0, 0), Vec3(DBL_MAX, 0, 0), Vec3(0, DBL_MAX, 0)}));
  EXPECT_TRUE(is_degenerate({Vec3(-DBL_MAX, 0, 0), Vec3(DBL_MAX, 0, 0), Vec3(0x1p-1074, 0, 0)}));
}

TEST(ExactTriangles, DegeneracyAgreesWithTheOracle) {
  Random random;
  std::size_t degenerate = 0;
  for (int i = 0; i < 20000; ++i) {
    Triangle t = random.grid_triangle(2);
    if (i % 4 == 1) t = {t[0] * 0.1, t[1] * 0.1, t[2] * 0.1};
    if (i % 4 == 2) t[0].x() = ulps_away(t[0].x(), 1);
    if (i % 4 == 3) t = {t[0] * 1e-310, t[1] * 1e-310, t[2] * 1e-310};
    degenerate += oracle::degenerate(t);
    ASSERT_EQ(is_degenerate(t), oracle::degenerate(t)) << "seed " << kSeed << text(t, t);
  }
  EXPECT_GT(degenerate, 500u);
}

TEST(ExactTrianglesOracle, RandomPairs) {
  Random random;
  Comparison comparison;
  for (int i = 0; i < 40000; ++i) comparison.add(random.triangle(), random.triangle());
  comparison.expect_both_answers();
}

// On a grid of 3 x 3 x 3 or 5 x 5 x 5 points nearly everything exact happens: shared corners and edges, corners on
// faces and edges, coplanar pairs of all kinds, segments and points.
TEST(ExactTrianglesOracle, GridPairs) {
  Random random;
  Comparison comparison;
  for (int i = 0; i < 60000; ++i) {
    const int n = 1 + i % 2;
    comparison.add(random.grid_triangle(n), random.grid_triangle(n));
  }
  comparison.expect_both_answers();
}

TEST(ExactTrianglesOracle, CoplanarPairsInObliquePlanes) {
  Random random;
  Comparison comparison;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 u = random.grid_point(5), v = random.grid_point(5), o = random.grid_point(9);
    const auto in_plane = [&] { return Vec3(o + random.integer(-4, 4) * u + random.integer(-4, 4) * v); };
    comparison.add({in_plane(), in_plane(), in_plane()}, {in_plane(), in_plane(), in_plane()});
  }
  comparison.expect_both_answers();
}

TEST(ExactTrianglesOracle, SharedCornersAndEdgesInGeneralPosition) {
  Random random;
  for (int i = 0; i < 10000; ++i) {
    const Triangle a = random.triangle();
    Triangle b = random.triangle();
    const int shared = random.integer(1, 3), from = random.integer(0, 2), to = random.integer(0, 2);
    for (int k = 0; k < shared; ++k) b[(to + k) % 3] = a[(from + k) % 3];
    ASSERT_TRUE(triangles_meet(a, b) && triangles_meet(b, a)) << "seed " << kSeed << text(a, b);
  }
}

// Corners rounded onto a face lie above or below it by less than an ulp.
TEST(ExactTrianglesOracle, CornersRoundedOntoFaces) {
  Random random;
  Comparison comparison;
  for (int i = 0; i < 30000; ++i) {
    const Triangle a = random.triangle();
    const double s = std::fabs(random.real()), t = std::fabs(random.real()) * (1 - s);
    Triangle b = random.triangle();
    b[0] = a[0] + s * (a[1] - a[0]) + t * (a[2] - a[0]);
    const Vec3 n = (a[1] - a[0]).cross(a[2] - a[0]);
    for (int k = 1; k < 3; ++k)  // the other two on one side of the plane
      if (n.dot(b[k] - a[0]) < 0) b[k] = 2 * b[0] - b[k];
    comparison.add(a, b);
  }
  comparison.expect_both_answers();
}

// The last double before contact and the first in contact along one coordinate, and ten to either side.
TEST(ExactTrianglesOracle, GrazingWithinTenUlps) {
  Random random;
  Comparison comparison;
  std::size_t found = 0;
  for (int i = 0; i < 1500; ++i) {
    const double offset = i % 3 == 1 ? 1e6 : i % 3 == 2 ? 1e12 : 0, size = i % 3 == 2 ? 1e3 : 1;
    const auto place = [&](const Vec3& p) -> Vec3 { return p * size + Vec3(offset, -offset, 0.5 * offset); };
    const Triangle a = map(random.triangle(), place), from = map(random.triangle(), place);
    const int axis = random.integer(0, 2), corner = random.integer(0, 3);  // 3: the whole triangle moves
    const auto moved = [&](double by) {
      Triangle b = from;
      for (int k = 0; k < 3; ++k)
        if (corner == 3 || corner == k) b[k][axis] += by;
      return b;
    };
    double apart = 0, meet = 0;
    for (int k = 1; k < 100; ++k) {
      const double by = random.real() * 3 * size;
      (triangles_meet(a, moved(by)) ? meet : apart) = by;
    }
    if (!triangles_meet(a, moved(meet)) || triangles_meet(a, moved(apart))) continue;
    while (true) {
      const double middle = meet + 0.5 * (apart - meet);
      if (middle == meet || middle == apart) break;
      (triangles_meet(a, moved(middle)) ? meet : apart) = middle;
    }
    ++found;
    const Triangle contact = moved(meet);
    for (int ulps = -10; ulps <= 10; ++ulps) {
      Triangle b = contact;
      for (int k = 0; k < 3; ++k)
        if (corner == 3 || corner == k) b[k][axis] = ulps_away(b[k][axis], ulps);
      comparison.add(a, b);
    }
  }
  EXPECT_GT(found, 500u);
  comparison.expect_both_answers();
}

TEST(ExactTrianglesOracle, ManyScalesAndFarFromTheOrigin) {
  Random random;
  Comparison comparison;
  for (int i = 0; i < 24000; ++i) {
    const double size = std::pow(10.0, random.integer(-12, 12));
    const double offset = i % 2 ? std::pow(10.0, random.integer(6, 12)) : 0;
    const Vec3 o = offset * random.point();
    const auto place = [&](const Vec3& p) -> Vec3 { return p * size + o; };
    comparison.add(map(i % 3 ? random.triangle() : random.grid_triangle(2), place),
                   map(i % 3 ? random.triangle() : random.grid_triangle(2), place));
  }
  comparison.expect_both_answers();
}

// Products of such coordinates underflow or overflow; the powers of two keep the grid exact, so that contact happens.
TEST(ExactTrianglesOracle, TheEndsOfTheRangeOfDoubles) {
  Random random;
  Comparison comparison;
  for (const int exponent :
       {-1074, -1070, -1022, -700, -540, -500, -360, -340, 300, 335, 345, 500, 510, 700, 1000, 1020})
    for (int i = 0; i < 1000; ++i) {
      const auto place = [&](const Vec3& p) -> Vec3 {
        return {std::ldexp(p.x(), exponent), std::ldexp(p.y(), exponent), std::ldexp(p.z(), exponent)};
      };
      if (i % 2)
        comparison.add(map(random.grid_triangle(2), place), map(random.grid_triangle(2), place));
      else
        comparison.add(map(random.triangle(), place), map(random.triangle(), place));
    }
  comparison.expect_both_answers();
}

// Each coordinate has an exponent of its own: the filter's sums span the whole range, some terms under-, some overflow.
TEST(ExactTrianglesOracle, AllExponentsInOnePair) {
  Random random;
  Comparison comparison;
  for (int i = 0; i < 6000; ++i) {
    std::array<int, 3> exponent;
    for (auto& e : exponent) e = random.integer(-1072, 1022);
    const auto place = [&](const Vec3& p) -> Vec3 {
      return {std::ldexp(p.x(), exponent[0]), std::ldexp(p.y(), exponent[1]), std::ldexp(p.z(), exponent[2])};
    };
    if (i % 2)
      comparison.add(map(random.grid_triangle(1), place), map(random.grid_triangle(1), place));
    else
      comparison.add(map(random.triangle(), place), map(random.triangle(), place));
  }
  comparison.expect_both_answers();
}

TEST(ExactTrianglesOracle, TheGreatestDoubles) {
  Random random;
  Comparison comparison;
  const auto place = [](const Vec3& p) -> Vec3 { return p * DBL_MAX; };
  for (int i = 0; i < 2000; ++i)
    comparison.add(map(random.grid_triangle(1), place), map(random.grid_triangle(1), place));
  comparison.expect_both_answers();
}

TEST(ExactTrianglesOracle, Slivers) {
  Random random;
  Comparison comparison;
  for (int i = 0; i < 20000; ++i) {
    const auto sliver = [&]() -> Triangle {
      const Vec3 p = random.point(), q = random.point();
      const double s = random.real(), thickness = std::pow(10.0, -random.integer(3, 18));
      return {p, q, p + s * (q - p) + thickness * random.point()};
    };
    Triangle b = i % 2 ? sliver() : random.triangle();
    const Triangle a = sliver();
    if (i % 4 < 2) {  // through a point of the first, nearly
      const Vec3 shift = 0.5 * (a[0] + a[1]) - (b[0] + 0.3 * (b[1] - b[0]));
      b = {b[0] + shift, b[1] + shift, b[2] + shift};
    }
    comparison.add(a, b);
  }
  comparison.expect_both_answers(0.01);
}

// Every pairing of point, segment and proper triangle, most of them in exact contact or close to it.
TEST(ExactTrianglesOracle, DegeneratePairs) {
  Random random;
  std::array<Comparison, 9> comparisons;
  const auto simplex = [&](int dimension, int n) -> Triangle {
    const Vec3 p = random.grid_point(n), d = random.grid_point(n);
    if (dimension == 0) return {p, p, p};
    if (dimension == 1) return {p, p + random.integer(-2, 2) * d, p + random.integer(-2, 2) * d};
    return random.grid_triangle(n);
  };
  for (int i = 0; i < 45000; ++i) {
    const int kind = i % 9, n = 1 + (i / 9) % 2;
    comparisons[kind].add(simplex(kind / 3, n), simplex(kind % 3, n));
  }
  for (int kind = 0; kind < 9; ++kind) {
    SCOPED_TRACE(kind);
    comparisons[kind].expect_both_answers(0.01);
  }
}

// Segments and points a few ulps from proper triangles: a degenerate facet next to rounded vertices.
TEST(ExactTrianglesOracle, DegenerateNearContact) {
  Random random;
  Comparison comparison;
  for (int i = 0; i < 20000; ++i) {
    const Triangle a = i % 2 ? random.triangle() : random.grid_triangle(2);
    const double s = random.integer(0, 8) / 8.0, t = random.integer(0, 8) / 8.0 * (1 - s);
    Vec3 p = a[0] + s * (a[1] - a[0]) + t * (a[2] - a[0]);
    const int axis = random.integer(0, 2);
    p[axis] = ulps_away(p[axis], random.integer(-1, 1));
    const Vec3 q = i % 3 ? random.grid_point(2) : p;
    comparison.add(a, {p, q, i % 2 ? p : q});
  }
  comparison.expect_both_answers();
}

// The second opinion on the oracle's own arithmetic.
TEST(OracleOracle, RationalsAgreeWithIntegers) {
  Random random;
  for (int i = 0; i < 600; ++i) {
    const Triangle a = i % 2 ? random.triangle() : random.grid_triangle(1);
    const Triangle b = i % 2 ? random.triangle() : random.grid_triangle(1);
    ASSERT_EQ(oracle::triangles_meet(a, b), programming::hulls_meet(a, b)) << "seed " << kSeed << text(a, b);
  }
}

}  // namespace
