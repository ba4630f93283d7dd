// The decision of a step against brute force over all pairs of triangles (tests/support/oracle.hpp).
#include "geometry/decision/meet.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "geometry/meshes/shapes.hpp"
#include "geometry/portable_math.hpp"
#include "tests/support/adversary.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/random.hpp"

namespace {

using namespace geometry;
using tests::kSeed;
using tests::Random;

Mesh tetrahedron() {
  Mesh mesh;
  mesh.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

/// Facets anywhere in a cube of edge 2; every third is a segment or a point.
Mesh soup(std::uint32_t facets) {
  Random random;
  Mesh mesh;
  for (std::uint32_t i = 0; i < 2 * facets; ++i) mesh.vertices.push_back(random.point());
  for (std::uint32_t i = 0; i < facets; ++i) {
    const std::uint32_t p = random.below(2 * facets), q = random.below(2 * facets), r = random.below(2 * facets);
    mesh.triangles.push_back({p, i % 6 == 3 ? p : q, i % 3 ? r : p});
  }
  return mesh;
}

/// A closed surface that is not convex: two boxes' facets in one mesh, apart.
Mesh two_boxes() {
  Mesh mesh = box("two", Vec3(1, 0.2, 0.2));
  const Mesh one = mesh;
  const auto n = static_cast<std::uint32_t>(one.vertices.size());
  for (const Vec3& v : one.vertices) mesh.vertices.push_back(v + Vec3(0, 1, 0));
  for (const Facet& f : one.triangles) mesh.triangles.push_back({f[0] + n, f[1] + n, f[2] + n});
  return mesh;
}

/// A torus of radii 1 and 0.25: n x n vertices.
Mesh ring(std::uint32_t n) {
  Mesh mesh;
  const auto vertex = [n](std::uint32_t i, std::uint32_t j) { return i % n * n + j % n; };
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const double f = 2 * std::numbers::pi * i / n, g = 2 * std::numbers::pi * j / n;
      const double out = 1 + 0.25 * portable::cos(g);
      mesh.vertices.emplace_back(out * portable::cos(f), 0.25 * portable::sin(g), out * portable::sin(f));
      mesh.triangles.push_back({vertex(i, j), vertex(i, j + 1), vertex(i + 1, j)});
      mesh.triangles.push_back({vertex(i + 1, j), vertex(i, j + 1), vertex(i + 1, j + 1)});
    }
  return mesh;
}

Mesh scaled(Mesh mesh, double by) {
  for (Vec3& v : mesh.vertices) v *= by;
  return mesh;
}

/// 4 to 60 facets each.
std::vector<Mesh> small_meshes() {
  return {tetrahedron(), box("cube", Vec3(1, 1, 1)), sphere("ball", 1, 2), soup(30), two_boxes()};
}

struct Scene {
  Bodies bodies;
  std::vector<Pose> poses;
  std::vector<Bvh> bvhs;

  explicit Scene(std::vector<Mesh> meshes) {
    bodies.meshes = std::move(meshes);
    bvhs = build_bvhs(bodies);
  }
  Scene& add(std::uint32_t mesh, const Pose& pose, bool fixed = false) {
    bodies.add(std::to_string(bodies.size()), mesh, fixed);
    poses.push_back(pose);
    return *this;
  }
  std::vector<PairRun> runs() const { return pair_runs(bodies, poses); }
  std::vector<Pair> hits() const { return Decision(bodies, bvhs).hits(poses, runs()); }
  bool meet() const { return Decision(bodies, bvhs).meet(poses, {0, 1}); }
};

/// Counts both answers, so that a comparison in which nothing meets is not mistaken for agreement.
struct Tally {
  std::size_t meeting = 0, apart = 0;
  void add(bool meet) { ++(meet ? meeting : apart); }
  ~Tally() {
    EXPECT_GE(meeting, (meeting + apart) / 50);
    EXPECT_GE(apart, (meeting + apart) / 50);
  }
};

/// Every pair alone and all at once, against the oracle.
void expect_truth(const Scene& scene, Tally& tally) {
  const auto runs = scene.runs();
  const auto expected = oracle::hits(scene.bodies, scene.poses, runs);
  Decision decision(scene.bodies, scene.bvhs);
  ASSERT_EQ(decision.hits(scene.poses, runs), expected) << "seed " << kSeed;
  for (const PairRun& run : runs)
    for (std::uint32_t b = run.first; b < run.last; ++b) {
      const bool meets = std::ranges::binary_search(expected, Pair{run.a, b});
      tally.add(meets);
      ASSERT_EQ(decision.meet(scene.poses, {run.a, b}), meets) << "seed " << kSeed << ", " << run.a << " and " << b;
    }
}

bool boxes_meet(const Vec3& offset, const Quaternion& turn = {}) {
  return Scene({box("cube", Vec3(1, 1, 1))}).add(0, {}).add(0, {turn, offset}).meet();
}

TEST(Decision, BoxesFaceToFaceMeetUntilOneUlpApart) {
  for (const Quaternion turn : {Quaternion{}, Quaternion{0, 1, 0, 0}, Quaternion{0, 0, 0, -1}}) {
    EXPECT_TRUE(boxes_meet({1, 0, 0}, turn));
    EXPECT_TRUE(boxes_meet({0, -1, 0.25}, turn));
    EXPECT_FALSE(boxes_meet({0, 0, std::nextafter(1, 2)}, turn));
  }
}

TEST(Decision, BoxesMeetInAnEdgeAndInACorner) {
  EXPECT_TRUE(boxes_meet({1, 1, 0}));
  EXPECT_TRUE(boxes_meet({-1, 0, 1}));
  EXPECT_TRUE(boxes_meet({1, 1, 1}));
  EXPECT_TRUE(boxes_meet({1, -1, 1}));
  EXPECT_FALSE(boxes_meet({1, 1, 1 + 0x1p-52}));
  EXPECT_FALSE(boxes_meet({1 + 0x1p-52, -1, 1}));
}

TEST(Decision, IdenticalBodiesMeet) { EXPECT_TRUE(boxes_meet({0, 0, 0})); }

TEST(Decision, ABodyWhollyInsideAnotherDoesNotMeetIt) {
  Scene scene({sphere("outer", 2, 8), sphere("inner", 1, 8), box("cube", Vec3(1, 1, 1))});
  scene.add(0, {}).add(1, {}).add(2, {{0.5, 0.5, 0.5, 0.5}, Vec3(0.1, 0, 0)});
  EXPECT_EQ(scene.hits(), std::vector<Pair>{});
  scene.poses[1].t = Vec3(1.5, 0, 0);  // now through the outer surface, over the cube's
  EXPECT_EQ(scene.hits(), (std::vector<Pair>{{0, 1}, {1, 2}}));
}

TEST(Decision, AnswersOneTriangleAgainstOne) {
  Mesh one;
  one.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  one.triangles = {{0, 1, 2}};
  EXPECT_TRUE(Scene({one}).add(0, {}).add(0, {{}, Vec3(0.5, 0.5, 0)}).meet());  // in the middle of an edge
  EXPECT_FALSE(Scene({one}).add(0, {}).add(0, {{}, Vec3(0.5, 0.5, 0x1p-1074)}).meet());
}

TEST(Decision, AnswersAboutNoPairsAtAll) {
  EXPECT_EQ(Scene({tetrahedron()}).hits(), std::vector<Pair>{});
  EXPECT_EQ(Scene({tetrahedron()}).add(0, {}).hits(), std::vector<Pair>{});
  EXPECT_EQ(Scene({tetrahedron()}).add(0, {}, true).add(0, {}, true).hits(), std::vector<Pair>{});
}

TEST(Decision, ReportsOnlyThePairsAsked) {
  Scene scene({tetrahedron()});
  for (int i = 0; i < 6; ++i) scene.add(0, {});
  Decision decision(scene.bodies, scene.bvhs);
  const std::vector<PairRun> runs{{0, 2, 3}, {0, 4, 6}, {2, 3, 4}, {4, 5, 6}};
  EXPECT_EQ(decision.hits(scene.poses, runs), (std::vector<Pair>{{0, 2}, {0, 4}, {0, 5}, {2, 3}, {4, 5}}));
}

TEST(Decision, LeavesUnbornBodiesAlone) {
  Scene scene({tetrahedron()});
  for (int i = 0; i < 5; ++i) scene.add(0, i % 2 ? unborn() : Pose{});
  EXPECT_EQ(scene.hits(), (std::vector<Pair>{{0, 2}, {0, 4}, {2, 4}}));
}

TEST(Decision, FollowsAFixedBodyThatIsMovedAfterAll) {
  Scene scene({box("cube", Vec3(1, 1, 1))});
  scene.add(0, {}, true).add(0, {{}, Vec3(5, 0, 0)});
  Decision decision(scene.bodies, scene.bvhs);
  EXPECT_TRUE(decision.hits(scene.poses, scene.runs()).empty());
  scene.poses[0].t = Vec3(4.5, 0, 0);
  EXPECT_EQ(decision.hits(scene.poses, scene.runs()).size(), 1u);
  EXPECT_TRUE(decision.meet(scene.poses, {0, 1}));
  scene.poses[0].t = Vec3(0, 0, 0);
  EXPECT_FALSE(decision.meet(scene.poses, {0, 1}));
}

TEST(Decision, FindsOneBodyAmongHundredsUnderAHugePlate) {
  Scene scene({box("plate", Vec3(1e4, 1, 1e4)), sphere("ball", 1, 4)});
  scene.add(0, {{}, Vec3(0, -0.5, 0)}, true);
  std::vector<Pair> expected;
  for (std::uint32_t i = 1; i <= 400; ++i) {
    scene.add(1, {{}, Vec3(3 * (i % 20), i % 50 ? 1.5 : 1, 3 * (i / 20))});  // the mesh's poles are at y = +-1 exactly
    if (i % 50 == 0) expected.push_back({0, i});
  }
  EXPECT_EQ(scene.hits(), expected);
}

TEST(Decision, DoesNotDependOnWhatWasAskedBefore) {
  Random random;
  Scene scene(small_meshes());
  for (std::uint32_t i = 0; i < 30; ++i) scene.add(i % 5, {random.turn(), 2 * random.point()}, i % 7 == 0);
  const auto runs = scene.runs();
  const std::vector<Pose> here = scene.poses;
  std::vector<Pose> there = here;
  for (Pose& pose : there) pose = {random.turn(), 2 * random.point()};

  const auto expected_here = Decision(scene.bodies, scene.bvhs).hits(here, runs);
  const auto expected_there = Decision(scene.bodies, scene.bvhs).hits(there, runs);
  ASSERT_NE(expected_here, expected_there);
  Decision decision(scene.bodies, scene.bvhs);
  std::vector<Pair> pairs;
  for (const PairRun& run : runs)
    for (std::uint32_t b = run.first; b < run.last; ++b) pairs.push_back({run.a, b});
  for (int round = 0; round < 5; ++round) {
    std::ranges::shuffle(pairs, random.bits);
    for (const Pair& pair : pairs) {
      const bool now_here = random.below(2);
      const auto& expected = now_here ? expected_here : expected_there;
      ASSERT_EQ(decision.meet(now_here ? here : there, pair), std::ranges::binary_search(expected, pair)) << kSeed;
    }
    EXPECT_EQ(decision.hits(there, runs), expected_there);
    EXPECT_EQ(decision.hits(here, runs), expected_here);
  }
}

std::vector<Pair> hits_now(Decision& decision, const Scene& scene, const std::vector<Pose>& poses) {
  std::vector<Pair> out;
  decision.prepare(poses);
  decision.hits(scene.runs(), out);
  return out;
}

// In time, backwards, shuffled, after quite another place, and with the memory emptied now and then.
TEST(Decision, NeverDependsOnItsMemory) {
  Random random;
  Scene scene({sphere("ball", 1, 4), ring(8), two_boxes(), soup(30)});
  for (std::uint32_t i = 0; i < 40; ++i) scene.add(i % 4, {random.turn(), 3 * random.point()});
  std::vector<std::vector<Pose>> steps{scene.poses};
  while (steps.size() < 30) {
    steps.push_back(steps.back());
    for (Pose& pose : steps.back()) {
      pose.q = normalised(pose.q * normalised({30, random.real(), random.real(), random.real()}));
      pose.t += 0.05 * random.point();
    }
  }
  std::vector<std::vector<Pair>> expected;
  for (const auto& poses : steps) {
    Decision fresh(scene.bodies, scene.bvhs);
    expected.push_back(hits_now(fresh, scene, poses));
  }
  ASSERT_NE(expected.front(), expected.back());

  std::vector<std::size_t> order(steps.size());
  std::iota(order.begin(), order.end(), 0u);
  Decision decision(scene.bodies, scene.bvhs);
  for (int round = 0; round < 5; ++round) {
    if (round == 1) std::ranges::reverse(order);
    if (round > 1) std::ranges::shuffle(order, random.bits);
    for (const std::size_t step : order) {
      if (round == 4 && random.below(3) == 0) decision.forget();
      ASSERT_EQ(hits_now(decision, scene, steps[step]), expected[step]) << "round " << round << ", step " << step;
      if (round != 3 || random.below(2)) decision.remember();
    }
  }
}

// Without remember() the memory stays what it was: this is what makes repeated timings fair.
TEST(Decision, AskedTwiceDoesTheSameWorkAndRememberingSavesSome) {
  Random random;
  Scene scene({sphere("ball", 1, 6)});
  for (std::uint32_t i = 0; i < 27; ++i) scene.add(0, {random.turn(), 1.95 * Vec3(i % 3, i / 3 % 3, i / 9)});
  Decision decision(scene.bodies, scene.bvhs);
  const auto first = hits_now(decision, scene, scene.poses);
  const auto cold = decision.operations();
  EXPECT_EQ(hits_now(decision, scene, scene.poses), first);
  EXPECT_EQ(decision.operations(), cold);
  decision.remember();
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(hits_now(decision, scene, scene.poses), first);
    EXPECT_LT(decision.operations(), cold / 2);
  }
  decision.forget();
  EXPECT_EQ(hits_now(decision, scene, scene.poses), first);
  EXPECT_EQ(decision.operations(), cold);
}

TEST(Decision, AppendsToWhatIsThere) {
  Scene scene({tetrahedron()});
  scene.add(0, {}).add(0, {});
  Decision decision(scene.bodies, scene.bvhs);
  std::vector<Pair> out{{7, 8}};
  decision.prepare(scene.poses);
  decision.hits(scene.runs(), out);
  EXPECT_EQ(out, (std::vector<Pair>{{7, 8}, {0, 1}}));
}

// Numbering the bodies the other way round swaps a and b in every pair.
TEST(Decision, IsSymmetric) {
  Random random;
  Scene scene(small_meshes()), reversed(small_meshes());
  const std::uint32_t n = 40;
  for (std::uint32_t i = 0; i < n; ++i) scene.add(i % 5, {random.turn(), 2 * random.point()});
  for (std::uint32_t i = n; i-- > 0;) reversed.add(i % 5, scene.poses[i]);
  std::vector<Pair> expected;
  for (const Pair& pair : scene.hits()) expected.push_back({n - 1 - pair.b, n - 1 - pair.a});
  std::ranges::sort(expected);
  EXPECT_EQ(reversed.hits(), expected);
}

TEST(DecisionOracle, ManyBodiesAtRandom) {
  Random random;
  Tally tally;
  for (int i = 0; i < 40; ++i) {
    Scene scene(small_meshes());
    for (std::uint32_t k = 0; k < 30; ++k) {
      const Vec3 stretch(1 + 3 * (i % 3 == 0), 1 + 3 * (i % 3 == 1), 1 + 3 * (i % 3 == 2));  // sweeps along each axis
      scene.add(k % 5, {random.turn(), 1.3 * random.point().cwiseProduct(stretch)}, k % 11 == 0);
      scene.bodies.chosen.push_back(i % 4 || k % 3 == 0);
    }
    expect_truth(scene, tally);
  }
}

// Unturned on a lattice: faces, edges and corners in exact contact, coplanar facets, equal vertices.
TEST(DecisionOracle, BodiesOnALattice) {
  Random random;
  Tally tally;
  for (int i = 0; i < 25; ++i) {
    Scene scene({tetrahedron(), box("cube", Vec3(1, 1, 1)), box("bar", Vec3(2, 0.5, 0.5)), two_boxes()});
    for (std::uint32_t k = 0; k < 24; ++k) {
      const Quaternion turns[] = {{}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}, {0.5, 0.5, 0.5, 0.5}};
      const Vec3 cell(random.below(9), random.below(9), random.below(9));
      scene.add(random.below(4), {turns[random.below(5)], 0.5 * cell});
    }
    expect_truth(scene, tally);
  }
}

// The last pose before contact and the first in contact along x, and three ulps to either side.
TEST(DecisionOracle, GrazingWithinUlps) {
  Random random;
  Tally tally;
  for (int i = 0; i < 500; ++i) {
    Scene scene(small_meshes());
    const double far = i % 4 == 3 ? 1e9 : i % 4 == 2 ? 1e3 : 0;
    const Vec3 offset = far * random.point();
    scene.add(random.below(5), {random.turn(), offset});
    scene.add(random.below(5), {random.turn(), offset + 0.3 * random.point()});
    Decision decision(scene.bodies, scene.bvhs);
    double& x = scene.poses[1].t.x();
    double meets = x, apart = x + 5;
    if (!decision.meet(scene.poses, {0, 1})) continue;
    while (true) {
      x = meets + 0.5 * (apart - meets);
      if (x == meets || x == apart) break;
      (decision.meet(scene.poses, {0, 1}) ? meets : apart) = x;
    }
    x = meets;
    for (int k = 0; k < 3; ++k) x = std::nextafter(x, -DBL_MAX);
    for (int k = -3; k <= 3; ++k, x = std::nextafter(x, DBL_MAX)) expect_truth(scene, tally);
  }
  EXPECT_GT(tally.meeting + tally.apart, 1500u);
}

// Meshes of every size, slivers and points, turned by quaternions as far from unit as may be, up to 1e12 sizes away; at
// random and bisected to the last pose in contact.
TEST(DecisionOracle, AdversarialMeshesAtAdversarialPoses) {
  Random random;
  Tally tally;
  for (int i = 0; i < 700; ++i) {
    const Mesh mesh = adversary::mesh(random);
    Mesh other = adversary::mesh(random);
    const double size = enclosure(mesh).radius, ratio = size / enclosure(other).radius;
    if (ratio > 1e-250 && ratio < 1e250 && random.below(4)) other = scaled(other, ratio);
    Scene scene({mesh, other});
    const Pose pose = adversary::pose(random, size);
    scene.add(0, pose).add(1, {adversary::quaternion(random), pose.t});
    // One vertex of each in one place, nearly; then along x until they part.
    const Vec3 from = oracle::world_vertex(scene.poses[0], mesh.vertices[random.below(18)]);
    const Vec3 to = oracle::world_vertex(scene.poses[1], other.vertices[random.below(18)]);
    scene.poses[1].t += from - to;
    if (!scene.poses[1].t.allFinite()) continue;
    Decision decision(scene.bodies, scene.bvhs);
    double& x = scene.poses[1].t.x();
    const double start = x;
    double meets = x, apart = x + 8 * size;
    if (!decision.meet(scene.poses, {0, 1}) || apart == meets) {
      expect_truth(scene, tally);
      continue;
    }
    while (true) {
      x = meets + 0.5 * (apart - meets);
      if (x == meets || x == apart) break;
      (decision.meet(scene.poses, {0, 1}) ? meets : apart) = x;
    }
    for (const double at : {start, std::nextafter(meets, -DBL_MAX), meets, std::nextafter(meets, DBL_MAX)}) {
      x = at;
      expect_truth(scene, tally);
    }
  }
  EXPECT_GT(tally.meeting + tally.apart, 1000u);
}

// Equal turned boxes one behind the other: the line of centres is the normal of the faces in contact, so that the slab
// between the bodies has the thickness of its own rounding error. Without its error bound it separates what touches.
TEST(DecisionOracle, FlushFacesOfTurnedBoxes) {
  Random random;
  Tally tally;
  for (int i = 0; i < 400; ++i) {
    const double scale = i % 4 == 3 ? 1e-320 : 1, far = i % 4 == 2 ? 1e6 : i % 4 == 1 ? 10 : 0;
    Scene scene({box("box", scale * Vec3(1, 1, 1)), box("slab", scale * Vec3(1, 3, 3))});
    const Quaternion turn = random.turn();
    const Vec3 offset = scale * far * random.point(), axis = rotation(turn).col(0);
    scene.add(0, {turn, offset}).add(i % 2, {turn, offset});
    Decision decision(scene.bodies, scene.bvhs);
    const auto place = [&](double distance) { scene.poses[1].t = offset + distance * axis; };
    double meets = 0.9 * scale, apart = 1.1 * scale;
    while (true) {
      const double middle = meets + 0.5 * (apart - meets);
      if (middle == meets || middle == apart) break;
      place(middle);
      (decision.meet(scene.poses, {0, 1}) ? meets : apart) = middle;
    }
    for (int k = 0; k < 4; ++k) meets = std::nextafter(meets, -DBL_MAX);
    for (int k = 0; k < 9; ++k, meets = std::nextafter(meets, DBL_MAX)) {
      place(meets);
      expect_truth(scene, tally);
    }
  }
}

// At sizes where products of coordinates under- or overflow, and far away in units of the bodies.
TEST(DecisionOracle, FarFromTheOriginAndOfManySizes) {
  Random random;
  Tally tally;
  for (const double scale : {1e-320, 1e-300, 1e-160, 1e-12, 1.0, 1e12, 1e100, 1e150, 1e306}) {
    std::vector<Mesh> meshes;
    for (const Mesh& mesh : small_meshes()) meshes.push_back(scaled(mesh, scale));
    for (const double far : {0.0, 1.0, 1e6, 1e12}) {
      if (far * scale > 1e307) continue;
      Scene scene(meshes);
      const Vec3 offset = far * random.point();
      for (std::uint32_t k = 0; k < 16; ++k) scene.add(k % 5, {random.turn(), scale * (offset + 1.3 * random.point())});
      expect_truth(scene, tally);
    }
  }
}

// Bodies whose centres coincide: there is no line of centres to begin with.
TEST(DecisionOracle, BodiesWithOneCentre) {
  Random random;
  Tally tally;
  Scene scene({sphere("a", 1, 3), scaled(sphere("b", 1, 3), 0.97), scaled(box("c", Vec3(1, 1, 1)), 1.2), soup(30),
               scaled(sphere("d", 1, 3), 0.3)});
  for (std::uint32_t k = 0; k < 25; ++k) scene.add(k % 5, {random.turn(), Vec3(0, 0, 0)});
  expect_truth(scene, tally);
}

// Larger meshes in shallow contact, where slabs and caps decide, and in deep overlap, where the descent does.
TEST(DecisionOracle, SpheresInShallowAndDeepContact) {
  Random random;
  Tally tally;
  Scene scene({sphere("ball", 1, 6), ring(12), scaled(two_boxes(), 1.5)});
  for (const double distance : {1.8, 1.94, 1.97, 1.98, 1.99, 1.995}) {
    scene.bodies.name.clear(), scene.bodies.mesh.clear(), scene.bodies.fixed.clear(), scene.poses.clear();
    for (std::uint32_t k = 0; k < 27; ++k)
      scene.add(k % 9 == 4 ? 1 + k % 2 : 0, {random.turn(), distance * Vec3(k % 3, k / 3 % 3, k / 9)});
    expect_truth(scene, tally);
  }
}

// The oracle's own short cut: boxes apart along a coordinate axis.
TEST(OracleOracle, TheShortCutOfBoxesChangesNothing) {
  Random random;
  for (int i = 0; i < 12; ++i) {
    const auto meshes = small_meshes();
    const auto a = oracle::world_triangles(meshes[i % 2], {random.turn(), Vec3(0, 0, 0)});
    const auto b = oracle::world_triangles(meshes[i % 5], {random.turn(), random.point()});
    for (const auto& s : a)
      for (const auto& t : b) ASSERT_FALSE(oracle::apart_along_an_axis(s, t) && oracle::triangles_meet(s, t)) << kSeed;
  }
}

}  // namespace
