// Binned surface-area splits (I. Wald, "On fast construction of SAH-based bounding volume hierarchies", 2007) along the
// axes of each node's own box, median splits where binning cannot help. The tree decides how fast an answer comes,
// never which.
#include "geometry/decision/bvh.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "geometry/vec.hpp"

namespace geometry {
namespace {

constexpr std::uint32_t kBins = 16;      // Wald's choice; more gained nothing
constexpr std::uint32_t kMaxDepth = 64;  // halving from there on bounds the depth, whatever the mesh

/// Half the surface of a box, up to a factor; 0 for an empty one.
double surface(const Box& box) {
  const Vec3 d = (box.max - box.min).cwiseMax(0);
  return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
}

/// Not less than x >= 0, or below it by an underflow, which geometry/decision/frames.cpp allows for.
float above(double x) { return static_cast<float>(x * (1 + 0x1p-22)); }

/// x rounded to a float. By way of memory: where several are rounded side by side and used as doubles again, GCC 12.2's
/// vectoriser loses the rounding.
double as_float(double x) {
  const volatile float rounded = static_cast<float>(x);
  return rounded;
}

class Builder {
 public:
  explicit Builder(const Mesh& mesh) : mesh_(mesh), items_(mesh.triangles.size()) {
    bvh_.order.resize(items_.size());
    std::iota(bvh_.order.begin(), bvh_.order.end(), 0u);
  }

  Bvh build() {
    add(0, static_cast<std::uint32_t>(items_.size()), 0);
    bvh_.nodes.shrink_to_fit();
    bvh_.bounds.shrink_to_fit();
    return std::move(bvh_);
  }

 private:
  /// A facet in the frame of the node at hand.
  struct Item {
    Box box;
    Vec3 centre;
  };

  /// Adds the node over order[first, last) and all below it. The depth is bounded: kMaxDepth + log2(#facets).
  void add(std::uint32_t first, std::uint32_t last, std::uint32_t depth) {
    const auto node = static_cast<std::uint32_t>(bvh_.nodes.size());
    bvh_.nodes.push_back({first, last - first, 0});
    bvh_.bounds.push_back(bound(std::span(bvh_.order).subspan(first, last - first)));
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

  /// Axes that may fit the facets, orthonormal floats: those of the mesh, those of the facets' second moments of area,
  /// and the latter turned to the mean normal, along which a smooth surface is thin.
  std::vector<Mat3> axes(std::span<const std::uint32_t> facets) const {
    std::vector<Mat3> out = {Mat3::Identity()};
    const auto offer = [&out](const Mat3& exact) {
      const Mat3 rounded = exact.unaryExpr(&as_float);
      if ((rounded.transpose() * rounded - Mat3::Identity()).squaredNorm() <= 0x1p-44) out.push_back(rounded);
    };
    const Vec3 origin = mesh_.vertices[mesh_.triangles[facets[0]][0]];
    Vec3 normal = Vec3::Zero(), mean = Vec3::Zero();
    Mat3 moments = Mat3::Zero();
    double area = 0;  // twice
    for (const std::uint32_t f : facets) {
      const auto& [i, j, k] = mesh_.triangles[f];
      const Vec3 p = mesh_.vertices[i] - origin, q = mesh_.vertices[j] - origin, r = mesh_.vertices[k] - origin;
      const Vec3 n = (q - p).cross(r - p), sum = p + q + r;
      const double twice = std::sqrt(dot(n, n));
      normal += n;
      mean += twice * sum;
      moments += twice * (p * p.transpose() + q * q.transpose() + r * r.transpose() + sum * sum.transpose());
      area += twice;
    }
    if (!(area > 1e-100 && area < 1e100)) return out;
    mean /= 3 * area;
    moments = moments / (12 * area) - mean * mean.transpose();
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(moments);
    if (!moments.allFinite() || solver.info() != Eigen::Success) return out;
    const Mat3 principal = solver.eigenvectors();  // by ascending moment
    offer(principal);
    const double length = std::sqrt(dot(normal, normal));
    if (!(length > 1e-3 * area)) return out;  // they cancel out
    normal /= length;
    const auto across = [&normal](const Vec3& d) -> Vec3 { return d - dot(d, normal) * normal; };
    Vec3 longest = across(principal.col(2));
    if (dot(longest, longest) < 0.01) longest = across(principal.col(1));
    longest /= std::sqrt(dot(longest, longest));
    Mat3 turned;
    turned << normal, longest, normal.cross(longest);
    offer(turned);
    return out;
  }

  /// A facet along a node's axes.
  Box along(const Mat3& axes, std::uint32_t facet) const {
    Box out;
    for (const std::uint32_t v : mesh_.triangles[facet]) {
      const Vec3& p = mesh_.vertices[v];
      out.add(Vec3(dot(axes.col(0), p), dot(axes.col(1), p), dot(axes.col(2), p)));
    }
    return out;
  }

  /// The box with the least surface of those that the axes give; leaves the facets along its axes in `items_`. Rounding
  /// is less than 16 u times the farthest vertex, u = 2^-53: part of what geometry/decision/frames.cpp allows for.
  Bvh::Bound bound(std::span<const std::uint32_t> facets) {
    const auto around = [&](const Mat3& some) {
      Box box;
      for (const std::uint32_t f : facets) box.add(along(some, f));
      return box;
    };
    const std::vector<Mat3> tried = axes(facets);
    Mat3 best = tried[0];
    Box box = around(best);
    for (std::size_t i = 1; i < tried.size(); ++i)
      if (const Box other = around(tried[i]); surface(other) < surface(box)) best = tried[i], box = other;
    for (const std::uint32_t f : facets) {
      Item& item = items_[f];
      item.box = along(best, f);
      item.centre = 0.5 * item.box.min + 0.5 * item.box.max;  // halved first: no overflow
    }
    Bvh::Bound out;
    const Vec3 middle = 0.5 * box.min + 0.5 * box.max;
    Vec3 centre;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) out.row[i][k] = static_cast<float>(best(i, k));
      centre[i] = as_float(dot(best.row(i), middle));
      out.row[i][3] = static_cast<float>(centre[i]);
    }
    for (int k = 0; k < 3; ++k) {
      const double at = dot(best.col(k), centre);
      out.half[k] = above(std::fmax(box.max[k] - at, at - box.min[k]));
    }
    out.half[3] = (out.half[0] + out.half[1]) + out.half[2];
    return out;
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

  const Mesh& mesh_;
  std::vector<Item> items_;  // #facets
  Bvh bvh_;
};

}  // namespace

Bvh build_bvh(const Mesh& mesh) {
  assert(!mesh.triangles.empty() && "a mesh has a facet");
  return Builder(mesh).build();
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
