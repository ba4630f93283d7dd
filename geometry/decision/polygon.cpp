// The cutting of polygons, in the plane, by exact orientations alone.
//
// Why it is right. Triangles whose corners are chained as ears are cut have the outline as the boundary of their sum.
// So where each of them turns the same way as the polygon, or not at all, they cover every point as often as the
// outline winds around it: exactly the inside, once, when the outline winds around each point once or never. Both
// conditions are checked, the first as ears are cut, the second by a sweep before (Sweep). An outline that passes
// through itself has three different winding numbers around the place, or does so where it runs back on itself, which
// the sweep finds as two bundles of edges that cross. Touching is allowed.
#include "geometry/decision/polygon.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <queue>
#include <set>
#include <tuple>

namespace geometry {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Points = std::vector<Kernel::Point_2>;
using Point = Kernel::Point_2;
using Index = std::uint32_t;

/// 1: r is to the left of the way from p to q; 0: on their line; -1: to the right. Exact.
int turn(const Point& p, const Point& q, const Point& r) { return static_cast<int>(CGAL::orientation(p, q, r)); }

bool before(const Point& p, const Point& q) { return p.x() < q.x() || (p.x() == q.x() && p.y() < q.y()); }

/// q, on a line with p and r, is strictly between them.
bool between(const Point& p, const Point& q, const Point& r) {
  return (before(p, q) && before(q, r)) || (before(r, q) && before(q, p));
}

// ---- The plane ---------------------------------------------------------------------------------------------------

struct Plane {
  int axis = 2;  // that is left out
  double off_plane = 0, extent = 0;
};

Plane plane_of(std::span<const Index> corners, std::span<const Vec3> vertices) {
  const Vec3 origin = vertices[corners[0]];
  Vec3 low = origin, high = origin;
  for (const Index c : corners) low = low.cwiseMin(vertices[c]), high = high.cwiseMax(vertices[c]);
  Plane plane{.extent = (high - low).maxCoeff()};
  if (!(plane.extent > 0)) return plane;
  // By a power of two, so that products of the smallest lengths do not vanish.
  const double scale = std::ldexp(1, -std::ilogb(plane.extent));
  const auto at = [&](std::size_t i) { return Vec3((vertices[corners[i % corners.size()]] - origin) * scale); };
  Vec3 area = Vec3::Zero(), greatest = Vec3::Zero(), mean = Vec3::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 p = at(i), q = at(i + 1);
    const Vec3 n(p.y() * q.z() - p.z() * q.y(), p.z() * q.x() - p.x() * q.z(), p.x() * q.y() - p.y() * q.x());
    area += n;
    greatest += n.cwiseAbs();
    mean += p;
  }
  mean /= double(corners.size());
  // Both halves of a figure of eight: their sum says nothing.
  const bool cancelled = area.cwiseAbs().maxCoeff() <= 1e-12 * greatest.maxCoeff();
  (cancelled ? greatest : Vec3(area.cwiseAbs())).maxCoeff(&plane.axis);
  const double length = std::sqrt((area.x() * area.x() + area.y() * area.y()) + area.z() * area.z());
  if (cancelled || !(length > 0)) return plane;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 d = at(i) - mean;
    const double height = ((d.x() * area.x() + d.y() * area.y()) + d.z() * area.z()) / length;
    plane.off_plane = std::max(plane.off_plane, std::fabs(height) / scale);
  }
  return plane;
}

Points flattened(std::span<const Index> corners, std::span<const Vec3> vertices, int axis) {
  Points out;
  out.reserve(corners.size());
  for (const Index c : corners) out.emplace_back(vertices[c][(axis + 1) % 3], vertices[c][(axis + 2) % 3]);
  return out;
}

// ---- The fan -----------------------------------------------------------------------------------------------------

/// Seen from the first corner the others go around in one direction and less than once: the fan covers the inside and
/// nothing else, and the outline does not cross itself. Also true of a polygon without area that lies on a line.
bool fan_stays_inside(const Points& p) {
  int sign = 0;
  for (std::size_t k = 1; k + 1 < p.size(); ++k) {
    const int s = turn(p[0], p[k], p[k + 1]);
    if (s * sign < 0) return false;
    if (s != 0) sign = s;
  }
  if (sign == 0) return true;
  std::size_t first = 1, last = p.size() - 1;
  while (p[first] == p[0]) ++first;
  while (p[last] == p[0]) --last;
  bool half = false;  // half a turn is done
  for (std::size_t k = first + 1; k <= last; ++k) {
    if (p[k] == p[0] || (turn(p[0], p[k - 1], p[k]) == 0 && between(p[k - 1], p[0], p[k]))) return false;
    const int s = sign * turn(p[0], p[first], p[k]);
    const bool opposite = s == 0 && between(p[first], p[0], p[k]);
    if (half && s >= 0 && !opposite) return false;
    half = half || s < 0 || opposite;
  }
  return true;
}

// ---- Does the outline cross itself? ------------------------------------------------------------------------------

/// Whether the inside is on the inner side of an edge, near one of its ends. It is not along a bridge of no width
/// between two parts, where the outline runs back beside itself. Where two edges lie on each other in one direction it
/// is on that of one of them only.
enum class Side : char { outside, inside, unknown };

/// An outline that winds around each point once or never, in one direction.
struct Outline {
  int sign = 0;                        // 1: counter-clockwise; -1: clockwise; 0: without area
  std::vector<Side> at_start, at_end;  // of the edge from each corner to the next
  std::vector<Index> place;            // of each corner; those in one place have one number
};

/// A sweep from left to right over the edges, which are kept in their order from below to above. Edges on one line are
/// one bundle. At each corner the winding numbers of the gaps between the bundles that leave it are counted, and new
/// neighbours are asked whether they cross. Nothing when the outline crosses itself.
class Sweep {
 public:
  explicit Sweep(const Points& points) : p_(points) {}

  std::optional<Outline> outline() {
    const std::size_t n = p_.size();
    out_.at_start.assign(n, Side::outside);
    out_.at_end.assign(n, Side::outside);
    out_.place.resize(n);
    std::vector<Index> order(n);
    std::iota(order.begin(), order.end(), Index(0));
    std::sort(order.begin(), order.end(), [&](Index a, Index b) { return before(p_[a], p_[b]); });
    for (std::size_t i = 0; i < n;) {
      const std::size_t from = i;
      while (i < n && p_[order[i]] == p_[order[from]]) out_.place[order[i++]] = Index(from);
      if (!pass(std::span(order).subspan(from, i - from))) return std::nullopt;
    }
    return std::move(out_);
  }

 private:
  /// Edges that leave `from` in one direction; `to` is their farthest end.
  struct Bundle {
    Point from, to;
    int below, above;  // winding numbers on either side
    std::vector<Index> edges;
  };
  struct Order {
    using is_transparent = void;
    bool operator()(const Bundle& a, const Bundle& b) const {
      if (before(b.from, a.from)) {
        const int s = turn(b.from, b.to, a.from);
        return (s != 0 ? s : turn(b.from, b.to, a.to)) < 0;
      }
      const int s = turn(a.from, a.to, b.from);
      return (s != 0 ? s : turn(a.from, a.to, b.to)) > 0;
    }
    bool operator()(const Bundle& a, const Point& p) const { return turn(a.from, a.to, p) > 0; }
    bool operator()(const Point& p, const Bundle& a) const { return turn(a.from, a.to, p) < 0; }
  };

  const Point& start(Index edge) const { return p_[edge]; }
  const Point& end(Index edge) const { return p_[edge + 1 == p_.size() ? 0 : edge + 1]; }
  bool upward(Index edge) const { return before(start(edge), end(edge)); }
  const Point& farther(Index edge) const { return upward(edge) ? end(edge) : start(edge); }

  /// Notes on which side of the edge the inside is at its end at `p`.
  void note(Index edge, const Point& p, const Bundle& bundle) {
    const int net = bundle.above - bundle.below, all = int(bundle.edges.size());
    const bool alone = (upward(edge) ? all + net : all - net) == 2;
    const bool inside = out_.sign * ((out_.sign > 0) == upward(edge) ? bundle.above : bundle.below) == 1;
    (p == start(edge) ? out_.at_start : out_.at_end)[edge] = !inside ? Side::outside
                                                             : alone ? Side::inside
                                                                     : Side::unknown;
  }

  static bool cross(const Bundle& a, const Bundle& b) {
    return turn(a.from, a.to, b.from) * turn(a.from, a.to, b.to) < 0 &&
           turn(b.from, b.to, a.from) * turn(b.from, b.to, a.to) < 0;
  }

  /// The sweep passes the point at which these corners are.
  bool pass(std::span<const Index> corners) {
    const Point p = p_[corners[0]];
    auto first = active_.lower_bound(p);
    const auto last = active_.upper_bound(p);
    int winding = first == active_.begin() ? 0 : std::prev(first)->above;
    leaving_.clear();
    for (auto bundle = first; bundle != last; ++bundle)
      for (const Index edge : bundle->edges) {
        if (farther(edge) == p)
          note(edge, p, *bundle);
        else
          leaving_.push_back(edge);
      }
    active_.erase(first, last);
    for (const Index c : corners)
      for (const Index edge : {c, Index(c == 0 ? p_.size() - 1 : c - 1)})
        if (before(p, farther(edge))) leaving_.push_back(edge);
    std::sort(leaving_.begin(), leaving_.end(), [&](Index a, Index b) {
      const int s = turn(p, farther(a), farther(b));
      return s != 0 ? s > 0 : a < b;
    });
    auto neighbour = last;
    for (std::size_t i = 0; i < leaving_.size();) {
      Bundle bundle{.from = p, .to = farther(leaving_[i]), .below = winding, .above = winding, .edges = {}};
      for (; i < leaving_.size() && turn(p, bundle.to, farther(leaving_[i])) == 0; ++i) {
        const Index edge = leaving_[i];
        if (before(bundle.to, farther(edge))) bundle.to = farther(edge);
        bundle.above += upward(edge) ? 1 : -1;
        bundle.edges.push_back(edge);
      }
      winding = bundle.above;
      if (out_.sign == 0) out_.sign = winding;
      if (winding * out_.sign < 0 || std::abs(winding) > 1) return false;
      for (const Index edge : bundle.edges)
        if (start(edge) == p || end(edge) == p) note(edge, p, bundle);
      const auto added = active_.insert(last, std::move(bundle));
      if (neighbour == last) neighbour = added;  // the lowest of the new ones
    }
    if (neighbour != active_.begin() && neighbour != active_.end() && cross(*std::prev(neighbour), *neighbour))
      return false;
    return last == active_.begin() || last == active_.end() || !cross(*std::prev(last), *last);
  }

  const Points& p_;
  Outline out_;
  std::set<Bundle, Order> active_;
  std::vector<Index> leaving_;
};

// ---- Ears --------------------------------------------------------------------------------------------------------

/// Which of the points that are switched on are in a triangle: a static tree of boxes.
class PointTree2 {
 public:
  explicit PointTree2(const Points& points) : p_(points), order_(points.size()), place_(points.size()) {
    std::iota(order_.begin(), order_.end(), Index(0));
    build(0, 0, Index(order_.size()));
    for (Index i = 0; i < order_.size(); ++i) place_[order_[i]] = i;
    on_.assign(points.size(), 0);
  }

  void set(Index point, bool on) {
    if (bool(on_[point]) == on) return;
    on_[point] = on;
    Index lo = 0, hi = Index(order_.size());
    for (std::size_t node = 0;;) {
      nodes_[node].on += on ? 1 : Index(-1);
      if (hi - lo <= kLeaf) return;
      const Index middle = lo + (hi - lo) / 2;
      const bool left = place_[point] < middle;
      (left ? hi : lo) = middle;
      node = 2 * node + (left ? 1 : 2);
    }
  }

  /// Whether `wanted` holds for a point that is on and in a box that the triangle, counter-clockwise, reaches.
  template <class Wanted>
  bool any(const std::array<Point, 3>& t, const Wanted& wanted) const {
    return any(0, 0, Index(order_.size()), t, wanted);
  }

 private:
  static constexpr Index kLeaf = 8;
  struct Node {
    double low[2], high[2];
    Index on = 0;
  };

  void build(std::size_t node, Index lo, Index hi) {
    if (node >= nodes_.size()) nodes_.resize(node + 1);
    Node box{{p_[order_[lo]].x(), p_[order_[lo]].y()}, {p_[order_[lo]].x(), p_[order_[lo]].y()}};
    for (Index i = lo; i < hi; ++i)
      for (int k = 0; k < 2; ++k) {
        box.low[k] = std::min(box.low[k], p_[order_[i]][k]);
        box.high[k] = std::max(box.high[k], p_[order_[i]][k]);
      }
    nodes_[node] = box;
    if (hi - lo <= kLeaf) return;
    const int k = box.high[0] - box.low[0] < box.high[1] - box.low[1];
    const Index middle = lo + (hi - lo) / 2;
    std::nth_element(order_.begin() + lo, order_.begin() + middle, order_.begin() + hi,
                     [&](Index a, Index b) { return p_[a][k] != p_[b][k] ? p_[a][k] < p_[b][k] : a < b; });
    build(2 * node + 1, lo, middle);
    build(2 * node + 2, middle, hi);
  }

  static bool apart(const Node& box, const std::array<Point, 3>& t) {
    for (int k = 0; k < 2; ++k)
      if ((t[0][k] < box.low[k] && t[1][k] < box.low[k] && t[2][k] < box.low[k]) ||
          (t[0][k] > box.high[k] && t[1][k] > box.high[k] && t[2][k] > box.high[k]))
        return true;
    for (int i = 0; i < 3; ++i) {
      const Point &a = t[i], &b = t[(i + 1) % 3];
      // The corner of the box that is farthest to the left of the way from a to b.
      if (turn(a, b, {b.y() < a.y() ? box.high[0] : box.low[0], b.x() > a.x() ? box.high[1] : box.low[1]}) < 0)
        return true;
    }
    return false;
  }

  template <class Wanted>
  bool any(std::size_t node, Index lo, Index hi, const std::array<Point, 3>& t, const Wanted& wanted) const {
    if (nodes_[node].on == 0 || apart(nodes_[node], t)) return false;
    if (hi - lo <= kLeaf)
      return std::any_of(order_.begin() + lo, order_.begin() + hi, [&](Index i) { return on_[i] && wanted(i); });
    const Index middle = lo + (hi - lo) / 2;
    return any(2 * node + 1, lo, middle, t, wanted) || any(2 * node + 2, middle, hi, t, wanted);
  }

  const Points& p_;
  std::vector<Index> order_, place_;
  std::vector<Node> nodes_;
  std::vector<char> on_;
};

/// Cuts a counter-clockwise outline that does not cross itself. `side` is that of the edge that leaves each corner,
/// there; `place` as in Outline.
class Ears {
 public:
  /// Which ear is cut first: by its third side, or by its corner's number.
  enum class Order { shortest, longest, number };

  Ears(const Points& points, std::vector<Side> side, std::vector<Index> place, Order order)
      : p_(points),
        order_(order),
        side_(std::move(side)),
        place_(std::move(place)),
        tree_(points),
        next_(points.size()),
        last_(points.size()),
        at_place_(points.size(), 0) {
    for (Index i = 0; i < p_.size(); ++i) {
      next_[i] = i + 1 == p_.size() ? 0 : i + 1;
      last_[next_[i]] = i;
      ++at_place_[place_[i]];
    }
  }

  /// Hands corners (u, v, w) to `out`; false when no ear is found any more.
  ///
  /// Whether a corner is an ear changes only with its neighbours: what is in its triangle and then cut off leaves an
  /// edge behind that has an end in the triangle. So a corner is asked anew only after a neighbour went.
  template <class Out>
  bool cut(const Out& out) {
    Index left = Index(p_.size());
    asked_.assign(left, 0);
    gone_.assign(left, 0);
    for (Index i = 0; i < left; ++i) tree_.set(i, !convex(i));
    wait_all();
    bool progress = true;
    while (left > 3) {
      if (queue_.empty()) {
        if (!progress && touching_) return false;
        touching_ = true;
        progress = false;
        wait_all();
      }
      const auto [length, v, time] = queue_.top();
      queue_.pop();
      if (gone_[v] || time != asked_[v] || !(runs_back(v) || is_ear(v))) continue;
      const Index u = last_[v], w = next_[v];
      out(u, v, w);
      side_[u] = Side::unknown;
      next_[u] = w;
      last_[w] = u;
      gone_[v] = 1;
      --at_place_[place_[v]];
      tree_.set(v, false);
      for (const Index i : {u, w}) {
        tree_.set(i, !convex(i));
        wait(i);
      }
      progress = true;
      --left;
    }
    Index v = 0;
    while (gone_[v]) ++v;
    const Index u = last_[v], w = next_[v];
    if (turn(p_[u], p_[v], p_[w]) < 0) return false;
    out(u, v, w);
    return true;
  }

 private:
  bool convex(Index v) const { return turn(p_[last_[v]], p_[v], p_[next_[v]]) > 0; }

  /// The corner repeats a neighbour, or the outline turns back on itself there: cutting it takes nothing from the
  /// inside.
  bool runs_back(Index v) const {
    const Point &u = p_[last_[v]], &w = p_[next_[v]];
    return turn(u, p_[v], w) == 0 && !between(u, p_[v], w);
  }

  /// Corners that run back go first: an ear beside one may be outside.
  void wait(Index v) {
    const Point &u = p_[last_[v]], &w = p_[next_[v]];
    const double x = w.x() - u.x(), y = w.y() - u.y();
    const double square = x * x + y * y;
    const double rank = order_ == Order::shortest ? square : order_ == Order::longest ? -square : 0;
    queue_.push({runs_back(v) ? -kInfinity : rank, v, ++asked_[v]});
  }
  void wait_all() {
    for (Index v = 0; v < p_.size(); ++v)
      if (!gone_[v]) wait(v);
  }

  /// Whether an edge of corner p goes to the left of the way from a to b.
  bool goes_left(Index p, const Point& a, const Point& b) const {
    return turn(a, b, p_[last_[p]]) > 0 || turn(a, b, p_[next_[p]]) > 0;
  }
  /// Whether an edge of corner p, which is where x is, goes into the triangle x, y, z.
  bool goes_into(Index p, const Point& x, const Point& y, const Point& z) const {
    for (const Index q : {last_[p], next_[p]})
      if (turn(x, y, p_[q]) > 0 && turn(x, z, p_[q]) < 0) return true;
    return false;
  }

  /// The triangle of v, in which nothing of the outline is, is inside. It can only be outside where both edges of v
  /// have others lying on them, so only where another corner is in the place of v. Else an end of the outline is
  /// counted: the way to a point in the triangle, if it is so thick that a double is in it.
  bool is_inside(Index v) const {
    if (side_[v] != Side::unknown) return side_[v] == Side::inside;
    if (at_place_[place_[v]] == 1) return true;
    const Point &u = p_[last_[v]], &m = p_[v], &w = p_[next_[v]];
    const Point x((u.x() + m.x() + w.x()) / 3, (u.y() + m.y() + w.y()) / 3);
    if (turn(u, m, x) <= 0 || turn(m, w, x) <= 0 || turn(w, u, x) <= 0) return true;
    int winding = 0;
    Index i = v;
    do {
      const Point &a = p_[i], &b = p_[next_[i]];
      if ((a.y() > x.y()) != (b.y() > x.y())) {
        const int up = b.y() > a.y() ? 1 : -1;
        if (turn(a, b, x) == up) winding += up;  // the edge is to the right of x
      }
      i = next_[i];
    } while (i != v);
    return winding == 1;
  }

  /// Nothing of the outline is within the triangle of v. It would come in by the edge from w to u, and its corner that
  /// is farthest from there is not convex: only such ones are looked at. One on that edge would make the next triangles
  /// flat, so it counts too as long as there are other ears.
  bool is_ear(Index v) const {
    const Index a = last_[v], b = next_[v];
    if (!convex(v) || side_[v] == Side::outside) return false;
    const Point &u = p_[a], &m = p_[v], &w = p_[b];
    const bool blocked = tree_.any({u, m, w}, [&](Index i) {
      if (i == a || i == v || i == b) return false;
      const Point& p = p_[i];
      const int um = turn(u, m, p), mw = turn(m, w, p), wu = turn(w, u, p);
      if (um < 0 || mw < 0 || wu < 0) return false;
      if (p == u) return goes_into(i, u, m, w);
      if (p == m) return goes_into(i, m, w, u);
      if (p == w) return goes_into(i, w, u, m);
      if (um == 0) return goes_left(i, u, m);
      if (mw == 0) return goes_left(i, m, w);
      if (wu == 0) return !touching_ || goes_left(i, w, u);
      return true;
    });
    return !blocked && is_inside(v);
  }

  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  const Points& p_;
  Order order_;
  std::vector<Side> side_;
  std::vector<Index> place_;
  PointTree2 tree_;
  std::vector<Index> next_, last_;
  std::vector<Index> at_place_;  // how many corners are still there
  std::vector<char> gone_;
  std::vector<Index> asked_;  // how often a corner was put into the queue: only its last entry counts
  using Entry = std::tuple<double, Index, Index>;  // rank, corner, asked_
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
  bool touching_ = false;
};

bool cut_ears(Points p, std::span<const Index> corners, std::span<Facet> out) {
  std::optional<Outline> outline = Sweep(p).outline();
  if (!outline) return false;
  const std::size_t n = p.size();
  const bool clockwise = outline->sign < 0;
  std::vector<Side> side = outline->at_start;
  if (clockwise) {  // from its last corner to its first
    std::reverse(p.begin(), p.end());
    std::reverse(outline->place.begin(), outline->place.end());
    for (std::size_t i = 0; i < n; ++i) side[i] = outline->at_end[(2 * n - 2 - i) % n];
  }
  const auto corner = [&](Index i) { return corners[clockwise ? n - 1 - i : i]; };
  // The shortest first, as that keeps triangles small. Where walls of no width lie on each other in several layers it
  // may come to an end before all is cut (1 of 3000 random ones of the kind); then another order nearly always does
  // not.
  for (const Ears::Order order : {Ears::Order::shortest, Ears::Order::longest, Ears::Order::number}) {
    std::size_t done = 0;
    if (Ears(p, side, outline->place, order).cut([&](Index u, Index v, Index w) {
          out[done++] = clockwise ? Facet{corner(w), corner(v), corner(u)} : Facet{corner(u), corner(v), corner(w)};
        }))
      return true;
  }
  return false;
}

}  // namespace

PolygonFacts cut_polygon(std::span<const std::uint32_t> corners, std::span<const Vec3> vertices, std::span<Facet> out) {
  assert(corners.size() >= 3 && out.size() + 2 == corners.size() && "n corners make n - 2 triangles");
  const auto fan = [&] {
    for (std::size_t k = 2; k < corners.size(); ++k) out[k - 2] = {corners[0], corners[k - 1], corners[k]};
  };
  if (corners.size() == 3) {
    fan();
    return {};
  }
  const Plane plane = plane_of(corners, vertices);
  PolygonFacts facts{.off_plane = plane.off_plane, .extent = plane.extent};
  Points points = flattened(corners, vertices, plane.axis);
  if (fan_stays_inside(points)) {
    fan();
  } else if (!cut_ears(std::move(points), corners, out)) {
    facts.crosses_itself = true;
    fan();
  }
  return facts;
}

}  // namespace geometry
