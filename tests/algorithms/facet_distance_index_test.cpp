// facet_distance: the tree over the larger set leaves out nothing that the definition reports.
#include <functional>

#include "algorithms/thesis/facet_distance.hpp"
#include "tests/support/facet_scenes.hpp"

namespace algorithms {
namespace {

using namespace facet_scenes;

const Knobs kAll = {{"prefilter", "none"}, {"densify", false}, {"facets_per_area", 1e9}};

Knobs limited(double max_distance, const char* search = "indexed") {
  Knobs knobs = kAll;
  knobs["max_distance"] = max_distance;
  knobs["search"] = search;
  return knobs;
}

double smallest_squared(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Vec3& p : a)
    for (const Vec3& q : b) {
      const double dx = q.x() - p.x(), dy = q.y() - p.y(), dz = q.z() - p.z();
      smallest = std::fmin(smallest, dx * dx + dy * dy + dz * dz);
    }
  return smallest;
}

double smallest_squared(const Scene& scene) {
  return smallest_squared(world_points(scene.bodies.mesh_of(0), scene.poses[0], 1),
                          world_points(scene.bodies.mesh_of(1), scene.poses[1], 1));
}

/// A few roundings below, at and above the root of the smallest squared distance, both orders; how many were hits.
int agrees_near_the_limit(const Scene& scene, double smallest) {
  int hits = 0;
  const Scene turned_round = swapped(scene);
  for (const int steps : {-2, -1, 0, 1, 2}) {
    double limit = std::sqrt(smallest);
    for (int i = 0; i < std::abs(steps); ++i) limit = std::nextafter(limit, steps < 0 ? 0.0 : 1e9);
    const bool expected = smallest < limit * limit;
    EXPECT_EQ(hit("facet_distance", scene, limited(limit)), expected) << steps;
    EXPECT_EQ(hit("facet_distance", turned_round, limited(limit)), expected) << steps << ", swapped";
    hits += expected;
  }
  return hits;
}

/// A flat grid of n by n points, 0.25 apart, in the plane of its local x and z.
Mesh grid(int n) {
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) points.emplace_back(0.25 * (i - n / 2), 0, 0.25 * (k - n / 2));
  return cloud(points);
}

// The nearest point is straight above: the distance to the box, along one axis, is the distance to the point, and only
// the margin keeps the pair from being left out. Far from the origin points are rounded to 1e-10 and 1e-7 metres.
TEST(FacetDistanceIndex, KeepsWhatIsNearByTheLastBitAlongAnAxis) {
  const std::uint64_t seed = 11;
  SCOPED_TRACE(seed);
  Random random(seed);
  const Mesh plate = grid(25);
  int hits = 0, cases = 0;
  for (const double far : {0.0, 1.0, 1e6, 1e9})
    for (int i = 0; i < 20; ++i) {
      SCOPED_TRACE(far);
      SCOPED_TRACE(i);
      const Pose pose = {.q = random.rotation(), .t = random.vector(far)};
      const Vec3 along[] = {{0, random.between(0.1, 0.9), 0}, {random.between(0.1, 0.9), 0, 0}};
      const Vec3 border(0.25 * 12, 0, 0.25 * random.whole(-12, 12));
      const Vec3 above = geometry::to_world(geometry::rotation(pose.q), pose.t, border + along[i % 2]);
      const Scene scene = two(plate, pose, cloud({{0, 0, 0}}), {.q = random.rotation(), .t = above});
      hits += agrees_near_the_limit(scene, smallest_squared(scene));
      cases += 5;
    }
  EXPECT_GT(hits, cases / 5);
  EXPECT_LT(hits, cases - cases / 5);
}

// A plate cut to 10^4 facets, everything turned.
TEST(FacetDistanceIndex, AgreesOnLargePlatesAtTheLastBit) {
  const std::uint64_t seed = 12;
  SCOPED_TRACE(seed);
  Random random(seed);
  const Mesh plate = geometry::densified(geometry::box("plate", {12, 0.5, 12}), 32);
  ASSERT_GT(plate.triangles.size(), 9000u);
  const Mesh sphere = geometry::sphere("sphere", 1, 6);
  int hits = 0;
  for (const double far : {0.0, 1e6, 1e9})
    for (int i = 0; i < 2; ++i) {
      SCOPED_TRACE(far);
      SCOPED_TRACE(i);
      const Pose pose = {.q = random.rotation(), .t = random.vector(far)};
      const Vec3 local(random.between(-7, 7), random.between(0.8, 1.6), random.between(-7, 7));
      const Pose other = {.q = random.rotation(), .t = geometry::to_world(geometry::rotation(pose.q), pose.t, local)};
      const Scene scene = two(plate, pose, sphere, other);
      hits += agrees_near_the_limit(scene, smallest_squared(scene));
    }
  EXPECT_GT(hits, 3);
  EXPECT_LT(hits, 27);
}

// Both sets are large, so that candidates are divided among many parts of the tree.
TEST(FacetDistanceIndex, AgreesOnTwoCrossingAndTwoParallelPlates) {
  const std::uint64_t seed = 13;
  SCOPED_TRACE(seed);
  Random random(seed);
  const Mesh a = grid(45), b = grid(40);
  for (int i = 0; i < 3; ++i) {
    SCOPED_TRACE(i);
    const Pose pose = {.q = random.rotation(), .t = random.vector(1)};
    const Pose crossing = {.q = random.rotation(), .t = random.vector(1)};
    const Pose parallel = {.q = pose.q,
                           .t = geometry::to_world(geometry::rotation(pose.q), pose.t, {0.03, 0.4, 0.07 * i})};
    for (const Pose& other : {crossing, parallel}) {
      const Scene scene = two(a, pose, b, other);
      agrees_near_the_limit(scene, smallest_squared(scene));
    }
  }
}

TEST(FacetDistanceIndex, AgreesOnSetsOfEveryShape) {
  const std::uint64_t seed = 14;
  SCOPED_TRACE(seed);
  Random random(seed);
  const auto made = [](int size, const std::function<Vec3(int)>& point) {
    std::vector<Vec3> points;
    for (int i = 0; i < size; ++i) points.push_back(point(i));
    return cloud(points);
  };
  for (const int size : {1, 16, 17, 33, 300}) {
    const Mesh shapes[] = {made(size, [](int) { return Vec3(0.5, -0.25, 2); }),                // one point
                           made(size, [](int i) { return Vec3(0.125 * i, 0, 0); }),            // a line
                           made(size, [](int i) { return Vec3(0, std::ldexp(1e9, -i), 0); }),  // a huge extent
                           made(size, [&](int i) { return Vec3(random.vector(i % 2 ? 1e-3 : 10)); })};
    for (const Mesh& mesh : shapes) {
      SCOPED_TRACE(size);
      const Pose pose = random.pose(2), other = random.pose(2);
      const Scene scene = two(mesh, pose, random.points(random.whole(1, 40), 1), other);
      agrees_near_the_limit(scene, smallest_squared(scene));
    }
  }
}

// Whatever the pose, the answer is what the arithmetic of the definition says: rotations that are none, positions whose
// differences or squares overflow, infinities.
TEST(FacetDistanceIndex, AgreesOnPosesThatAreOutOfBounds) {
  const std::uint64_t seed = 15;
  SCOPED_TRACE(seed);
  Random random(seed);
  const double infinity = std::numeric_limits<double>::infinity();
  const Mesh a = random.points(40, 1), b = random.points(100, 1);
  int hits = 0;
  for (const double far : {1e20, 1e99, 1e101, 1e160, 1e300, 1.7e308, infinity})
    for (const geometry::Quaternion& q : {geometry::Quaternion{}, random.rotation(), geometry::Quaternion{2, 0, 1, 0},
                                          geometry::Quaternion{0.1, 0.1, 0, 0}, geometry::Quaternion{1e200, 0, 0, 0}})
      for (const bool together : {true, false}) {
        const Pose pose = {.q = q, .t = {far, 0, -far}}, other = together ? pose : at(0, 0, 0);
        for (const bool far_first : {true, false}) {
          const Scene scene = far_first ? two(a, pose, b, other) : two(b, other, a, pose);
          const bool expected = smallest_squared(scene) < 0.0625;
          EXPECT_EQ(hit("facet_distance", scene, limited(0.25)), expected) << far << ' ' << q.w << ' ' << together;
          EXPECT_EQ(hit("facet_distance", scene, limited(0.25, "exhaustive")), expected) << far << ' ' << q.w;
          hits += expected;
        }
      }
  EXPECT_GT(hits, 10);
}

// A rotation scaled by 2: R^T (p - t) is no way back into the mesh's frame.
TEST(FacetDistanceIndex, AgreesOnAScaledRotation) {
  const std::uint64_t seed = 16;
  SCOPED_TRACE(seed);
  Random random(seed);
  const Mesh plate = grid(20);
  int hits = 0;
  for (int i = 0; i < 40; ++i) {
    const geometry::Quaternion q = random.rotation();
    const double scale = random.between(0.5, 1.5);
    const Pose pose = {.q = {scale * q.w, scale * q.x, scale * q.y, scale * q.z}, .t = random.vector(1)};
    const Scene scene = two(plate, pose, random.points(20, 1), random.pose(3));
    const bool expected = smallest_squared(scene) < 0.0625;
    EXPECT_EQ(hit("facet_distance", scene, limited(0.25)), expected) << i;
    hits += expected;
  }
  EXPECT_GT(hits, 4);
  EXPECT_LT(hits, 36);
}

// Squares of 1e-161 are below the normal numbers, so that points somewhat farther than the limit are near by rounding.
TEST(FacetDistanceIndex, AgreesWhereSquaresUnderflow) {
  const std::uint64_t seed = 17;
  SCOPED_TRACE(seed);
  Random random(seed);
  // A corner that no facet has gives the box a surface; without one a single facet would be dense enough.
  const auto tiny = [&random](int most) {
    Mesh mesh = random.points(random.whole(1, most), 1e-161);
    mesh.vertices.emplace_back(1, 1, 1);
    return mesh;
  };
  int hits = 0;
  for (int i = 0; i < 200; ++i) {
    const Mesh a = tiny(20), b = tiny(40);
    const Scene scene = two(a, at(0, 0, 0), b, at(2e-161, 0, 0));
    const double limit = random.between(1e-162, 2e-161);
    const bool expected = smallest_squared(scene) < limit * limit;
    EXPECT_EQ(hit("facet_distance", scene, limited(limit)), expected) << i;
    hits += expected;
  }
  EXPECT_GT(hits, 20);
  EXPECT_LT(hits, 180);
}

// Spheres and blocks heaped on a cut plate, every pair.
TEST(FacetDistanceIndex, AgreesWithTheExhaustiveSearchOnAPile) {
  const std::uint64_t seed = 18;
  SCOPED_TRACE(seed);
  Random random(seed);
  Scene pile;
  pile.add(geometry::box("plate", {9, 1, 9}), at(0, -0.5, 0));
  for (int i = 0; i < 30; ++i) {
    Pose pose = random.pose(3);
    pose.t.y() = random.between(0.9, 3.5);
    if (i % 3)
      pile.add(geometry::sphere("sphere", 1, 8), pose);
    else
      pile.add(geometry::box("block", {1, 0.6, 2}), pose);
  }
  pile.bodies.fixed[0] = 1;
  for (const char* prefilter : {"none", "rotated_aabb"})
    for (const double limit : {0.1, 0.25}) {
      const Knobs knobs = {{"prefilter", prefilter}, {"max_distance", limit}};
      Knobs exhaustive = knobs;
      exhaustive["search"] = "exhaustive";
      const Told all = ask("facet_distance", pile, exhaustive), told = ask("facet_distance", pile, knobs);
      EXPECT_EQ(told.hits, all.hits) << prefilter << ' ' << limit;
      EXPECT_GT(told.hits.size(), 10u);
      EXPECT_LT(told.hits.size(), 31u * 30 / 2 - 50);
      EXPECT_LT(told.operations, all.operations / 5);
    }
}

// Of the plate's 10^4 points those under the sphere are compared, not all.
TEST(FacetDistanceIndex, LooksOnlyAtThePlateUnderTheSphere) {
  const Scene scene =
      two(geometry::box("plate", {24, 1, 24}), at(0, -0.5, 0), geometry::sphere("sphere", 1, 16), at(5, 1.3, -4));
  ASSERT_FALSE(hit("facet_distance", scene, {{"prefilter", "none"}}));
  EXPECT_LT(ask("facet_distance", scene, {{"prefilter", "none"}}).operations, 500u);
  const Scene nearer =
      two(geometry::box("plate", {24, 1, 24}), at(0, -0.5, 0), geometry::sphere("sphere", 1, 16), at(5, 1.24, -4));
  EXPECT_LT(ask("facet_distance", nearer, {{"prefilter", "none"}}).operations, 3000u);
}

}  // namespace
}  // namespace algorithms
