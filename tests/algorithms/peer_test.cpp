// What the plug-ins of algorithms/peers/libraries share, with engines made up here: no library of others is needed.
#define PEER_VERSION "1"
#include "algorithms/peers/libraries/peer.hpp"

#include <gtest/gtest.h>

#include "algorithms/peers/plugins.hpp"
#include "tests/support/setting.hpp"

namespace algorithms {
namespace {

using namespace setting;

/// Answers by boxes that are grown by its margin; what it does not see is up to its kind.
enum class Kind { silent, always, boxes };
template <Kind kind>
struct Engine {
  Engine(const Bodies& bodies, const collision_value* knobs) : bodies(bodies), knobs(knobs), at(bodies.size()) {}
  static double margin(const collision_value* knobs) { return knobs ? knobs[0].real : 0; }
  void place(std::uint32_t body, const Pose& pose) { at[body] = pose; }
  bool meet(std::uint32_t a, std::uint32_t b) {
    ++asked;
    if (kind != Kind::boxes) return kind == Kind::always;
    return (at[a].t - at[b].t).norm() < 0.7 * geometry::half_extents(bodies.mesh_of(a)).x() + 2 * margin(knobs);
  }
  const Bodies& bodies;
  const collision_value* knobs;
  std::vector<Pose> at;
  static inline int asked = 0;
};

/// The plug-in side of a setting, as the pipeline hands it over.
struct Handed {
  explicit Handed(const Bodies& from) {
    for (const Mesh& mesh : from.meshes)
      meshes.push_back({.name = mesh.name.c_str(),
                        .vertices = mesh.vertices.front().data(),
                        .vertex_count = mesh.vertices.size(),
                        .triangles = mesh.triangles.front().data(),
                        .triangle_count = mesh.triangles.size(),
                        .sphere_radius = 0,
                        .shape = "{}"});
    for (const std::string& name : from.name) names.push_back(name.c_str());
    bodies = {std::uint32_t(from.size()),
              std::uint32_t(meshes.size()),
              meshes.data(),
              names.data(),
              from.mesh.data(),
              from.fixed.data(),
              nullptr,
              0};
  }
  std::vector<collision_mesh> meshes;
  std::vector<const char*> names;
  collision_bodies bodies;
};

template <Kind kind>
std::string said(const Bodies& bodies) {
  const collision_row& row = *peers::table<Engine<kind>>({.name = "mine", .what = "", .precision = "double"})->row[0];
  char error[COLLISION_ERROR_SIZE] = "";
  const Handed handed(bodies);
  collision_method* made = row.create(&handed.bodies, nullptr, error);
  if (made) row.destroy(made);
  return made ? "made" : error;
}

TEST(Peer, AnEngineThatIsSilentOrSaysYesToAllIsNotBelieved) {
  const Setting two = Setting().add(geometry::box("cube", {2, 2, 2}), {}).add(geometry::box("cube", {2, 2, 2}), {});
  EXPECT_EQ(said<Kind::silent>(two.bodies), "the library's test fails: two tetrahedra that cross are not reported");
  EXPECT_EQ(said<Kind::always>(two.bodies), "the library's test fails: two tetrahedra that are apart are reported");
  EXPECT_EQ(said<Kind::boxes>(two.bodies), "made");
}

std::vector<Pair> answered(const Setting& setting, double margin, std::uint64_t& operations) {
  const collision_row& row =
      *peers::table<Engine<Kind::boxes>>({.name = "mine", .what = "", .precision = "double"})->row[0];
  char error[COLLISION_ERROR_SIZE] = "";
  const Handed handed(setting.bodies);
  const collision_value knobs[] = {{.integer = 0, .real = margin, .text = nullptr}};
  collision_method* method = row.create(&handed.bodies, knobs, error);
  EXPECT_TRUE(method) << error;
  std::vector<collision_pair> room(100);
  collision_hits hits = {room.data(), 0, room.size(), nullptr, nullptr};
  const std::vector<PairRun> runs = setting.runs();
  EXPECT_EQ(row.prepare(method, reinterpret_cast<const collision_pose*>(setting.poses.data()), 0, error), 0);
  EXPECT_EQ(
      row.count(method, reinterpret_cast<const collision_run*>(runs.data()), runs.size(), &hits, &operations, error),
      0);
  row.destroy(method);
  std::vector<Pair> out;
  for (std::uint64_t i = 0; i < hits.size; ++i) out.push_back({hits.pair[i].a, hits.pair[i].b});
  return out;
}

TEST(Peer, OnlyPairsWhoseBoxesTouchAreAskedAbout) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  Setting setting = Setting().add(cube, {}).add(cube, {{}, {0.5, 0, 0}}).add(cube, {{}, {2.6, 0, 0}});
  setting.add(cube, {}, true);
  setting.poses.back() = geometry::unborn();
  std::uint64_t operations = 0;
  EXPECT_EQ(answered(setting, 0, operations), (std::vector<Pair>{{0, 1}}));
  EXPECT_EQ(operations, 1u);
}

// Boxes 0.6 m apart: an engine that adds 0.4 m to each body has to be asked about them.
TEST(Peer, BoxesGrowByTheMargin) {
  const Mesh cube = geometry::box("cube", {2, 2, 2});
  const Setting setting = Setting().add(cube, {}).add(cube, {{}, {2.6, 0, 0}});
  std::uint64_t operations = 0;
  EXPECT_EQ(answered(setting, 0.29, operations), (std::vector<Pair>{}));
  EXPECT_EQ(operations, 0u);
  answered(setting, 0.4, operations);
  EXPECT_EQ(operations, 1u);
}

// Turned and shifted bodies too: whatever lies within the margin of a mesh lies in the box of the grown one.
TEST(Peer, TheGrownBoxHoldsTheMeshAndTheMargin) {
  std::mt19937 random(17);
  SCOPED_TRACE("seed 17");
  for (int i = 0; i < 200; ++i) {
    const double margin = 0.01 * (1 + i % 40);
    Setting setting = crowd(random, 5, 3);
    const Bodies grown = peers::grown(setting.bodies, margin);
    for (std::uint32_t body = 0; body < 5; ++body) {
      const geometry::Pose& at = setting.poses[body];
      const geometry::Enclosure mesh = geometry::enclosure(grown.mesh_of(body));
      const geometry::Box box = geometry::world_box(mesh, geometry::placement(mesh, at));
      for (const Vec3& v : setting.bodies.mesh_of(body).vertices) {
        const Vec3 world = geometry::to_world(geometry::rotation(at.q), at.t, v);
        ASSERT_TRUE((world.array() - margin >= box.min.array() - 1e-12).all() &&
                    (world.array() + margin <= box.max.array() + 1e-12).all());
      }
    }
  }
}

TEST(Peer, EveryPlugInIsNamedWithWhatItTakesBodiesForAndItsLicence) {
  for (const Algorithm& row : plugin_peers()) {
    EXPECT_TRUE(row.library.plugin && !row.make) << row.name;
    for (const std::string& text : {row.library.name, row.library.package, row.library.tests, row.library.licence,
                                    row.library.language, row.what})
      EXPECT_FALSE(text.empty()) << row.name;
  }
}

}  // namespace
}  // namespace algorithms
