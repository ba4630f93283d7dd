// Each margin against exact arithmetic: it holds, and by how much it is used.
#include "geometry/decision/frames.hpp"

#include <CGAL/Gmpq.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "geometry/meshes/shapes.hpp"
#include "tests/support/adversary.hpp"

namespace {

using namespace geometry;
using adversary::Random;
using Exact = CGAL::Gmpq;

/// A mesh that owns what a Body refers to.
struct Owned {
  Mesh mesh;
  Bvh bvh = build_bvh(mesh);
  Enclosure around = enclosure(mesh);
  Placement at{};

  explicit Owned(Mesh m) : mesh(std::move(m)) {}
  Body at_pose(const Pose& pose) {
    at = placement(around, pose);
    return {mesh, bvh, around, at};
  }
};

Exact dot(const Vec3& d, const Vec3& p) {
  Exact sum = 0;
  for (int k = 0; k < 3; ++k) sum += Exact(d[k]) * Exact(p[k]);
  return sum;
}

/// A pose up to a million sizes away: farther out no margin is useful.
Pose near_pose(Random& random, double size) {
  const double far = random.below(2) ? std::pow(10, 6 * random.real()) : 0;
  return {adversary::quaternion(random), far * size * random.point()};
}

Mesh usual_mesh(Random& random, double scale) {
  Mesh mesh = random.below(3) ? sphere("ball", 1, 2) : box("box", Vec3(1, 0.01, 3));
  for (Vec3& v : mesh.vertices) v = scale * (v + (random.below(4) ? 0 : 0.3) * random.point());
  return mesh;
}

// The gap along a direction, as computed, against the exact one between the very world vertices.
TEST(Frames, GapsAlongDirectionsAreWithinTheirMargin) {
  Random random;
  double used = 0;
  int asked = 0;
  for (int i = 0; i < 800; ++i) {
    const double scale = std::pow(10, 12 * random.real());
    Owned a(usual_mesh(random, scale)), b(usual_mesh(random, scale * (random.below(3) ? 1 : 0.01)));
    const Pose pose = near_pose(random, scale);
    const Body a_body = a.at_pose(pose);
    const Body b_body = b.at_pose({adversary::quaternion(random), pose.t + 3 * scale * random.point()});
    const Margin close = margin(a_body, b_body);
    if (!close.useful) continue;
    ++asked;
    Vec3 d = random.point();
    d /= d.norm();
    for (double& x : d) x = static_cast<float>(x);
    std::uint64_t operations = 0;
    const Slab slab = find_slab(a_body, b_body, d, close, operations);
    bool first = true;
    Exact top = 0, bottom = 0;
    for (const Vec3& v : a.mesh.vertices) {
      const Exact along = dot(d, to_world(a.at.r, a.at.t, v));
      if (first || along > top) top = along;
      first = false;
    }
    first = true;
    for (const Vec3& v : b.mesh.vertices) {
      const Exact along = dot(d, to_world(b.at.r, b.at.t, v));
      if (first || along < bottom) bottom = along;
      first = false;
    }
    const Exact error = CGAL::abs(Exact(slab.gap) - (bottom - top));
    used = std::max(used, CGAL::to_double(Exact(error / Exact(close.fine))));
    ASSERT_LE(error, Exact(close.fine)) << "seed " << adversary::kSeed << ", case " << i;
    ASSERT_EQ(slab.apart, slab.gap > close.fine);
  }
  std::printf("the margin of planes is used to %.2f %% in %d cases\n", 100 * used, asked);
  EXPECT_GT(asked, 400);
  EXPECT_GE(used, 1e-3) << "a margin a thousand times smaller would do: the poses are no adversaries";
}

/// A flat grid of n x n squares across z.
Mesh grid(std::uint32_t n) {
  Mesh mesh;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j) mesh.vertices.emplace_back(1.0 * i / n - 0.5, 1.0 * j / n - 0.5, 0);
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t v = i * (n + 1) + j;
      mesh.triangles.push_back({v, v + 1, v + n + 1});
      mesh.triangles.push_back({v + 1, v + n + 2, v + n + 1});
    }
  return mesh;
}

// Along the normal of a turned plate all vertices are equally far but for the last digits of doubles: bounds in floats
// without margin would leave out nearly every node.
TEST(Frames, SupportsAreTheGreatestOfAllDotProducts) {
  Random random;
  for (int i = 0; i < 100; ++i) {
    Mesh mesh = i % 4 ? grid(8) : sphere("ball", 1, 4);
    const Mat3 turn = rotation(random.turn());
    const double scale = std::pow(10, 12 * random.real());
    const Vec3 offset = random.below(2) ? random.point() : Vec3::Zero();
    for (Vec3& v : mesh.vertices) v = scale * (turn * v + offset);
    Owned a(mesh);
    Vec3 d = i % 4 ? Vec3(turn.col(2)) : random.point();
    d /= d.norm();
    double greatest = -std::numeric_limits<double>::infinity();
    for (const Vec3& v : a.mesh.vertices)
      greatest = std::max(greatest, (d.x() * v.x() + d.y() * v.y()) + d.z() * v.z());
    std::uint64_t operations = 0;
    EXPECT_EQ(support(a.at_pose({}), d, operations).dot, greatest) << "seed " << adversary::kSeed << ", case " << i;
  }
}

// World vertices beyond the bounding sphere about the computed middle.
TEST(Frames, BoundingSpheresHoldTheWorldVerticesWithinTheirMargin) {
  Random random;
  double used = -1;
  for (int i = 0; i < 800; ++i) {
    const double scale = std::pow(10, 12 * random.real());
    Owned a(usual_mesh(random, scale));
    const Body body = a.at_pose(near_pose(random, scale));
    const Margin close = margin(body, body);
    if (!close.useful) continue;
    const Exact share = Exact(close.fine) / 2, radius = Exact(a.around.radius);
    for (const Vec3& v : a.mesh.vertices) {
      const Vec3 world = to_world(a.at.r, a.at.t, v);
      Exact square = 0;
      for (int k = 0; k < 3; ++k)
        square += (Exact(world[k]) - Exact(a.at.middle[k])) * (Exact(world[k]) - Exact(a.at.middle[k]));
      ASSERT_LE(square, (radius + share) * (radius + share)) << "seed " << adversary::kSeed << ", case " << i;
      // square = (radius + x)^2, where x is small
      used = std::max(used, CGAL::to_double(Exact((square - radius * radius) / (2 * radius * share))));
    }
  }
  std::printf("the margin of bounding spheres is used to %.2f %%\n", 100 * used);
  EXPECT_GE(used, 1e-3) << "a margin a thousand times smaller would do: the poses are no adversaries";
}

/// The vertices of the facets below a node.
std::vector<Vec3> vertices_of(const Owned& owned, std::uint32_t node) {
  const Bvh::Node& n = owned.bvh.nodes[node];
  std::vector<Vec3> out;
  for (std::uint32_t k = n.first; k < n.first + n.count; ++k)
    for (const std::uint32_t v : owned.mesh.triangles[owned.bvh.order[k]]) out.push_back(owned.mesh.vertices[v]);
  if (n.count) return out;
  out = vertices_of(owned, node + 1);
  const std::vector<Vec3> second = vertices_of(owned, n.second);
  out.insert(out.end(), second.begin(), second.end());
  return out;
}

/// The axes of a node's box, in the mesh's frame, as columns.
Mat3 axes_of(const Owned& owned, std::uint32_t node) {
  Mat3 out;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) out(i, k) = owned.bvh.bounds[node].row[i][k];
  return out;
}

// One vertex of either of two nodes in one place of the world, the farthest of a's along some axis that the test asks
// and the farthest of b's against it: a test without margin would separate one half of them.
TEST(Frames, NodesThatTouchAreNeverSeparated) {
  Random random;
  double used[3] = {};  // along faces of a, of b, along edges
  int asked = 0;
  for (int i = 0; i < 7500; ++i) {
    const double scale = std::pow(10, 12 * random.real());
    const Mesh a_mesh = i % 2 ? adversary::mesh(random) : usual_mesh(random, scale);
    Mesh b_mesh = i % 3 ? adversary::mesh(random) : usual_mesh(random, scale);
    const Enclosure around = enclosure(a_mesh), other_around = enclosure(b_mesh);
    if (around.radius < 1e-15 || other_around.radius < 1e-15 || around.reach > 1e15 || other_around.reach > 1e15)
      continue;
    const double ratio = around.radius / other_around.radius * (random.below(3) ? 1 : 0.01);
    for (Vec3& v : b_mesh.vertices) v *= ratio;
    Owned a(a_mesh), b(b_mesh);
    const std::array<NodePair, 2> pairs = {NodePair{static_cast<std::uint32_t>(random.below(a.bvh.nodes.size())),
                                                    static_cast<std::uint32_t>(random.below(b.bvh.nodes.size()))},
                                           NodePair{0, 0}};
    Pose pose = near_pose(random, a.around.reach), other{adversary::quaternion(random), pose.t};
    const Mat3 ra = rotation(pose.q), rb = rotation(other.q);
    const Mat3 of_a = ra * axes_of(a, pairs[0].a), of_b = rb * axes_of(b, pairs[0].b);
    const int k = static_cast<int>(random.below(15)), kind = k < 3 ? 0 : k < 6 ? 1 : 2;
    Vec3 d = kind == 0   ? Vec3(of_a.col(k))
             : kind == 1 ? Vec3(of_b.col(k - 3))
                         : Vec3(of_a.col((k - 6) / 3).cross(of_b.col((k - 6) % 3)));
    if (random.below(2)) d = -d;
    const auto farthest = [](const std::vector<Vec3>& vertices, const Vec3& local) {
      return *std::ranges::max_element(vertices, {}, [&](const Vec3& v) { return local.dot(v); });
    };
    const Vec3 x = farthest(vertices_of(a, pairs[0].a), ra.transpose() * d);
    const Vec3 y = farthest(vertices_of(b, pairs[0].b), rb.transpose() * -d);
    other.t = to_world(ra, pose.t, x) - to_world(rb, Vec3::Zero(), y);
    const Body a_body = a.at_pose(pose), b_body = b.at_pose(other);
    const Margin close = margin(a_body, b_body);
    if (!close.useful) continue;
    ++asked;
    EXPECT_FALSE(spheres_apart(a_body, b_body, close)) << "seed " << adversary::kSeed << ", case " << i;
    const Relative relative(a_body, b_body, close);
    const std::array<float, 2> overlap = relative.overlap(pairs);
    ASSERT_GE(overlap[0], 0) << "seed " << adversary::kSeed << ", case " << i << ", axis " << k;
    ASSERT_GE(overlap[1], 0) << "seed " << adversary::kSeed << ", case " << i;
    EXPECT_EQ(relative.overlap({pairs[1], pairs[0]}), (std::array{overlap[1], overlap[0]}));
    used[kind] = std::max(used[kind], 1 - double{overlap[0]} / double{close.coarse});
  }
  std::printf("the margin of nodes is used to %.2f, %.2f and %.2f %% along the three kinds of axes in %d cases\n",
              100 * used[0], 100 * used[1], 100 * used[2], asked);
  EXPECT_GT(asked, 4000);
  for (const double share : used)
    EXPECT_GE(share, 1e-3) << "a margin a thousand times smaller would do: the poses are no adversaries";
}

// Leaves of one plate that share a vertex, as if of two bodies in one pose: nothing lies between their frames, so that
// the margin comes from their reach alone.
TEST(Frames, LeavesThatShareAVertexAreNeverSeparated) {
  Random random;
  for (int i = 0; i < 20; ++i) {
    Mesh mesh = grid(6);
    const Mat3 turn = rotation(random.turn());
    const Vec3 offset = random.point();
    for (Vec3& v : mesh.vertices) v = turn * v + offset;
    Owned a(mesh);
    const Body body = a.at_pose({random.turn(), random.below(2) ? random.point() : Vec3::Zero()});
    const Relative relative(body, body, margin(body, body));
    const auto share = [&](std::uint32_t m, std::uint32_t n) {
      for (const Vec3& v : vertices_of(a, m))
        for (const Vec3& w : vertices_of(a, n))
          if (v == w) return true;
      return false;
    };
    for (std::uint32_t m = 0; m < a.bvh.nodes.size(); ++m)
      for (std::uint32_t n = 0; n < a.bvh.nodes.size(); ++n)
        if (a.bvh.nodes[m].count && a.bvh.nodes[n].count && share(m, n)) {
          ASSERT_GE(relative.overlap({NodePair{m, n}, NodePair{n, m}})[0], 0)
              << "seed " << adversary::kSeed << ", case " << i << ", nodes " << m << " and " << n;
        }
  }
}

// Unit cubes a thousandth apart along one axis and overlapping along all others: a test without that axis would not
// separate them.
TEST(Frames, NodesApartAlongOneAxisAloneAreSeparated) {
  Random random;
  Owned a(box("a", Vec3(1, 1, 1))), b(box("b", Vec3(1, 1, 1)));
  int separated[15] = {};
  for (int i = 0; i < 3000; ++i) {
    const Quaternion q_a = adversary::quaternion(random), q_b = adversary::quaternion(random);
    const Mat3 r_a = rotation(q_a), r_b = rotation(q_b);
    const auto axis = [&](int k) -> Vec3 {
      return k < 3   ? Vec3(r_a.col(k))
             : k < 6 ? Vec3(r_b.col(k - 3))
                     : Vec3(r_a.col((k - 6) / 3).cross(r_b.col((k - 6) % 3)));
    };
    // How far both cubes reach along an axis, and how far apart t puts them.
    const auto gap = [&](int k, const Vec3& t) {
      const Vec3 d = axis(k);
      if (d.norm() < 0.1) return -1.0;  // parallel edges
      return std::fabs(d.dot(t)) / d.norm() -
             0.5 * ((r_a.transpose() * d).cwiseAbs().sum() + (r_b.transpose() * d).cwiseAbs().sum()) / d.norm();
    };
    const int k = static_cast<int>(random.below(15));
    if (axis(k).norm() < 0.1) continue;
    const Vec3 d = axis(k).normalized(), across = d.cross(random.point());
    const double touching = 1 - gap(k, d);  // the distance along d at which the cubes' reaches meet
    const Vec3 t = random.real() * across + (touching + 1e-3) * d;
    bool alone = true;
    for (int other = 0; other < 15; ++other) alone = alone && (other == k || gap(other, t) < -1e-3);
    if (!alone) continue;
    const Body a_body = a.at_pose({q_a, Vec3::Zero()}), b_body = b.at_pose({q_b, random.below(2) ? t : Vec3(-t)});
    EXPECT_LT(Relative(a_body, b_body, margin(a_body, b_body)).overlap({NodePair{0, 0}, NodePair{0, 0}})[1], 0)
        << "axis " << k;
    ++separated[k];
  }
  for (int k = 0; k < 15; ++k) EXPECT_GT(separated[k], 5) << "axis " << k;
}

// Where a margin would not be small against the bodies, or a bound may not hold, there is none.
TEST(Frames, NoMarginIsUsefulAtTheEndsOfTheRange) {
  const auto useful = [](double scale, const Pose& pose) {
    Mesh mesh = sphere("ball", 1, 2);
    for (Vec3& v : mesh.vertices) v *= scale;
    Owned a(mesh);
    const Body body = a.at_pose(pose);
    return margin(body, body).useful;
  };
  EXPECT_TRUE(useful(1, {}));
  EXPECT_TRUE(useful(1e-12, {}));
  EXPECT_TRUE(useful(1e12, {}));
  EXPECT_FALSE(useful(1, {{}, Vec3(1e12, 0, 0)}));
  EXPECT_FALSE(useful(1e-30, {}));
  EXPECT_FALSE(useful(1e-310, {}));
  EXPECT_FALSE(useful(1e30, {}));
  EXPECT_FALSE(useful(1e306, {}));
  EXPECT_FALSE(useful(1, {{2, 0, 0, 0}, Vec3::Zero()}));
  EXPECT_FALSE(useful(1, {{}, Vec3(std::numeric_limits<double>::infinity(), 0, 0)}));

  Mesh astray = sphere("ball", 1, 2);
  for (Vec3& v : astray.vertices) v.x() += 2e5;
  Owned a(astray);
  const Body body = a.at_pose({});
  EXPECT_FALSE(margin(body, body).useful) << "coarse would be six radii";
}

}  // namespace
