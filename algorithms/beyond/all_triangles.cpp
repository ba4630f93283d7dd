// Boxes are the least and greatest of the very numbers that the tests see, and those of nodes of the boxes in them:
// what the tree rejects has no two facets whose boxes touch.
#include "algorithms/beyond/all_triangles.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <type_traits>

#include "algorithms/beyond/triangle_tests.hpp"
#include "algorithms/contract/prefilter.hpp"
#include "geometry/decision/bvh.hpp"

namespace algorithms {
namespace {

using geometry::Facet;

constexpr char kTest[] = "test", kPrecision[] = "precision", kSearch[] = "search";

/// The facets of a mesh in an order in which every node of a tree has a range of them. The first child is the next
/// node; a leaf has no second one.
struct Tree {
  struct Node {
    std::uint32_t first = 0, last = 0, second = 0;
  };
  static constexpr std::uint32_t kLeaf = 4;  // facets at most; 2 and 8 take longer
  std::vector<Node> nodes;
  std::vector<Facet> facets;

  explicit Tree(const geometry::Mesh& mesh) {
    const geometry::Bvh bvh = geometry::build_bvh(mesh);
    facets.reserve(mesh.triangles.size());
    for (const std::uint32_t f : bvh.order) facets.push_back(mesh.triangles[f]);
    std::vector<Node> fine(bvh.nodes.size());
    for (std::size_t i = fine.size(); i-- > 0;) {  // children come after their parent
      const auto& [first, count, second] = bvh.nodes[i];
      fine[i] = count ? Node{first, first + count, 0} : Node{fine[i + 1].first, fine[second].last, second};
    }
    nodes.reserve(fine.size());
    add(fine, 0);
    nodes.shrink_to_fit();
  }

  static std::uint64_t bytes(std::uint64_t facets) {
    return facets * sizeof(Facet) + node_count(facets) * sizeof(Node);
  }

  /// About: measured.
  static std::uint64_t node_count(std::uint64_t facets) { return 1 + 7 * facets / 10; }

 private:
  void add(const std::vector<Node>& fine, std::uint32_t from) {
    const std::size_t mine = nodes.size();
    nodes.push_back({fine[from].first, fine[from].last, 0});
    if (fine[from].last - fine[from].first <= kLeaf) return;
    add(fine, from + 1);
    nodes[mine].second = static_cast<std::uint32_t>(nodes.size());
    add(fine, fine[from].second);
  }
};

struct FloatRegister {
  using Type = float __attribute__((vector_size(16)));
};
struct DoubleRegister {
  using Type = double __attribute__((vector_size(16)));
};

/// Four numbers side by side, the fourth is 0: as many registers as that takes on any x86-64 processor, one or two. GCC
/// 12 compares vectors that are wider than a register number by number.
template <class Number>
struct Four {
  static constexpr int kLanes = 16 / sizeof(Number), kRegisters = 4 / kLanes;
  using Register = typename std::conditional_t<std::is_same_v<Number, float>, FloatRegister, DoubleRegister>::Type;
  Register part[kRegisters];

  Four() = default;
  Four(Number x, Number y, Number z) {
    const Number from[4] = {x, y, z, 0};
    std::memcpy(part, from, sizeof part);
  }
  Number operator[](int i) const { return part[i / kLanes][i % kLanes]; }
};

template <class Number>
struct Range {
  Four<Number> min, max;

  void add(const Four<Number>& p) { add(Range{p, p}); }
  void add(const Range& other) {
    for (int k = 0; k < Four<Number>::kRegisters; ++k) {
      min.part[k] = other.min.part[k] < min.part[k] ? other.min.part[k] : min.part[k];
      max.part[k] = other.max.part[k] > max.part[k] ? other.max.part[k] : max.part[k];
    }
  }
};

template <class Number>
bool touch(const Range<Number>& a, const Range<Number>& b) {
  bool out = true;
  for (int k = 0; k < 3; ++k) out = int(out) & int(a.min[k] <= b.max[k]) & int(b.min[k] <= a.max[k]);
  return out;
}

/// A pose in that precision.
template <class Number>
struct At {
  Number r[3][3], t[3];
};

template <class Number>
At<Number> at(const Pose& pose) {
  const geometry::Mat3 r = geometry::rotation(pose.q);
  At<Number> out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out.r[i][j] = static_cast<Number>(r(i, j));
    out.t[i] = static_cast<Number>(pose.t[i]);
  }
  return out;
}

template <class Number>
struct Placed {
  bool is = false;
  std::vector<Four<Number>> vertices;
  std::vector<Range<Number>> nodes;
};

/// The facets of all bodies in one precision, and the search for two that pass a test.
template <class Number, bool (*Test)(const std::array<Eigen::Matrix<Number, 3, 1>, 3>&,
                                     const std::array<Eigen::Matrix<Number, 3, 1>, 3>&)>
struct AllTriangles {
  using Vector = Eigen::Matrix<Number, 3, 1>;
  using Box = Range<Number>;

  AllTriangles(const Bodies& bodies, const Knobs& knobs)
      : tree(value_of<std::string>(knobs, kSearch) == "tree"),
        bare(value_of<std::string>(knobs, kSearch) == "bare"),
        mesh(bodies.mesh),
        poses(bodies.size()),
        placed(bodies.size()) {
    trees.reserve(bodies.meshes.size());
    local.reserve(bodies.meshes.size());
    for (const geometry::Mesh& one : bodies.meshes) {
      trees.emplace_back(one);
      std::vector<Four<Number>>& vertices = local.emplace_back();
      vertices.reserve(one.vertices.size());
      for (const geometry::Vec3& v : one.vertices) vertices.emplace_back(Number(v.x()), Number(v.y()), Number(v.z()));
    }
    for (std::size_t body = 0; body < bodies.size(); ++body) {
      placed[body].vertices.resize(local[mesh[body]].size());
      if (tree) placed[body].nodes.resize(trees[mesh[body]].nodes.size());
    }
    stack.reserve(256);
  }

  static Memory memory(const Bodies& bodies, const Knobs& knobs) {
    const bool tree = value_of<std::string>(knobs, kSearch) == "tree";
    Memory out = memory_by_body(bodies, sizeof(std::uint32_t) + sizeof(Pose) + sizeof(Placed<Number>));
    std::uint64_t making = 0;
    for (const geometry::Mesh& one : bodies.meshes) {
      const std::uint64_t facets = one.triangles.size();
      making = std::max(making, out.held + std::uint64_t(geometry::kBuildingBvh * double(geometry::bvh_bytes(facets))));
      out.held += Tree::bytes(facets) + sizeof(Four<Number>) * one.vertices.size();
    }
    for (std::uint32_t body = 0; body < bodies.size(); ++body)
      out.held += sizeof(Four<Number>) * bodies.mesh_of(body).vertices.size() +
                  (tree ? sizeof(Box) * Tree::node_count(bodies.mesh_of(body).triangles.size()) : 0);
    out.greatest = std::max(out.held, making);
    return out;
  }

  void prepare(std::span<const Pose> now, double) {
    std::copy(now.begin(), now.end(), poses.begin());
    for (Placed<Number>& body : placed) body.is = false;
  }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) {
    place(a);
    place(b);
    return tree ? descend(a, b, count) : exhaust(a, b, count);
  }

  /// Vertices and boxes of a body, when it is first asked for.
  void place(std::uint32_t body) {
    Placed<Number>& to = placed[body];
    if (to.is) return;
    to.is = true;
    const std::vector<Four<Number>>& from = local[mesh[body]];
    turn(at<Number>(poses[body]), from.data(), from.size(), to.vertices.data());
    if (!tree) return;
    const Tree& of = trees[mesh[body]];
    for (std::size_t i = of.nodes.size(); i-- > 0;) {
      const auto& [first, last, second] = of.nodes[i];
      if (second) {
        Box both = to.nodes[i + 1];
        both.add(to.nodes[second]);
        to.nodes[i] = both;
        continue;
      }
      Box around{to.vertices[of.facets[first][0]], to.vertices[of.facets[first][0]]};
      for (std::uint32_t f = first; f < last; ++f)
        for (const std::uint32_t v : of.facets[f]) around.add(to.vertices[v]);
      to.nodes[i] = around;
    }
  }

  /// ((r0 x + r1 y) + r2 z) + t, as geometry::to_world.
  static void turn(const At<Number>& pose, const Four<Number>* from, std::size_t size, Four<Number>* to) {
    Four<Number> column[3], t(pose.t[0], pose.t[1], pose.t[2]);
    for (int k = 0; k < 3; ++k) column[k] = Four<Number>(pose.r[0][k], pose.r[1][k], pose.r[2][k]);
    for (std::size_t i = 0; i < size; ++i)
      for (int k = 0; k < Four<Number>::kRegisters; ++k)
        to[i].part[k] =
            ((column[0].part[k] * from[i][0] + column[1].part[k] * from[i][1]) + column[2].part[k] * from[i][2]) +
            t.part[k];
  }

  Box box(std::uint32_t body, const Facet& f) const {
    const std::vector<Four<Number>>& v = placed[body].vertices;
    Box out{v[f[0]], v[f[0]]};
    out.add(v[f[1]]);
    out.add(v[f[2]]);
    return out;
  }

  std::array<Vector, 3> corners(std::uint32_t body, const Facet& f) const {
    const std::vector<Four<Number>>& v = placed[body].vertices;
    const auto corner = [&](int i) { return Vector(v[f[i]][0], v[f[i]][1], v[f[i]][2]); };
    return {corner(0), corner(1), corner(2)};
  }

  /// Facets [first, last) of a against those of b.
  template <class Count>
  bool ask(std::uint32_t a, std::uint32_t a_first, std::uint32_t a_last, std::uint32_t b, std::uint32_t b_first,
           std::uint32_t b_last, Count& count) const {
    const std::vector<Facet>&of_a = trees[mesh[a]].facets, &of_b = trees[mesh[b]].facets;
    std::array<Box, Tree::kLeaf> boxes;  // of some facets of b
    for (std::uint32_t some = b_first; some < b_last; some += Tree::kLeaf) {
      const std::uint32_t end = std::min(b_last, some + Tree::kLeaf);
      for (std::uint32_t j = some; j < end; ++j) boxes[j - some] = box(b, of_b[j]);
      for (std::uint32_t i = a_first; i < a_last; ++i) {
        const Box around = box(a, of_a[i]);
        for (std::uint32_t j = some; j < end; ++j) {
          count += 1;
          if (!bare && !touch(around, boxes[j - some])) continue;
          count += !bare;
          if (Test(corners(a, of_a[i]), corners(b, of_b[j]))) return true;
        }
      }
    }
    return false;
  }

  template <class Count>
  bool exhaust(std::uint32_t a, std::uint32_t b, Count& count) const {
    const auto facets = [&](std::uint32_t body) { return std::uint32_t(trees[mesh[body]].facets.size()); };
    return ask(a, 0, facets(a), b, 0, facets(b), count);
  }

  template <class Count>
  bool descend(std::uint32_t a, std::uint32_t b, Count& count) {
    const std::vector<Tree::Node>&of_a = trees[mesh[a]].nodes, &of_b = trees[mesh[b]].nodes;
    const std::vector<Box>&a_boxes = placed[a].nodes, &b_boxes = placed[b].nodes;
    stack.assign(1, {0, 0});
    while (!stack.empty()) {
      const auto [i, j] = stack.back();
      stack.pop_back();
      count += 1;
      if (!touch(a_boxes[i], b_boxes[j])) continue;
      const Tree::Node &m = of_a[i], &n = of_b[j];
      if (!m.second && !n.second) {
        if (ask(a, m.first, m.last, b, n.first, n.last, count)) return true;
      } else if (!n.second || (m.second && m.last - m.first >= n.last - n.first)) {
        stack.push_back({m.second, j});
        stack.push_back({i + 1, j});
      } else {
        stack.push_back({i, n.second});
        stack.push_back({i, j + 1});
      }
    }
    return false;
  }

  bool tree, bare;
  std::vector<std::uint32_t> mesh;               // per body
  std::vector<Tree> trees;                       // per distinct mesh
  std::vector<std::vector<Four<Number>>> local;  // likewise, its vertices
  std::vector<Pose> poses;                       // of the step
  std::vector<Placed<Number>> placed;            // per body
  std::vector<std::pair<std::uint32_t, std::uint32_t>> stack;
};

template <class Vector>
bool eleven_axes(const std::array<Vector, 3>& s, const std::array<Vector, 3>& t) {
  return geometry::meet_by_eleven_axes(geometry::edged(s[0], s[1], s[2]), geometry::edged(t[0], t[1], t[2]));
}

/// What `made` gives for the test that the knobs name.
template <class Number, class Made>
auto of_test(const Knobs& knobs, Made made) {
  using Vector = Eigen::Matrix<Number, 3, 1>;
  const auto& test = value_of<std::string>(knobs, kTest);
  if (test == "moller") return made.template operator()<AllTriangles<Number, triangle_tests::moller<Vector>>>();
  if (test == "guigue_devillers")
    return made.template operator()<AllTriangles<Number, triangle_tests::guigue_devillers<Vector>>>();
  return made.template operator()<AllTriangles<Number, eleven_axes<Vector>>>();
}

template <class Made>
auto of_knobs(const Knobs& knobs, Made made) {
  return value_of<std::string>(knobs, kPrecision) == "single" ? of_test<float>(knobs, made)
                                                              : of_test<double>(knobs, made);
}

}  // namespace

Algorithm all_triangles() {
  Knob prefilter = prefilter_knob();
  prefilter.preset = "aabb";
  return {.name = "all_triangles",
          .what = "some facet of the one meets some facet of the other by a published test in plain floating point",
          .operations_unit = with_prefilter("pairs of boxes and triangle pairs"),
          .promise = Promise::none,
          .knobs = {{.name = kTest,
                     .preset = "eleven_axes",
                     .unit = "1",
                     .what = "of two triangles",
                     .choices = {"eleven_axes", "moller", "guigue_devillers"}},
                    {.name = kPrecision,
                     .preset = "double",
                     .unit = "1",
                     .what = "of poses, vertices, boxes and test",
                     .choices = {"double", "single"}},
                    prefilter,
                    {.name = kSearch,
                     .preset = "tree",
                     .unit = "1",
                     .what = "facets whose boxes touch, by a tree or one by one (same answers); bare: all facets",
                     .choices = {"tree", "exhaustive", "bare"}}},
          .make =
              [](const Bodies& bodies, const Knobs& knobs) {
                return of_knobs(knobs, [&]<class Test>() { return make_filtered<Test>(bodies, knobs); });
              },
          .memory =
              [](const Bodies& bodies, const Knobs& knobs) {
                return of_knobs(knobs, [&]<class Test>() { return filtered_memory<Test>(bodies, knobs); });
              }};
}

}  // namespace algorithms
