#include "pipeline/scene/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "pipeline/config.hpp"
#include "tests/support/scene_size.hpp"

using namespace pipeline;

namespace {

Config falling(const std::string& scene_keys = "") {
  return parse_config("[scene]\nkind = \"falling\"\n" + scene_keys, "test.toml");
}

// Three shapes, of which the two bodies that fall have the first two; the sphere of another set; two obstacles.
constexpr char kSolids[] =
    "density = 500\ncontact_spheres = 6\n"
    "[[scene.obstacle]]\nname = 'post'\nshape = 'capsule'\nheight = 3\nradius = 0.5\nposition = [9, 1.5, 0]\n"
    "[[scene.obstacle]]\nname = 'wall'\nshape = 'box'\nsize = [1, 2, 3]\nposition = [-9, 1, 0]\n"
    "[[scene.set]]\nlying = [3, 1]\nabove = [1, 1, 2]\nspacing = 4\nturned = true\n"
    "shapes = [{shape = 'box', size = [1, 2, 3]}, {shape = 'torus', diameter = 2, thickness = 0.5, density = 700},"
    " {shape = 'box', size = [1, 2, 3], contact_spheres = 9}]\n"
    "[[scene.set]]\nlying = [2, 1]\nabove = [0, 0, 0]\ncorner = [20, 20]\n";

Scene made(const Config& config) { return config.scene_kind->make(config); }

}  // namespace

TEST(FallingScene, HasTheThesissBodies) {
  const Scene scene = made(falling());
  ASSERT_EQ(scene.bodies.size(), 275u);
  EXPECT_EQ(std::count(scene.bodies.fixed.begin(), scene.bodies.fixed.end(), 1), 1);
  EXPECT_EQ(scene.bodies.mesh_of(1).triangles.size(), 1224u);

  // The plate's top is y = 0 and its sides are at 30 m.
  const geometry::Box plate = geometry::local_box(scene.bodies.mesh_of(0));
  EXPECT_EQ(scene.states[0].position[1] + plate.max.y(), 0);
  EXPECT_EQ(plate.max.x(), 30);

  const auto position = [&](const std::string& name) {
    const auto at = std::find(scene.bodies.name.begin(), scene.bodies.name.end(), name) - scene.bodies.name.begin();
    return scene.states.at(std::size_t(at)).position;
  };
  using Point = std::array<double, 3>;
  EXPECT_EQ(position("set1_lying_0"), (Point{-14, 1, -20}));
  EXPECT_EQ(position("set1_above_0"), (Point{-14 + 0.15, 5, -20 + 0.15}));
  EXPECT_EQ(position("set2_lying_9"), (Point{-10 + 2.5 * 9, 1, -18}));
  EXPECT_EQ(position("set2_above_9"), (Point{-10 + 0.15 + 2.5 * 9, 26, -18 + 0.15}));
  EXPECT_EQ(position("set3_lying_35"), (Point{-5 + 2.1 * 5, 1, -3 + 2.1 * 5}));
  EXPECT_EQ(position("set3_above_215"), (Point{-5 + 0.15 + 2.1 * 5, 75 + 2.1 * 5, -3 + 0.15 + 2.1 * 5}));
}

// A displacement within jitter along each axis, of the spheres above alone, another one for each and for each seed.
TEST(FallingScene, JitterDisplacesTheSpheresAboveByTheSeed) {
  const double jitter = 0.04;
  const auto with_seed = [&](const std::string& seed) {
    return made(parse_config("seed = " + seed + "\n[scene]\nkind = \"falling\"\njitter = 0.04\n", "test.toml"));
  };
  const Scene still = made(falling()), one = with_seed("1"), again = with_seed("1"), two = with_seed("2");
  std::set<double> moves;
  for (std::size_t b = 0; b < still.states.size(); ++b) {
    EXPECT_EQ(one.states[b].position, again.states[b].position);
    const bool above = still.bodies.name[b].find("_above_") != std::string::npos;
    EXPECT_EQ(one.states[b].position != still.states[b].position, above) << still.bodies.name[b];
    EXPECT_EQ(one.states[b].position != two.states[b].position, above) << still.bodies.name[b];
    for (int axis = 0; axis < 3 && above; ++axis) {
      const double move = one.states[b].position[axis] - still.states[b].position[axis];
      EXPECT_LE(std::fabs(move), jitter * (1 + 1e-12));
      moves.insert(move);
    }
  }
  // 227 spheres of the thesis's sets: 681 numbers, spread over the whole range (within 5 % of each end surely).
  EXPECT_EQ(moves.size(), 681u);
  EXPECT_LT(*moves.begin(), -0.95 * jitter);
  EXPECT_GT(*moves.rbegin(), 0.95 * jitter);
}

TEST(FallingScene, WithoutJitterTheSeedChangesNothing) {
  const Scene one = made(falling());
  const Scene two = made(parse_config("seed = 2\n[scene]\nkind = \"falling\"\njitter = 0\n", "test.toml"));
  for (std::size_t b = 0; b < one.states.size(); ++b) EXPECT_EQ(one.states[b].position, two.states[b].position);
}

TEST(FallingScene, NoTwoSpheresOverlapAtTheStart) {
  const Scene scene = made(falling());
  for (std::size_t a = 1; a < scene.states.size(); ++a)
    for (std::size_t b = a + 1; b < scene.states.size(); ++b) {
      double distance_squared = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const double d = scene.states[a].position[axis] - scene.states[b].position[axis];
        distance_squared += d * d;
      }
      ASSERT_GT(distance_squared, 4) << scene.bodies.name[a] << " and " << scene.bodies.name[b];
    }
}

TEST(FallingScene, ContactRadiusIsInscribedUnlessNominalIsAsked) {
  const Scene inscribed = made(falling());
  EXPECT_LT(inscribed.rigid[1].radius, 1);
  EXPECT_GT(inscribed.rigid[1].radius, 0.98);
  const Scene nominal =
      made(parse_config("[scene]\nkind = \"falling\"\n[physics]\ncontact_radius = \"nominal\"\n", "test.toml"));
  EXPECT_EQ(nominal.rigid[1].radius, 1);
  // Mass and inertia do not depend on it: 4/3 pi r^3 density, 2/5 m r^2.
  EXPECT_NEAR(inscribed.rigid[1].mass, 4188.790204786391, 1e-9);
  EXPECT_NEAR(inscribed.rigid[1].inertia, 1675.5160819145564, 1e-9);
  EXPECT_EQ(inscribed.rigid[1].mass, nominal.rigid[1].mass);
}

TEST(FallingScene, SizeIsKnownWithoutMakingIt) {
  for (const char* keys : {"", "segments = 4\n[[scene.set]]\nlying = [3, 2]\nabove = [0, 0, 0]\n", kSolids}) {
    const Config config = falling(keys);
    tests::expect_size(config.scene_kind->size(config), made(config));
  }
}

TEST(FallingScene, ShapesGoRoundAndLieOnThePlate) {
  const Scene scene = made(falling(kSolids));
  std::vector<std::string> meshes;
  for (std::uint32_t b = 0; b < scene.bodies.size(); ++b) meshes.push_back(scene.bodies.mesh_of(b).name);
  // The wall is touched as a box, so its mesh has no contact spheres.
  EXPECT_EQ(meshes, (std::vector<std::string>{"plate", "post", "wall", "box", "torus", "box_2", "box", "torus",
                                              "sphere", "sphere"}));
  EXPECT_EQ(std::count(scene.bodies.fixed.begin(), scene.bodies.fixed.end(), 1), 3);
  for (std::size_t b = 3; b < 6; ++b) {
    const geometry::Mesh& mesh = scene.bodies.mesh_of(std::uint32_t(b));
    EXPECT_EQ(scene.states[b].position[1], -geometry::local_box(mesh).min.y());
    EXPECT_EQ(scene.states[b].orientation, (std::array<double, 4>{1, 0, 0, 0}));
    EXPECT_EQ(scene.rigid[b].spheres.size(), mesh.contact_spheres.size());
    EXPECT_LE(mesh.contact_spheres.size(), b == 5 ? 9u : 6u);
  }
  EXPECT_NE(scene.states[6].orientation, scene.states[7].orientation);
  EXPECT_NEAR(scene.rigid[3].mass, 500 * 6, 1e-9);
  EXPECT_GT(scene.rigid[4].mass, 700 * 0.9 * 2 * 9.8696 * 1 * 0.0625);  // a torus of 16 segments lacks some of it
  EXPECT_TRUE(scene.rigid[2].spheres.empty());
  EXPECT_FALSE(scene.rigid[2].sphere);
}

TEST(FallingScene, WritesItsShapesAsItReadsThem) {
  const Config once = falling(kSolids), again = parse_config(once.effective, "again.toml");
  EXPECT_EQ(again.effective, once.effective);
  EXPECT_NE(once.effective.find("[[scene.set.shapes]]\nshape = \"torus\""), std::string::npos);
}
