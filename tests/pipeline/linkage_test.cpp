#include "pipeline/physics/linkage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

using pipeline::Linkage;
using pipeline::LinkJoint;
using pipeline::LinkPlace;

namespace {

constexpr double kQuarter = std::numbers::pi / 2;

void expect_at(const LinkPlace& place, double x, double y, double z) {
  EXPECT_NEAR(place.position[0], x, 1e-15);
  EXPECT_NEAR(place.position[1], y, 1e-15);
  EXPECT_NEAR(place.position[2], z, 1e-15);
}

}  // namespace

// Two rods of 1 m in a plane: a quarter turn of the first takes the second joint from (1, 0) to (0, 1), and another of
// the second points what slides on it along -x.
TEST(Linkage, TurnsAndSlidesAlongItsAxes) {
  const LinkJoint first{.above = -1, .position = {0, 0, 5}, .kind = LinkJoint::turning, .axis = {0, 0, 2}};
  const LinkJoint second{.above = 0, .position = {1, 0, 0}, .kind = LinkJoint::turning, .axis = {0, 0, 1}};
  const LinkJoint slide{.above = 1, .position = {1, 0, 0}, .kind = LinkJoint::sliding, .axis = {1, 0, 0}};
  Linkage linkage({first, second, slide});
  expect_at(linkage.places({0, 0, 0})[2], 2, 0, 5);
  const auto places = linkage.places({kQuarter, kQuarter, 0.5});
  expect_at(places[0], 0, 0, 5);
  expect_at(places[1], 0, 1, 5);
  expect_at(places[2], -1.5, 1, 5);
  EXPECT_NEAR(std::abs(places[2].orientation[3]), 1, 1e-15);  // half a turn about z
  expect_at(linkage.places({0, 0, 0})[2], 2, 0, 5);           // nothing is remembered
}

// A joint's own frame is turned before its axis is taken: x of a frame turned by 90 degrees about z is y.
TEST(Linkage, AxesAreOfTheJointsFrame) {
  const double half = std::sqrt(0.5);
  const LinkJoint slide{.above = -1, .orientation = {half, 0, 0, half}, .kind = LinkJoint::sliding, .axis = {1, 0, 0}};
  const LinkJoint stuck{.above = 0, .position = {0, 0, 1}, .orientation = {half, 0, half, 0}};
  Linkage linkage({slide, stuck});
  const auto places = linkage.places({3, 0});
  expect_at(places[0], 0, 3, 0);
  expect_at(places[1], 0, 3, 1);
}
