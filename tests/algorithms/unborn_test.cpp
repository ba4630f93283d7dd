// Time against the number of bodies is only that if bodies that are not yet born cost nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "tests/support/setting.hpp"

namespace {

/// Fastest of several preparations, ns.
std::int64_t prepare_ns(algorithms::Method& method, const std::vector<geometry::Pose>& poses) {
  using Clock = std::chrono::steady_clock;
  std::int64_t fastest = std::numeric_limits<std::int64_t>::max();
  for (int i = 0; i < 9; ++i) {
    const auto start = Clock::now();
    method.prepare(poses);
    fastest = std::min<std::int64_t>(fastest, std::chrono::nanoseconds(Clock::now() - start).count());
  }
  return fastest;
}

}  // namespace

// Those whose preparation does more than copy a position. Measured: 1/24 to 1/210 of it.
TEST(Unborn, CostLessThanHalfThePreparationOfTheBorn) {
  constexpr std::uint32_t kBodies = 2000;
  geometry::Bodies bodies;
  bodies.meshes.push_back(geometry::sphere("sphere", 1, 4));
  for (std::uint32_t body = 0; body < kBodies; ++body) {
    bodies.add("sphere_" + std::to_string(body), 0);
  }
  std::mt19937 random(1);
  std::vector<geometry::Pose> born, unborn(kBodies, geometry::unborn());
  for (std::uint32_t body = 0; body < kBodies; ++body)
    born.push_back({setting::uniform_turn(random), setting::uniform_point(random, 10)});
  for (const char* name : {"aabb", "obb_sat", "obb_corners", "rotated_aabb"}) {
    const auto method = setting::make(name, bodies);
    const std::int64_t all = prepare_ns(*method, born), none = prepare_ns(*method, unborn);
    EXPECT_LT(2 * none, all) << name;
  }
}
