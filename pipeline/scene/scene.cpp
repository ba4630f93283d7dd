#include "pipeline/scene/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace pipeline {

Scene make_scene(const SceneConfig& config) {
  Scene scene = config.scene_kind->make(config);
  scene.bodies.closed_within = config.closed_within;
  return scene;
}

std::uint64_t Ahead::before(double steps) const {
  const double last = steps - 1;  // what happens between two samples shows in the later one
  if (!(first <= last)) return 0;
  if (every == 0) return times;
  return std::uint64_t(std::min(double(times), std::floor((last - first) / every) + 1));
}

std::string left_out(const SceneConfig& config) {
  if (!config.scene_kind || !config.scene_kind->ahead) return "";
  struct Left {
    std::string what;
    std::uint64_t times = 0, left = 0;
    double first = 0, last = 0;  // steps of what is left
  };
  std::vector<Left> kinds;
  for (const Ahead& event : config.scene_kind->ahead(config)) {
    auto kind = std::ranges::find(kinds, event.what, &Left::what);
    if (kind == kinds.end()) kind = kinds.insert(kind, {.what = event.what});
    const std::uint64_t seen = event.before(double(config.steps));
    kind->times += event.times;
    if (seen == event.times) continue;
    const double first = event.step(seen), last = event.step(event.times - 1);
    kind->first = kind->left == 0 ? first : std::min(kind->first, first);
    kind->last = kind->left == 0 ? last : std::max(kind->last, last);
    kind->left += event.times - seen;
  }
  std::string list;
  for (const Left& kind : kinds) {
    if (kind.left == 0) continue;
    const auto step = [](double at) { return std::to_string(std::int64_t(std::ceil(at))); };
    list += list.empty() ? "" : ", ";
    list += kind.times == 1 ? "the " : std::to_string(kind.left) + " of " + std::to_string(kind.times) + " ";
    list += kind.what + " (step " + step(kind.first) + (kind.left > 1 ? " to " + step(kind.last) : "") + ")";
  }
  if (list.empty()) return "";
  return one_line(config.path.string(), 4096) + ": " + std::to_string(config.steps) + " steps leave out " + list +
         ": what remains is another scene";
}

BodyState unborn_state() {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  BodyState state;
  state.position.fill(kNaN);
  state.orientation.fill(kNaN);
  state.velocity.fill(kNaN);
  state.angular_velocity.fill(kNaN);
  return state;
}

bool is_born(const BodyState& state) { return !std::isnan(state.position[0]); }

geometry::Pose pose_of(const BodyState& state) {
  if (!is_born(state)) return geometry::unborn();
  const auto& q = state.orientation;
  const auto& p = state.position;
  return {geometry::normalised({q[0], q[1], q[2], q[3]}), {p[0], p[1], p[2]}};
}

RigidBody solid_sphere(const geometry::Mesh& mesh, double density, ContactRadius contact_radius) {
  const double nominal = mesh.sphere_radius;
  RigidBody sphere;
  sphere.radius = contact_radius == ContactRadius::nominal ? nominal : geometry::inscribed_radius(mesh);
  sphere.mass = density * (4.0 / 3.0) * std::numbers::pi * (nominal * nominal * nominal);
  sphere.inertia = 0.4 * sphere.mass * (nominal * nominal);
  return sphere;
}

std::string all_open_text(const std::string& mesh, const geometry::Solid& solid) {
  return "mesh '" + mesh + "' is open, " + geometry::open_text(solid) +
         "; no mesh is closed, so nothing can be inside another; close one, raise truth.closed_within, or set "
         "truth.containment to \"ignore\"";
}

}  // namespace pipeline
