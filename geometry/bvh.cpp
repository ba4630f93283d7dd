// Binned surface-area splits (I. Wald, "On fast construction of SAH-based bounding volume hierarchies", 2007), median
// splits where binning cannot help. The tree decides how fast an answer comes, never which.
#include "geometry/bvh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace geometry {
namespace {

constexpr std::uint32_t kBins = 16;      // Wald's choice; more gained nothing
constexpr std::uint32_t kMaxDepth = 64;  // halving from there on bounds the depth, whatever the mesh

struct Item {
  Box box;
  Vec3 centre;
};

/// Half the surface of a box, up to a factor; 0 for an empty one.
double surface(const Box& box) {
  const Vec3 d = (box.max - box.min).cwiseMax(0);
  return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
}

class Builder {
 public:
  explicit Builder(const Mesh& mesh) : items_(mesh.triangles.size()) {
    for (std::size_t i = 0; i < items_.size(); ++i) {
      for (const std::uint32_t v : mesh.triangles[i]) items_[i].box.add(mesh.vertices[v]);
      items_[i].centre = 0.5 * items_[i].box.min + 0.5 * items_[i].box.max;  // halved first: no overflow
    }
    bvh_.order.resize(items_.size());
    std::iota(bvh_.order.begin(), bvh_.order.end(), 0u);
  }

  Bvh build() {
    add(0, static_cast<std::uint32_t>(items_.size()), 0);
    return std::move(bvh_);
  }

 private:
  /// Adds the node over order[first, last) and all below it. The depth is bounded: kMaxDepth + log2(#facets).
  void add(std::uint32_t first, std::uint32_t last, std::uint32_t depth) {
    const auto node = static_cast<std::uint32_t>(bvh_.nodes.size());
    bvh_.nodes.push_back({first, last - first, 0});
    if (last - first <= Bvh::kLeafSize) {
      std::sort(bvh_.order.begin() + first, bvh_.order.begin() + last);
      return;
    }
    const std::uint32_t middle = split(first, last, depth);
    bvh_.nodes[node].count = 0;
    add(first, middle, depth + 1);
    bvh_.nodes[node].second = static_cast<std::uint32_t>(bvh_.nodes.size());
    add(middle, last, depth + 1);
  }

  /// Orders [first, last) in two parts, neither empty, and returns where the second begins.
  std::uint32_t split(std::uint32_t first, std::uint32_t last, std::uint32_t depth) {
    Box centres;
    for (std::uint32_t i = first; i < last; ++i) centres.add(items_[bvh_.order[i]].centre);
    int axis = 0;
    const double extent = (centres.max - centres.min).maxCoeff(&axis);
    const double low = centres.min[axis];
    const auto begin = bvh_.order.begin() + first, end = bvh_.order.begin() + last;

    const double scale = kBins / extent;
    if (extent > 0 && scale > 0 && scale <= std::numeric_limits<double>::max() && depth < kMaxDepth) {
      const auto bin = [&](std::uint32_t facet) {
        return std::min(kBins - 1, static_cast<std::uint32_t>((items_[facet].centre[axis] - low) * scale));
      };
      if (const std::uint32_t best = best_split(begin, end, bin)) {
        const auto middle = std::partition(begin, end, [&](std::uint32_t facet) { return bin(facet) < best; });
        return static_cast<std::uint32_t>(middle - bvh_.order.begin());
      }
    }
    const auto middle = begin + (end - begin) / 2;
    std::nth_element(begin, middle, end, [&](std::uint32_t f, std::uint32_t g) {
      const double x = items_[f].centre[axis], y = items_[g].centre[axis];
      return x != y ? x < y : f < g;
    });
    return static_cast<std::uint32_t>(middle - bvh_.order.begin());
  }

  /// The bin before which to split, at least cost and with facets on both sides; 0 when there is none.
  template <class Iterator, class BinOf>
  std::uint32_t best_split(Iterator begin, Iterator end, const BinOf& bin) const {
    struct Bin {
      Box box;
      std::uint32_t count = 0;
    };
    std::array<Bin, kBins> bins;
    for (auto i = begin; i != end; ++i) {
      Bin& into = bins[bin(*i)];
      into.box.add(items_[*i].box);
      ++into.count;
    }
    std::array<double, kBins> right_cost{};
    std::array<std::uint32_t, kBins> right_count{};
    Bin right;
    for (std::uint32_t k = kBins; k-- > 1;) {
      right.box.add(bins[k].box);
      right.count += bins[k].count;
      right_cost[k] = right.count * surface(right.box);
      right_count[k] = right.count;
    }
    std::uint32_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    Bin left;
    for (std::uint32_t k = 1; k < kBins; ++k) {
      left.box.add(bins[k - 1].box);
      left.count += bins[k - 1].count;
      if (left.count == 0 || right_count[k] == 0) continue;
      const double cost = left.count * surface(left.box) + right_cost[k];
      if (cost < least) {
        least = cost;
        best = k;
      }
    }
    return best;
  }

  std::vector<Item> items_;  // #facets
  Bvh bvh_;
};

/// Not less than x >= 0, unless that underflows: geometry/frames.hpp has no use for such small meshes.
float above(double x) { return static_cast<float>(x * (1 + 0x1p-22)); }

/// The unit normal of the facets, weighted by area; 0 where they cancel out or a length leaves the range of floats.
Vec3 mean_normal(const Mesh& mesh, std::span<const std::uint32_t> facets) {
  Vec3 sum = Vec3::Zero();
  for (const std::uint32_t f : facets) {
    const auto& [i, j, k] = mesh.triangles[f];
    sum += (mesh.vertices[j] - mesh.vertices[i]).cross(mesh.vertices[k] - mesh.vertices[i]);
  }
  const double length = std::sqrt((sum.x() * sum.x() + sum.y() * sum.y()) + sum.z() * sum.z());
  if (!(length > 1e-100 && length < 1e100)) return Vec3::Zero();
  return sum / length;
}

/// The bound of facets whose box is known. The dot products below are off by less than 4 u |v|, u = 2^-53: part of what
/// geometry/frames.hpp allows for.
Bvh::Bound bound(const Mesh& mesh, std::span<const std::uint32_t> facets, const Box& box) {
  Bvh::Bound out;
  const Vec3 normal = mean_normal(mesh, facets);
  for (int k = 0; k < 3; ++k) {
    out.centre[k] = static_cast<float>(0.5 * box.min[k] + 0.5 * box.max[k]);
    out.half[k] = above(std::fmax(box.max[k] - out.centre[k], out.centre[k] - box.min[k]));
    out.normal[k] = static_cast<float>(normal[k]);
  }
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const std::uint32_t f : facets)
    for (const std::uint32_t v : mesh.triangles[f]) {
      const Vec3& p = mesh.vertices[v];
      const double along = (out.normal[0] * p.x() + out.normal[1] * p.y()) + out.normal[2] * p.z();
      low = std::fmin(low, along);
      high = std::fmax(high, along);
    }
  out.middle = static_cast<float>(0.5 * low + 0.5 * high);
  out.thickness = above(std::fmax(high - out.middle, out.middle - low));
  return out;
}

}  // namespace

Bvh build_bvh(const Mesh& mesh) {
  assert(!mesh.triangles.empty() && "a mesh has a facet");
  Bvh bvh = Builder(mesh).build();
  std::vector<Box> boxes(bvh.nodes.size());
  refit(bvh, mesh, mesh.vertices, boxes);
  std::vector<std::uint32_t> last(bvh.nodes.size());  // a node's facets are order[first, last)
  bvh.bounds.resize(bvh.nodes.size());
  for (std::size_t i = bvh.nodes.size(); i-- > 0;) {
    const Bvh::Node& node = bvh.nodes[i];
    last[i] = node.count ? node.first + node.count : last[node.second];
    bvh.bounds[i] = bound(mesh, std::span(bvh.order).subspan(node.first, last[i] - node.first), boxes[i]);
  }
  return bvh;
}

void refit(const Bvh& bvh, const Mesh& mesh, std::span<const Vec3> world, std::span<Box> boxes) {
  assert(world.size() == mesh.vertices.size() && "one world vertex per vertex");
  assert(boxes.size() == bvh.nodes.size() && "one box per node");
  for (std::size_t i = bvh.nodes.size(); i-- > 0;) {
    const Bvh::Node& node = bvh.nodes[i];
    Box box;
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k)
      for (const std::uint32_t v : mesh.triangles[bvh.order[k]]) box.add(world[v]);
    if (node.count == 0) {
      box = boxes[i + 1];
      box.add(boxes[node.second]);
    }
    boxes[i] = box;
  }
}

}  // namespace geometry
