// kind = "playground": a hero passes straight through obstacles of many shapes (thesis, "Hřiště"). A script: nothing is
// integrated.
//
// Obstacles stand on a square grid in the plane y = 0, so wide that on every pass the hero's bounding sphere stays
// clear of all obstacles but the target. A bounding sphere is about the body's position, of the nominal shape's half
// extents: bounding_sphere and cannon_naive report nobody else either.
#include "pipeline/scene/kinds/playground.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "geometry/portable_math.hpp"

namespace pipeline {
namespace {

using geometry::Quaternion;
using geometry::Vec3;
using Hero = PlaygroundPath::Hero;

constexpr double kBeyond = 1;        // m, from the bounding spheres to the end of a pass along an axis
constexpr double kOff = 1.7;         // m, the thesis's passes off the middle
constexpr double kLeastStep = 1e-3;  // m
constexpr std::size_t kMostObstacles = 1000;
constexpr double kMostSamples = 1e7;  // of the script
const std::vector<std::string> kAxes = {"x", "y", "z"};

// ---- Rotations ---------------------------------------------------------------------------------------------------

/// A turn about an axis of the world.
Quaternion turn(int axis, double degrees) {
  // A quarter turn has equal parts: with those of sin and cos the middle of a side would not stay on its axis.
  const double half = degrees / 360 * std::numbers::pi;
  double c = geometry::portable::cos(half), s = geometry::portable::sin(half);
  if (std::fabs(degrees) == 90) s = std::copysign(c, degrees);
  Quaternion q{c, 0, 0, 0};
  (axis == 0 ? q.x : axis == 1 ? q.y : q.z) = s;
  return q;
}

/// Turns one after another, each about an axis of the world.
Quaternion turned(const std::vector<std::pair<std::string, double>>& turns) {
  Quaternion q;
  for (const auto& [axis, degrees] : turns) q = turn(axis[0] - 'x', degrees) * q;
  return geometry::normalised(q);
}

/// `rotation` or `orientation`; neither: not turned.
Quaternion read_orientation(const Section& s) {
  if (!s.has("orientation")) return turned(s.named_reals("rotation", kAxes, {.least = -360, .most = 360}));
  if (s.has("rotation")) s.refuse("rotation", "be absent where 'orientation' is given", "remove one of them");
  double wxyz[4] = {};
  s.reals("orientation", wxyz, {.least = -2, .most = 2});
  const Quaternion q{wxyz[0], wxyz[1], wxyz[2], wxyz[3]};
  if (!(std::fabs(geometry::norm(q) - 1) <= 1e-6))
    s.refuse("orientation", "be a quaternion [w, x, y, z] of length 1, to 1e-6");
  return geometry::normalised(q);
}

void write_orientation(const Quaternion& q, TomlText& out) {
  out.list("orientation", std::vector<double>{q.w, q.x, q.y, q.z});
}

// ---- The thesis's obstacles and paths ----------------------------------------------------------------------------

std::vector<PlaygroundObstacle> thesis_obstacles() {
  const BoxShape slab{{6, 6, 1}}, cube{{7, 7, 7}};
  const TorusShape torus{.diameter = 6, .thickness = 1};
  // Two angles are Babylon.js's rotation.x and rotation.z: the turn about z comes first.
  return {{"slab", slab, {}},
          {"slab_45_xz", slab, turned({{"z", 45}, {"x", 45}})},
          {"slab_90_xz", slab, turned({{"z", 90}, {"x", 90}})},
          {"slab_45_y", slab, turned({{"y", 45}})},
          {"torus", torus, {}},
          {"torus_45_x", torus, turned({{"x", 45}})},
          {"torus_90_x", torus, turned({{"x", 90}})},
          {"sphere", SphereShape{.radius = 2}, {}},
          {"capsule", CapsuleShape{5, 0.7, 1.4}, {}},
          {"torus_knot", TorusKnotShape{.radius = 3, .tube = 0.5}, {}},
          {"cube", cube, {}}};
}

/// Along each axis through the middle and off it, the hero lying along the path and across.
std::vector<PlaygroundPath> thesis_paths(const std::vector<std::string>& targets) {
  std::vector<PlaygroundPath> paths;
  for (int axis = 0; axis < 3; ++axis)
    for (const double offset : {0.0, kOff})
      for (const Hero hero : {Hero::along, Hero::across})
        paths.push_back(
            {.name = kAxes[axis], .targets = targets, .axis = axis, .offset = offset, .hero = hero, .orientation = {}});
  return paths;
}

// ---- From the scene to passes ------------------------------------------------------------------------------------

Vec3 half_extents(const BoxShape& s) { return 0.5 * s.size; }
Vec3 half_extents(const SphereShape& s) { return {s.radius, s.radius, s.radius}; }
Vec3 half_extents(const CapsuleShape& s) {
  const double radius = std::max(s.radius_bottom, s.radius_top);
  return {radius, s.height / 2, radius};
}
Vec3 half_extents(const TorusShape& s) {
  const double outer = (s.diameter + s.thickness) / 2;
  return {outer, s.thickness / 2, outer};
}
Vec3 half_extents(const TorusKnotShape& s) {
  const double outer = 1.5 * s.radius + s.tube;
  return {outer, outer, 0.5 * s.radius + s.tube};
}

double norm(const Vec3& v) { return std::sqrt((v.x() * v.x() + v.y() * v.y()) + v.z() * v.z()); }

/// About the position, of the nominal shape's half extents: those of its mesh are no greater.
double bounding_radius(const Shape& shape) {
  return norm(std::visit([](const auto& s) { return half_extents(s); }, shape));
}

Quaternion hero_orientation(const PlaygroundPath& path) {
  if (path.hero == Hero::given) return path.orientation;
  const int axis = (*path.axis + (path.hero == Hero::along ? 0 : 2)) % 3;
  return axis == 0 ? turned({{"z", -90}}) : axis == 1 ? Quaternion{} : turned({{"x", 90}});
}

/// The pass of a path by an obstacle at the origin, but for its steps.
Pass pass_of(const PlaygroundScene& scene, const PlaygroundPath& path, const PlaygroundObstacle& obstacle) {
  constexpr const char* kNames[] = {"along", "across", "given"};
  Pass pass;
  pass.path = path.name;
  pass.orientation = kNames[int(path.hero)];
  pass.q = hero_orientation(path);
  if (path.axis) {
    const double reach = bounding_radius(scene.hero) + bounding_radius(obstacle.shape) + kBeyond;
    pass.offset = path.offset;
    pass.from = pass.to = Vec3::Zero();
    pass.from[(*path.axis + 1) % 3] = pass.to[(*path.axis + 1) % 3] = path.offset;
    pass.from[*path.axis] = -reach;
    pass.to[*path.axis] = reach;
  } else {
    pass.from = path.from;
    pass.to = path.to;
    // The foot of the perpendicular from the target on the line.
    const Vec3 d = path.to - path.from;
    const double along = -((path.from.x() * d.x() + path.from.y() * d.y()) + path.from.z() * d.z()) /
                         ((d.x() * d.x() + d.y() * d.y()) + d.z() * d.z());
    pass.offset = norm(path.from + along * d);
  }
  return pass;
}

double samples_of(const PlaygroundScene& scene, const Pass& pass) {
  return std::max(1.0, std::ceil(length(pass) / scene.step)) + 1;
}

/// Calls visit(obstacle number, pass) for every pass, obstacle by obstacle.
template <class Visit>
void for_each_pass(const PlaygroundScene& scene, Visit visit) {
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o)
    for (const PlaygroundPath& path : scene.paths)
      if (std::ranges::find(path.targets, scene.obstacles[o].name) != path.targets.end())
        visit(o, pass_of(scene, path, scene.obstacles[o]));
}

/// From obstacle to obstacle, whole metres: the hero's bounding sphere on a pass by one, and the other's, do not touch.
double spacing(const PlaygroundScene& scene) {
  double reach = 0, radius = 0;
  for (const PlaygroundObstacle& obstacle : scene.obstacles) radius = std::max(radius, bounding_radius(obstacle.shape));
  for_each_pass(scene, [&](std::size_t, const Pass& pass) {
    reach = std::max({reach, norm(pass.from), norm(pass.to)});
  });
  return std::ceil(reach + radius + bounding_radius(scene.hero) + kBeyond);
}

std::size_t columns(const PlaygroundScene& scene) {
  std::size_t columns = 1;
  while (columns * columns < scene.obstacles.size()) ++columns;
  return columns;
}

std::vector<Pass> all_passes(const PlaygroundScene& scene) {
  const double apart = spacing(scene);
  const std::size_t row = columns(scene);
  std::vector<Pass> passes;
  std::int64_t step = 0;
  for_each_pass(scene, [&](std::size_t o, Pass pass) {
    const Vec3 place{apart * double(o % row), 0, apart * double(o / row)};
    pass.hero = 0;
    pass.target = std::uint32_t(o + 1);
    pass.first_step = step;
    pass.samples = std::int64_t(samples_of(scene, pass));
    pass.from += place;
    pass.to += place;
    step += pass.samples;
    passes.push_back(std::move(pass));
  });
  return passes;
}

// ---- Keys --------------------------------------------------------------------------------------------------------

void refuse_bad_name(const Section& s, const std::string& name, const std::set<std::string>& taken) {
  if (!valid_label(name)) s.refuse("name", kLabelRule);
  if (taken.contains(name)) s.refuse("name", "be the only one of its name", "give it another");
}

std::vector<PlaygroundObstacle> read_obstacles(const Section& s) {
  if (!s.has("obstacle")) return thesis_obstacles();
  std::vector<PlaygroundObstacle> obstacles;
  std::set<std::string> taken{"hero"};
  for (const Section& t : s.sections("obstacle")) {
    PlaygroundObstacle obstacle;
    obstacle.shape = read_shape(t, {"name", "rotation", "orientation"});
    if (!t.has("name")) t.fail("missing key '" + t.full("name") + "'; every obstacle has one");
    obstacle.name = t.text("name", "");
    refuse_bad_name(t, obstacle.name, taken);
    taken.insert(obstacle.name);
    obstacle.orientation = read_orientation(t);
    obstacles.push_back(std::move(obstacle));
  }
  if (obstacles.empty() || obstacles.size() > kMostObstacles)
    s.refuse("obstacle", "be 1 to " + std::to_string(kMostObstacles) + " tables",
             "leave the key out for the thesis's eleven");
  return obstacles;
}

PlaygroundPath read_path(const Section& s, const std::vector<std::string>& obstacles, std::size_t number) {
  PlaygroundPath path;
  path.targets = s.choices("targets", obstacles, obstacles);
  const bool turned = s.has("rotation") || s.has("orientation");
  if (s.has("axis")) {
    s.only({"name", "targets", "axis", "offset", "hero", "rotation", "orientation"});
    path.axis = s.choice("axis", "", kAxes)[0] - 'x';
    path.offset = s.real("offset", 0, kCoordinate);
    if (turned && s.has("hero")) s.refuse("hero", "be absent where a rotation is given", "remove one of them");
    path.hero = s.choice("hero", "along", {"along", "across"}) == "along" ? Hero::along : Hero::across;
  } else {
    s.only({"name", "targets", "from", "to", "rotation", "orientation"});
    for (const char* key : {"from", "to"})
      if (!s.has(key)) s.fail("missing key '" + s.full(key) + "'; a path has an axis, or from and to");
    double from[3] = {}, to[3] = {};
    s.reals("from", from, kCoordinate);
    s.reals("to", to, kCoordinate);
    path.from = {from[0], from[1], from[2]};
    path.to = {to[0], to[1], to[2]};
    const Vec3 d = path.to - path.from;
    if (!(std::max({std::fabs(d.x()), std::fabs(d.y()), std::fabs(d.z())}) >= kLeastLength))
      s.refuse("to", "differ from 'from'", "a path without steps passes nothing");
  }
  if (turned || !path.axis) {
    path.hero = Hero::given;
    path.orientation = read_orientation(s);
  }
  path.name = s.text("name", path.axis ? kAxes[*path.axis] : "path_" + std::to_string(number));
  if (s.has("name")) refuse_bad_name(s, path.name, {});
  return path;
}

void read(const Section& s, SceneConfig& config) {
  s.only({"kind", "step", "hero", "obstacle", "path"});
  PlaygroundScene scene;
  scene.step = s.real("step", scene.step, {.least = kLeastStep, .most = kMostLength});
  if (s.has("hero")) scene.hero = read_shape(s.section("hero"));
  scene.obstacles = read_obstacles(s);
  std::vector<std::string> names;
  for (const PlaygroundObstacle& obstacle : scene.obstacles) names.push_back(obstacle.name);
  if (!s.has("path")) scene.paths = thesis_paths(names);
  for (const Section& t : s.sections("path")) scene.paths.push_back(read_path(t, names, scene.paths.size()));
  if (scene.paths.empty()) s.refuse("path", "be at least 1 table", "leave the key out for the thesis's twelve");

  double samples = 0;
  for_each_pass(scene, [&](std::size_t, const Pass& pass) { samples += samples_of(scene, pass); });
  if (samples > kMostSamples)
    s.fail("the passes must have at most 1e7 samples together, not " + real_text(samples) + "; raise 'scene.step'");
  if (spacing(scene) * double(columns(scene)) > kMostLength)
    s.fail("the obstacles must stand within 1e6 m, not " + real_text(spacing(scene) * double(columns(scene))) +
           "; lower their sizes or the lengths of the paths");
  config.scene = std::move(scene);
}

void write(const SceneConfig& config, TomlText& out) {
  const PlaygroundScene& scene = config.keys<PlaygroundScene>();
  out.line("step", scene.step);
  out.table("[scene.hero]");
  write_shape(scene.hero, out);
  for (const PlaygroundObstacle& obstacle : scene.obstacles) {
    out.table("[[scene.obstacle]]");
    out.line("name", obstacle.name);
    write_shape(obstacle.shape, out);
    write_orientation(obstacle.orientation, out);
  }
  for (const PlaygroundPath& path : scene.paths) {
    out.table("[[scene.path]]");
    out.line("name", path.name);
    out.list("targets", path.targets);
    if (path.axis) {
      out.line("axis", kAxes[*path.axis]);
      out.line("offset", path.offset);
    } else {
      out.list("from", std::vector<double>{path.from.x(), path.from.y(), path.from.z()});
      out.list("to", std::vector<double>{path.to.x(), path.to.y(), path.to.z()});
    }
    if (path.hero == Hero::given)
      write_orientation(path.orientation, out);
    else
      out.line("hero", std::string(path.hero == Hero::along ? "along" : "across"));
  }
}

// ---- Size and bodies ---------------------------------------------------------------------------------------------

std::int64_t steps(const SceneConfig& config) {
  const std::vector<Pass> passes = all_passes(config.keys<PlaygroundScene>());
  return passes.back().first_step + passes.back().samples;
}

/// The distinct shapes of hero and obstacles, by their keys, and which each body has. Body 0 is the hero.
struct Shapes {
  std::vector<Shape> distinct;
  std::vector<std::uint32_t> of_body;

  explicit Shapes(const PlaygroundScene& scene) {
    add(scene.hero);
    for (const PlaygroundObstacle& obstacle : scene.obstacles) add(obstacle.shape);
  }

 private:
  void add(const Shape& shape) {
    TomlText keys;
    write_shape(shape, keys);
    const auto at = std::ranges::find(keys_, keys.text) - keys_.begin();
    of_body.push_back(std::uint32_t(at));
    if (at < std::ptrdiff_t(keys_.size())) return;
    keys_.push_back(keys.text);
    distinct.push_back(shape);
  }
  std::vector<std::string> keys_;
};

SceneSize size(const SceneConfig& config) {
  const PlaygroundScene& scene = config.keys<PlaygroundScene>();
  const Shapes shapes(scene);
  SceneSize size{.bodies = shapes.of_body.size(), .meshes = shapes.distinct.size()};
  for (const Shape& shape : shapes.distinct) {
    size.mesh_vertices += mesh_size(shape).vertices;
    size.mesh_triangles += mesh_size(shape).triangles;
  }
  for (const std::uint32_t shape : shapes.of_body) size.body_vertices += mesh_size(shapes.distinct[shape]).vertices;
  size.pairs = size.bodies - 1;
  const auto whole = [&](const Pass& pass) { return pass.first_step + pass.samples <= config.steps; };
  if (const auto passes = std::ranges::count_if(all_passes(scene), whole)) size.asked["passes"] = std::uint64_t(passes);
  return size;
}

Scene make(const SceneConfig& config) {
  const PlaygroundScene& playground = config.keys<PlaygroundScene>();
  Scene scene;
  geometry::Bodies& bodies = scene.bodies;
  const Shapes shapes(playground);
  std::vector<geometry::Pose> poses(1);
  bodies.add("hero", shapes.of_body[0]);
  const double apart = spacing(playground);
  const std::size_t row = columns(playground);
  for (std::size_t o = 0; o < playground.obstacles.size(); ++o) {
    bodies.add(playground.obstacles[o].name, shapes.of_body[o + 1], true);
    poses.push_back({playground.obstacles[o].orientation, {apart * double(o % row), 0, apart * double(o / row)}});
  }
  bodies.chosen.assign(bodies.size(), 0);
  bodies.chosen[0] = 1;
  // A mesh is named after the first body that has it.
  for (std::uint32_t shape = 0; shape < shapes.distinct.size(); ++shape) {
    const auto body = std::ranges::find(bodies.mesh, shape) - bodies.mesh.begin();
    bodies.meshes.push_back(make_mesh(shapes.distinct[shape], bodies.name[std::size_t(body)]));
  }

  for (const Pass& pass : all_passes(playground)) {
    for (std::int64_t i = 0; i < pass.samples && std::int64_t(scene.script.size()) < config.steps; ++i) {
      poses[pass.hero] = pose_at(pass, position(pass, i));
      scene.script.push_back(poses);
    }
    if (pass.first_step + pass.samples <= config.steps) scene.passes.push_back(pass);
  }
  return scene;
}

std::vector<Ahead> ahead(const SceneConfig& config) {
  std::vector<Ahead> out;
  for (const Pass& pass : all_passes(config.keys<PlaygroundScene>()))
    out.push_back({.what = "passes", .first = double(pass.first_step + pass.samples - 1)});
  return out;
}

}  // namespace

SceneKind playground_kind() {
  return {.name = "playground",
          .what = "a hero passes straight through obstacles; scripted (thesis, \"Hriste\")",
          .integrated = false,
          .read = read,
          .write = write,
          .size = size,
          .make = make,
          .steps = steps,
          .ahead = ahead};
}

}  // namespace pipeline
