// facet_distance: the smallest squared distance of two sets of facet points, against max_distance squared.
//
// The indexed search asks the very sum of the definition, (dx dx + dy dy) + dz dz < max_distance^2 of the same world
// points, about fewer pairs of points. The larger set is a tree in its mesh's frame and is never placed as a whole: the
// points of the smaller, p in the world, are brought into that frame as q ~ R^T (p - t), and parts of the tree whose
// boxes q is not near are left out. What is left is placed as the definition places it, and compared.
//
// Why no hit is lost. With m = max_distance, u = 2^-53, v a local point of the tree, w = to_world(R, t, v), |v| <= S: a
// sum below the rounded m^2 means, where the last term is for squares that underflow,
//   |p - w| <= D = m (1 + 2^-50) + 1e-160                                                                       (1)
//
// The world point has a rounding error e, and the matrix a defect E, which is looked at:
//   w = R v + t + e,   |e| <= 8 u (S + |t|),   R^T R = I + E,   |E| <= 2^-44                                    (2)
//
// So R^T (p - t) = v + E v + R^T (e + p - w), and q is that within 8 u |p - t|, where |p - t| <= 2 (S + |t| + D):
//   |q - v| <= D + 2^-43 (S + |t| + D)                                                                          (3)
//
// A point is left out when, on some axis or from a ball, it is beyond
//   m + kMargin (S + |t| + m) + 1e-150,   kMargin = 2^-42                                                       (4)
//
// The slack of 2^-43 of it all between (3) and (4) is far more than the roundings of boxes, sums and squares here, each
// some 2^-50 of the same lengths.
//
// Should p - t or what follows overflow, p is beyond 1e300 or not a number: it is left out, and is near nothing, since
// S and |t| are below 1e100. Bodies that are not so, or whose R is no rotation, are searched exhaustively.
#include "algorithms/thesis/facet_distance.hpp"

#include <algorithm>

#include "algorithms/contract/prefilter.hpp"
#include "algorithms/parts/facets.hpp"
#include "algorithms/parts/point_tree.hpp"
#include "geometry/processor_clones.hpp"

namespace algorithms {
namespace {

using geometry::Ball;
using geometry::Box;
using geometry::Mat3;
using geometry::Points;
using geometry::PointTree;
using geometry::Vec3;

constexpr double kMargin = 0x1p-42;  // of lengths: (4)

/// A body's sampled facet points in local space, metres.
Points sampled(const geometry::Mesh& mesh, double facets_per_area, bool densify) {
  const geometry::Mesh& dense = densify ? geometry::densified(mesh, facets_per_area) : mesh;
  return facet_points(
      dense, geometry::stride_of_density(dense.triangles.size(), facets_per_area, geometry::box_surface(mesh)));
}

/// True when one of the first `size` points is nearer to p than the root of `limit`. No early exit within the row: it
/// vectorises.
PROCESSOR_CLONES bool any_near(double px, double py, double pz, const double* x, const double* y, const double* z,
                               std::size_t size, double limit) {
  std::int64_t near = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const double dx = x[i] - px, dy = y[i] - py, dz = z[i] - pz;
    near |= (dx * dx + dy * dy) + dz * dz < limit ? std::int64_t{1} : std::int64_t{0};
  }
  return near != 0;
}

/// The sampled points of a mesh, for the indexed search.
struct Indexed {
  explicit Indexed(const Points& points) {
    if (points.size() == 0) return;
    ball = geometry::ball_around(points);
    size = (ball.centre.norm() + ball.radius) * (1 + 1e-12);
    usable = true;
    for (std::size_t i = 0; i < points.size(); ++i) usable &= points.at(i).cwiseAbs().maxCoeff() < 1e100;
    if (usable) tree = PointTree(points);
  }

  PointTree tree;
  Ball ball;
  double size = 0;      // no point is farther from the mesh's origin, metres
  bool usable = false;  // false: an overflow may lurk, or there is no point
};

/// Where a body is at a step, for the indexed search.
struct Frame {
  Mat3 r;
  Vec3 t;
  Vec3 centre;        // of the ball, world
  double margin = 0;  // metres, of points near or in this frame
  bool usable = false;

  Frame() = default;
  Frame(const Pose& pose, const Indexed& index) : r(geometry::rotation(pose.q)), t(pose.t) {
    const double skew = (r.transpose() * r - Mat3::Identity()).cwiseAbs().maxCoeff();  // |E| is at most three times it
    const double extent = index.size + t.norm();
    usable = index.usable && skew < 0x1p-46 && extent < 1e100;  // false for NaN
    centre = geometry::to_world(r, t, index.ball.centre);
    margin = kMargin * extent + 1e-150;
  }
};

/// A point of the smaller set: p, and q ~ R^T (p - t) in the frame of the larger.
struct Candidate {
  Vec3 world, local;
};

/// The coordinates of points, columns.
struct Columns {
  double *x, *y, *z;
};

Columns columns(Points& points) { return {points.x.data(), points.y.data(), points.z.data()}; }

/// q of each point p, and keep[i] = 1 when q is in the box and nearer than `reach` to the centre, else 0.
PROCESSOR_CLONES void into_frame(const Points& p, const Frame& frame, const Box& box, const Vec3& centre, double reach,
                                 Columns q, std::int64_t* keep) {
  const double *px = p.x.data(), *py = p.y.data(), *pz = p.z.data();
  const double r00 = frame.r(0, 0), r01 = frame.r(0, 1), r02 = frame.r(0, 2), r10 = frame.r(1, 0), r11 = frame.r(1, 1),
               r12 = frame.r(1, 2), r20 = frame.r(2, 0), r21 = frame.r(2, 1), r22 = frame.r(2, 2);
  const double tx = frame.t.x(), ty = frame.t.y(), tz = frame.t.z(), cx = centre.x(), cy = centre.y(), cz = centre.z();
  const double x0 = box.min.x(), y0 = box.min.y(), z0 = box.min.z(), x1 = box.max.x(), y1 = box.max.y(),
               z1 = box.max.z(), reach_squared = reach * reach;
  const std::size_t size = p.size();
#ifndef __clang__
#pragma GCC ivdep
#endif
  for (std::size_t i = 0; i < size; ++i) {
    const double sx = px[i] - tx, sy = py[i] - ty, sz = pz[i] - tz;
    const double x = (r00 * sx + r10 * sy) + r20 * sz, y = (r01 * sx + r11 * sy) + r21 * sz,
                 z = (r02 * sx + r12 * sy) + r22 * sz;
    const double dx = x - cx, dy = y - cy, dz = z - cz;
    q.x[i] = x;
    q.y[i] = y;
    q.z[i] = z;
    const bool near = (x >= x0) & (x <= x1) & (y >= y0) & (y <= y1) & (z >= z0) & (z <= z1) &
                      ((dx * dx + dy * dy) + dz * dz < reach_squared);
    keep[i] = near ? std::int64_t{1} : std::int64_t{0};
  }
}

/// The number of the first candidate that is nearer than the root of `limit` to one of the kLeaf points, placed by
/// to_world; `size` when there is none.
PROCESSOR_CLONES std::size_t first_near(const Candidate* candidates, std::size_t size, const double* vx,
                                        const double* vy, const double* vz, const Frame& frame, double limit) {
  double x[PointTree::kLeaf], y[PointTree::kLeaf], z[PointTree::kLeaf];
  for (std::uint32_t i = 0; i < PointTree::kLeaf; ++i) {
    const Vec3 w = geometry::to_world(frame.r, frame.t, {vx[i], vy[i], vz[i]});
    x[i] = w.x();
    y[i] = w.y();
    z[i] = w.z();
  }
  for (std::size_t k = 0; k < size; ++k) {
    const double px = candidates[k].world.x(), py = candidates[k].world.y(), pz = candidates[k].world.z();
    std::int64_t near = 0;
    for (std::uint32_t i = 0; i < PointTree::kLeaf; ++i) {
      const double dx = x[i] - px, dy = y[i] - py, dz = z[i] - pz;
      near |= (dx * dx + dy * dy) + dz * dz < limit ? std::int64_t{1} : std::int64_t{0};
    }
    if (near) return k;
  }
  return size;
}

Box enlarged(const Box& box, double by) {
  return {.min = box.min - Vec3::Constant(by), .max = box.max + Vec3::Constant(by)};
}

bool contains(const Box& box, const Vec3& p) {
  return (p.x() >= box.min.x()) & (p.x() <= box.max.x()) & (p.y() >= box.min.y()) & (p.y() <= box.max.y()) &
         (p.z() >= box.min.z()) & (p.z() <= box.max.z());
}

struct FacetDistance {
  FacetDistance(const Bodies& bodies, const Knobs& knobs)
      : max_distance(value_of<double>(knobs, "max_distance")),
        limit(max_distance * max_distance),
        indexed(value_of<std::string>(knobs, "search") == "indexed"),
        mesh(bodies.mesh),
        poses(bodies.size()),
        frame(bodies.size()),
        framed(bodies.size()),
        placed(bodies, local_points(bodies, knobs)) {
    q.resize(placed.most());
    keep.resize(placed.most());
    candidates.resize(placed.most());
  }

  /// Also fills `index`, which needs the same points.
  std::vector<Points> local_points(const Bodies& bodies, const Knobs& knobs) {
    std::vector<Points> local;
    for (const geometry::Mesh& mesh : bodies.meshes) {
      local.push_back(sampled(mesh, value_of<double>(knobs, "facets_per_area"), value_of<bool>(knobs, "densify")));
      index.emplace_back(indexed ? local.back() : Points());
    }
    return local;
  }

  static Memory memory(const Bodies& bodies, const Knobs& knobs) {
    const auto density = value_of<double>(knobs, "facets_per_area");
    const bool densify = value_of<bool>(knobs, "densify"),
               indexed = value_of<std::string>(knobs, "search") == "indexed";
    std::vector<std::size_t> count;
    std::uint64_t before = 0, trees = 0, made = 0, most = 0;
    for (const geometry::Mesh& mesh : bodies.meshes) {
      const std::uint64_t parts = densify ? geometry::parts_of_density(mesh, density) : 1;
      const std::uint64_t facets = mesh.triangles.size() * parts * parts;
      count.push_back(
          geometry::point_count(facets, geometry::stride_of_density(facets, density, geometry::box_surface(mesh))));
      const std::uint64_t points = sizeof(Vec3) * count.back();
      const std::uint64_t tree = sizeof(Indexed) + (indexed ? PointTree::bytes(count.back()) : 0);
      // First the dense mesh and its points; then these twice, the tree and the order it is built in.
      made = std::max({made, before + geometry::dense_bytes(mesh, parts) + points,
                       before + 2 * points + tree + sizeof(std::uint32_t) * count.back()});
      before += points + tree;
      trees += tree;
    }
    for (const std::uint32_t mesh : bodies.mesh) most = std::max(most, std::uint64_t{count[mesh]});
    const std::uint64_t held = geometry::PlacedPoints::bytes(bodies, count) + trees +
                               most * (sizeof(Vec3) + sizeof(std::int64_t) + sizeof(Candidate)) +
                               bodies.size() * (sizeof(std::uint32_t) + sizeof(Pose) + sizeof(Frame) + 1);
    return {held, std::max(held, made)};
  }

  void prepare(std::span<const Pose> now, double) {
    placed.prepare(now);
    std::copy(now.begin(), now.end(), poses.begin());
    std::fill(framed.begin(), framed.end(), std::uint8_t{0});
  }

  template <class Count>
  bool hit(std::uint32_t a, std::uint32_t b, Count& count) {
    if (!indexed) return exhaustive(a, b, count);
    const Frame &frame_a = frame_of(a), &frame_b = frame_of(b);
    if (!frame_a.usable || !frame_b.usable) return exhaustive(a, b, count);

    const double reach =
        (index[mesh[a]].ball.radius + index[mesh[b]].ball.radius + max_distance + frame_a.margin + frame_b.margin) *
        (1 + kMargin);
    count += 1;
    if ((frame_b.centre - frame_a.centre).squaredNorm() >= reach * reach) return false;
    return placed[a].size() < placed[b].size() ? search(a, b, count) : search(b, a, count);
  }

  /// The definition.
  template <class Count>
  bool exhaustive(std::uint32_t body_a, std::uint32_t body_b, Count& count) {
    placed.place(body_a);
    placed.place(body_b);
    const Points &a = placed[body_a], &b = placed[body_b];
    for (std::size_t i = 0; i < a.size(); ++i) {
      count += b.size();
      if (any_near(a.x[i], a.y[i], a.z[i], b.x.data(), b.y.data(), b.z.data(), b.size(), limit)) return true;
    }
    return false;
  }

  const Frame& frame_of(std::uint32_t body) {
    if (!framed[body]) {
      framed[body] = 1;
      frame[body] = Frame(poses[body], index[mesh[body]]);
    }
    return frame[body];
  }

  /// Is a point of the body `few` near one of the body `many`, whose tree is asked?
  template <class Count>
  bool search(std::uint32_t few, std::uint32_t many, Count& count) {
    const Indexed& of = index[mesh[many]];
    Asked asked{.tree = of.tree, .frame = frame[many], .reach = max_distance * (1 + kMargin) + frame[many].margin};
    placed.place(few);
    const Points& points = placed[few];
    count += points.size();
    into_frame(points, asked.frame, enlarged(of.tree.nodes[0].box, asked.reach), of.ball.centre,
               (of.ball.radius + asked.reach) * (1 + kMargin), columns(q), keep.data());
    std::size_t size = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      candidates[size] = {.world = points.at(i), .local = q.at(i)};
      size += static_cast<std::size_t>(keep[i]);  // without a branch: near and far points alternate unpredictably
    }
    return size > 0 && near(asked, 0, size, count);
  }

  struct Asked {
    const PointTree& tree;
    const Frame& frame;
    double reach;  // metres; a point farther from a box, in the tree's frame, is near nothing in it
  };

  /// Is one of the first `size` candidates, at least one, near a point of the node? Their order changes, as a set they
  /// stay the first.
  template <class Count>
  bool near(const Asked& asked, std::uint32_t number, std::size_t size, Count& count) {
    const PointTree::Node& node = asked.tree.nodes[number];
    if (node.second == 0) {
      const Points& points = asked.tree.points;
      const std::size_t first =
          first_near(candidates.data(), size, points.x.data() + node.first, points.y.data() + node.first,
                     points.z.data() + node.first, asked.frame, limit);
      count += node.size * std::min(first + 1, size);
      return first < size;
    }
    Box around;
    for (std::size_t i = 0; i < size; ++i) around.add(candidates[i].local);
    for (const std::uint32_t child : {number + 1, node.second}) {
      const Box box = enlarged(asked.tree.nodes[child].box, asked.reach);
      count += 1;
      if (!touch(box, around)) continue;
      std::size_t near_size = size;
      if (!contains(box, around.min) || !contains(box, around.max)) {
        count += size;
        near_size = to_front(box, size);
      }
      if (near_size > 0 && near(asked, child, near_size, count)) return true;
    }
    return false;
  }

  /// Moves those of the first `size` candidates that are in the box to the front; how many.
  std::size_t to_front(const Box& box, std::size_t size) {
    std::size_t front = 0;
    for (std::size_t i = 0; i < size; ++i)
      if (contains(box, candidates[i].local)) std::swap(candidates[front++], candidates[i]);
    return front;
  }

  double max_distance, limit;  // metres, square metres
  bool indexed;
  std::vector<Indexed> index;        // #meshes; of no points when the search is exhaustive
  std::vector<std::uint32_t> mesh;   // #bodies
  std::vector<Pose> poses;           // #bodies
  std::vector<Frame> frame;          // #bodies
  std::vector<std::uint8_t> framed;  // #bodies; 1: `frame` is of this step
  geometry::PlacedPoints placed;
  Points q;  // scratch, as the next two
  std::vector<std::int64_t> keep;
  std::vector<Candidate> candidates;
};

}  // namespace

Algorithm facet_distance() {
  return {.name = "facet_distance",
          .thesis_key = "K",
          .what = "the nearest facet points of two bodies are nearer than a limit",
          .operations_unit = with_prefilter("distances and boxes"),
          .promise = Promise::none,
          .knobs = {{.name = "max_distance",
                     .preset = 0.25,
                     .unit = "m",
                     .what = "a hit when two facet points are nearer than this",
                     .least = 0,
                     .most = 1e9},
                    {.name = "facets_per_area",
                     .preset = geometry::kFacetsPerArea,
                     .unit = "1/m^2",
                     .what = "facets sampled per surface of the local vertex box",
                     .least = 0,
                     .most = 1e9,
                     .valid = [](const Value& value) { return std::get<double>(value) > 0; },
                     .rule = "be greater than 0"},
                    prefilter_knob(),
                    {.name = "densify",
                     .preset = true,
                     .unit = "1",
                     .what = "cut the facets of a mesh that has fewer than facets_per_area",
                     .role = Role::density},
                    {.name = "search",
                     .preset = std::string("indexed"),
                     .unit = "1",
                     .what = "leave out points that surely are not near, or compare all; the answers are the same",
                     .choices = {"indexed", "exhaustive"}}},
          .make = make_filtered<FacetDistance>,
          .memory = filtered_memory<FacetDistance>};
}

}  // namespace algorithms
