// Axis-aligned boxes: touching counts, empty and undefined boxes touch nothing.
#include "geometry/box.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace geometry {
namespace {

Box cube(double from, double to) { return {Vec3::Constant(from), Vec3::Constant(to)}; }

TEST(Box, TouchesWhatSharesOnlyAFaceAnEdgeOrACorner) {
  const Box box = cube(0, 1);
  EXPECT_TRUE(touch(box, {{1, 0, 0}, {2, 1, 1}}));
  EXPECT_TRUE(touch(box, {{1, 1, 0}, {2, 2, 1}}));
  EXPECT_TRUE(touch(box, cube(1, 2)));
  EXPECT_TRUE(touch(box, cube(0.25, 0.5)));
}

TEST(Box, IsApartAtTheNextDoubleOnAnyAxis) {
  const double beyond = std::nextafter(1.0, 2.0);
  for (int axis = 0; axis < 3; ++axis) {
    Box other = cube(0, 2);
    other.min[axis] = beyond;
    EXPECT_FALSE(touch(cube(0, 1), other)) << "axis " << axis;
    EXPECT_FALSE(touch(other, cube(0, 1))) << "axis " << axis;
  }
}

TEST(Box, EmptyAndUndefinedBoxesTouchNothing) {
  const Box empty, undefined = cube(std::nan(""), std::nan("")), all = cube(-1e308, 1e308);
  EXPECT_FALSE(touch(empty, all));
  EXPECT_FALSE(touch(empty, empty));
  EXPECT_FALSE(touch(undefined, all));
  EXPECT_FALSE(touch(undefined, undefined));
}

TEST(Box, BoundsHoldExactlyTheExtremePoints) {
  const std::vector<Vec3> points = {{1, -2, 3}, {-4, 5, 0}, {0, 0, -6}};
  const Box box = bounds(points);
  EXPECT_EQ(box.min, Vec3(-4, -2, -6));
  EXPECT_EQ(box.max, Vec3(1, 5, 3));
  EXPECT_EQ(box.centre(), Vec3(-1.5, 1.5, -1.5));
  EXPECT_EQ(box.half_size(), Vec3(2.5, 3.5, 4.5));
}

TEST(Box, BoundsOfOnePointTouchThatPoint) {
  const std::vector<Vec3> point = {{1, 2, 3}};
  EXPECT_TRUE(touch(bounds(point), bounds(point)));
}

TEST(Box, BoundsLeaveOutNan) {
  const Vec3 unknown = Vec3::Constant(std::nan(""));
  const std::vector<Vec3> points = {unknown, {1, 2, 3}, unknown};
  EXPECT_EQ(bounds(points).min, Vec3(1, 2, 3));
  EXPECT_EQ(bounds(points).max, Vec3(1, 2, 3));
  const std::vector<Vec3> nothing = {unknown};
  EXPECT_FALSE(touch(bounds(nothing), cube(-1e308, 1e308)));
}

}  // namespace
}  // namespace geometry
