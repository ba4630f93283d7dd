#include "pipeline/keys.hpp"

#include <algorithm>
#include <map>

#include "pipeline/config.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/study/problem.hpp"

namespace pipeline {
namespace {

struct KeyText {
  const char* path;
  const char* unit;
  const char* what;
  bool required = false;  // or without a fixed preset: what its reader starts from is none
};

/// In the order of the list.
constexpr KeyText kTexts[] = {
    {"title", "1", "name of the run; without it the file's name", true},
    {"seed", "1", "every random number of the run comes from it"},
    {"steps", "1",
     "samples of the motion, the initial poses included; where it is scripted or replayed all without it"},
    {"rate", "1/s", "samples per second"},
    {"study", "1", "takes the place of [scene]: a study of the integrators", true},
    {"scene.kind", "1", "what is simulated or replayed (`pipeline list scenes`)", true},
    {"scene.segments", "1", "tessellation of the spheres"},
    {"scene.radius", "m", "radius of the spheres"},
    {"scene.density", "kg/m^3", "density of the spheres"},
    {"scene.plate", "m", "sides of the plate"},
    {"scene.shift", "m", "displaces every upper sphere along x, so that none falls on a pole"},
    {"scene.jitter", "m", "greatest random displacement of every upper sphere along each axis"},
    {"scene.contact_spheres", "1", "spheres inside a mesh by which bodies that are no spheres touch, at most"},
    {"scene.set.N.lying", "1", "lying bodies along x and z"},
    {"scene.set.N.above", "1", "falling bodies along x, y and z"},
    {"scene.set.N.corner", "m", "x and z of the first body of the set"},
    {"scene.set.N.spacing", "m", "distance of neighbouring bodies"},
    {"scene.set.N.height", "m", "height of the lowest falling bodies"},
    {"scene.set.N.turned", "1", "the falling bodies are turned at random"},
    {"scene.set.N.shapes.N.shape", "1", "what falls instead of spheres, one after another (`pipeline list shapes`)",
     true},
    {"scene.set.N.shapes.N.mesh", "1", "the same from a file (OBJ, OFF, STL or PLY); instead of shape", true},
    {"scene.set.N.shapes.N.density", "kg/m^3", "density; without it that of the scene"},
    {"scene.set.N.shapes.N.contact_spheres", "1", "as of the scene, of this one"},
    {"scene.half_width", "m", "from the middle of the cube to the inner faces"},
    {"scene.thickness", "m", "thickness of the plates"},
    {"scene.births.count", "1", "spheres that are born"},
    {"scene.births.from", "1", "step of the first birth"},
    {"scene.births.every", "1", "steps between births; 0: all are born at once"},
    {"scene.push.from", "1", "step of the first push"},
    {"scene.push.every", "1", "steps between pushes"},
    {"scene.push.speed", "m/s", "speed that a push adds along an axis of the sphere's own frame"},
    {"scene.push.directions", "1", "axes of the pushes, one after another"},
    {"scene.step", "m", "distance of neighbouring samples on a path"},
    {"scene.hero.shape", "1", "shape of the body that moves (`pipeline list shapes`); without it the thesis's capsule",
     true},
    {"scene.obstacle.N.name", "1", "name of the obstacle", true},
    {"scene.obstacle.N.shape", "1", "shape of the obstacle (`pipeline list shapes`)", true},
    {"scene.obstacle.N.mesh", "1", "file of its mesh (OBJ, OFF, STL or PLY); instead of shape", true},
    {"scene.obstacle.N.density", "kg/m^3", "as of the scene; nothing depends on it"},
    {"scene.obstacle.N.contact_spheres", "1", "as of the scene, of this one"},
    {"scene.obstacle.N.position", "m", "where it stands"},
    {"scene.obstacle.N.rotation", "degrees", "turns about axes of the world, one after another"},
    {"scene.obstacle.N.orientation", "1", "w, x, y, z; in the playground instead of rotation", true},
    {"scene.path.N.name", "1", "name of the path; without it its axis or number"},
    {"scene.path.N.targets", "1", "obstacles that it goes through, one pass each; without it all"},
    {"scene.path.N.axis", "1", "axis along which it goes; else from and to", true},
    {"scene.path.N.offset", "m", "distance of the path from the middle of the target"},
    {"scene.path.N.hero", "1", "how the hero lies"},
    {"scene.path.N.from", "m", "beginning of the path, from the target", true},
    {"scene.path.N.to", "m", "end of the path, from the target", true},
    {"scene.path.N.rotation", "degrees", "turns of the hero about axes of the world, one after another"},
    {"scene.path.N.orientation", "1", "of the hero, w, x, y, z; instead of rotation", true},
    {"scene.poses", "1", "CSV of poses; or motion, or poses of each moving body", true},
    {"scene.motion", "1", "result whose bodies and poses are taken; instead of poses and bodies", true},
    {"scene.only", "1", "only pairs with one of these bodies count; without it all"},
    {"scene.half_turns", "1", "that a first quaternion begins with 0 is meant, and not asked about"},
    {"scene.quaternion_tolerance", "1", "how far from 1 the length of a quaternion, or of a matrix's columns, may be"},
    {"scene.euler", "1", "order of angles: \"xyz\" about fixed axes, x first; \"XYZ\" about the body's own", true},
    {"scene.body.N.name", "1", "name of the body, as in the CSV; of parts what stands before the name of a node", true},
    {"scene.body.N.mesh", "1", "file of its mesh (OBJ, OFF, STL, PLY, or glTF and what else assimp reads); or shape",
     true},
    {"scene.body.N.shape", "1", "built-in shape (`pipeline list shapes`); instead of mesh", true},
    {"scene.body.N.node", "1", "node of the file that is the body, with what is under it; without it all of the file",
     true},
    {"scene.body.N.parts", "1", "every node of the file that has a mesh is a body, named after it"},
    {"scene.body.N.scale", "1", "metres a unit of the file", true},
    {"scene.body.N.up", "1", "axis of the file that becomes y"},
    {"scene.body.N.fixed", "1", "it never moves"},
    {"scene.body.N.poses", "1", "of a moving body: CSV of its own, also lines of TUM; instead of those of the scene",
     true},
    {"scene.body.N.position", "m", "of a fixed body; else one row of the CSV at step 0", true},
    {"scene.body.N.orientation", "1", "of a fixed body, w, x, y, z"},
    {"scene.robot.N.name", "1", "what stands before the name of each link, with a point; without it nothing", true},
    {"scene.robot.N.urdf", "1", "URDF of the robot: each link with a <collision> is a body", true},
    {"scene.robot.N.joints", "1", "CSV of the values of its joints, by their names; rad or m", true},
    {"scene.robot.N.position", "m", "where its root stands"},
    {"scene.robot.N.orientation", "1", "of its root, w, x, y, z"},
    {"scene.pairs", "1", "pairs of shapes"},
    {"scene.scales", "m", "sizes of the bodies"},
    {"scene.offsets", "m", "coordinates at which they stand"},
    {"scene.orientations", "1", "random orientations of each"},
    {"SHAPE.radius", "m", "radius; of a torus knot from its axis to the middle of the tube", true},
    {"SHAPE.size", "m", "sides along x, y and z", true},
    {"SHAPE.height", "m", "height along y, the round ends included", true},
    {"SHAPE.radius_bottom", "m", "radius of the lower end; with radius_top instead of radius", true},
    {"SHAPE.radius_top", "m", "radius of the upper end; with radius_bottom instead of radius", true},
    {"SHAPE.diameter", "m", "diameter of the circle in the middle of the tube", true},
    {"SHAPE.thickness", "m", "diameter of the tube", true},
    {"SHAPE.tube", "m", "radius of the tube", true},
    {"SHAPE.segments", "1", "tessellation"},
    {"SHAPE.radial_segments", "1", "tessellation around the tube"},
    {"SHAPE.tubular_segments", "1", "tessellation along the tube"},
    {"SHAPE.p", "1", "turns about the axis"},
    {"SHAPE.q", "1", "turns about the circle"},
    {"physics.bodies", "1",
     "free: each body by itself; tree: Simbody's multibody tree, slower, the motions of earlier results"},
    {"physics.integrator", "1", "`pipeline list integrators`"},
    {"physics.accuracy", "1", "relative accuracy asked of the integrator"},
    {"physics.gravity", "m/s^2", "along x, y and z"},
    {"physics.linear_damping", "1/s", "force against the velocity, per mass"},
    {"physics.angular_damping", "1/s", "torque against the angular velocity, per moment of inertia"},
    {"physics.stiffness", "Pa", "plane-strain modulus of the surfaces"},
    {"physics.dissipation", "s/m", "Hunt and Crossley's"},
    {"physics.static_friction", "1", "greatest coefficient of friction"},
    {"physics.dynamic_friction", "1", "coefficient of friction of fast sliding"},
    {"physics.viscous_friction", "s/m", "coefficient that grows with the slip"},
    {"physics.transition_velocity", "m/s", "slip at which friction is greatest"},
    {"physics.contact_radius", "1", "sphere of the contact: within the mesh, or of the nominal radius"},
    {"physics.step_budget", "1", "internal steps between two samples, at most; then the integration fails"},
    {"physics.time_budget", "s", "time between two samples, at most; 0: any"},
    {"physics.energy_bound", "1", "energy over the first, at most; then the integration fails"},
    {"truth.containment", "1", "what becomes of a body wholly inside another (pipeline/FILE.md)"},
    {"truth.closed_within", "1", "corners of an open mesh nearer than this part of its size count as one"},
    {"truth.gap", "1", "bounds on the distance of near pairs that do not meet"},
    {"truth.gap_margin", "m", "how near; with gap = true"},
    {"timing.repeats", "1", "passes of every method over a step: the fastest and the median are kept"},
    {"timing.noise", "1", "the first label is timed a second time: the noise floor; not of extremes"},
    {"timing.pin", "1", "number of the one processor that times are taken on; without it any", true},
    {"plugin.N.path", "1", "shared library of methods, relative to the configuration (algorithms/README.md)", true},
    {"algorithm.N.name", "1", "`pipeline list algorithms`; its knobs are further keys", true},
    {"algorithm.N.label", "1", "name of its answers; without it that of the algorithm"},
    {"algorithm.N.optional", "1", "left out, and said, where its library or its program is not there"},
    {"algorithm.N.command", "1", "of a program of others: the program and its words; further keys are its knobs", true},
    {"algorithm.N.step_budget", "s", "of a method of others: for one answer, at most"},
    {"algorithm.N.time_budget", "s", "of a method of others: for its set-up and all answers together, at most"},
    {"algorithm.N.memory_budget", "MiB", "of a method of others: data of its process, at most"},
    {"every", "1", "of all cases only every one that this number divides is run"},
    {"bodies", "1", "free: each body by itself; tree: Simbody's multibody tree"},
    {"budget.force_evaluations", "1", "of a case, at most"},
    {"budget.processor_time", "s", "of a case, at most"},
    {"budget.energy_bound", "1", "energy gained over the problem's, at most"},
    {"sweep.N.name", "1", "name of the sweep; without it that of its problem"},
    {"sweep.N.problem", "1", "what is integrated (`pipeline list problems`)", true},
    {"sweep.N.integrator", "1", "integrators that are compared; without it all"},
    {"sweep.N.accuracy", "1", "accuracies asked of them; without it and fixed_step 1e-3"},
    {"sweep.N.fixed_step", "s", "fixed steps, of those that take one"},
    {"sweep.N.units", "1", "of the integration: SI, or the problem's own length, mass and time"},
    {"sweep.N.duration", "s", "simulated time"},
    {"sweep.N.greatest_step", "s", "steps are at most of this length, unless fixed"},
    {"sweep.N.radius", "m", "radius of the ball"},
    {"sweep.N.thickness", "m", "thickness of the plate"},
    {"sweep.N.offset", "m", "moves everything along x, y and z"},
    {"sweep.N.mass", "kg", "mass of the ball"},
    {"sweep.N.inertia", "kg m^2", "moment of inertia of the ball"},
    {"sweep.N.balls", "1", "balls in the stack"},
    {"sweep.N.mass_ratio", "1", "mass of the topmost ball over that of each other"},
    {"sweep.N.speed", "m/s", "speed of approach or of the throw"},
    {"sweep.N.transition_velocity", "m/s", "slip at which friction is greatest"},
    {"sweep.N.stiffness", "Pa", "plane-strain modulus of the surfaces"},
    {"sweep.N.dissipation", "s/m", "Hunt and Crossley's"},
};

/// A configuration of which the readers ask all that its kind has.
struct Example {
  std::string where, text;
  bool of_shape = false;
};

/// What beside `kind` makes a reader ask for more.
const std::multimap<std::string, std::string> kMore = {
    {"falling",
     "[[scene.obstacle]]\nname = 'a'\nmesh = 'a.obj'\n[[scene.obstacle]]\nname = 'b'\nshape = 'sphere'\n"
     "radius = 1\n[[scene.set]]\nshapes = [{mesh = 'b.obj'}, {shape = 'sphere', radius = 1}]\n"},
    {"playground",
     "hero = {shape = 'sphere', radius = 1}\n[[scene.obstacle]]\nname = 'a'\nshape = 'sphere'\nradius = 1\n"
     "[[scene.obstacle]]\nname = 'b'\nshape = 'sphere'\nradius = 1\norientation = [1, 0, 0, 0]\n"
     "[[scene.path]]\naxis = 'x'\n[[scene.path]]\naxis = 'y'\nrotation = [['x', 1]]\n"
     "[[scene.path]]\nfrom = [0, 0, 0]\nto = [1, 0, 0]\norientation = [1, 0, 0, 0]\n"},
    {"replay",
     "poses = 'p.csv'\neuler = 'xyz'\n[[scene.body]]\nname = 'a'\nmesh = 'a.glb'\nnode = 'b'\nscale = 1\nposes = "
     "'a.txt'\n[[scene.body]]\nname = 'b'\nshape = 'sphere'\n"
     "radius = 1\nfixed = true\nposition = [0, 0, 0]\norientation = [1, 0, 0, 0]\n[[scene.robot]]\nurdf = "
     "'a.urdf'\njoints = 'j.csv'\n"},
    {"replay", "motion = 'm.h5'\n"},
};
const std::multimap<std::string, std::string> kShapeTexts = {
    {"sphere", "radius = 1"},
    {"box", "size = [1, 1, 1]"},
    {"capsule", "height = 4, radius = 1"},
    {"capsule", "height = 4, radius_bottom = 1, radius_top = 1"},
    {"torus", "diameter = 2, thickness = 1"},
    {"torus_knot", "radius = 2, tube = 1"},
};

std::vector<Example> examples() {
  std::vector<Example> out;
  for (const SceneKind& kind : scene_kinds()) {
    const auto [first, last] = kMore.equal_range(kind.name);
    const std::string head = "[scene]\nkind = '" + kind.name + "'\n",
                      tail =
                          "[truth]\ngap = true\n[[plugin]]\npath = 'libmine.so'\n[[algorithm]]\nname = 'aabb'\n"
                          "[[algorithm]]\nname = 'program'\ncommand = ['x']\n";
    if (first == last) out.push_back({kind.name, head + tail});
    for (auto more = first; more != last; ++more) out.push_back({kind.name, head + more->second + tail});
  }
  for (const auto& [shape, keys] : kShapeTexts)
    out.push_back({shape, "[scene]\nkind = 'playground'\nhero = {shape = '" + shape + "', " + keys + "}\n", true});
  for (const Problem& problem : problems())
    out.push_back({problem.name, "study = 'integration'\n[[sweep]]\nproblem = '" + problem.name + "'\n"});
  return out;
}

/// scene.set.2.height as scene.set.N.height.
std::string numberless(const std::string& path) {
  std::string out;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const std::string part = path.substr(begin, end - begin);
    const bool number = !part.empty() && part.find_first_not_of("0123456789") == std::string::npos;
    out += (out.empty() ? "" : ".") + (number ? "N" : part);
    begin = end + 1;
  }
  return out;
}

/// The key of a shape, whatever has it, as SHAPE.radius.
std::string general(const std::string& path) {
  for (const std::string holder : {"scene.hero.", "scene.obstacle.N.", "scene.body.N.", "scene.set.N.shapes.N."})
    if (path.starts_with(holder)) {
      const std::string shape = "SHAPE." + path.substr(holder.size());
      if (std::ranges::any_of(kTexts, [&](const KeyText& text) { return shape == text.path; })) return shape;
    }
  return path;
}

const KeyText* text_of(const std::string& path) {
  const auto found = std::ranges::find_if(kTexts, [&](const KeyText& text) { return path == text.path; });
  return found == std::end(kTexts) ? nullptr : &*found;
}

}  // namespace

std::vector<KeyFacts> key_facts() {
  std::vector<KeyFacts> all;
  for (const Example& example : examples())
    for (AskedKey key : asked_keys(example.text)) {
      key.path = general(numberless(key.path));
      // Of shapes the example of each tells; the others only have one.
      if (key.path.starts_with("SHAPE.") != example.of_shape) continue;
      auto found = std::ranges::find(all, key.path, [](const KeyFacts& facts) { return facts.key.path; });
      if (found == all.end()) found = all.insert(all.end(), {key, "1", "", {}});
      if (found->key.type.empty()) found->key = key;
      if (std::ranges::find(found->where, example.where) == found->where.end()) found->where.push_back(example.where);
    }
  // Tables are no keys: what stands in them is.
  const auto is_table = [](const std::vector<KeyFacts>& keys, const KeyFacts& facts) {
    const std::string begin = facts.key.path + ".";
    return facts.key.type.empty() &&
           (std::ranges::any_of(keys, [&](const KeyFacts& other) { return other.key.path.starts_with(begin); }) ||
            facts.key.path == "scene.hero");
  };
  std::vector<KeyFacts> keys;
  std::ranges::copy_if(all, std::back_inserter(keys), [&](const KeyFacts& facts) { return !is_table(all, facts); });
  for (KeyFacts& facts : keys)
    if (const KeyText* text = text_of(facts.key.path)) {
      facts.unit = text->unit;
      facts.what = text->what;
      if (text->required) facts.key.preset.clear();
    }
  std::ranges::stable_sort(keys, {}, [](const KeyFacts& facts) {
    const KeyText* text = text_of(facts.key.path);
    return text ? text - kTexts : std::ssize(kTexts);
  });
  return keys;
}

std::vector<std::string> unasked_keys() {
  const std::vector<KeyFacts> all = key_facts();
  std::vector<std::string> out;
  for (const KeyText& text : kTexts)
    if (std::ranges::none_of(all, [&](const KeyFacts& facts) { return facts.key.path == text.path; }))
      out.push_back(text.path);
  return out;
}

}  // namespace pipeline
