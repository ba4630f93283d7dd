// kind = "falling": sets of spheres fall onto others that lie on a finite plate, its top at y = 0 (thesis, "Padani");
// or bodies of any closed meshes, also onto and into obstacles that stand on it.
//
// Keys are read without touching the files they name; files are read when the configuration is (complete), and again
// when the scene is made (as in replay.cpp).
#include "pipeline/scene/kinds/falling.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "geometry/decision/inscribed.hpp"
#include "geometry/meshes/shapes.hpp"
#include "geometry/random.hpp"
#include "geometry/vec.hpp"
#include "pipeline/scene/mesh_input.hpp"
#include "pipeline/scene/solid_body.hpp"
#include "pipeline/terminal/error.hpp"

namespace pipeline {

namespace {

// ---- Keys --------------------------------------------------------------------------------------------------------

/// The thesis's scene: one sphere onto another, ten onto ten, and a block of 6 x 6 x 6 onto 6 x 6.
std::vector<FallingSet> thesis_sets() {
  return {{.lying = {1, 1}, .above = {1, 1, 1}, .corner = {-14, -20}, .spacing = 2.1, .height = 5, .shapes = {}},
          {.lying = {10, 1}, .above = {10, 1, 1}, .corner = {-10, -18}, .spacing = 2.5, .height = 26, .shapes = {}},
          {.lying = {6, 6}, .above = {6, 6, 6}, .corner = {-5, -3}, .spacing = 2.1, .height = 75, .shapes = {}}};
}

/// At most 1e12 + 1e18 by the rules for each count: no overflow.
std::int64_t sphere_count(const FallingSet& set) {
  return set.lying[0] * set.lying[1] + set.above[0] * set.above[1] * set.above[2];
}

/// A mesh or a shape with its parameters, beside the keys `others`.
FallingBody read_body(const Section& s, const FallingScene& scene, std::vector<std::string> others) {
  FallingBody body;
  others.insert(others.end(), {"density", "contact_spheres"});
  if (s.has("mesh")) {
    if (s.has("shape")) s.refuse("shape", "be absent where 'mesh' is given", "a body has one of them");
    others.push_back("mesh");
    s.only(others);
    body.mesh = s.text("mesh", "");
    if (body.mesh.empty()) s.refuse("mesh", "name a file");
    body.place = place_of(s, "mesh");
  } else {
    if (!s.has("shape"))
      s.fail("missing key '" + s.full("shape") + "', with its parameters (`pipeline list shapes`); or 'mesh', a file");
    body.shape = read_shape(s, others);
    body.place = place_of(s, "shape");
  }
  body.density = s.real("density", scene.density, kDensity);
  body.contact_spheres = s.integer("contact_spheres", scene.contact_spheres, 1, kMostContactSpheres);
  return body;
}

FallingObstacle read_obstacle(const Section& s, const FallingScene& scene) {
  FallingObstacle out;
  if (!s.has("name")) s.fail("missing key '" + s.full("name") + "', the name of the obstacle");
  out.name = s.text("name", "");
  if (!valid_label(out.name)) s.refuse("name", kLabelRule);
  out.body = read_body(s, scene, {"name", "position", "orientation"});
  s.reals("position", out.position, kCoordinate);
  s.reals("orientation", out.orientation, kCoordinate);
  const auto& q = out.orientation;
  if (!(std::abs(geometry::norm({q[0], q[1], q[2], q[3]}) - 1) <= 1e-6))
    s.refuse("orientation", "be a quaternion [w, x, y, z] of length 1 within 1e-6");
  return out;
}

bool has_solids(const FallingScene& scene);

void write(const FallingBody& body, TomlText& out) {
  if (body.shape)
    write_shape(*body.shape, out);
  else
    out.line("mesh", body.mesh);
  out.line("density", body.density);
  out.line("contact_spheres", body.contact_spheres);
}

void read(const Section& s, SceneConfig& config) {
  s.only({"kind", "segments", "radius", "density", "plate", "shift", "jitter", "contact_spheres", "obstacle", "set"});
  FallingScene scene;
  scene.segments = s.integer("segments", scene.segments, 1, kMostSegments);
  scene.radius = s.real("radius", scene.radius, kLength);
  scene.density = s.real("density", scene.density, kDensity);
  s.reals("plate", scene.plate, kLength);
  scene.shift = s.real("shift", scene.shift, kCoordinate);
  scene.jitter = s.real("jitter", scene.jitter, {.least = 0, .most = kMostLength});
  scene.contact_spheres = s.integer("contact_spheres", scene.contact_spheres, 1, kMostContactSpheres);
  std::set<std::string> taken{"plate"};
  for (const Section& t : s.sections("obstacle")) {
    scene.obstacles.push_back(read_obstacle(t, scene));
    if (!taken.insert(scene.obstacles.back().name).second) t.refuse("name", "be the only one of its name");
  }
  if (!s.has("set")) scene.sets = thesis_sets();
  std::int64_t spheres = 0;
  for (const Section& t : s.sections("set")) {
    t.only({"lying", "above", "corner", "spacing", "height", "shapes", "turned"});
    FallingSet set;
    t.integers("lying", set.lying, 0, kMostBodies);
    t.integers("above", set.above, 0, kMostBodies);
    t.reals("corner", set.corner, kCoordinate);
    set.spacing = t.real("spacing", set.spacing, kLength);
    set.height = t.real("height", set.height, kCoordinate);
    set.turned = t.boolean("turned", false);
    for (const Section& u : t.sections("shapes")) set.shapes.push_back(read_body(u, scene, {}));
    if (t.has("shapes") && set.shapes.empty())
      t.refuse("shapes", "hold at least one shape", "leave the key out for the scene's sphere");
    spheres += sphere_count(set);
    if (spheres > kMostBodies)
      t.fail("'scene.set' must hold at most " + std::to_string(kMostBodies) + " bodies, not " +
             std::to_string(spheres) + "; lower 'lying' or 'above'");
    scene.sets.push_back(set);
  }
  if (s.has("set") && spheres == 0) s.fail("'scene.set' must hold at least 1 sphere, not 0; raise 'lying' or 'above'");
  config.scene = std::move(scene);
}

void write(const SceneConfig& config, TomlText& out) {
  const FallingScene& scene = config.keys<FallingScene>();
  out.line("segments", scene.segments);
  out.line("radius", scene.radius);
  out.line("density", scene.density);
  out.list("plate", scene.plate);
  out.line("shift", scene.shift);
  out.line("jitter", scene.jitter);
  if (has_solids(scene)) out.line("contact_spheres", scene.contact_spheres);
  for (const FallingObstacle& obstacle : scene.obstacles) {
    out.table("[[scene.obstacle]]");
    out.line("name", obstacle.name);
    write(obstacle.body, out);
    out.list("position", obstacle.position);
    out.list("orientation", obstacle.orientation);
  }
  for (const FallingSet& set : scene.sets) {
    out.table("[[scene.set]]");
    out.list("lying", set.lying);
    out.list("above", set.above);
    out.list("corner", set.corner);
    out.line("spacing", set.spacing);
    out.line("height", set.height);
    if (set.turned) out.line("turned", true);
    for (const FallingBody& body : set.shapes) {
      out.table("[[scene.set.shapes]]");
      write(body, out);
    }
  }
}

// ---- Meshes ------------------------------------------------------------------------------------------------------

bool has_solids(const FallingScene& scene) {
  return !scene.obstacles.empty() ||
         std::ranges::any_of(scene.sets, [](const FallingSet& set) { return !set.shapes.empty(); });
}

/// All that the scene names, in order.
std::vector<const FallingBody*> bodies_of(const FallingScene& scene) {
  std::vector<const FallingBody*> out;
  for (const FallingObstacle& obstacle : scene.obstacles) out.push_back(&obstacle.body);
  for (const FallingSet& set : scene.sets)
    for (const FallingBody& body : set.shapes) out.push_back(&body);
  return out;
}

/// A box that stands is touched as such, a sphere by its one sphere.
bool has_contact_spheres(const FallingBody& body, bool fixed) {
  return !body.shape || !(std::holds_alternative<SphereShape>(*body.shape) ||
                          (fixed && std::holds_alternative<BoxShape>(*body.shape)));
}

/// The meshes of the files that a scene names, by their names as written there.
using FileMeshes = std::map<std::string, geometry::Mesh>;

FileMeshes read_meshes(SceneConfig& config) {
  FileMeshes out;
  NodeFiles nodes;
  const FallingScene scene = config.keys<FallingScene>();
  for (const FallingBody* body : bodies_of(scene)) {
    if (body->shape || out.contains(body->mesh)) continue;
    out.emplace(body->mesh,
                std::move(read_mesh(config, {.file = body->mesh, .place = body->place}, "mesh", nodes).mesh));
  }
  return out;
}

/// Throws std::logic_error before the files were read.
const geometry::Mesh& mesh_read(const FileMeshes& files, const FallingBody& body) {
  const auto found = files.find(body.mesh);
  if (found == files.end()) throw std::logic_error("a falling scene is asked for before its files were read");
  return found->second;
}

MeshSize mesh_size_of(const FileMeshes& files, const FallingBody& body) {
  if (body.shape) return mesh_size(*body.shape);
  const geometry::Mesh& mesh = mesh_read(files, body);
  return {.vertices = mesh.vertices.size(), .triangles = mesh.triangles.size()};
}

/// Bodies of which this is equal share a mesh.
std::string key_of(const FallingBody& body, bool fixed) {
  TomlText text;
  if (body.shape)
    write_shape(*body.shape, text);
  else
    text.line("mesh", body.mesh);
  if (has_contact_spheres(body, fixed)) text.line("contact_spheres", body.contact_spheres);
  return text.text;
}

/// What a mesh is called: its shape or its file, what cannot be in a name left out.
std::string name_of(const FallingBody& body) {
  static const std::array<const char*, 5> kNames{"box", "sphere", "capsule", "torus", "torus_knot"};
  if (body.shape) return kNames[body.shape->index()];
  std::string out;
  for (const char c : std::filesystem::path(body.mesh).stem().string())
    if (out.size() < 56 && valid_label(std::string("x") + c)) out += c;
  return valid_label(out) ? out : "mesh";
}

/// As the configuration names it.
std::string what_of(const FallingBody& body) { return body.shape ? name_of(body) : one_line(body.mesh); }

/// Whether some set is of the scene's sphere.
bool has_default_sphere(const FallingScene& scene) {
  return std::ranges::any_of(scene.sets,
                             [](const FallingSet& set) { return set.shapes.empty() && sphere_count(set) > 0; });
}

/// How many bodies of a set have shape number `k`.
std::uint64_t count_of(const FallingSet& set, std::size_t k) {
  std::uint64_t out = 0;
  for (const std::int64_t count : {set.lying[0] * set.lying[1], set.above[0] * set.above[1] * set.above[2]})
    out += std::uint64_t(count) / set.shapes.size() + (k < std::uint64_t(count) % set.shapes.size());
  return out;
}

SceneSize size_of(const FallingScene& scene, const FileMeshes& files) {
  SceneSize out;
  std::set<std::string> known;
  const auto add = [&](std::uint64_t count, const MeshSize& mesh, const std::string& key) {
    out.bodies += count;
    out.body_vertices += count * mesh.vertices;
    if (!known.insert(key).second) return;
    ++out.meshes;
    out.mesh_vertices += mesh.vertices;
    out.mesh_triangles += mesh.triangles;
  };
  const auto add_body = [&](std::uint64_t count, const FallingBody& body, bool fixed) {
    const MeshSize mesh = mesh_size_of(files, body);
    add(count, mesh, key_of(body, fixed));
    if (!has_contact_spheres(body, fixed)) return;
    out.contact_spheres += count * std::uint64_t(body.contact_spheres);
    out.placing_bytes =
        std::max(out.placing_bytes, geometry::inscribed_balls_bytes(mesh.triangles, std::size_t(body.contact_spheres)));
  };
  add(1, mesh_size(BoxShape{}), "plate");
  for (const FallingObstacle& obstacle : scene.obstacles) add_body(1, obstacle.body, true);
  for (const FallingSet& set : scene.sets) {
    const std::uint64_t spheres = set.shapes.empty() ? std::uint64_t(sphere_count(set)) : 0;
    if (spheres > 0) add(spheres, mesh_size(SphereShape{scene.radius, scene.segments}), "sphere");
    for (std::size_t k = 0; k < set.shapes.size(); ++k)
      if (const std::uint64_t count = count_of(set, k); count > 0) add_body(count, set.shapes[k], false);
  }
  return out;
}

/// The meshes of a scene while it is made.
class Meshes {
 public:
  Meshes(const SceneConfig& config, const FileMeshes& files, geometry::Bodies& bodies)
      : config_(config), files_(files), bodies_(bodies) {
    for (const geometry::Mesh& mesh : bodies.meshes) names_.insert(mesh.name);
  }

  /// The number of a body's mesh, made when it is the first of its kind and then called `called` or something like it.
  std::uint32_t of(const FallingBody& body, bool fixed, const std::string& called) {
    const auto [at, fresh] = known_.emplace(key_of(body, fixed), std::uint32_t(bodies_.meshes.size()));
    if (!fresh) return at->second;
    std::string name = called;
    for (int i = 2; !names_.insert(name).second; ++i) name = called.substr(0, 56) + "_" + std::to_string(i);
    geometry::Mesh mesh = body.shape ? make_mesh(*body.shape, name) : mesh_read(files_, body);
    mesh.name = name;
    if (has_contact_spheres(body, fixed))
      place_contact_spheres(mesh, body.contact_spheres, config_.closed_within, body.place, in_quotes(what_of(body)));
    bodies_.meshes.push_back(std::move(mesh));
    return at->second;
  }

  /// The physical side of a body of that mesh.
  RigidBody rigid(const FallingBody& body, bool fixed, std::uint32_t mesh) const {
    RigidBody out;
    if (has_contact_spheres(body, fixed)) {
      out = solid_body(bodies_.meshes[mesh], body.density, config_.closed_within);
    } else if (const auto* box = std::get_if<BoxShape>(&*body.shape)) {
      out.sphere = false;
      out.half_extents = {box->size.x() / 2, box->size.y() / 2, box->size.z() / 2};
    } else {
      out = solid_sphere(bodies_.meshes[mesh], body.density, config_.contact_radius);
    }
    out.fixed = fixed;
    return out;
  }

 private:
  const SceneConfig& config_;
  const FileMeshes& files_;
  geometry::Bodies& bodies_;
  std::map<std::string, std::uint32_t> known_;
  std::set<std::string> names_;
};

/// Body 0 is the plate, then come the obstacles, then set by set the lying and the upper bodies, x slowest, whose
/// shapes go round. Of the stream of its body's number an upper body is displaced along x, y and z by jitter times the
/// first three numbers in [-1, 1), and turned by what follows them.
Scene make(const SceneConfig& config) {
  const FallingScene& falling = config.keys<FallingScene>();
  Scene scene;
  geometry::Bodies& bodies = scene.bodies;
  const auto& plate = falling.plate;
  bodies.meshes.push_back(geometry::box("plate", {plate[0], plate[1], plate[2]}));
  if (has_default_sphere(falling))
    bodies.meshes.push_back(geometry::sphere("sphere", falling.radius, falling.segments));

  const auto add = [&](const std::string& name, std::uint32_t mesh, const RigidBody& rigid, double x, double y,
                       double z) {
    bodies.add(name, mesh, rigid.fixed);
    scene.rigid.push_back(rigid);
    scene.states.push_back({.position = {x, y, z}});
  };
  const auto displace = [&](bool turned) {
    if (falling.jitter == 0 && !turned) return;
    geometry::Random random = geometry::Random::of(std::uint64_t(config.seed), scene.states.size() - 1);
    BodyState& state = scene.states.back();
    for (double& coordinate : state.position) coordinate += falling.jitter * random.signed_unit();
    if (!turned) return;
    const geometry::Quaternion q = random.rotation();
    state.orientation = {q.w, q.x, q.y, q.z};
  };

  RigidBody floor;
  floor.fixed = true;
  floor.sphere = false;
  floor.half_extents = {plate[0] / 2, plate[1] / 2, plate[2] / 2};
  add("plate", 0, floor, 0, -plate[1] / 2, 0);

  SceneConfig again = config;
  const FileMeshes files = falling.size ? read_meshes(again) : FileMeshes();
  refuse_changed(config, again);
  Meshes meshes(config, files, bodies);
  for (const FallingObstacle& obstacle : falling.obstacles) {
    const std::uint32_t mesh = meshes.of(obstacle.body, true, obstacle.name);
    const auto& [x, y, z] = obstacle.position;
    add(obstacle.name, mesh, meshes.rigid(obstacle.body, true, mesh), x, y, z);
    scene.states.back().orientation = obstacle.orientation;
  }

  struct Kind {
    std::uint32_t mesh;
    RigidBody rigid;
    double height;  // m, of its origin when it lies on the plate
  };
  const auto sphere = [&] {
    return Kind{1, solid_sphere(bodies.meshes[1], falling.density, config.contact_radius), falling.radius};
  };
  for (std::size_t s = 0; s < falling.sets.size(); ++s) {
    const FallingSet& set = falling.sets[s];
    if (sphere_count(set) == 0) continue;
    std::vector<Kind> kinds;
    if (set.shapes.empty()) kinds.push_back(sphere());
    for (std::size_t k = 0; k < set.shapes.size(); ++k) {
      if (count_of(set, k) == 0) break;  // nor has any that follows
      const std::uint32_t mesh = meshes.of(set.shapes[k], false, name_of(set.shapes[k]));
      kinds.push_back(
          {mesh, meshes.rigid(set.shapes[k], false, mesh), -geometry::local_box(bodies.meshes[mesh]).min.y()});
    }
    const std::string prefix = "set" + std::to_string(s + 1);
    std::size_t number = 0;
    const auto next = [&]() -> const Kind& { return kinds[number % kinds.size()]; };
    for (std::int64_t i = 0; i < set.lying[0]; ++i)
      for (std::int64_t k = 0; k < set.lying[1]; ++k, ++number)
        add(prefix + "_lying_" + std::to_string(number), next().mesh, next().rigid,
            set.corner[0] + set.spacing * double(i), next().height, set.corner[1] + set.spacing * double(k));
    number = 0;
    for (std::int64_t i = 0; i < set.above[0]; ++i)
      for (std::int64_t j = 0; j < set.above[1]; ++j)
        for (std::int64_t k = 0; k < set.above[2]; ++k, ++number) {
          add(prefix + "_above_" + std::to_string(number), next().mesh, next().rigid,
              set.corner[0] + falling.shift + set.spacing * double(i), set.height + set.spacing * double(j),
              set.corner[1] + falling.shift + set.spacing * double(k));
          displace(set.turned);
        }
  }
  return scene;
}

// ---- What is known beforehand ------------------------------------------------------------------------------------

/// Seconds in which a body at rest falls this many metres against linear damping: y = g / c (t - (1 - exp(-c t)) / c).
double fall_time(double metres, double gravity, double damping) {
  double low = 0, high = std::sqrt(2 * metres / gravity);
  const auto fallen = [&](double t) {
    return damping * t < 1e-6 ? gravity * t * t / 2 : gravity / damping * (t + std::expm1(-damping * t) / damping);
  };
  while (fallen(high) < metres) high *= 2;
  for (int i = 0; i < 60; ++i) (fallen((low + high) / 2) < metres ? low : high) = (low + high) / 2;
  return high;
}

/// The height of what stands at a place of the plate, below `top`: 0 for the plate.
double ground(const FallingScene& falling, const FileMeshes& files, double x, double z, double top) {
  double out = 0;
  for (const FallingObstacle& obstacle : falling.obstacles) {
    const geometry::Mesh mesh =
        obstacle.body.shape ? make_mesh(*obstacle.body.shape, "") : mesh_read(files, obstacle.body);
    const auto& q = obstacle.orientation;
    const auto& p = obstacle.position;
    std::vector<geometry::Vec3> world(mesh.vertices.size());
    geometry::to_world({{q[0], q[1], q[2], q[3]}, {p[0], p[1], p[2]}}, mesh.vertices, world);
    for (const geometry::Facet& facet : mesh.triangles) {
      // Weights of the corners, of the place seen from above.
      double weight[3], sum = 0, y = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const geometry::Vec3 &a = world[facet[(k + 1) % 3]], &b = world[facet[(k + 2) % 3]];
        weight[k] = (a.x() - x) * (b.z() - z) - (a.z() - z) * (b.x() - x);
        sum += weight[k];
        y += weight[k] * world[facet[k]].y();
      }
      const auto inside = [&](double w) { return w / sum >= 0; };
      if (sum != 0 && std::ranges::all_of(weight, inside) && y / sum < top) out = std::max(out, y / sum);
    }
  }
  return out;
}

/// Where the upper bodies of a set are as the configuration has them: the middle of the lowest layer.
std::array<double, 3> middle_of(const FallingScene& falling, const FallingSet& set) {
  const double half = set.spacing / 2;
  return {set.corner[0] + falling.shift + half * double(set.above[0] - 1), set.height,
          set.corner[1] + falling.shift + half * double(set.above[2] - 1)};
}

/// The same of the middle and the corners of a set's upper bodies, `closer` times as far from the middle as they are.
double ground(const FallingScene& falling, const FileMeshes& files, const FallingSet& set, double closer) {
  double out = 0;
  if (falling.obstacles.empty()) return out;
  const auto& [x, top, z] = middle_of(falling, set);
  const double dx = closer * set.spacing / 2 * double(set.above[0] - 1);
  const double dz = closer * set.spacing / 2 * double(set.above[2] - 1);
  for (const auto& [i, k] : {std::pair{-1., -1.}, {1., -1.}, {-1., 1.}, {1., 1.}, {0., 0.}})
    out = std::max(out, ground(falling, files, x + i * dx, z + k * dz, top));
  return out;
}

/// The radius of a set's spheres; of other bodies half their side, on average.
double radius_of(const FallingScene& falling, const FileMeshes& files, const FallingSet& set) {
  if (set.shapes.empty()) return falling.radius;
  double sum = 0;
  for (const FallingBody& body : set.shapes) {
    const geometry::Mesh mesh = body.shape ? make_mesh(*body.shape, "") : mesh_read(files, body);
    const geometry::Vec3 half = geometry::local_box(mesh).half_size();
    sum += (half.x() + half.y() + half.z()) / 3;
  }
  return sum / double(set.shapes.size());
}

/// How much nearer to each other a set's upper bodies are when they are pressed together.
double pressing(const FallingSet& set, double radius) {
  constexpr double kSpheres = 2.02, kSolids = 2.45;  // radii from middle to middle
  return std::min(1.0, (set.shapes.empty() ? kSpheres : kSolids) * radius / set.spacing);
}

/// Of the lowest of a set's upper spheres: it falls to those that lie, beside them by `shift`, or to the plate.
Fall fall_of(const FallingScene& falling, const FileMeshes& files, const FallingSet& set) {
  Fall out{.radius = radius_of(falling, files, set)};
  const double r = out.radius, aside = 2 * falling.shift * falling.shift;
  const bool meets = set.lying[0] > 0 && set.lying[1] > 0 && aside < 4 * r * r;
  const double above = set.height - r - (meets ? std::sqrt(4 * r * r - aside) : 0);
  out.drop = above - ground(falling, files, set, 1);
  out.pressed = above - ground(falling, files, set, pressing(set, r));
  out.most = out.drop + double(set.above[1] - 1) * std::max(0.0, set.spacing - 2 * r);
  return out;
}

SceneSize size(const SceneConfig& config) {
  const FallingScene& scene = config.keys<FallingScene>();
  return scene.size ? *scene.size : size_of(scene, {});
}

std::vector<Fall> falls_of(const FallingScene& falling, const FileMeshes& files) {
  std::vector<Fall> out;
  for (const FallingSet& set : falling.sets) out.push_back(fall_of(falling, files, set));
  return out;
}

std::vector<Fall> falls(const FallingScene& falling) { return falling.size ? falling.falls : falls_of(falling, {}); }

void complete(SceneConfig& config) {
  const FileMeshes files = read_meshes(config);
  if (files.empty()) return;
  FallingScene scene = config.keys<FallingScene>();
  scene.size = size_of(scene, files);
  scene.falls = falls_of(scene, files);
  config.scene = std::move(scene);
}

std::vector<Ahead> ahead(const SceneConfig& config) {
  const FallingScene& falling = config.keys<FallingScene>();
  // Of the time of the highest's fall, after its landing; measured on the third set of padani.toml, heap and cup.
  constexpr double kLively = 0.75, kLivelySolids = 0.25;
  const std::vector<Fall> all = falls(falling);
  std::vector<Ahead> out;
  for (std::size_t s = 0; s < falling.sets.size(); ++s) {
    const FallingSet& set = falling.sets[s];
    const std::uint64_t spheres = std::uint64_t(set.above[0] * set.above[1] * set.above[2]);
    const std::uint64_t lying = std::uint64_t(set.lying[0] * set.lying[1]);
    const double metres = all[s].drop, gravity = -config.physics.gravity[1];
    if (spheres == 0) continue;
    double step = 0, last = 0;
    if (all[s].most > 0) {
      if (!(gravity > 0)) continue;  // it never lands
      const auto landing = [&](double fallen) {
        return config.rate * fall_time(std::max(fallen, 0.0), gravity, config.physics.linear_damping);
      };
      step = landing(metres);
      last = landing(all[s].most);
    }
    const std::string noun =
        set.shapes.empty() ? (spheres == 1 ? " sphere" : " spheres") : (spheres == 1 ? " body" : " bodies");
    out.push_back({.what = "landing of set " + std::to_string(s + 1) + ", " + std::to_string(spheres) + noun,
                   .first = step,
                   .bodies = spheres + lying,
                   .lasts = last - step + (set.shapes.empty() ? kLively : kLivelySolids) * last});
  }
  return out;
}

/// Every set has just landed; pressed together, near pairs that do not meet cost answers the most.
void hurry(const SceneConfig& config, std::vector<BodyState>& states, bool pressed) {
  const FallingScene& falling = config.keys<FallingScene>();
  const double gravity = -config.physics.gravity[1];
  const std::vector<Fall> all = falls(falling);
  std::size_t body = 1 + falling.obstacles.size();
  for (std::size_t s = 0; s < falling.sets.size(); ++s) {
    const FallingSet& set = falling.sets[s];
    body += std::size_t(set.lying[0] * set.lying[1]);
    const std::array<double, 3> from = middle_of(falling, set);
    const Fall& fall = all[s];
    const double metres = pressed ? fall.pressed : fall.drop, closer = pressed ? pressing(set, fall.radius) : 1;
    const std::size_t end = body + std::size_t(set.above[0] * set.above[1] * set.above[2]);
    for (; body < end; ++body) {
      if (!(metres > 0 && gravity > 0)) continue;
      for (std::size_t axis = 0; axis < 3; ++axis)
        states[body].position[axis] = from[axis] + closer * (states[body].position[axis] - from[axis]);
      states[body].position[1] -= metres;
      // Half the speed of those in the middle, as if some of it were lost already.
      states[body].velocity[1] = -std::sqrt(gravity * (fall.drop + fall.most)) / 2;
    }
  }
}

bool draws(const SceneConfig& config) {
  const FallingScene& scene = config.keys<FallingScene>();
  return scene.jitter > 0 || std::ranges::any_of(scene.sets, &FallingSet::turned);
}

}  // namespace

SceneKind falling_kind() {
  return {.name = "falling",
          .what = "sets of spheres or other bodies fall on a finite plate and obstacles (thesis, \"Padani\")",
          .integrated = true,
          .read = read,
          .write = write,
          .size = size,
          .make = make,
          .draws = draws,
          .draw_by = "scene.jitter above 0, or turned = true in a set",
          .ahead = ahead,
          .hurry = hurry,
          .complete = complete};
}

}  // namespace pipeline
