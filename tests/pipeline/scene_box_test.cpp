// The box: its plates and schedule, places of births, pushes, restitution, and the motion with its events.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "pipeline/config.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/motion.hpp"
#include "pipeline/terminal/error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/scene_size.hpp"
#include "tests/support/temporary_folder.hpp"

using namespace pipeline;

namespace {

constexpr std::size_t kPlates = 6;

/// A box of coarse meshes; `sets` as of --set.
Config box(std::vector<std::string> sets = {}, const std::string& more = "") {
  sets.insert(sets.begin(), "scene.segments=4");
  return parse_config("[scene]\nkind = \"box\"\n" + more, "box.toml", sets);
}

/// The user's error; "" when there is none.
std::string refusal(const std::vector<std::string>& sets) {
  return tests::refusal_of([&] { box(sets); });
}

/// The motion in a part of its own, or in `folder` if it is given.
Motion motion_of(const Config& config, const std::filesystem::path& folder = {}) {
  const TemporaryFolder temporary;
  Checkpoint part(folder.empty() ? temporary / "x.part" : folder, {.config_sha256 = "c", .program_sha256 = "p"}, "box",
                  config.steps, false);
  Progress progress("motion", std::uint64_t(config.steps), true);
  return integrate(config, config.scene_kind->make(config), part, progress);
}

void expect_same_bits(const Motion& a, const Motion& b) {
  EXPECT_EQ(a.physics.status, b.physics.status);
  ASSERT_EQ(a.poses.size(), b.poses.size());
  for (std::size_t s = 0; s < a.poses.size(); ++s) {
    for (std::size_t i = 0; i < a.poses[s].size(); ++i) {
      const geometry::Pose &p = a.poses[s][i], &q = b.poses[s][i];
      ASSERT_EQ(geometry::is_born(p), geometry::is_born(q)) << "step " << s << " body " << i;
      if (!geometry::is_born(p)) continue;
      ASSERT_TRUE(p.t == q.t && p.q.w == q.q.w && p.q.x == q.q.x && p.q.y == q.q.y && p.q.z == q.q.z)
          << "step " << s << " body " << i;
    }
    ASSERT_EQ(a.physics.rows[s].energy, b.physics.rows[s].energy) << "step " << s;
    ASSERT_EQ(a.physics.rows[s].integrator_steps, b.physics.rows[s].integrator_steps) << "step " << s;
  }
}

/// Step at which a body is first there, -1 if never; and it stays.
std::int64_t first_step(const Motion& motion, std::size_t body) {
  std::int64_t first = -1;
  for (std::size_t s = 0; s < motion.poses.size(); ++s) {
    const bool born = geometry::is_born(motion.poses[s][body]);
    if (born && first < 0) first = std::int64_t(s);
    EXPECT_EQ(born, first >= 0) << "step " << s << " body " << body;
  }
  return first;
}

/// The ratio of the speeds after and before a bounce of one sphere on a plate, with the scene's own physics.
double restitution(const Config& config, double speed) {
  const Scene scene = config.scene_kind->make(config);
  std::vector<RigidBody> bodies(scene.rigid.begin(), scene.rigid.begin() + kPlates + 1);
  std::vector<BodyState> states(scene.states.begin(), scene.states.begin() + kPlates + 1);
  states[kPlates] = BodyState();
  states[kPlates].position = {4, 0.3, -0.2};
  states[kPlates].velocity = {speed, 0, 0};
  Simulation simulation(bodies, config.physics, states, 0);
  PhysicsSample sample;
  // 0.5 m to the plate, a contact of some 0.03 s, and back.
  EXPECT_EQ(simulation.advance_to(1.2 / speed + 0.1, sample), "");
  const auto after = simulation.states()[kPlates].velocity;
  EXPECT_LT(after[0], 0);
  return -after[0] / speed;
}

/// Of the law (1 + 3/2 c v) times a force of depth: the root e of u - ln(1 + u) = -e u - ln(1 - e u), u = 3/2 c v.
double restitution_of_the_law(double dissipation, double speed) {
  const double u = 1.5 * dissipation * speed;
  double low = 0, high = std::fmin(1, 1 / u);
  for (int i = 0; i < 100; ++i) {
    const double e = (low + high) / 2;
    (-e * u - std::log1p(-e * u) < u - std::log1p(u) ? low : high) = e;
  }
  return low;
}

}  // namespace

TEST(BoxScene, HasSixPlatesAroundACubeOfTenMetres) {
  const Config config = parse_config("[scene]\nkind = \"box\"\n", "box.toml");
  const Scene scene = config.scene_kind->make(config);
  ASSERT_EQ(scene.bodies.size(), 86u);
  EXPECT_EQ(scene.bodies.mesh_of(6).triangles.size(), 1224u);  // the default 16 segments
  const char* names[] = {"plate_-x", "plate_+x", "plate_-y", "plate_+y", "plate_-z", "plate_+z"};
  for (std::uint32_t plate = 0; plate < kPlates; ++plate) {
    EXPECT_EQ(scene.bodies.name[plate], names[plate]);
    EXPECT_TRUE(scene.bodies.fixed[plate]);
    // The mesh's sides are the physical ones: its inner face lies at 5 m, its outer at 6 m, the others reach the edges.
    const geometry::Box mesh = geometry::local_box(scene.bodies.mesh_of(plate));
    const int axis = int(plate) / 2;
    for (int i = 0; i < 3; ++i) {
      const double low = scene.states[plate].position[std::size_t(i)] + mesh.min[i];
      const double high = scene.states[plate].position[std::size_t(i)] + mesh.max[i];
      const bool negative = plate % 2 == 0;
      EXPECT_EQ(low, i != axis ? -6 : negative ? -6 : 5) << names[plate];
      EXPECT_EQ(high, i != axis ? 6 : negative ? -5 : 6) << names[plate];
      EXPECT_EQ(mesh.max[i], scene.rigid[plate].half_extents[std::size_t(i)]);
    }
  }
  for (std::size_t body = kPlates; body < 86; ++body) EXPECT_FALSE(is_born(scene.states[body]));
}

TEST(BoxScene, ContactRadiusIsInscribedUnlessNominalIsAsked) {
  const Config inscribed = box(), nominal = box({"physics.contact_radius=nominal"});
  const double radius = inscribed.scene_kind->make(inscribed).rigid[kPlates].radius;
  EXPECT_LT(radius, 0.5);
  EXPECT_GT(radius, 0.45);
  EXPECT_EQ(nominal.scene_kind->make(nominal).rigid[kPlates].radius, 0.5);
}

TEST(BoxScene, SizeIsKnownWithoutMakingIt) {
  const Config config = box({"scene.births.count=5"});
  tests::expect_size(config.scene_kind->size(config), config.scene_kind->make(config));
}

TEST(BoxScene, ExplicitPhysicsWinsOverThePresets) {
  EXPECT_EQ(box().physics.gravity, (std::array<double, 3>{0, 0, 0}));
  EXPECT_EQ(box().physics.linear_damping, 0);
  EXPECT_EQ(box().physics.angular_damping, 0);
  const Config config = box({"physics.gravity=[0,-1,0]", "physics.dissipation=0.2", "physics.angular_damping=0.5"});
  EXPECT_EQ(config.physics.gravity[1], -1);
  EXPECT_EQ(config.physics.material.dissipation, 0.2);
  EXPECT_EQ(config.physics.angular_damping, 0.5);
}

TEST(BoxScene, RefusesWhatCannotBe) {
  // A packing fills at most 0.7405 of the cube: 1414 spheres of 0.5 m in 1000 m^3 fill 0.7404, 1415 fill 0.7409.
  EXPECT_EQ(refusal({"scene.births.count=1414", "scene.births.every=0"}), "");
  const std::string full = refusal({"scene.births.count=1415", "scene.births.every=0"});
  EXPECT_NE(full.find("1415 spheres would fill 0.741 of it"), std::string::npos) << full;
  // Only births within the run count.
  EXPECT_EQ(refusal({"scene.births.count=1415"}), "");
  EXPECT_NE(refusal({"scene.radius=5.1"}).find("'scene.half_width' must be at least scene.radius"), std::string::npos);
  EXPECT_NE(refusal({"steps=20", "scene.births.from=20"}).find("no sphere would ever be born"), std::string::npos);
  EXPECT_NE(refusal({"scene.push.every=0"}).find("'scene.push.every' must be an integer"), std::string::npos);
  EXPECT_NE(refusal({"scene.births.count=0"}).find("'scene.births.count'"), std::string::npos);
  EXPECT_NE(refusal({"scene.push.directions=[]"}).find("an array of at least one text"), std::string::npos);
  EXPECT_NE(refusal({"scene.push.directions=['+x', 'up']"}).find("'scene.push.directions.1' must be"),
            std::string::npos);
  EXPECT_NE(refusal({"scene.births.countt=3"}).find("did you mean"), std::string::npos);
}

TEST(BoxPhysics, BouncesAsTheLawSaysAndNearFourFifths) {
  const Config config = box();
  const double dissipation = config.physics.material.dissipation;
  double slowest = 1;
  for (const double speed : {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 9.5}) {
    const double measured = restitution(config, speed);
    EXPECT_NEAR(measured, restitution_of_the_law(dissipation, speed), 0.01) << speed << " m/s";
    EXPECT_LT(measured, slowest) << "faster bounces lose more";
    slowest = measured;
  }
  // A quarter of the bounces of configs/kostka.toml are slower than 2.7 m/s, a quarter faster than 6.2 m/s.
  EXPECT_NEAR(restitution(config, 4.3), 0.8, 0.02);
  EXPECT_NEAR(restitution(config, 2.7), 0.8, 0.08);
  EXPECT_NEAR(restitution(config, 6.2), 0.8, 0.08);
}

TEST(BoxPhysics, NothingActsBetweenBounces) {
  const Config config = box();
  const Scene scene = config.scene_kind->make(config);
  std::vector<RigidBody> bodies(scene.rigid.begin(), scene.rigid.begin() + kPlates + 1);
  std::vector<BodyState> states(scene.states.begin(), scene.states.begin() + kPlates + 1);
  states[kPlates] = BodyState();
  states[kPlates].velocity = {1, -0.5, 0.25};
  Simulation simulation(bodies, config.physics, states, 0);
  PhysicsSample sample;
  ASSERT_EQ(simulation.advance_to(3, sample), "");
  EXPECT_EQ(simulation.states()[kPlates].velocity, states[kPlates].velocity);  // bit for bit: no force at all
}

TEST(BoxMotion, BirthsAreAtTheScheduledSteps) {
  const Config config = box({"steps=60", "scene.births.count=5", "scene.births.from=3", "scene.births.every=20"});
  const Motion motion = motion_of(config);
  EXPECT_EQ(motion.physics.status, "complete");
  for (std::size_t plate = 0; plate < kPlates; ++plate) EXPECT_EQ(first_step(motion, plate), 0);
  EXPECT_EQ(first_step(motion, 6), 3);
  EXPECT_EQ(first_step(motion, 7), 23);
  EXPECT_EQ(first_step(motion, 8), 43);
  EXPECT_EQ(first_step(motion, 9), -1);  // step 63 is beyond the run
  EXPECT_EQ(first_step(motion, 10), -1);
  // At rest until the first push, at step 50.
  for (std::size_t s = 0; s < 50; ++s) EXPECT_EQ(motion.physics.rows[s].kinetic_energy, 0) << s;
  EXPECT_GT(motion.physics.rows[50].kinetic_energy, 0);
}

TEST(BoxMotion, NothingOverlapsAtBirth) {
  for (const int seed : {1, 2}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    // Crowded: 25 spheres in a cube of 4 m, most of them in motion when the later ones are born.
    const Config config = box({"seed=" + std::to_string(seed), "steps=26", "scene.half_width=2",
                               "scene.births.count=25", "scene.births.every=1", "scene.push.from=5"});
    const Motion motion = motion_of(config);
    ASSERT_EQ(motion.physics.status, "complete");
    for (std::size_t s = 0; s < 25; ++s) {
      const geometry::Pose& newborn = motion.poses[s][kPlates + s];
      ASSERT_TRUE(geometry::is_born(newborn));
      EXPECT_LE(newborn.t.cwiseAbs().maxCoeff(), 1.5);
      for (std::size_t other = kPlates; other < kPlates + s; ++other)
        EXPECT_GE((newborn.t - motion.poses[s][other].t).norm(), 1 - 1e-15) << "step " << s << " body " << other;
    }
  }
}

TEST(BoxMotion, OrientationsOfBirthsDiffer) {
  const Motion motion = motion_of(box({"steps=1", "scene.births.count=30", "scene.births.every=0"}));
  for (std::size_t a = kPlates; a < kPlates + 30; ++a)
    for (std::size_t b = a + 1; b < kPlates + 30; ++b) {
      const geometry::Quaternion &p = motion.poses[0][a].q, &q = motion.poses[0][b].q;
      EXPECT_LT(std::fabs(p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z), 0.999);
    }
}

// A sphere alone keeps its velocity between pushes, so differences of positions show what each push added.
TEST(BoxMotion, PushesAddAlongTheBodysOwnAxes) {
  for (int body_seed = 1; body_seed <= 5; ++body_seed) {
    SCOPED_TRACE(testing::Message() << "seed " << body_seed);
    const Config config =
        box({"seed=" + std::to_string(body_seed), "steps=45", "rate=100", "scene.births.count=1", "scene.half_width=50",
             "scene.push.from=4", "scene.push.every=10", "scene.push.speed=3"});
    const Motion motion = motion_of(config);
    ASSERT_EQ(motion.physics.status, "complete");
    const geometry::Mat3 r = geometry::rotation(motion.poses[0][kPlates].q);
    const auto velocity = [&](std::size_t s) {
      return geometry::Vec3((motion.poses[s + 1][kPlates].t - motion.poses[s][kPlates].t) * 100);
    };
    geometry::Vec3 expected = geometry::Vec3::Zero();
    EXPECT_LT((velocity(0) - expected).norm(), 1e-9);
    const std::pair<int, double> axes[] = {{0, 3}, {0, -3}, {2, 3}, {2, -3}};
    for (std::size_t push = 0; push < 4; ++push) {
      expected += axes[push].second * r.col(axes[push].first);
      EXPECT_LT((velocity(4 + 10 * push) - expected).norm(), 1e-9) << "push " << push;
      EXPECT_LT((velocity(12 + 10 * push) - expected).norm(), 1e-9) << "push " << push;
    }
  }
}

TEST(BoxMotion, EnergyRisesOnlyByPushes) {
  const Config config = box({"steps=201", "scene.half_width=2", "scene.births.count=12", "scene.births.every=4"});
  const Motion motion = motion_of(config);
  ASSERT_EQ(motion.physics.status, "complete");
  std::int64_t contacts = 0;
  for (std::size_t s = 1; s < motion.poses.size(); ++s) {
    const double before = motion.physics.rows[s - 1].energy, now = motion.physics.rows[s].energy;
    contacts += motion.physics.rows[s].contacts;
    if (s % 50 == 0) continue;
    EXPECT_LE(now, before * 1.001) << s;  // the accuracy of the integrator
  }
  EXPECT_GT(contacts, 20);
  EXPECT_LT(motion.physics.rows[199].energy, 0.8 * motion.physics.rows[150].energy);
}

TEST(BoxMotion, NoSphereLeavesTheCube) {
  const Motion motion = motion_of(
      box({"steps=160", "scene.half_width=2", "scene.births.count=10", "scene.births.every=5", "scene.push.speed=10"}));
  ASSERT_EQ(motion.physics.status, "complete");
  for (const auto& poses : motion.poses)
    for (std::size_t body = kPlates; body < poses.size(); ++body) {
      if (!geometry::is_born(poses[body])) continue;
      EXPECT_LT(poses[body].t.cwiseAbs().maxCoeff(), 2);
    }
}

// Plates as soft as foam: the sphere that is pushed into one goes through.
TEST(BoxMotion, ASphereThatLeavesEndsTheMotionAsData) {
  const Config config =
      box({"steps=200", "scene.births.count=2", "scene.births.every=0", "scene.push.from=10", "physics.stiffness=100"});
  const Motion motion = motion_of(config);
  const std::string& status = motion.physics.status;
  ASSERT_EQ(status.find("failed at step "), 0u) << status;
  EXPECT_NE(status.find(": sphere_"), std::string::npos) << status;
  EXPECT_NE(status.find(" left the cube: its centre is at "), std::string::npos) << status;
  const std::size_t step = std::stoul(status.substr(15));
  ASSERT_LT(step, 200u);
  ASSERT_GT(step, 10u);
  for (std::size_t s = 0; s < 200; ++s) {
    EXPECT_TRUE(geometry::is_born(motion.poses[s][0])) << "plates stay";
    EXPECT_EQ(geometry::is_born(motion.poses[s][6]), s < step) << s;
    EXPECT_EQ(geometry::is_born(motion.poses[s][7]), s < step) << s;
  }
  // At 5 m/s and 60 steps per second the sphere was at most 0.084 m before the plate at the step before.
  double outermost = 0;
  for (const std::size_t body : {6, 7})
    outermost = std::fmax(outermost, motion.poses[step - 1][body].t.cwiseAbs().maxCoeff());
  EXPECT_LE(outermost, 5);
  EXPECT_GT(outermost, 5 - 5.0 / 60 - 1e-6);
}

TEST(BoxMotion, IsAFunctionOfTheConfiguration) {
  const std::vector<std::string> sets = {"steps=120", "scene.half_width=2", "scene.births.every=6",
                                         "scene.births.count=14"};
  const Motion motion = motion_of(box(sets));
  expect_same_bits(motion, motion_of(box(sets)));
  std::vector<std::string> other = sets;
  other.push_back("seed=2");
  EXPECT_NE(motion_of(box(other)).poses[0][kPlates].t, motion.poses[0][kPlates].t);
}

// Births at steps 0, 20, ... 100 or 9, 29, 49, ... or 10, 30, 50, ..., pushes at 29, 39, 49, ... 99: at the last step
// of a chunk, at the first and inside. A run that goes on from any chunk ends with the same bits.
TEST(BoxMotion, ResumesFromAnyChunkWithTheSameBits) {
  for (const char* from : {"0", "9", "10"}) {
    SCOPED_TRACE(from);
    const Config config = box({"steps=110", "scene.half_width=1.5", "scene.births.count=6", "scene.births.every=20",
                               std::string("scene.births.from=") + from, "scene.push.from=29", "scene.push.every=10"});
    const TemporaryFolder folder;
    const std::filesystem::path part = folder / "x.part";
    const Motion whole = motion_of(config, part);
    ASSERT_EQ(whole.physics.status, "complete");
    for (std::int64_t first = 0; first < 110; first += kChunkSteps) {
      // As after a kill: this chunk and all later ones are missing. Then, this one alone.
      for (std::int64_t lost = first; lost < 110; lost += kChunkSteps)
        ASSERT_TRUE(std::filesystem::remove(part / chunk_name("motion", lost)));
      expect_same_bits(whole, motion_of(config, part));
      ASSERT_TRUE(std::filesystem::remove(part / chunk_name("motion", first)));
      expect_same_bits(whole, motion_of(config, part));
    }
  }
}

TEST(BoxMotion, ABirthWithoutAPlaceIsTheUsersError) {
  // 60 spheres would fill 0.49 of a cube of 4 m: a dense packing holds them, places at random do not.
  const Config config = box({"steps=100", "scene.half_width=2", "scene.births.count=60", "scene.births.every=1"});
  std::string first;
  for (int i = 0; i < 2; ++i) {
    const std::string what = tests::refusal_of([&] { motion_of(config); });
    EXPECT_EQ(what.find("box.toml: sphere_"), 0u) << what;
    EXPECT_NE(what.find(" must be born at step "), std::string::npos) << what;
    EXPECT_NE(what.find("lower scene.births.count"), std::string::npos) << what;
    EXPECT_TRUE(first.empty() || first == what) << first << '\n' << what;
    first = what;
  }
}

// With an event at every step no Simulation lives for longer than one: what it counted on the way to it must not be
// lost.
TEST(BoxMotion, RowsCountTheStepsBeforeAnEventAndShowWhatHoldsAfterIt) {
  const Config config = box({"steps=30", "scene.births.count=30", "scene.births.every=1", "scene.push.from=20"});
  const double mass = config.scene_kind->make(config).rigid[kPlates].mass;
  const Motion motion = motion_of(config);
  EXPECT_EQ(motion.physics.rows[0].integrator_steps, 0);
  for (std::size_t s = 1; s < 30; ++s) {
    const PhysicsSample& row = motion.physics.rows[s];
    EXPECT_GT(row.integrator_steps, 0) << s;
    EXPECT_GT(row.force_evaluations, row.integrator_steps) << s;
    EXPECT_GT(row.time_ns, 0) << s;
  }
  // The push at step 20 moves all 21 spheres, that born at step 20 too.
  EXPECT_EQ(motion.physics.rows[19].kinetic_energy, 0);
  EXPECT_NEAR(motion.physics.rows[20].kinetic_energy, 21 * mass / 2 * 25, 1e-6);
}

TEST(BoxMotion, TheTimeBudgetIsThatOfTheWholeMotion) {
  // Every step has an event, so each Simulation lives for one step only; together they take longer than the budget.
  const Motion motion =
      motion_of(box({"steps=400", "scene.births.every=1", "scene.births.count=80", "physics.time_budget=0.02"}));
  EXPECT_NE(motion.physics.status.find("s of wall time"), std::string::npos) << motion.physics.status;
}
