#include "pipeline/scene/kinds/replay_keys.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "geometry/meshes/nodes.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

constexpr Range kAnyCoordinate{.least = -geometry::kGreatestCoordinate, .most = geometry::kGreatestCoordinate};

void read_orientation(const Section& s, std::array<double, 4>& q, double tolerance) {
  s.reals("orientation", q, kAnyCoordinate);
  const double norm = geometry::norm({q[0], q[1], q[2], q[3]});
  if (!(std::abs(norm - 1) <= tolerance))
    s.refuse("orientation", "be a quaternion [w, x, y, z] of length 1 within " + real_text(tolerance),
             "its length is " + real_text(norm));
}

void read_mesh_keys(const Section& s, ReplayBody& body) {
  const bool nodes = geometry::is_node_file(body.mesh);
  if (s.has("node")) {
    if (body.parts) s.refuse("node", "be absent where 'parts' is");
    body.node = s.text("node", "");
    if (body.node.empty()) s.refuse("node", "name a node of the file");
  }
  for (const char* key : {"node", "parts"})
    if (s.has(key) && !nodes) s.refuse(key, "be given for files of nodes only, such as .glb");
  if (s.has("scale")) body.scale = s.real("scale", 1, {.least = 1e-9, .most = 1e9});
  body.up = s.choice("up", "y", {"x", "y", "z"});
  std::string lower = body.mesh;
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  if (!body.scale && (lower.ends_with(".3mf") || lower.ends_with(".fbx")))
    s.refuse(
        "mesh", "have a 'scale' beside it",
        "such files have a unit of their own, which assimp does not apply: scale = 0.001 where it is a millimetre");
}

ReplayBody read_body(const Section& s, double tolerance) {
  ReplayBody body;
  body.parts = s.boolean("parts", false);
  if (!s.has("name") && !body.parts) s.fail("missing key '" + s.full("name") + "', the name of the body");
  body.name = s.text("name", "");
  if (s.has("name") && !valid_label(body.name)) s.refuse("name", kLabelRule);
  const std::vector<std::string> others{"name", "mesh",  "node",  "parts",    "scale",
                                        "up",   "fixed", "poses", "position", "orientation"};
  if (s.has("mesh")) {
    if (s.has("shape")) s.refuse("shape", "be absent where 'mesh' is given", "a body has one of them");
    s.only(others);
    body.mesh = s.text("mesh", "");
    if (body.mesh.empty()) s.refuse("mesh", "name a file");
    body.place = place_of(s, "mesh");
    read_mesh_keys(s, body);
  } else {
    for (const char* key : {"node", "parts", "scale", "up"})
      if (s.has(key)) s.refuse(key, "be given beside 'mesh' only");
    if (!s.has("shape"))
      s.fail("missing key '" + s.full("mesh") + "', or 'shape' with its parameters; see `pipeline list shapes`");
    body.shape = read_shape(s, others);
    body.place = place_of(s, "shape");
  }
  body.fixed = s.boolean("fixed", false);
  if (!body.fixed)
    for (const char* key : {"position", "orientation"})
      if (s.has(key)) s.refuse(key, "be given for fixed bodies only", "a moving body has its poses in the CSV");
  if (s.has("poses")) {
    if (body.parts) s.refuse("poses", "be absent where 'parts' is", "the rows of scene.poses name the parts");
    if (body.fixed) s.refuse("poses", "be given for moving bodies only", "a fixed body has its position");
    body.poses = s.text("poses", "");
    if (body.poses.empty()) s.refuse("poses", "name a CSV file");
    body.poses_place = place_of(s, "poses");
  }
  if (s.has("position") && body.parts)
    s.refuse("position", "be absent where 'parts' is", "fixed parts stand where the file has them");
  if (s.has("position")) s.reals("position", body.position.emplace(), kAnyCoordinate);
  if (s.has("orientation")) {
    if (!body.position) s.fail("missing key '" + s.full("position") + "' beside 'orientation'");
    read_orientation(s, body.orientation, tolerance);
  }
  return body;
}

Robot read_robot(const Section& s, double tolerance) {
  s.only({"name", "urdf", "joints", "position", "orientation"});
  Robot robot;
  robot.name = s.text("name", "");
  if (s.has("name") && !valid_label(robot.name)) s.refuse("name", kLabelRule);
  if (!s.has("urdf")) s.fail("missing key '" + s.full("urdf") + "', the file of the robot");
  robot.urdf = s.text("urdf", "");
  if (robot.urdf.empty()) s.refuse("urdf", "name a file");
  robot.place = place_of(s, "urdf");
  robot.joints = s.text("joints", "");
  if (s.has("joints")) {
    if (robot.joints.empty()) s.refuse("joints", "name a CSV file");
    robot.joints_place = place_of(s, "joints");
  }
  s.reals("position", robot.position, kAnyCoordinate);
  read_orientation(s, robot.orientation, tolerance);
  return robot;
}

/// The order of angles, three different axes of one case.
std::string read_euler(const Section& s) {
  const std::string order = s.text("euler", "");
  if (!s.has("euler")) return order;
  std::string sorted = order;
  std::ranges::sort(sorted);
  if (sorted != "xyz" && sorted != "XYZ")
    s.refuse("euler",
             "be the order of three axes, such as \"xyz\" about fixed axes, x first, or \"XYZ\" about the body's own");
  return order;
}

/// Whether it stands where the configuration or its mesh file has it.
bool has_place(const ReplayBody& body) { return body.position || (body.fixed && (body.parts || !body.node.empty())); }

/// Whether some body has its poses neither here nor in a file of its own.
bool needs_poses(const ReplayScene& scene) {
  return std::ranges::any_of(scene.bodies,
                             [](const ReplayBody& body) { return body.poses.empty() && !has_place(body); });
}

}  // namespace

void read_replay(const Section& s, SceneConfig& config) {
  s.only({"kind", "poses", "motion", "only", "half_turns", "quaternion_tolerance", "euler", "body", "robot"});
  ReplayScene scene;
  scene.only = s.texts("only");
  if (s.has("only") && scene.only.empty()) s.refuse("only", "name at least one body", "leave it out for all pairs");
  if (s.has("only")) scene.only_place = place_of(s, "only");
  if (s.has("motion")) {
    const std::string remedy = "bodies, meshes and poses are those of that result";
    for (const char* key : {"poses", "half_turns", "quaternion_tolerance", "euler", "body", "robot"})
      if (s.has(key)) s.refuse(key, "be absent where 'motion' is given", remedy);
    scene.motion = s.text("motion", "");
    if (scene.motion.empty()) s.refuse("motion", "name a result file");
    scene.place = place_of(s, "motion");
  } else {
    scene.poses = s.text("poses", "");
    if (s.has("poses")) {
      if (scene.poses.empty()) s.refuse("poses", "name a CSV file");
      scene.place = place_of(s, "poses");
    }
    scene.half_turns = s.boolean("half_turns", false);
    scene.rules.tolerance = s.real("quaternion_tolerance", CsvRules().tolerance, {.least = 1e-15, .most = 0.1});
    scene.rules.euler = read_euler(s);
    std::set<std::string> taken;
    for (const Section& t : s.sections("body")) {
      scene.bodies.push_back(read_body(t, scene.rules.tolerance));
      if (!scene.bodies.back().parts && !taken.insert(scene.bodies.back().name).second)
        t.refuse("name", "be the only one of its name");
    }
    for (const Section& t : s.sections("robot")) scene.robots.push_back(read_robot(t, scene.rules.tolerance));
    const bool moved = !scene.robots.empty() ||
                       std::ranges::any_of(scene.bodies, [](const ReplayBody& body) { return !body.poses.empty(); });
    if (scene.poses.empty() && (needs_poses(scene) || !moved))
      s.fail("missing key '" + s.full("poses") + "', a CSV file; or 'motion', the result of an earlier run");
    if (scene.bodies.empty() && scene.robots.empty())
      s.fail("missing [[scene.body]]: name the bodies of the CSV and their meshes");
    // Else when the files are read.
    const bool known = scene.robots.empty() && std::ranges::none_of(scene.bodies, &ReplayBody::parts);
    for (const std::string& name : scene.only)
      if (known && !taken.contains(name))
        s.refuse("only", "hold names of bodies", hint(name, std::vector<std::string>(taken.begin(), taken.end())));
  }
  config.scene = std::move(scene);
}

void write_mesh_or_shape(const ReplayBody& body, TomlText& out) {
  if (body.shape) return write_shape(*body.shape, out);
  out.line("mesh", body.mesh);
  if (!body.node.empty()) out.line("node", body.node);
  if (body.parts) out.line("parts", true);
  if (body.scale) out.line("scale", *body.scale);
  if (body.up != "y") out.line("up", body.up);
}

void write_replay(const SceneConfig& config, TomlText& out) {
  const ReplayScene& scene = config.keys<ReplayScene>();
  if (!scene.poses.empty()) out.line("poses", scene.poses);
  if (!scene.motion.empty()) out.line("motion", scene.motion);
  if (scene.rules.tolerance != CsvRules().tolerance) out.line("quaternion_tolerance", scene.rules.tolerance);
  if (!scene.rules.euler.empty()) out.line("euler", scene.rules.euler);
  if (scene.half_turns) out.line("half_turns", true);
  if (!scene.only.empty()) out.list("only", scene.only);
  for (const ReplayBody& body : scene.bodies) {
    out.table("[[scene.body]]");
    if (!body.name.empty()) out.line("name", body.name);
    write_mesh_or_shape(body, out);
    out.line("fixed", body.fixed);
    if (!body.poses.empty()) out.line("poses", body.poses);
    if (!body.position) continue;
    out.list("position", *body.position);
    out.list("orientation", body.orientation);
  }
  for (const Robot& robot : scene.robots) {
    out.table("[[scene.robot]]");
    if (!robot.name.empty()) out.line("name", robot.name);
    out.line("urdf", robot.urdf);
    if (!robot.joints.empty()) out.line("joints", robot.joints);
    out.list("position", robot.position);
    out.list("orientation", robot.orientation);
  }
}

}  // namespace pipeline
