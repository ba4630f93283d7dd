#include "geometry/decision/bvh.hpp"

#include <CGAL/Mpzf.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "geometry/meshes/shapes.hpp"

namespace {

using namespace geometry;

/// Facets anywhere in the unit cube, some of them without area.
Mesh soup(std::size_t facets, unsigned seed) {
  std::mt19937_64 bits(seed);
  const auto real = [&] { return static_cast<double>(static_cast<std::int64_t>(bits())) * 0x1p-63; };
  Mesh mesh;
  for (std::uint32_t i = 0; i < 3 * facets; ++i) mesh.vertices.emplace_back(real(), real(), real());
  for (std::uint32_t i = 0; i < facets; ++i) mesh.triangles.push_back({3 * i, 3 * i + 1, i % 5 ? 3 * i + 2 : 3 * i});
  return mesh;
}

Mesh copies_of_one_facet(std::size_t facets) {
  Mesh mesh;
  mesh.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  mesh.triangles.assign(facets, {0, 1, 2});
  return mesh;
}

/// Facets ever smaller towards the origin: equal bins put all but a few into one.
Mesh geometric_row(std::size_t facets) {
  Mesh mesh;
  double x = 1;
  for (std::uint32_t i = 0; i < facets; ++i, x *= 0.5) {
    mesh.vertices.insert(mesh.vertices.end(), {Vec3(x, 0, 0), Vec3(x, x, 0), Vec3(x, 0, x)});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

/// Walks the tree; returns its depth.
int expect_tree(const Bvh& bvh, std::uint32_t node, std::vector<int>& seen, std::vector<int>& facet_seen) {
  if (node >= bvh.nodes.size() || seen[node]++) {
    ADD_FAILURE() << "node " << node << " is outside or reached twice";
    return 0;
  }
  const Bvh::Node& n = bvh.nodes[node];
  if (n.count) {
    for (std::uint32_t k = n.first; k < n.first + n.count; ++k) ++facet_seen[bvh.order[k]];
    return 1;
  }
  EXPECT_GT(n.second, node + 1) << "children come after their parent";
  return 1 + std::max(expect_tree(bvh, node + 1, seen, facet_seen), expect_tree(bvh, n.second, seen, facet_seen));
}

void expect_whole(const Mesh& mesh, int most_deep) {
  const Bvh bvh = build_bvh(mesh);
  std::vector<int> seen(bvh.nodes.size()), facet_seen(mesh.triangles.size());
  EXPECT_LE(expect_tree(bvh, 0, seen, facet_seen), most_deep);
  EXPECT_TRUE(std::ranges::all_of(seen, [](int n) { return n == 1; })) << "every node once";
  EXPECT_TRUE(std::ranges::all_of(facet_seen, [](int n) { return n == 1; })) << "every facet in one leaf";
  std::vector<std::uint32_t> order = bvh.order, all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  std::ranges::sort(order);
  EXPECT_EQ(order, all);
}

TEST(Bvh, HoldsEveryFacetOnce) {
  expect_whole(soup(1, 1), 1);
  for (const std::size_t facets : {2, 3, 4, 5, 6, 7, 9, 60, 1000}) expect_whole(soup(facets, 1), 40);
  expect_whole(sphere("s", 1, 16), 40);
  expect_whole(box("b", Vec3(1, 2, 3)), 10);
}

TEST(Bvh, HoldsFacetsThatLieAllInOnePlace) {
  expect_whole(copies_of_one_facet(5), 3);
  expect_whole(copies_of_one_facet(1000), 10);  // halved: 1000 / 2^8 < 4
}

// 1000 facets within 2^-1000: bins peel off a few at a time, until halving bounds the depth.
TEST(Bvh, DepthStaysBoundedOnUnevenMeshes) { expect_whole(geometric_row(1000), 64 + 10); }

TEST(Bvh, HoldsFacetsAtTheEndsOfTheRangeOfDoubles) {
  for (const double scale : {1e308, 1e-320, 1e200, 0.0}) {
    Mesh mesh = soup(100, 2);
    for (Vec3& v : mesh.vertices) v *= scale;
    expect_whole(mesh, 40);
  }
}

TEST(Bvh, IsTheSameEveryTime) {
  const Mesh mesh = soup(500, 3);
  const Bvh a = build_bvh(mesh), b = build_bvh(mesh);
  EXPECT_EQ(a.order, b.order);
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    EXPECT_EQ(a.nodes[i].first, b.nodes[i].first);
    EXPECT_EQ(a.nodes[i].count, b.nodes[i].count);
    EXPECT_EQ(a.nodes[i].second, b.nodes[i].second);
  }
}

/// The facets below a node.
void collect(const Bvh& bvh, std::uint32_t node, std::vector<std::uint32_t>& facets) {
  const Bvh::Node& n = bvh.nodes[node];
  for (std::uint32_t k = n.first; k < n.first + n.count; ++k) facets.push_back(bvh.order[k]);
  if (n.count) return;
  collect(bvh, node + 1, facets);
  collect(bvh, n.second, facets);
}

TEST(Bvh, RefittedBoxesAreTheLeastAndGreatestDoublesOfTheirFacets) {
  for (const Mesh& mesh : {soup(1, 4), soup(77, 4), sphere("s", 1, 6), box("b", Vec3(1, 2, 3))}) {
    const Bvh bvh = build_bvh(mesh);
    const Pose pose{normalised({0.3, -0.2, 0.5, 0.7}), Vec3(1e3, -2, 0.1)};
    std::vector<Vec3> world(mesh.vertices.size());
    to_world(pose, mesh.vertices, world);
    std::vector<Box> boxes(bvh.nodes.size());
    refit(bvh, mesh, world, boxes);
    for (std::uint32_t i = 0; i < bvh.nodes.size(); ++i) {
      std::vector<std::uint32_t> facets;
      collect(bvh, i, facets);
      for (int axis = 0; axis < 3; ++axis) {
        double low = 1e300, high = -1e300;
        for (const std::uint32_t f : facets)
          for (const std::uint32_t v : mesh.triangles[f]) {
            low = std::min(low, world[v][axis]);
            high = std::max(high, world[v][axis]);
          }
        ASSERT_EQ(boxes[i].min[axis], low);
        ASSERT_EQ(boxes[i].max[axis], high);
      }
    }
  }
}

// Two million take some 7 s.
TEST(Bvh, HoldsTensOfThousandsOfFacets) { expect_whole(sphere("s", 1, 110), 60); }

// Every vertex of every node, in exact arithmetic: |axis . (v - centre)| <= half, but for the rounding that
// geometry/decision/frames.cpp allows for, and axes as orthonormal as it takes them for.
TEST(Bvh, BoundsHoldTheVerticesOfTheirNodes) {
  using Exact = CGAL::Mpzf;
  Mesh flat = soup(40, 5);
  for (Vec3& v : flat.vertices) v = Vec3(v.x(), v.x() + 1e-9 * v.y(), -v.x());
  for (const Mesh& mesh : {soup(100, 3), sphere("s", 2, 4), copies_of_one_facet(9), box("b", Vec3(1e-9, 1, 1e6)), flat,
                           torus_knot("k", 3, 0.5, 16, 8, 2, 3)}) {
    const Bvh bvh = build_bvh(mesh);
    double reach = 0;
    for (const Vec3& v : mesh.vertices) reach = std::max(reach, v.norm());
    ASSERT_EQ(bvh.bounds.size(), bvh.nodes.size());
    for (std::uint32_t i = 0; i < bvh.nodes.size(); ++i) {
      const Bvh::Bound& bound = bvh.bounds[i];
      Mat3 axes;
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l) axes(k, l) = bound.row[k][l];
      EXPECT_LE((axes.transpose() * axes - Mat3::Identity()).norm(), 0x1p-22);
      EXPECT_EQ(bound.half[3], (bound.half[0] + bound.half[1]) + bound.half[2]);
      std::vector<std::uint32_t> facets;
      collect(bvh, i, facets);
      for (const std::uint32_t f : facets)
        for (const std::uint32_t v : mesh.triangles[f])
          for (int k = 0; k < 3; ++k) {
            Exact along = 0;
            for (int l = 0; l < 3; ++l)
              along = along +
                      Exact(double{bound.row[l][k]}) * (Exact(mesh.vertices[v][l]) - Exact(double{bound.row[l][3]}));
            ASSERT_LE(CGAL::abs(along), Exact(double{bound.half[k]}) + Exact(16 * 0x1p-53 * reach));
          }
    }
  }
}

// A long bar across the mesh's axes, and patches of a sphere: along the mesh's axes their boxes would be far larger.
TEST(Bvh, BoxesLieAlongTheirFacets) {
  Mesh bar = box("bar", Vec3(10, 0.1, 0.1));
  const Mat3 r = rotation(normalised({0.8, 0.1, 0.4, -0.3}));
  for (Vec3& v : bar.vertices) v = r * v;
  const Bvh::Bound whole = build_bvh(bar).bounds[0];
  std::array<float, 3> half = {whole.half[0], whole.half[1], whole.half[2]};
  std::ranges::sort(half);
  EXPECT_NEAR(half[2], 5, 1e-3);
  EXPECT_LE(half[1], 0.05 * std::sqrt(2) + 1e-3) << "the circle around the bar's section";

  // A patch of half width w on a unit sphere is w^2 / 2 high. Its box is that of least surface, not the thinnest: near
  // the mesh's axes it may be that of the mesh.
  const Bvh ball = build_bvh(sphere("s", 1, 32));
  int small = 0, thin = 0;
  for (const Bvh::Bound& bound : ball.bounds) {
    const auto [least, most] = std::minmax({bound.half[0], bound.half[1], bound.half[2]});
    if (most > 0.3f) continue;
    ++small;
    thin += least <= 0.5f * most * most + 1e-6f;
  }
  EXPECT_GT(small, 1000);
  EXPECT_GT(thin, 0.9 * small);
}

// All bodies of a shape share these; what a body of its own takes is its placement and box.
TEST(Bvh, TakesUnder200BytesATriangleWithItsMesh) {
  for (const Mesh& mesh : {sphere("s", 1, 16), sphere("s", 1, 64), soup(5000, 4)}) {
    const Bvh bvh = build_bvh(mesh);
    const auto bytes = [](const auto& column) { return column.capacity() * sizeof column[0]; };
    const std::size_t mesh_bytes = bytes(mesh.vertices) + bytes(mesh.triangles);
    const std::size_t sum = mesh_bytes + bytes(bvh.nodes) + bytes(bvh.bounds) + bytes(bvh.order);
    const double each = static_cast<double>(sum) / static_cast<double>(mesh.triangles.size());
    RecordProperty(mesh.name + std::to_string(mesh.triangles.size()), std::to_string(each));
    EXPECT_LT(each, 200);
    EXPECT_GT(each, 40) << "a triangle, its part of the vertices and its place in the order alone take this";
  }
}

}  // namespace
