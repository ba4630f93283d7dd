#include "algorithms/parts/point_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

namespace {

using namespace geometry;

Points cube(std::size_t size) {
  std::mt19937_64 bits(size);
  const auto real = [&] { return static_cast<double>(static_cast<std::int64_t>(bits())) * 0x1p-63; };
  Points points;
  for (std::size_t i = 0; i < size; ++i) {
    const double x = real(), y = real(), z = real();
    points.add({x, y, z});
  }
  return points;
}

/// Ever nearer to the origin: equal cells put nearly all into one.
Points geometric_row(std::size_t size) {
  Points points;
  double x = 1e9;
  for (std::size_t i = 0; i < size; ++i, x *= 0.5) points.add({x, 0, 0});
  return points;
}

Points equal(std::size_t size) {
  Points points;
  for (std::size_t i = 0; i < size; ++i) points.add({1, 2, 3});
  return points;
}

using Sorted = std::vector<std::array<double, 3>>;

Sorted sorted(const Points& points, std::size_t size) {
  Sorted out;
  for (std::size_t i = 0; i < size; ++i) out.push_back({points.x[i], points.y[i], points.z[i]});
  std::sort(out.begin(), out.end());
  return out;
}

/// The depth of the tree below `number`, after a look at every node.
std::size_t checked_depth(const PointTree& tree, std::uint32_t number) {
  const PointTree::Node& node = tree.nodes[number];
  Box box;
  for (std::uint32_t i = node.first; i < node.first + node.size; ++i) box.add(tree.points.at(i));
  EXPECT_EQ(box.min, node.box.min);
  EXPECT_EQ(box.max, node.box.max);
  EXPECT_EQ(node.first % PointTree::kLeaf, 0u);
  if (node.second == 0) {
    EXPECT_GE(node.size, 1u);
    EXPECT_LE(node.size, PointTree::kLeaf);
    return 1;
  }
  const PointTree::Node &first = tree.nodes[number + 1], &second = tree.nodes[node.second];
  EXPECT_EQ(first.first, node.first);
  EXPECT_EQ(second.first, node.first + first.size);
  EXPECT_EQ(first.size + second.size, node.size);
  return 1 + std::max(checked_depth(tree, number + 1), checked_depth(tree, node.second));
}

TEST(PointTree, HoldsEveryPointOnceInBalancedTightBoxes) {
  const std::function<Points(std::size_t)> makers[] = {cube, geometric_row, equal};
  for (const auto& points_of : makers)
    for (const std::size_t size : {1, 2, 15, 16, 17, 31, 32, 33, 500, 1025}) {
      SCOPED_TRACE(size);
      const Points points = points_of(size);
      const PointTree tree(points);
      EXPECT_EQ(tree.nodes[0].size, size);
      EXPECT_EQ(sorted(tree.points, size), sorted(points, size));
      EXPECT_LE(double(checked_depth(tree, 0)), 2 + std::ceil(std::log2(double(size))));
    }
}

TEST(PointTree, FillsTheLastLeafWithWhatIsNearNothing) {
  const PointTree tree(cube(21));
  ASSERT_EQ(tree.points.size(), 2 * PointTree::kLeaf);
  for (std::size_t i = 0; i < tree.points.size(); ++i) EXPECT_EQ(std::isnan(tree.points.x[i]), i >= 21) << i;
}

TEST(PointTree, OfNoPointsHasNoNode) {
  const PointTree tree{Points()};
  EXPECT_TRUE(tree.nodes.empty());
  EXPECT_EQ(tree.points.size(), 0u);
}

}  // namespace
