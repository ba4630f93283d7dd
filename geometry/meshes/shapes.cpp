// The built-in shapes, after Babylon.js's builders (sphere, box, torus, torus knot), whose meshes the thesis used, but
// closed: neighbouring facets share their vertices, poles are single vertices, no facet is without area.
//
// Babylon.js is left-handed and its facets run clockwise seen from outside in our right-handed frame; here each keeps
// Babylon's first corner and has the other two swapped. Angles are folded into the first octant before the sine
// is taken, so that meshes are mirror-symmetric to the last bit and lie exactly on the axes where they should.
#include "geometry/meshes/shapes.hpp"

#include <cassert>
#include <charconv>
#include <cmath>
#include <numbers>
#include <numeric>

#include "geometry/portable_math.hpp"
#include "geometry/vec.hpp"

namespace geometry {
namespace {

/// JSON of a shape: {"kind":"box","size":[1,1,1]}. Doubles in their shortest form that reads back the same.
class Json {
 public:
  explicit Json(const char* kind) : text_(std::string("{\"kind\":\"") + kind + '"') {}

  Json& add(const char* key, double value) { return field(key, number(value)); }
  Json& add(const char* key, std::int64_t value) { return field(key, std::to_string(value)); }
  Json& add(const char* key, const Vec3& value) {
    return field(key, '[' + number(value.x()) + ',' + number(value.y()) + ',' + number(value.z()) + ']');
  }
  std::string text() const { return text_ + '}'; }

 private:
  static std::string number(double value) {
    char buffer[32];  // the longest double takes 24
    return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
  }
  Json& field(const char* key, const std::string& value) {
    text_ += std::string(",\"") + key + "\":" + value;
    return *this;
  }

  std::string text_;
};

struct Direction {
  double cos = 1, sin = 0;
};

/// The direction at k of n equal parts of the full turn, 0 <= k. Exact on the axes; directions that mirror each other
/// at an axis or a diagonal have the same digits.
Direction direction(std::int64_t k, std::int64_t n) {
  std::int64_t part = 8 * (k % n);  // in 8n-ths of the turn
  const bool below = part > 4 * n;
  if (below) part = 8 * n - part;
  const bool left = part > 2 * n;
  if (left) part = 4 * n - part;
  const bool steep = part > n;
  if (steep) part = 2 * n - part;

  const double angle = static_cast<double>(part) * (std::numbers::pi / 4) / static_cast<double>(n);
  const double c = portable::cos(angle), s = part == n ? c : portable::sin(angle);
  Direction d = steep ? Direction{s, c} : Direction{c, s};
  if (left) d.cos = -d.cos;
  if (below) d.sin = -d.sin;
  return d;
}

/// A point of the meridian of a body of revolution about y: distance from the axis and height, metres.
struct MeridianPoint {
  double out = 0, y = 0;
};

/// The closed body of revolution about y with these rows from top to bottom; the first and the last lie on the axis and
/// become poles. Vertex order: top pole, row 1, ..., bottom pole; column j of a row is
/// (out cos f, y, -out sin f), f = 2 pi j / columns. Triangle order: bands from the top, columns within a band; with
/// v(i, j) of row i, first v(i,j) v(i+1,j) v(i,j+1), then v(i+1,j) v(i+1,j+1) v(i,j+1); at a pole only the one of the
/// two that has an area.
void revolve(Mesh& mesh, const std::vector<MeridianPoint>& rows, std::int64_t columns) {
  const std::size_t last = rows.size() - 1;
  mesh.vertices.emplace_back(0, rows[0].y, 0);
  for (std::size_t i = 1; i < last; ++i)
    for (std::int64_t j = 0; j < columns; ++j) {
      const Direction f = direction(j, columns);
      mesh.vertices.emplace_back(rows[i].out * f.cos, rows[i].y, 0.0 - rows[i].out * f.sin);  // 0.0 -: no minus zero
    }
  mesh.vertices.emplace_back(0, rows[last].y, 0);

  const auto vertex = [&](std::size_t i, std::int64_t j) {
    if (i == 0) return std::uint32_t{0};
    if (i == last) return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    return static_cast<std::uint32_t>(1 + (i - 1) * columns + j % columns);
  };
  for (std::size_t i = 0; i < last; ++i)
    for (std::int64_t j = 0; j < columns; ++j) {
      if (i > 0) mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
      if (i + 1 < last) mesh.triangles.push_back({vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
}

/// Distance of the origin of the meridian plane from the segment pq.
double distance_from_origin(const MeridianPoint& p, const MeridianPoint& q) {
  const double dx = q.out - p.out, dy = q.y - p.y;
  const double along = -(p.out * dx + p.y * dy) / (dx * dx + dy * dy);
  const double t = std::fmin(1, std::fmax(0, along));
  const double x = p.out + t * dx, y = p.y + t * dy;
  return std::sqrt(x * x + y * y);
}

/// The greatest of f on [0, 1], f being concave there.
template <class Function>
double greatest_of_concave(const Function& f) {
  double low = 0, high = 1, greatest = std::fmax(f(low), f(high));
  for (int i = 0; i < 80; ++i) {  // (2/3)^80 = 1e-14: beyond that the value no longer changes
    const double left = low + (high - low) / 3, right = high - (high - low) / 3;
    const double at_left = f(left), at_right = f(right);
    greatest = std::fmax(greatest, std::fmax(at_left, at_right));
    (at_left < at_right ? low : high) = at_left < at_right ? left : right;
  }
  return greatest;
}

/// The facets of a tube that closes in both directions: `rings` rings of `sides` vertices each, ring by ring. Order:
/// rings, sides within a ring; `corners` makes the two facets of a quad from (i,j), (i+1,j), (i+1,j+1), (i,j+1).
template <class Corners>
void close_tube(Mesh& mesh, std::int64_t rings, std::int64_t sides, const Corners& corners) {
  const auto vertex = [&](std::int64_t i, std::int64_t j) {
    return static_cast<std::uint32_t>((i % rings) * sides + j % sides);
  };
  for (std::int64_t i = 0; i < rings; ++i)
    for (std::int64_t j = 0; j < sides; ++j)
      for (const Facet& facet : corners(vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)))
        mesh.triangles.push_back(facet);
}

/// The greatest value of distance(facet, weights, point) over a grid of points on every facet: barycentric weights in
/// quarters, so that corners and the middles of edges are among them.
template <class Distance>
double greatest_on_grid(const Mesh& mesh, const Distance& distance) {
  constexpr int kParts = 4;
  double greatest = 0;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const auto& [a, b, c] = mesh.triangles[f];
    for (int i = 0; i <= kParts; ++i)
      for (int j = 0; i + j <= kParts; ++j) {
        const Vec3 weights = Vec3(kParts - i - j, i, j) / kParts;
        const Vec3 point =
            weights[0] * mesh.vertices[a] + weights[1] * mesh.vertices[b] + weights[2] * mesh.vertices[c];
        greatest = std::fmax(greatest, distance(f, weights, point));
      }
  }
  return greatest;
}

Vec3 unit(const Vec3& v) { return v / std::sqrt(dot(v, v)); }

/// The curve inside a torus knot and its derivatives by the angle u, which runs from 0 to 2 pi p:
/// radius / 2 ((2 + cos v) cos u, (2 + cos v) sin u, sin v), v = u q / p.
struct KnotCurve {
  double radius, q_over_p;

  Vec3 operator()(double u) const {
    const double v = q_over_p * u, out = 2 + portable::cos(v);
    return 0.5 * radius * Vec3(out * portable::cos(u), out * portable::sin(u), portable::sin(v));
  }

  /// Distance of p from the curve near u (Newton's method on the squared distance).
  double distance(const Vec3& p, double u) const {
    const double k = q_over_p;
    for (int i = 0; i < 20; ++i) {
      const double cu = portable::cos(u), su = portable::sin(u), cv = portable::cos(k * u), sv = portable::sin(k * u);
      const double out = 2 + cv, out1 = -k * sv, out2 = -k * k * cv;
      const Vec3 to_curve = 0.5 * radius * Vec3(out * cu, out * su, sv) - p;
      const Vec3 first = 0.5 * radius * Vec3(out1 * cu - out * su, out1 * su + out * cu, k * cv);
      const Vec3 second =
          0.5 * radius * Vec3(out2 * cu - 2 * out1 * su - out * cu, out2 * su + 2 * out1 * cu - out * su, -k * k * sv);
      const double slope = dot(to_curve, first), steepness = dot(first, first);
      const double bend = steepness + dot(to_curve, second);
      // Where a thick tube passes a centre of curvature, the second derivative is useless.
      const double step = slope / (bend > 0.1 * steepness ? bend : steepness);
      u -= step;
      if (std::abs(step) < 1e-5) break;  // convergence is quadratic: what remains is below 1e-9 radians
    }
    const Vec3 nearest = (*this)(u), to_curve = nearest - p;
    return std::sqrt(dot(to_curve, to_curve));
  }
};

}  // namespace

// Both triangles of a quad lie in one plane (a trapezoid mirrored by its middle meridian), so the quad's point nearest
// to the centre lies on that meridian, where its rows are nearer to the axis by cos(pi / columns).
Mesh sphere(const std::string& name, double radius, std::int64_t segments) {
  assert(radius > 0 && "radius is positive");
  assert(segments >= 1 && "a sphere has at least one segment");
  const std::int64_t bands = segments + 2, columns = 2 * bands;
  std::vector<MeridianPoint> rows;
  for (std::int64_t i = 0; i <= bands; ++i) {
    const Direction d = direction(i, 2 * bands);
    rows.push_back({radius * d.sin, radius * d.cos});
  }
  Mesh mesh;
  mesh.name = name;
  mesh.shape = Json("sphere").add("radius", radius).add("segments", segments).text();
  mesh.sphere_radius = radius;
  revolve(mesh, rows, columns);

  const double inner = direction(1, 2 * columns).cos;
  double nearest = radius;
  for (std::int64_t i = 0; i < bands; ++i)
    nearest = std::fmin(
        nearest, distance_from_origin({inner * rows[i].out, rows[i].y}, {inner * rows[i + 1].out, rows[i + 1].y}));
  mesh.surface_deviation = radius - nearest;
  return mesh;
}

Mesh box(const std::string& name, const Vec3& size) {
  assert(size.minCoeff() >= 0 && "no side of a box is negative");
  Mesh mesh;
  mesh.name = name;
  mesh.shape = Json("box").add("size", size).text();
  mesh.surface_deviation = 0;
  const Vec3 half = 0.5 * size;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back(i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(),
                               i & 4 ? half.z() : -half.z());
  mesh.triangles = {{5, 6, 4}, {5, 7, 6},   // +z
                    {3, 0, 2}, {3, 1, 0},   // -z
                    {3, 5, 1}, {3, 7, 5},   // +x
                    {6, 0, 4}, {6, 2, 0},   // -x
                    {6, 3, 2}, {6, 7, 3},   // +y
                    {5, 0, 1}, {5, 4, 0}};  // -y
  return mesh;
}

// Inside a convex body the depth below its surface is a concave function, and each quad is mirrored by its middle
// meridian: so the deepest point of a quad lies on that meridian.
Mesh capsule(const std::string& name, double height, double radius_bottom, double radius_top, std::int64_t segments) {
  const double between = height - radius_bottom - radius_top;  // the centres of the two spheres
  assert(radius_bottom > 0 && radius_top > 0 && "radii are positive");
  assert(between > std::abs(radius_bottom - radius_top) &&
         "a capsule is high enough for neither cap to hold the other");
  assert(segments >= 1 && "a capsule has at least one segment");
  const std::int64_t bands = segments + 2, columns = 2 * bands, cap_bands = (bands + 1) / 2;
  constexpr std::int64_t kSideBands = 2;  // Babylon.js's preset
  const double top_y = 0.5 * height - radius_top, bottom_y = radius_bottom - 0.5 * height;
  // The side's outward normal rises by this angle; caps and side meet where the spheres have that normal.
  const double rise_sin = (radius_bottom - radius_top) / between, rise_cos = std::sqrt(1 - rise_sin * rise_sin);
  const double rise = portable::asin(rise_sin), quarter_turn = std::numbers::pi / 2;

  std::vector<MeridianPoint> rows;
  rows.push_back({0, 0.5 * height});
  for (std::int64_t i = 1; i < cap_bands; ++i) {
    const double angle = (quarter_turn - rise) * static_cast<double>(i) / static_cast<double>(cap_bands);
    rows.push_back({radius_top * portable::sin(angle), top_y + radius_top * portable::cos(angle)});
  }
  const MeridianPoint upper{radius_top * rise_cos, top_y + radius_top * rise_sin};
  const MeridianPoint lower{radius_bottom * rise_cos, bottom_y + radius_bottom * rise_sin};
  for (std::int64_t i = 0; i <= kSideBands; ++i) {
    const double t = static_cast<double>(i) / kSideBands;
    rows.push_back({(1 - t) * upper.out + t * lower.out, (1 - t) * upper.y + t * lower.y});
  }
  for (std::int64_t i = cap_bands - 1; i > 0; --i) {
    const double angle = (quarter_turn + rise) * static_cast<double>(i) / static_cast<double>(cap_bands);
    rows.push_back({radius_bottom * portable::sin(angle), bottom_y - radius_bottom * portable::cos(angle)});
  }
  rows.push_back({0, -0.5 * height});

  Mesh mesh;
  mesh.name = name;
  mesh.shape = Json("capsule")
                   .add("height", height)
                   .add("radius_bottom", radius_bottom)
                   .add("radius_top", radius_top)
                   .add("segments", segments)
                   .text();
  revolve(mesh, rows, columns);

  const auto depth = [&](const MeridianPoint& p) {
    const double y = p.y - bottom_y, along = rise_cos * y - rise_sin * p.out;
    if (along < 0) return radius_bottom - std::sqrt(p.out * p.out + y * y);
    if (along > rise_cos * between) return radius_top - std::sqrt(p.out * p.out + (y - between) * (y - between));
    return radius_bottom - (rise_cos * p.out + rise_sin * y);
  };
  const double inner = direction(1, 2 * columns).cos;
  mesh.surface_deviation = 0;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i)
    mesh.surface_deviation = std::fmax(mesh.surface_deviation, greatest_of_concave([&](double t) {
                                         return depth({inner * ((1 - t) * rows[i].out + t * rows[i + 1].out),
                                                       (1 - t) * rows[i].y + t * rows[i + 1].y});
                                       }));
  return mesh;
}

Mesh torus(const std::string& name, double diameter, double thickness, std::int64_t segments) {
  assert(thickness > 0 && thickness < diameter && "a torus has a hole");
  assert(segments >= 3 && "a torus has at least three segments");
  const double ring = 0.5 * diameter, tube = 0.5 * thickness;
  Mesh mesh;
  mesh.name = name;
  mesh.shape = Json("torus").add("diameter", diameter).add("thickness", thickness).add("segments", segments).text();
  for (std::int64_t i = 0; i < segments; ++i)
    for (std::int64_t j = 0; j < segments; ++j) {
      const Direction around = direction(i, segments), section = direction(j, segments);
      const double out = ring - tube * section.cos;
      mesh.vertices.emplace_back(out * around.sin, 0.0 - tube * section.sin, out * around.cos);  // 0.0 -: no minus zero
    }
  close_tube(mesh, segments, segments, [](auto a, auto b, auto c, auto d) {
    return std::array<Facet, 2>{{{a, b, d}, {d, b, c}}};
  });
  mesh.surface_deviation = greatest_on_grid(mesh, [&](std::size_t, const Vec3&, const Vec3& p) {
    const double out = std::sqrt(p.x() * p.x() + p.z() * p.z()) - ring;
    return std::abs(std::sqrt(out * out + p.y() * p.y()) - tube);
  });
  return mesh;
}

Mesh torus_knot(const std::string& name, double radius, double tube, std::int64_t radial_segments,
                std::int64_t tubular_segments, std::int64_t p, std::int64_t q) {
  assert(radius > 0 && tube > 0 && "radius and tube are positive");
  assert(radial_segments >= 3 && tubular_segments >= 3 && "a knot has at least three segments each way");
  assert(p >= 1 && q >= 1 && std::gcd(p, q) == 1 && "p and q have no common factor");
  const KnotCurve curve{radius, static_cast<double>(q) / static_cast<double>(p)};
  const double part = 2 * std::numbers::pi * static_cast<double>(p) / static_cast<double>(radial_segments);
  Mesh mesh;
  mesh.name = name;
  mesh.shape = Json("torus_knot")
                   .add("radius", radius)
                   .add("tube", tube)
                   .add("radial_segments", radial_segments)
                   .add("tubular_segments", tubular_segments)
                   .add("p", p)
                   .add("q", q)
                   .text();
  for (std::int64_t i = 0; i < radial_segments; ++i) {
    constexpr double kAhead = 0.01;  // radians, Babylon.js's
    const double u = part * static_cast<double>(i);
    const Vec3 here = curve(u), ahead = curve(u + kAhead);
    const Vec3 tangent = ahead - here, side = cross(tangent, ahead + here);
    const Vec3 normal = unit(cross(side, tangent)), binormal = unit(side);
    for (std::int64_t j = 0; j < tubular_segments; ++j) {
      const Direction section = direction(j, tubular_segments);
      mesh.vertices.push_back(here - tube * section.cos * normal + tube * section.sin * binormal);
    }
  }
  close_tube(mesh, radial_segments, tubular_segments, [](auto a, auto b, auto c, auto d) {
    return std::array<Facet, 2>{{{d, a, b}, {d, b, c}}};
  });
  mesh.surface_deviation = greatest_on_grid(mesh, [&](std::size_t facet, const Vec3& weights, const Vec3& point) {
    // Two facets a quad: d a b has one corner (b) on the next ring, d b c has two.
    const double ahead = facet % 2 == 0 ? weights[2] : weights[1] + weights[2];
    const double u = part * (static_cast<double>(facet / 2 / tubular_segments) + ahead);
    return std::abs(curve.distance(point, u) - tube);
  });
  return mesh;
}

}  // namespace geometry
