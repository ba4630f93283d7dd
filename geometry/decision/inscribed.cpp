// Candidates: at points p spread evenly over the surface, the greatest ball that touches it there from inside. It is
// found by shrinking (J. Ma, S. Bae, S. Choi, "3D medial axis point approximation using nearest neighbors and the
// normal field", 2012): the nearest surface point q of the ball's centre, if it is inside the ball, gives a smaller
// ball, through q. Every ball inside that touches the surface in p lies in that one. But in a mesh that stands for a
// round surface balls are small that touch a facet beside its middle, so others are tried too, that come near p but for
// a part e of their distance: centres p + s n, n being the normal, of which q is no nearer than (1 - e) s. With
// a = |q - p|^2, b = n (q - p) and k = 1 - (1 - e)^2 it is nearer between the two roots of k s^2 - 2 b s + a = 0.
//
// How a ball was found proves nothing: of the centre alone the radius is proved by the certified distance of every
// facet near it, and its side by the parity rule.
//
// Choice: a point is covered when it is within a distance d of a ball. For a given d, balls are taken one by one,
// always the one that covers most points that are not covered yet: greedy set cover, with counts that only fall, so
// that old ones are upper bounds. d is bisected.
#include "geometry/decision/inscribed.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

#include "geometry/decision/exact.hpp"
#include "geometry/decision/gap.hpp"
#include "geometry/random.hpp"
#include "geometry/vec.hpp"

namespace geometry {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A point of the surface and the unit normal there that points inside.
struct Sample {
  Vec3 point, inward;
};

/// How many points of the surface stand for it.
std::size_t sample_count(std::size_t most) { return 1024 + 4 * most; }

struct Surface {
  const Mesh& mesh;
  const Bvh& bvh;
  std::vector<Box> boxes;  // of the nodes, in the mesh's frame

  Triangle triangle(std::uint32_t facet) const {
    const Facet& f = mesh.triangles[facet];
    return {mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]]};
  }
};

double square(double x) { return x * x; }

double distance_squared(const Box& box, const Vec3& p) {
  double out = 0;
  for (int k = 0; k < 3; ++k) out += square(std::fmax(0, std::fmax(box.min[k] - p[k], p[k] - box.max[k])));
  return out;
}

double longest_squared(const Triangle& t) {
  double out = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge = t[(k + 1) % 3] - t[k];
    out = std::fmax(out, dot(edge, edge));
  }
  return out;
}

/// Two halves, cut through the middle of the longest edge; they run round as the whole does.
std::pair<Triangle, Triangle> halves(const Triangle& t) {
  std::size_t from = 0;
  double longest = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge = t[(k + 1) % 3] - t[k];
    if (const double length = dot(edge, edge); length > longest) longest = length, from = k;
  }
  const Vec3 &a = t[from], &b = t[(from + 1) % 3], &c = t[(from + 2) % 3];
  const Vec3 middle = 0.5 * (a + b);
  return {{a, middle, c}, {middle, b, c}};
}

Vec3 centroid(const Triangle& t) { return ((t[0] + t[1]) + t[2]) / 3; }

/// About `count` points, each in the middle of a part of a facet that is no longer than neighbours are apart. The j-th
/// lies where the area so far passes j + a random part of the area of one.
std::vector<Sample> samples(const Surface& surface, std::size_t count) {
  const auto normal_of = [](const Triangle& t) { return cross(t[1] - t[0], t[2] - t[0]); };
  double area = 0;
  for (std::uint32_t f = 0; f < surface.mesh.triangles.size(); ++f) {
    const Vec3 n = normal_of(surface.triangle(f));
    area += std::sqrt(dot(n, n)) / 2;
  }
  std::vector<Sample> out;
  if (!(area > 0 && area < kInfinity)) return out;
  const double cell = area / double(count), longest = 4 * cell;  // of an edge, squared
  Random random(1);
  double passed = 0, next = random.unit() * cell;
  std::vector<Triangle> parts;
  for (std::uint32_t f = 0; f < surface.mesh.triangles.size(); ++f) {
    const Triangle whole = surface.triangle(f);
    const Vec3 n = normal_of(whole);
    const double length = std::sqrt(dot(n, n));
    if (!(length > 0)) continue;
    parts.assign(1, whole);
    double part_area = length / 2;
    std::vector<double> areas(1, part_area);
    while (!parts.empty()) {
      const Triangle part = parts.back();
      part_area = areas.back();
      parts.pop_back();
      areas.pop_back();
      if (part_area > cell || (longest_squared(part) > longest && part_area > 1e-3 * cell)) {
        const auto [one, other] = halves(part);
        parts.insert(parts.end(), {other, one});
        areas.insert(areas.end(), 2, part_area / 2);
        continue;
      }
      passed += part_area;
      if (passed <= next) continue;
      out.push_back({centroid(part), -n / length});
      next = (std::floor(passed / cell) + 1 + random.unit()) * cell;
    }
  }
  return out;
}

/// The point of a triangle nearest to p, about: the foot on the plane when it is inside, else on the nearest edge.
Vec3 nearest_point(const Triangle& t, const Vec3& p) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  bool inside = true;
  Vec3 best = t[0];
  double least = kInfinity;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &a = t[k], edge = t[(k + 1) % 3] - a, to = p - a;
    inside = inside && dot(cross(edge, to), n) > 0;
    const double square = dot(edge, edge);
    const double along = square > 0 ? std::fmin(1, std::fmax(0, dot(edge, to) / square)) : 0;
    const Vec3 foot = a + along * edge, apart = p - foot;
    if (const double distance = dot(apart, apart); distance < least) least = distance, best = foot;
  }
  if (!inside) return best;
  return p - (dot(p - t[0], n) / dot(n, n)) * n;
}

/// The nearest point of the surface to p that is nearer than the square root of `least`, which becomes its distance
/// squared; p itself when there is none.
Vec3 nearest_point(const Surface& surface, const Vec3& p, double& least) {
  Vec3 best = p;
  std::vector<std::pair<double, std::uint32_t>> stack{{distance_squared(surface.boxes[0], p), 0}};
  while (!stack.empty()) {
    const auto [bound, i] = stack.back();
    stack.pop_back();
    if (bound >= least) continue;
    const Bvh::Node& node = surface.bvh.nodes[i];
    if (node.count == 0) {
      std::pair<double, std::uint32_t> near{distance_squared(surface.boxes[i + 1], p), i + 1},
          far{distance_squared(surface.boxes[node.second], p), node.second};
      if (far.first < near.first) std::swap(near, far);
      stack.push_back(far);
      stack.push_back(near);
    }
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      const Vec3 q = nearest_point(surface.triangle(surface.bvh.order[k]), p), apart = p - q;
      if (const double distance = dot(apart, apart); distance < least) least = distance, best = q;
    }
  }
  return best;
}

/// How far behind the sample the centre is of the greatest ball inside that comes near it but for the part `missing` of
/// that; `away` is a first guess from above. 0 when there is none.
double centre_of_greatest(const Surface& surface, const Sample& sample, double missing, double away) {
  constexpr int kMostTries = 50;
  const double part = 1 - missing, k = (1 + part) * missing;
  for (int i = 0; i < kMostTries; ++i) {
    double least = square(away * part);
    const double before = least;
    const Vec3 q = nearest_point(surface, sample.point + away * sample.inward, least);
    if (least == before) break;
    const Vec3 to = q - sample.point;
    const double a = dot(to, to), b = dot(to, sample.inward);
    const double smaller = a / (b + std::sqrt(std::fmax(0, b * b - a * k)));
    if (!(b > 0 && smaller < away)) return 0;
    away = smaller;
  }
  return away;
}

/// A proved lower bound of the distance of p from the surface.
double certified_distance(const Surface& surface, const Vec3& p) {
  double least = kInfinity;
  nearest_point(surface, p, least);
  const double reach = least * (1 + 1e-6);  // what is further cannot make it less than the nearest, whatever rounding
  double out = std::sqrt(least);
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const std::uint32_t i = stack.back();
    stack.pop_back();
    if (distance_squared(surface.boxes[i], p) > reach) continue;
    const Bvh::Node& node = surface.bvh.nodes[i];
    if (node.count == 0) {
      stack.push_back(node.second);
      stack.push_back(i + 1);
    }
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      const Triangle t = surface.triangle(surface.bvh.order[k]);
      out = std::fmin(out, triangle_gap({p, p, p}, t).lower);
    }
  }
  return out;
}

/// Points in a tree of boxes, to count those near a place.
class Points {
 public:
  explicit Points(std::vector<Vec3> points) : points_(std::move(points)), order_(points_.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    build(0, std::uint32_t(order_.size()));
  }

  /// Calls `visit` with every point that is within `radius` of p, in no particular order.
  template <class Visit>
  void near(const Vec3& p, double radius, Visit visit) const {
    const double reach = square(radius);
    std::vector<std::uint32_t>& stack = stack_;
    stack.assign(1, 0);
    while (!stack.empty()) {
      const Node& node = nodes_[stack.back()];
      stack.pop_back();
      if (distance_squared(node.box, p) > reach) continue;
      if (node.second == 0) {
        for (std::uint32_t k = node.first; k < node.last; ++k) {
          const Vec3 apart = points_[order_[k]] - p;
          if (dot(apart, apart) <= reach) visit(order_[k]);
        }
        continue;
      }
      stack.push_back(node.second);
      stack.push_back(std::uint32_t(&node - nodes_.data()) + 1);
    }
  }

 private:
  struct Node {
    Box box;
    std::uint32_t first, last, second;  // points; the second child, 0 for a leaf
  };

  void build(std::uint32_t first, std::uint32_t last) {
    const std::size_t here = nodes_.size();
    nodes_.push_back({{}, first, last, 0});
    Box box;
    for (std::uint32_t k = first; k < last; ++k) box.add(points_[order_[k]]);
    nodes_[here].box = box;
    if (last - first <= 8) return;
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (box.max[k] - box.min[k] > box.max[axis] - box.min[axis]) axis = k;
    const std::uint32_t middle = first + (last - first) / 2;
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                     [&](std::uint32_t a, std::uint32_t b) {
                       return std::pair(points_[a][axis], a) < std::pair(points_[b][axis], b);
                     });
    build(first, middle);
    nodes_[here].second = std::uint32_t(nodes_.size());
    build(middle, last);
  }

  std::vector<Vec3> points_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
  mutable std::vector<std::uint32_t> stack_;
};

/// The balls, in the order in which they are chosen, that come within `distance` of every point that some candidate
/// comes so near to; none when that takes more than `most`.
std::vector<std::uint32_t> cover(const std::vector<ContactBall>& candidates, const Points& points, std::size_t count,
                                 double distance, std::size_t most) {
  std::vector<std::uint8_t> covered(count);
  const auto covers = [&](std::uint32_t c) {
    std::uint32_t out = 0;
    points.near(candidates[c].centre, candidates[c].radius + distance,
                [&](std::uint32_t p) { out += covered[p] == 0; });
    return out;
  };
  // The most first; of equals the first.
  using Entry = std::pair<std::uint32_t, std::uint32_t>;  // count, then ~candidate
  std::priority_queue<Entry> queue;
  for (std::uint32_t c = 0; c < candidates.size(); ++c) queue.emplace(covers(c), ~c);
  std::vector<std::uint32_t> out;
  while (!queue.empty()) {
    const std::uint32_t c = ~queue.top().second;
    queue.pop();
    const std::uint32_t now = covers(c);
    if (now == 0) continue;
    if (!queue.empty() && Entry(now, ~c) < queue.top()) {
      queue.emplace(now, ~c);
      continue;
    }
    if (out.size() == most) return {};
    out.push_back(c);
    points.near(candidates[c].centre, candidates[c].radius + distance, [&](std::uint32_t p) { covered[p] = 1; });
  }
  return out;
}

/// How far a point is from the nearest ball; 0 in one.
double uncovered(const std::vector<ContactBall>& balls, const Vec3& p) {
  double out = kInfinity;
  for (const ContactBall& ball : balls) {
    const Vec3 apart = p - ball.centre;
    out = std::fmin(out, std::sqrt(dot(apart, apart)) - ball.radius);
  }
  return std::fmax(out, 0);
}

/// The greatest such distance on the surface, by branch and bound: it changes by no more than one moves.
double deviation(const Surface& surface, const std::vector<ContactBall>& balls) {
  struct Part {
    double bound;
    Triangle at;
    bool operator<(const Part& other) const { return bound < other.bound; }
  };
  std::priority_queue<Part> parts;
  double found = 0;
  const auto add = [&](const Triangle& t) {
    const Vec3 middle = centroid(t);
    const double here = uncovered(balls, middle);
    double reach = 0;
    for (const Vec3& corner : t) reach = std::fmax(reach, dot(corner - middle, corner - middle));
    found = std::fmax(found, here);
    for (const Vec3& corner : t) found = std::fmax(found, uncovered(balls, corner));
    if (const double bound = here + std::sqrt(reach); bound > found) parts.push({bound, t});
  };
  for (std::uint32_t f = 0; f < surface.mesh.triangles.size(); ++f) add(surface.triangle(f));
  constexpr double kExact = 1e-3;  // of the deviation
  while (!parts.empty() && parts.top().bound > found * (1 + kExact)) {
    const auto [one, other] = halves(parts.top().at);
    parts.pop();
    add(one);
    add(other);
  }
  return parts.empty() ? found : std::fmax(found, parts.top().bound);
}

std::vector<ContactBall> candidates(const Surface& surface, const std::vector<Sample>& at) {
  constexpr double kLeast = 1. / 8;  // of the greatest ball: beads would be soft, and pass each other by
  const Box& box = surface.boxes[0];
  const double first = box.half_size().minCoeff() * (1 + 1e-9);
  std::vector<ContactBall> out;
  double greatest = 0;
  for (const Sample& sample : at) {
    double away = first;
    for (const double missing : {0.1, 0.02, 1e-9}) {
      const double now = centre_of_greatest(surface, sample, missing, away);
      if (!(now > 0)) break;
      if (now == away && now != first) continue;  // the same as before
      away = now;
      const Vec3 centre = sample.point + away * sample.inward;
      if (!is_inside(centre, surface.mesh, surface.bvh, surface.mesh.vertices, surface.boxes)) continue;
      const double radius = certified_distance(surface, centre);
      greatest = std::fmax(greatest, radius);
      out.push_back({centre, radius});
    }
  }
  std::erase_if(out, [&](const ContactBall& ball) { return !(ball.radius > 0 && ball.radius >= kLeast * greatest); });
  return out;
}

}  // namespace

InscribedBalls inscribed_balls(const Mesh& mesh, const Solid& solid, std::size_t most) {
  assert(solid.closed && most > 0);
  const Mesh& closed = solid.surface ? solid.surface->mesh : mesh;
  const Bvh bvh = build_bvh(closed);
  Surface surface{closed, bvh, std::vector<Box>(bvh.nodes.size())};
  refit(bvh, closed, closed.vertices, surface.boxes);

  const std::vector<Sample> at = samples(surface, sample_count(most));
  const std::vector<ContactBall> all = candidates(surface, at);
  InscribedBalls out;
  if (all.empty()) return out;
  std::vector<Vec3> points;
  for (const Sample& sample : at) points.push_back(sample.point);
  const Points tree(std::move(points));

  constexpr int kBisections = 12;
  const Vec3 size = surface.boxes[0].max - surface.boxes[0].min;
  double low = 0, high = std::sqrt(dot(size, size));
  std::vector<std::uint32_t> chosen;
  for (int i = 0; i < kBisections; ++i) {
    const double distance = i == 0 ? high : (low + high) / 2;
    std::vector<std::uint32_t> found = cover(all, tree, at.size(), distance, most);
    (found.empty() ? low : high) = distance;
    if (!found.empty()) chosen = std::move(found);
  }
  for (const std::uint32_t c : chosen) out.balls.push_back(all[c]);
  out.deviation = deviation(surface, out.balls);
  return out;
}

std::uint64_t inscribed_balls_bytes(std::size_t facets, std::size_t most) {
  return bvh_bytes(facets) + facets * sizeof(Box) * 2 + sample_count(most) * 400;
}

}  // namespace geometry
