// Exact triangle tests: a filter in doubles first, CGAL for whatever it cannot certify.
//
// The filter follows P. Guigue, O. Devillers, "Fast and robust triangle-triangle overlap test using orientation
// predicates", 2003, in general position only; its error bound is derived below. CGAL's do_intersect for the kernel
// Epick is exact for the doubles it is given, but its precondition is a proper triangle. Given degenerate ones
// CGAL 5.5.1 throws, or under NDEBUG answers wrongly: 8887 false hits and no miss in 20,000 pairs of small integer
// coordinates. So a triangle whose corners lie on one line is handed to it as the segment or the point that it is: 0
// wrong of the same.
//
// CGAL's exact stage computes in multi-precision numbers with an exponent of 32 bits, so denormals and
// coordinates up to the greatest double are no special case (tests/geometry/exact_test.cpp asks for both).
#include "geometry/decision/exact.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Point_3.h>
#include <CGAL/Segment_3.h>
#include <CGAL/Triangle_3.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "geometry/vec.hpp"

namespace geometry {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Segment = Kernel::Segment_3;

/// (q - p) x (r - p) in doubles, with what bounds its error.
struct Normal {
  Vec3 n;
  Vec3 magnitude;  // per component the sum of the absolute products
};

Normal normal(const Vec3& p, const Vec3& q, const Vec3& r) {
  const Vec3 e = q - p, f = r - p;
  const double yz = e.y() * f.z(), zy = e.z() * f.y();
  const double zx = e.z() * f.x(), xz = e.x() * f.z();
  const double xy = e.x() * f.y(), yx = e.y() * f.x();
  return {{yz - zy, zx - xz, xy - yx},
          {std::fabs(yz) + std::fabs(zy), std::fabs(zx) + std::fabs(xz), std::fabs(xy) + std::fabs(yx)}};
}

// Error of dot(normal(p, q, r).n, s - p), with u = 2^-53 and h = 2^-1075, the greatest absolute error of a product that
// underflows (sums and differences never lose anything to underflow). A component of the normal passes through four
// roundings (two differences, a product, a sum), the dot product through four more (a difference, a product, two sums).
// With P the sum of the absolute triple products, without underflow
//   |error| <= ((1 + u)^8 - 1) P < 8.1 u P                                                                      (1)
//
// P is itself computed, from below by no more than (1 - u)^8. Covered twice by
//   kRelative = 2^-49 = 16 u                                                                                    (2)
//
// Underflow adds at most 3 h to a component of the normal and its magnitude, which the difference d multiplies, and 3 h
// to each dot product, covered by kUnderflow many times:
//   |error by underflow| < 10 h (1 + |dx| + |dy| + |dz|) < kUnderflow (1 + |dx| + |dy| + |dz|)                  (3)
//
// Overflow gives an infinite or undefined bound, with which no comparison is true: nothing is certified then.
constexpr double kRelative = 0x1p-49;     // (2)
constexpr double kUnderflow = 0x1p-1060;  // (3)

/// The error of dot(normal.n, d) for every |d| <= reach.
double bound(const Normal& normal, const Vec3& reach) {
  return kRelative * dot(normal.magnitude, reach) + kUnderflow * (1 + ((reach.x() + reach.y()) + reach.z()));
}

/// The sign of what was computed with this error, where it is certain; 0 when uncertain.
int sign(double value, double error) { return (value > error) - (value < -error); }

/// The certain sides of t's corners with respect to the plane.
struct Sides {
  std::array<int, 3> of;
  bool apart() const { return of[0] != 0 && of[0] == of[1] && of[0] == of[2]; }
  bool certain() const { return of[0] != 0 && of[1] != 0 && of[2] != 0; }
  /// The corner that is alone on its side; the corners are certain and not all on one side.
  int lone() const { return of[0] == of[1] ? 2 : of[0] == of[2] ? 1 : 0; }
};

Sides sides(const Normal& plane, const Vec3& origin, const Triangle& t) {
  const Vec3 d0 = t[0] - origin, d1 = t[1] - origin, d2 = t[2] - origin;
  const double e = bound(plane, d0.cwiseAbs().cwiseMax(d1.cwiseAbs()).cwiseMax(d2.cwiseAbs()));
  return {{sign(dot(plane.n, d0), e), sign(dot(plane.n, d1), e), sign(dot(plane.n, d2), e)}};
}

/// The certain side of s with respect to the plane through p, q, r; 0 when uncertain.
int certain_side(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  const Normal plane = normal(p, q, r);
  const Vec3 d = s - p;
  return sign(dot(plane.n, d), bound(plane, d.cwiseAbs()));
}

enum class Answer { kApart, kMeet, kUncertain };

/// Guigue and Devillers' interval test. Each triangle has its corners certainly on both sides of the other's plane, so
/// each cuts the line common to both planes in an interval. Turned so that corner 0 is alone on its side, and mirrored
/// so that this side is the positive one, the intervals overlap exactly when two orientations are not positive.
Answer intervals_meet(const Triangle& a, const Sides& a_sides, const Triangle& b, const Sides& b_sides) {
  const int i = a_sides.lone(), j = b_sides.lone();
  const Vec3 &a0 = a[i], &b0 = b[j];
  const Vec3 *a1 = &a[(i + 1) % 3], *a2 = &a[(i + 2) % 3], *b1 = &b[(j + 1) % 3], *b2 = &b[(j + 2) % 3];
  if (a_sides.of[i] < 0) std::swap(b1, b2);
  if (b_sides.of[j] < 0) std::swap(a1, a2);
  const int low = certain_side(*a1, b0, a0, *b1);
  if (low > 0) return Answer::kApart;
  const int high = certain_side(a0, b0, *a2, *b2);
  if (high > 0) return Answer::kApart;
  return low < 0 && high < 0 ? Answer::kMeet : Answer::kUncertain;
}

Point point(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

/// True when a component of the computed normal is certainly not 0.
bool certainly_proper(const Normal& normal) {
  // Four roundings instead of eight and nothing multiplied afterwards: bound() covers this with a reach of 1.
  return (normal.n.array().abs() > kRelative * normal.magnitude.array() + kUnderflow).any();
}

bool collinear(const Triangle& t) { return CGAL::collinear(point(t[0]), point(t[1]), point(t[2])); }

/// A triangle as the simplex it is. Collinear points lie on their line in lexicographic order.
std::variant<Kernel::Triangle_3, Segment, Point> simplex(const Triangle& t, const Normal& normal) {
  const Point p = point(t[0]), q = point(t[1]), r = point(t[2]);
  if (certainly_proper(normal) || !collinear(t)) return Kernel::Triangle_3(p, q, r);
  const auto [first, last] = std::minmax({p, q, r});
  if (first == last) return p;
  return Segment(first, last);
}

}  // namespace

bool is_degenerate(const Triangle& t) { return !certainly_proper(normal(t[0], t[1], t[2])) && collinear(t); }

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const int certain = certain_side(a, b, c, d);
  return certain != 0 ? certain : static_cast<int>(CGAL::orientation(point(a), point(b), point(c), point(d)));
}

bool triangles_meet(const Triangle& a, const Triangle& b) {
  // All corners certainly on one side of a plane means apart, whether or not the other triangle is degenerate.
  const Normal a_normal = normal(a[0], a[1], a[2]);
  const Sides b_sides = sides(a_normal, a[0], b);
  if (b_sides.apart()) return false;
  const Normal b_normal = normal(b[0], b[1], b[2]);
  const Sides a_sides = sides(b_normal, b[0], a);
  if (a_sides.apart()) return false;
  // A certain side with respect to a plane also certifies that its triangle is proper.
  if (a_sides.certain() && b_sides.certain()) {
    const Answer answer = intervals_meet(a, a_sides, b, b_sides);
    if (answer != Answer::kUncertain) return answer == Answer::kMeet;
  }
  return std::visit([](const auto& s, const auto& t) { return CGAL::do_intersect(s, t); }, simplex(a, a_normal),
                    simplex(b, b_normal));
}

}  // namespace geometry
