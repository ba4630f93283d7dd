#include "pipeline/scene/shape_keys.hpp"

#include <cmath>
#include <numeric>

#include "geometry/meshes/shapes.hpp"
#include "pipeline/scene/scene.hpp"

namespace pipeline {
namespace {

// One overload of each per shape: its keys, its parameters read, written, counted and made.

double length(const Section& s, const std::string& key) {
  if (!s.has(key)) s.fail("missing key '" + s.full(key) + "', a length in metres");
  return s.real(key, 0, kLength);
}

std::int64_t segments(const Section& s, const std::string& key, std::int64_t preset, std::int64_t least) {
  return s.integer(key, preset, least, kMostSegments);
}

void read(const Section& s, BoxShape& box) {
  if (!s.has("size")) s.fail("missing key '" + s.full("size") + "', the sides [x, y, z] in metres");
  double size[3] = {};
  s.reals("size", size, kLength);
  box.size = {size[0], size[1], size[2]};
}

void read(const Section& s, SphereShape& sphere) {
  sphere.radius = length(s, "radius");
  sphere.segments = segments(s, "segments", sphere.segments, 1);
}

void read(const Section& s, CapsuleShape& capsule) {
  capsule.height = length(s, "height");
  if (s.has("radius")) {
    for (const char* key : {"radius_bottom", "radius_top"})
      if (s.has(key)) s.refuse(key, "be absent where 'radius' is given", "remove one of them");
    capsule.radius_bottom = capsule.radius_top = length(s, "radius");
  } else {
    if (!s.has("radius_bottom") && !s.has("radius_top"))
      s.fail("missing key '" + s.full("radius") + "', or radius_bottom and radius_top");
    capsule.radius_bottom = length(s, "radius_bottom");
    capsule.radius_top = length(s, "radius_top");
  }
  // As geometry::capsule asserts it, with the same roundings.
  const double between = capsule.height - capsule.radius_bottom - capsule.radius_top;
  if (!(between > std::abs(capsule.radius_bottom - capsule.radius_top)))
    s.refuse("height", "be more than twice the greater radius", "raise it, or use a sphere");
  capsule.segments = segments(s, "segments", capsule.segments, 1);
}

void read(const Section& s, TorusShape& torus) {
  torus.diameter = length(s, "diameter");
  torus.thickness = length(s, "thickness");
  if (!(torus.thickness < torus.diameter))
    s.refuse("thickness", "be below the diameter " + real_text(torus.diameter), "a torus has a hole");
  torus.segments = segments(s, "segments", torus.segments, 3);
}

void read(const Section& s, TorusKnotShape& knot) {
  knot.radius = length(s, "radius");
  knot.tube = length(s, "tube");
  knot.radial_segments = segments(s, "radial_segments", knot.radial_segments, 3);
  knot.tubular_segments = segments(s, "tubular_segments", knot.tubular_segments, 3);
  knot.p = segments(s, "p", knot.p, 1);
  knot.q = segments(s, "q", knot.q, 1);
  if (std::gcd(knot.p, knot.q) == 1) return;
  const std::string rule = "have no common factor with ";
  if (s.has("q")) s.refuse("q", rule + "p = " + std::to_string(knot.p));
  s.refuse("p", rule + "q = " + std::to_string(knot.q));
}

void write(const BoxShape& box, TomlText& out) {
  out.line("shape", std::string("box"));
  out.list("size", std::vector<double>{box.size.x(), box.size.y(), box.size.z()});
}

void write(const SphereShape& sphere, TomlText& out) {
  out.line("shape", std::string("sphere"));
  out.line("radius", sphere.radius);
  out.line("segments", sphere.segments);
}

void write(const CapsuleShape& capsule, TomlText& out) {
  out.line("shape", std::string("capsule"));
  out.line("height", capsule.height);
  out.line("radius_bottom", capsule.radius_bottom);
  out.line("radius_top", capsule.radius_top);
  out.line("segments", capsule.segments);
}

void write(const TorusShape& torus, TomlText& out) {
  out.line("shape", std::string("torus"));
  out.line("diameter", torus.diameter);
  out.line("thickness", torus.thickness);
  out.line("segments", torus.segments);
}

void write(const TorusKnotShape& knot, TomlText& out) {
  out.line("shape", std::string("torus_knot"));
  out.line("radius", knot.radius);
  out.line("tube", knot.tube);
  out.line("radial_segments", knot.radial_segments);
  out.line("tubular_segments", knot.tubular_segments);
  out.line("p", knot.p);
  out.line("q", knot.q);
}

// The counts are those that geometry/meshes/shapes.hpp documents; a test compares.

MeshSize size(const BoxShape&) { return {.vertices = 8, .triangles = 12}; }

MeshSize size(const SphereShape& sphere) {
  const std::uint64_t bands = std::uint64_t(sphere.segments) + 2;
  return {.vertices = 2 * bands * (bands - 1) + 2, .triangles = 4 * bands * (bands - 1)};
}

MeshSize size(const CapsuleShape& capsule) {
  const std::uint64_t columns = 2 * (std::uint64_t(capsule.segments) + 2);
  const std::uint64_t bands = 2 * ((columns / 2 + 1) / 2) + 2;  // two caps and a side of two
  return {.vertices = columns * (bands - 1) + 2, .triangles = 2 * columns * (bands - 1)};
}

MeshSize size(const TorusShape& torus) {
  const std::uint64_t n = std::uint64_t(torus.segments);
  return {.vertices = n * n, .triangles = 2 * n * n};
}

MeshSize size(const TorusKnotShape& knot) {
  const std::uint64_t vertices = std::uint64_t(knot.radial_segments) * std::uint64_t(knot.tubular_segments);
  return {.vertices = vertices, .triangles = 2 * vertices};
}

geometry::Mesh make(const BoxShape& box, const std::string& name) { return geometry::box(name, box.size); }

geometry::Mesh make(const SphereShape& sphere, const std::string& name) {
  return geometry::sphere(name, sphere.radius, sphere.segments);
}

geometry::Mesh make(const CapsuleShape& capsule, const std::string& name) {
  return geometry::capsule(name, capsule.height, capsule.radius_bottom, capsule.radius_top, capsule.segments);
}

geometry::Mesh make(const TorusShape& torus, const std::string& name) {
  return geometry::torus(name, torus.diameter, torus.thickness, torus.segments);
}

geometry::Mesh make(const TorusKnotShape& knot, const std::string& name) {
  return geometry::torus_knot(name, knot.radius, knot.tube, knot.radial_segments, knot.tubular_segments, knot.p,
                              knot.q);
}

struct Kind {
  std::string name;
  std::vector<std::string> keys;
  Shape preset;
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> kinds = {
      {"box", {"size"}, BoxShape{}},
      {"sphere", {"radius", "segments"}, SphereShape{}},
      {"capsule", {"height", "radius", "radius_bottom", "radius_top", "segments"}, CapsuleShape{}},
      {"torus", {"diameter", "thickness", "segments"}, TorusShape{}},
      {"torus_knot", {"radius", "tube", "radial_segments", "tubular_segments", "p", "q"}, TorusKnotShape{}},
  };
  return kinds;
}

}  // namespace

Shape read_shape(const Section& section, const std::vector<std::string>& others) {
  std::vector<std::string> names;
  for (const Kind& kind : kinds()) names.push_back(kind.name);
  if (!section.has("shape")) section.fail("missing key '" + section.full("shape") + "'; " + hint("", names));
  const std::string name = section.choice("shape", "", names);
  for (const Kind& kind : kinds()) {
    if (kind.name != name) continue;
    std::vector<std::string> known = {"shape"};
    known.insert(known.end(), kind.keys.begin(), kind.keys.end());
    known.insert(known.end(), others.begin(), others.end());
    section.only(known);
    Shape shape = kind.preset;
    std::visit([&](auto& parameters) { read(section, parameters); }, shape);
    return shape;
  }
  throw std::logic_error("choice() returns one of the names");
}

void write_shape(const Shape& shape, TomlText& out) {
  std::visit([&](const auto& parameters) { write(parameters, out); }, shape);
}

geometry::Mesh make_mesh(const Shape& shape, const std::string& name) {
  return std::visit([&](const auto& parameters) { return make(parameters, name); }, shape);
}

MeshSize mesh_size(const Shape& shape) {
  return std::visit([](const auto& parameters) { return size(parameters); }, shape);
}

}  // namespace pipeline
