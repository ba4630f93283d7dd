#include "algorithms/thesis/obb_triangles.hpp"

#include <gtest/gtest.h>

#include <array>

#include "algorithms/parts/eleven_axes.hpp"
#include "algorithms/parts/turned_box.hpp"
#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using namespace setting;
using geometry::edged;
using geometry::meet_by_eleven_axes;

const Changed kAlone = {{"prefilter", std::string("none")}};
const Changed kBehindBoxes = {{"prefilter", std::string("aabb")}};
const Mesh kCube = geometry::box("cube", {2, 2, 2});
const Mesh kSlab = geometry::box("slab", {6, 0.5, 4});

bool met(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b, const Changed& changed = {}) {
  return hit("obb_triangles", a, at_a, b, at_b, changed);
}

/// The triangle test written out as published, one array of projections per axis.
bool eleven_axes(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  const auto dot = [](const Vec3& p, const Vec3& q) { return (p[0] * q[0] + p[1] * q[1]) + p[2] * q[2]; };
  const auto cross = [](const Vec3& p, const Vec3& q) {
    return Vec3(p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]);
  };
  const Vec3 e[3] = {a[1] - a[0], a[2] - a[0], (a[2] - a[0]) - (a[1] - a[0])};
  const Vec3 f[3] = {b[1] - b[0], b[2] - b[0], (b[2] - b[0]) - (b[1] - b[0])};
  const Vec3 n = cross(e[0], e[1]), m = cross(f[0], f[1]), d = b[0] - a[0];
  // le, lf: the products with E0, E1 and F0, F1.
  const auto apart = [&](const std::array<double, 2>& le, double ld, const std::array<double, 2>& lf) {
    const std::array<double, 3> p{0, le[0], le[1]}, q{ld, ld + lf[0], ld + lf[1]};
    return *std::max_element(p.begin(), p.end()) < *std::min_element(q.begin(), q.end()) ||
           *std::max_element(q.begin(), q.end()) < *std::min_element(p.begin(), p.end());
  };
  if (apart({0, 0}, dot(n, d), {dot(n, f[0]), dot(n, f[1])})) return false;
  if (apart({dot(m, e[0]), dot(m, e[1])}, dot(m, d), {0, 0})) return false;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Vec3 l = cross(e[i], f[j]);
      std::array<double, 2> le{dot(l, e[0]), dot(l, e[1])}, lf{dot(l, f[0]), dot(l, f[1])};
      if (i < 2) le[i] = 0;
      if (j < 2) lf[j] = 0;
      if (apart(le, dot(l, d), lf)) return false;
    }
  return true;
}

/// All 144 pairs, without a prefilter.
bool definition(const Mesh& a, const Pose& at_a, const Mesh& b, const Pose& at_b) {
  const auto triangles = [](const Mesh& mesh, const Pose& pose) {
    const auto corners =
        geometry::turned_corners(geometry::half_extents(mesh), geometry::turn_xyz(geometry::euler_angles(pose.q)));
    std::vector<std::array<Vec3, 3>> out;
    for (const auto& [i, j, k] : geometry::kBoxTriangles)
      out.push_back({pose.t + corners[i], pose.t + corners[j], pose.t + corners[k]});
    return out;
  };
  for (const auto& one : triangles(a, at_a))
    for (const auto& other : triangles(b, at_b))
      if (eleven_axes(one, other)) return true;
  return false;
}

TEST(BoxTriangles, CoverTheSixFacesAndFaceOutwards) {
  const auto corners = geometry::turned_corners({1, 2, 3}, geometry::turn_xyz({}));
  double area = 0;
  for (std::size_t k = 0; k < 12; ++k) {
    const auto& [i, j, l] = geometry::kBoxTriangles[k];
    const auto triangle = edged(corners[i], corners[j], corners[l]);
    area += 0.5 * triangle.normal.norm();
    EXPECT_GT(triangle.normal.dot(corners[i] + corners[j] + corners[l]), 0) << "triangle " << k;
  }
  EXPECT_DOUBLE_EQ(area, 2 * (2 * 4 + 4 * 6 + 6 * 2));
}

TEST(ElevenAxes, TouchingIsYes) {
  const auto flat = edged({0, 0, 0}, {2, 0, 0}, {0, 2, 0});
  EXPECT_TRUE(meet_by_eleven_axes(flat, edged({0.5, 0.5, 0}, {0.5, 0.5, 1}, {1, 0.5, 1}))) << "a corner on the face";
  EXPECT_FALSE(meet_by_eleven_axes(flat, edged({0.5, 0.5, 0x1p-50}, {0.5, 0.5, 1}, {1, 0.5, 1})));
  EXPECT_TRUE(meet_by_eleven_axes(flat, edged({1, -1, -1}, {1, -1, 1}, {1, 0, 0}))) << "a corner on an edge";
  EXPECT_FALSE(meet_by_eleven_axes(flat, edged({1, -1, -1}, {1, -1, 1}, {1, -0x1p-50, 0})));
}

TEST(ElevenAxes, SeesACrossing) {
  EXPECT_TRUE(
      meet_by_eleven_axes(edged({0, 0, 0}, {2, 0, 0}, {0, 2, 0}), edged({0.5, 0.5, -1}, {0.5, 0.5, 1}, {9, 9, 0})));
}

TEST(ElevenAxes, CoplanarTrianglesAreYesHoweverFarApart) {
  const auto here = edged({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), there = edged({100, 0, 0}, {101, 0, 0}, {100, 1, 0});
  EXPECT_TRUE(meet_by_eleven_axes(here, there));
}

TEST(ElevenAxes, ATriangleWithoutAreaIsJudgedByTheOtherAxes) {
  const auto face = edged({0, 0, 0}, {2, 0, 0}, {0, 2, 0});
  EXPECT_TRUE(meet_by_eleven_axes(face, edged({0.5, 0.5, -1}, {0.5, 0.5, 1}, {0.5, 0.5, 0})));
  EXPECT_FALSE(meet_by_eleven_axes(face, edged({0.5, 0.5, 2}, {0.5, 0.5, 1}, {0.5, 0.5, 3}))) << "above the face";
  EXPECT_FALSE(meet_by_eleven_axes(face, edged({5, 5, -1}, {5, 5, 1}, {5, 5, 0}))) << "beside the face";
}

TEST(ObbTriangles, IsExactOnTheUnturnedSlab) {
  const Vec3 sum = geometry::half_extents(kCube) + geometry::half_extents(kSlab);
  for (int axis = 0; axis < 3; ++axis)
    for (const double gap : {-1e-6, 1e-6}) {
      Vec3 at(0.1, 0.2, 0.3);
      at[axis] = sum[axis] + gap;
      EXPECT_EQ(met(kCube, {}, kSlab, {{}, at}), gap < 0) << "axis " << axis << ", gap " << gap;
      EXPECT_EQ(truly_meet(kCube, {}, kSlab, {{}, at}), gap < 0);
    }
}

TEST(ObbTriangles, SeesARodThroughASlabWithoutACornerInside) {
  EXPECT_TRUE(met(geometry::box("rod", {0.5, 10, 0.5}), {}, kSlab, {}));
}

TEST(ObbTriangles, IsEarlyOnSpheres) {
  const Mesh sphere = geometry::sphere("sphere", 1, 16);
  const Pose beside{{}, {1.9, 1.8, 1.7}};
  EXPECT_TRUE(met(sphere, {}, sphere, beside));
  EXPECT_FALSE(truly_meet(sphere, {}, sphere, beside));
}

TEST(ObbTriangles, MissesABodyInsideAnother) {
  const Mesh big = geometry::box("big", {10, 10, 10});
  for (const Changed& changed : {Changed{}, kAlone}) {
    EXPECT_FALSE(met(big, {}, kCube, {{}, {1, 2, 3}}, changed));
    EXPECT_FALSE(met(kCube, {turn_deg({0, 0, 1}, 30), {1, 2, 3}}, big, {}, changed));
  }
  // A sphere that crosses the big one's facets, but whose box is inside the other's box.
  const Mesh ball = geometry::sphere("ball", 5, 16), small = geometry::sphere("small", 1, 16);
  const Pose in_corner{{}, {3, 3, 1}};
  EXPECT_TRUE(truly_meet(ball, {}, small, in_corner));
  EXPECT_FALSE(met(ball, {}, small, in_corner));
}

TEST(ObbTriangles, CoplanarFacesAreYesHoweverFarApart) {
  EXPECT_TRUE(met(kCube, {}, kCube, {{}, {10, 0, 0.25}}, kAlone)) << "the faces above y";
  EXPECT_FALSE(met(kCube, {}, kCube, {{}, {10, 0.5, 0.25}}, kAlone)) << "no two faces in a plane";
  EXPECT_FALSE(met(kCube, {}, kCube, {{}, {10, 0, 0.25}})) << "the prefilter hides it";
}

TEST(ObbTriangles, HandlesRingsTurnedAboutOneAxisButNotTheEmptyMiddle) {
  const Mesh around = ring(3, 0.5), ball = geometry::sphere("ball", 1, 8);
  for (const double degrees : {0.0, 25.0, 70.0}) {
    const Pose turned{turn_deg({1, 0, 0}, degrees), {0, 0, 0}};
    // Above the ring's rim, just inside and just outside.
    const geometry::Mat3 r = geometry::rotation(turned.q);
    for (const double gap : {-0.05, 0.1}) {
      const Pose above{turned.q, r * Vec3(3, 0.5 + 1 + gap, 0)};
      EXPECT_EQ(met(around, turned, ball, above, kBehindBoxes), gap < 0) << degrees << " degrees, gap " << gap;
    }
    const Pose in_the_middle{turned.q, r * Vec3(0, 0.3, 0)};
    EXPECT_TRUE(met(around, turned, ball, in_the_middle, kBehindBoxes)) << "the box has no hole";
    EXPECT_FALSE(truly_meet(around, turned, ball, in_the_middle));
  }
}

TEST(ObbTriangles, IsRightForSlabsTurnedAboutOneAxisAndLateOrBlindForTwo) {
  std::mt19937 random(81);
  SCOPED_TRACE("seed 81");
  int meeting = 0, missed_for_two = 0;
  for (int round = 0; round < 300; ++round) {
    const Vec3 axis = Vec3::Unit(round % 3), next = Vec3::Unit((round + 1) % 3);
    const double most = round % 3 == 0 ? 90 : 180;  // beyond 90 degrees a turn about x has three angles
    const double first = most * uniform(random), second = most * uniform(random);
    const Vec3 at = uniform_point(random, 3);
    const Pose one{turn_deg(axis, first), {0, 0, 0}}, other{turn_deg(axis, second), at};
    ASSERT_EQ(met(kSlab, one, kSlab, other, kBehindBoxes), truly_meet(kSlab, one, kSlab, other)) << "round " << round;
    const Pose two{turn_deg(axis, first) * turn_deg(next, second), {0, 0, 0}}, still{{}, at};
    const bool truly = truly_meet(kSlab, two, kSlab, still);
    meeting += truly;
    missed_for_two += truly && !met(kSlab, two, kSlab, still, kBehindBoxes);
  }
  EXPECT_GT(meeting, 50);
  EXPECT_GT(missed_for_two, 10);
}

TEST(ObbTriangles, MissesWhatItsPrefilterMisses) {
  const Quaternion q = turn_deg({0, 0, 1}, 45);
  EXPECT_FALSE(met(kCube, {q, {0, 0, 0}}, kCube, {q, {0.1, 0.5, 0.2}}));
  EXPECT_TRUE(met(kCube, {q, {0, 0, 0}}, kCube, {q, {0.1, 0.5, 0.2}}, kAlone));
}

TEST(ObbTriangles, AnswersAsDefined) {
  std::size_t reported = 0;
  for (std::uint32_t seed = 82; seed <= 85; ++seed) {
    std::mt19937 random(seed);
    const Setting setting = crowd(random, 40, 4);
    const std::vector<Pair> expected = by_definition(setting, definition);
    reported += expected.size();
    EXPECT_EQ(hits("obb_triangles", setting, kAlone), expected) << "seed " << seed;
  }
  EXPECT_GT(reported, 200u);
}

// Coplanar faces are decided by rounding: steps of a quarter metre and turns of 45 degrees, near and far from the
// origin.
TEST(ObbTriangles, AnswersAsDefinedWhereRoundingDecides) {
  std::mt19937 random(86);
  SCOPED_TRACE("seed 86");
  const std::vector<Mesh> meshes = {kCube, kSlab, geometry::box("flat", {2, 0, 2}), geometry::box("rod", {1, 4, 1})};
  for (const double far : {0.0, 1000.0, 1e7}) {
    std::size_t reported = 0, pairs = 0;
    for (int round = 0; round < 10; ++round) {
      Setting setting;
      for (int i = 0; i < 16; ++i) {
        const Vec3 p = uniform_point(random, 12);
        const Vec3 at = far * Vec3(1, -1, 1) + 0.25 * Vec3(std::round(p.x()), std::round(p.y()), std::round(p.z()));
        const Quaternion q = turn_deg(Vec3::Unit(random() % 3), 45.0 * (random() % 8));
        setting.add(meshes[i % meshes.size()], {i % 3 ? q : q * turn_deg(Vec3::Unit(random() % 3), 45), at});
      }
      const std::vector<Pair> expected = by_definition(setting, definition);
      reported += expected.size();
      pairs += geometry::pair_count(setting.runs());
      EXPECT_EQ(hits("obb_triangles", setting, kAlone), expected) << "round " << round << ", far " << far;
    }
    EXPECT_GT(reported, pairs / 8);
    EXPECT_LT(reported, pairs);
  }
}

TEST(ObbTriangles, CountsPlanesThePairsOfTrianglesTheyLeaveAndThePrefilter) {
  const auto operations = [&](const Vec3& at, const Changed& changed) {
    const Setting setting = Setting().add(kCube, {}).add(kCube, {{}, at});
    const auto method = make("obb_triangles", setting.bodies, changed);
    std::vector<Pair> found;
    method->prepare(setting.poses);
    return method->count(setting.runs(), found);
  };
  EXPECT_EQ(operations({10, 10, 10}, kAlone), 12u) << "each plane has all of the other cube on one side";
  // All planes have all of the other cube on one side but y = 1 and z = 1 of the first, y = -0.5 and
  // z = -0.75 of the second. Parallel faces are parted by either plane. Left are y = 1 with z = -0.75, and z = 1 with
  // y = -0.5, of two triangles each; none of them meet, being 8 m apart.
  EXPECT_EQ(operations({10, 0.5, 0.25}, kAlone), 12u + 4 + 4);
  EXPECT_EQ(operations({0, 0, 0}, kAlone), 12u + 1) << "the first triangles are the same";
  EXPECT_EQ(operations({9, 0, 0}, {}), 1u) << "one axis of the prefilter";
  EXPECT_EQ(operations({0, 0, 0}, {}), 3u + 12 + 1) << "three axes of the prefilter";
}

}  // namespace
}  // namespace algorithms
