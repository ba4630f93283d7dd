// The built-in shapes, after Babylon.js's builders (sphere, box, torus, torus knot), whose meshes the thesis used, but
// closed: neighbouring facets share their vertices, poles are single vertices, no facet is without area.
//
// Babylon.js is left-handed and its facets run clockwise seen from outside in our right-handed frame; here each keeps
// Babylon's first corner and has the other two swapped. Angles are folded into the first octant before the sine
// is taken, so that meshes are mirror-symmetric to the last bit and lie exactly on the axes where they should.
#include "geometry/shapes.hpp"

#include <cassert>
#include <charconv>
#include <cmath>
#include <numbers>

#include "geometry/portable_math.hpp"

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
  assert(size.minCoeff() > 0 && "the sides of a box are positive");
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

}  // namespace geometry
