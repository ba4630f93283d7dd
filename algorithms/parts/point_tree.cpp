#include "algorithms/parts/point_tree.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <numeric>
#include <span>

namespace geometry {
namespace {

struct Builder {
  const Points& from;
  PointTree& tree;

  void add(std::span<std::uint32_t> chosen) {
    const std::size_t number = tree.nodes.size();
    PointTree::Node node;
    for (const std::uint32_t i : chosen) node.box.add(from.at(i));
    node.first = static_cast<std::uint32_t>(tree.points.size());
    node.size = static_cast<std::uint32_t>(chosen.size());
    tree.nodes.push_back(node);
    if (chosen.size() <= PointTree::kLeaf) {
      std::sort(chosen.begin(), chosen.end());
      for (const std::uint32_t i : chosen) tree.points.add(from.at(i));
      return;
    }

    int axis = 0;
    (node.box.max - node.box.min).maxCoeff(&axis);
    const std::vector<double>& along = axis == 0 ? from.x : axis == 1 ? from.y : from.z;
    // Whole leaves in the first half, so that only the last leaf of all is not full.
    const std::size_t half = PointTree::leaf_count(chosen.size()) / 2 * PointTree::kLeaf;
    std::nth_element(chosen.begin(), chosen.begin() + half, chosen.end(), [&along](std::uint32_t i, std::uint32_t j) {
      return along[i] != along[j] ? along[i] < along[j] : i < j;  // no ties: the halves are the same everywhere
    });
    add(chosen.first(half));
    tree.nodes[number].second = static_cast<std::uint32_t>(tree.nodes.size());
    add(chosen.subspan(half));
  }
};

}  // namespace

PointTree::PointTree(const Points& from) {
  assert(from.size() <= std::size_t{1} << 31 && "points are numbered by 32 bits");
  if (from.size() == 0) return;
  const std::size_t leaves = leaf_count(from.size());
  for (auto* column : {&points.x, &points.y, &points.z}) column->reserve(leaves * kLeaf);
  nodes.reserve(2 * leaves - 1);
  std::vector<std::uint32_t> chosen(from.size());
  std::iota(chosen.begin(), chosen.end(), 0u);
  Builder{from, *this}.add(chosen);
  while (points.size() % kLeaf) points.add(Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace geometry
