// kind = "replay": other people's motion. Bodies from mesh files or built-in shapes and poses from CSV, or both from
// the result of an earlier run.
//
// Keys are read without touching the files they name, because a result's own configuration is read again long after
// they are gone. The files are read when the configuration is (complete), for their size and flaws, and again when the
// scene is made: nothing of them stays in memory between.
#include "pipeline/scene/kinds/replay.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "geometry/decision/contain.hpp"
#include "geometry/meshes/mesh_file.hpp"
#include "geometry/meshes/nodes.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/scene/kinds/replay_keys.hpp"
#include "pipeline/scene/mesh_input.hpp"
#include "pipeline/scene/poses_csv.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/print.hpp"

namespace pipeline {

namespace {

/// What the files of a replayed scene hold.
struct ReplayInputs {
  geometry::Bodies bodies;
  std::vector<const ReplayBody*> of;                 // B, of the configuration; null: of a robot
  std::vector<CsvMotion> robots;                     // with a track for each of the B bodies
  std::vector<std::optional<geometry::Pose>> stays;  // B, of fixed bodies whose pose is not in the CSV
  std::vector<BodyFacts> facts;
  CsvMotion csv;
  std::vector<std::vector<geometry::Pose>> poses;  // S x B, of an earlier result; else empty
  std::optional<double> rate;                      // of an earlier result

  std::int64_t steps() const { return poses.empty() ? csv.steps : std::int64_t(poses.size()); }
};

/// Bodies as the configuration lists them. Bodies of one file or of equal shapes share a mesh, which is named after the
/// first of them.
class Bodies {
 public:
  Bodies(SceneConfig& config, bool judge, ReplayInputs& out) : config_(config), judge_(judge), out_(out) {}

  void add(const ReplayBody& body) {
    MeshFile file{.file = body.mesh, .place = body.place, .node = body.node, .up = body.up[0]};
    file.scale.fill(body.scale.value_or(1));
    if (body.parts) {
      for (MeshInput& part : read_parts(config_, file, body.name.empty() ? "" : body.name + ".", nodes_)) {
        const std::string name = part.mesh.name;
        const auto pose = part.pose;
        add(body, name, new_mesh(name, body.place, std::move(part)), pose);
      }
      return;
    }
    TomlText text;
    write_mesh_or_shape(body, text);
    auto at = known_.find(text.text);
    if (at == known_.end()) {
      Known known;
      if (body.shape) {
        any_closed_ = true;
        known.mesh = std::uint32_t(out_.bodies.meshes.size());
        out_.bodies.meshes.push_back(make_mesh(*body.shape, body.name));
        closed_.push_back(true);
      } else {
        MeshInput input = read_mesh(config_, file, body.name, nodes_);
        known.pose = input.pose;
        known.mesh = new_mesh(body.name, body.place, std::move(input));
      }
      at = known_.emplace(text.text, known).first;
    }
    add(body, body.name, at->second.mesh, at->second.pose);
  }

  /// Links as bodies. A robot's tracks are of all bodies once all are there (load_poses).
  void add(const Robot& robot) {
    LoadedRobot loaded = load_robot(config_, robot, nodes_);
    std::vector<CsvTrack> tracks(out_.bodies.size());
    for (std::size_t i = 0; i < loaded.bodies.size(); ++i) {
      RobotBody& link = loaded.bodies[i];
      const std::string name = link.input.mesh.name;
      const std::uint32_t mesh = new_mesh(name, robot.place, std::move(link.input));
      std::optional<geometry::Pose> stays;
      if (link.fixed) stays = loaded.motion.tracks[i].poses[0];
      add(nullptr, name, robot.place, robot.urdf, link.fixed, mesh, stays);
      tracks.push_back(link.fixed ? CsvTrack{} : std::move(loaded.motion.tracks[i]));
    }
    loaded.motion.tracks = std::move(tracks);
    out_.robots.push_back(std::move(loaded.motion));
  }

  /// Throws Error(kInput) when containment counts and nothing can hold anything.
  void finish() const {
    if (judge_ && config_.containment != Containment::ignore && !any_closed_)
      throw Error(kInput, first_open_->place + " of body '" + first_open_->name +
                              "': " + all_open_text(first_open_->name, first_open_->solid));
  }

 private:
  struct Known {
    std::uint32_t mesh = 0;
    std::optional<geometry::Pose> pose;
  };

  std::uint32_t new_mesh(const std::string& name, const std::string& place, MeshInput input) {
    const auto at = std::uint32_t(out_.bodies.meshes.size());
    closed_.push_back(false);
    if (judge_) {
      geometry::Solid solid = geometry::solid_of(input.mesh, config_.closed_within);
      note_flaws(input.mesh, solid, input.path, config_);
      any_closed_ |= solid.closed;
      closed_.back() = solid.closed;
      if (!solid.closed && !first_open_) first_open_ = {name, place, std::move(solid)};
    }
    out_.bodies.meshes.push_back(std::move(input.mesh));
    return at;
  }

  void add(const ReplayBody& body, const std::string& name, std::uint32_t mesh,
           const std::optional<geometry::Pose>& pose) {
    std::optional<geometry::Pose> stays;
    if (body.position) {
      const auto& t = *body.position;
      const auto& q = body.orientation;
      stays = {geometry::normalised({q[0], q[1], q[2], q[3]}), {t[0], t[1], t[2]}};
    } else if (body.fixed) {
      stays = pose;
    }
    add(&body, name, body.place, body.mesh, body.fixed, mesh, stays);
  }

  void add(const ReplayBody* body, const std::string& name, const std::string& place, const std::string& file,
           bool fixed, std::uint32_t mesh, const std::optional<geometry::Pose>& stays) {
    if (!names_.insert(name).second)
      throw Error(kInput, place + ": another body is named " + in_quotes(one_line(name)) + "; rename one");
    out_.bodies.add(name, mesh, fixed);
    out_.of.push_back(body);
    out_.stays.push_back(stays);
    if (!judge_) return;
    const geometry::Mesh& surface = out_.bodies.meshes[mesh];
    const geometry::Box box = geometry::local_box(surface);
    out_.facts.push_back({.name = name,
                          .mesh = file,
                          .fixed = fixed,
                          .closed = closed_[mesh],
                          .facets = surface.triangles.size(),
                          .size = box.max - box.min});
  }

  SceneConfig& config_;
  const bool judge_;
  ReplayInputs& out_;
  NodeFiles nodes_;
  std::map<std::string, Known> known_;  // by the keys of the mesh
  std::set<std::string> names_;
  std::vector<bool> closed_;  // by mesh
  struct Open {
    std::string name, place;
    geometry::Solid solid;
  };
  std::optional<Open> first_open_;
  bool any_closed_ = false;
};

/// One table of poses: what it says, and what is to be said of it.
void load_table(SceneConfig& config, const ReplayScene& scene, const std::string& file, const std::string& place,
                const std::vector<CsvBody>& bodies, CsvMotion& motion) {
  const Input input = read_input(config, file, place);
  CsvMotion table = parse_poses(input.bytes, input.path, bodies, scene.rules);
  if (!table.plain) config.understood.push_back(input.path + ": " + table.understood);
  if (table.begins_with_half_turns && !scene.half_turns)
    config.notes.push_back(input.path +
                           ": the first quaternion of every body has qw = 0, a half turn: are they in the order of "
                           "the header? If they are x, y, z, w, let the header end with qx,qy,qz,qw; if half turns are "
                           "meant, set scene.half_turns = true");
  join(motion, std::move(table), input.path);
}

CsvMotion load_poses(SceneConfig& config, const ReplayScene& scene, ReplayInputs& inputs) {
  std::vector<CsvBody> bodies;
  for (std::uint32_t b = 0; b < inputs.bodies.size(); ++b)
    bodies.push_back({inputs.bodies.name[b], inputs.stays[b]                                 ? CsvBody::none
                                             : !inputs.of[b] || !inputs.of[b]->poses.empty() ? CsvBody::elsewhere
                                             : !inputs.bodies.fixed[b]                       ? CsvBody::every_step
                                                                                             : CsvBody::first_step});
  CsvMotion motion;
  motion.tracks.resize(bodies.size());
  if (!scene.poses.empty()) load_table(config, scene, scene.poses, scene.place, bodies, motion);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].rows == CsvBody::elsewhere && inputs.of[b]) {
      const ReplayBody& body = *inputs.of[b];
      CsvMotion own;
      load_table(config, scene, body.poses, body.poses_place, {{body.name}}, own);
      std::vector<CsvTrack> tracks(bodies.size());
      tracks[b] = std::move(own.tracks[0]);
      own.tracks = std::move(tracks);
      join(motion, std::move(own), (config.path.parent_path() / body.poses).string());
    }
    if (bodies[b].rows == CsvBody::none) motion.tracks[b] = {.first = 0, .stays = true, .poses = {*inputs.stays[b]}};
  }
  for (std::size_t r = 0; r < inputs.robots.size(); ++r) {
    CsvMotion& robot = inputs.robots[r];
    if (robot.steps == 0) continue;  // none of its joints moves
    join(motion, std::move(robot), (config.path.parent_path() / scene.robots[r].joints).string());
  }
  if (motion.steps == 0) throw Error(kInput, scene.robots[0].place + ": nothing moves; give poses or joints that do");
  return motion;
}

void load_result(SceneConfig& config, const ReplayScene& scene, bool judge, ReplayInputs& inputs) {
  const std::string path = read_input(config, scene.motion, scene.place).path;
  Result earlier = read_result(path);
  if (judge && config.containment != Containment::ignore) {
    std::vector<geometry::Solid> solids;
    for (const geometry::Mesh& mesh : earlier.bodies.meshes) {
      solids.push_back(geometry::solid_of(mesh, config.closed_within));
      note_flaws(mesh, solids.back(), path + ": mesh '" + mesh.name + "'", config);
    }
    if (std::ranges::none_of(solids, &geometry::Solid::closed))
      throw Error(kInput, scene.place + ": " + all_open_text(earlier.bodies.meshes[0].name, solids[0]));
  }
  inputs.bodies = std::move(earlier.bodies);
  inputs.poses = std::move(earlier.motion);
  inputs.rate = earlier.rate;
}

/// The one in the middle; `values` are not empty.
double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// What looks as if a file were in another unit: a body a hundred times as large as the others are, or as small, and a
/// path of thousands of its own lengths.
void add_doubts(ReplayInputs& inputs) {
  for (std::size_t b = 0; b < inputs.facts.size(); ++b) {
    BodyFacts& body = inputs.facts[b];
    geometry::Vec3 low = geometry::Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const geometry::Pose& pose : inputs.csv.tracks[b].poses) {
      low = low.cwiseMin(pose.t);
      high = high.cwiseMax(pose.t);
    }
    body.path = std::max(0.0, (high - low).maxCoeff());
    const double size = body.size.maxCoeff();
    if (body.path > 5000 * size)
      body.doubt = print("goes %.3g m, %.0f times its own length: are positions in millimetres, or its mesh in metres?",
                         body.path, body.path / size);
    std::vector<double> others;
    for (std::size_t o = 0; o < inputs.facts.size(); ++o)
      if (o != b) others.push_back(inputs.facts[o].size.maxCoeff());
    if (others.empty() || body.mesh.empty()) continue;
    const double usual = median(std::move(others));
    if (size >= 100 * usual || size <= usual / 100)
      body.doubt = print("is %.3g m long, the others %.3g m: is its file in another unit? scale = %s", size, usual,
                         size > usual ? "0.001 or 0.01" : "1000 or 100");
  }
}

/// `judge`: with a look at what is wrong with the meshes.
ReplayInputs load(SceneConfig& config, const ReplayScene& scene, bool judge) {
  ReplayInputs inputs;
  if (!scene.motion.empty()) {
    load_result(config, scene, judge, inputs);
  } else {
    Bodies bodies(config, judge, inputs);
    for (const ReplayBody& body : scene.bodies) bodies.add(body);
    for (const Robot& robot : scene.robots) bodies.add(robot);
    bodies.finish();
    inputs.csv = load_poses(config, scene, inputs);
    add_doubts(inputs);
  }
  if (scene.only.empty()) return inputs;
  geometry::Bodies& bodies = inputs.bodies;
  bodies.chosen.assign(bodies.size(), 0);
  for (const std::string& name : scene.only) {
    const auto at = std::ranges::find(bodies.name, name);
    if (at == bodies.name.end())
      throw Error(kInput, scene.only_place + " must hold names of bodies, not " + in_quotes(one_line(name)) + "; " +
                              hint(name, bodies.name));
    bodies.chosen[std::size_t(at - bodies.name.begin())] = 1;
  }
  return inputs;
}

SceneSize size_of(const geometry::Bodies& bodies) {
  SceneSize out{.bodies = bodies.size(), .meshes = bodies.meshes.size()};
  for (const geometry::Mesh& mesh : bodies.meshes) {
    out.mesh_vertices += mesh.vertices.size();
    out.mesh_triangles += mesh.triangles.size();
  }
  for (std::uint32_t b = 0; b < bodies.size(); ++b) out.body_vertices += bodies.mesh_of(b).vertices.size();
  return out;
}

std::vector<Ahead> births_of(const ReplayInputs& inputs) {
  std::vector<Ahead> out;
  for (std::size_t b = 0; b < inputs.bodies.size(); ++b) {
    const auto born = [b](const auto& step) { return geometry::is_born(step[b]); };
    double first = 0;  // also of a body with its pose in the configuration
    if (inputs.poses.empty())
      first = std::max(0.0, double(inputs.csv.tracks[b].first));
    else
      first = double(std::ranges::find_if(inputs.poses, born) - inputs.poses.begin());
    out.push_back({.what = "births", .first = first});
  }
  return out;
}

/// The file that says how many steps there are.
std::string steps_of(const ReplayScene& scene) {
  if (!scene.motion.empty() || !scene.poses.empty()) return scene.motion + scene.poses;
  const auto own = std::ranges::find_if(scene.bodies, [](const ReplayBody& body) { return !body.poses.empty(); });
  return own == scene.bodies.end() ? scene.robots[0].joints : own->poses;
}

void complete(SceneConfig& config) {
  ReplayScene scene = config.keys<ReplayScene>();
  const ReplayInputs inputs = load(config, scene, true);
  const std::int64_t steps = inputs.steps();
  if (config.steps_place.empty())
    config.steps = steps;
  else if (config.steps > steps)
    throw Error(kInput, config.steps_place + ": 'steps' must be at most " + std::to_string(steps) + ", the steps of " +
                            steps_of(scene) + ", not " + std::to_string(config.steps));
  if (!config.rate_given && inputs.rate) config.rate = *inputs.rate;
  if (const auto rate = rate_of(inputs.csv); rate && !config.rate_given) {
    if (!(*rate >= kLeastRate && *rate <= kMostRate))
      throw Error(kInput, "the times of the poses are " + real_text(1 / *rate) +
                              " s apart on the mean; check their unit, or give the rate");
    config.rate = *rate;
    config.understood.push_back("steps are " + real_text(1 / *rate) +
                                " s apart on the mean: rate = " + real_text(*rate));
  }
  scene.size = size_of(inputs.bodies);
  scene.births = births_of(inputs);
  scene.facts = inputs.facts;
  config.scene = std::move(scene);
}

const ReplayScene& completed(const SceneConfig& config) {
  const ReplayScene& scene = config.keys<ReplayScene>();
  if (!scene.size) throw std::logic_error("a replayed scene is asked for before its files were read");
  return scene;
}

SceneSize size(const SceneConfig& config) { return *completed(config).size; }

std::vector<Ahead> ahead(const SceneConfig& config) { return completed(config).births; }

std::vector<BodyFacts> facts(const SceneConfig& config) { return completed(config).facts; }

Scene make(const SceneConfig& config) {
  SceneConfig again = config;
  ReplayInputs inputs = load(again, completed(config), false);
  refuse_changed(config, again);
  Scene scene;
  scene.bodies = std::move(inputs.bodies);
  if (inputs.poses.empty()) {
    scene.script = poses_of(inputs.csv, config.steps);
  } else {
    scene.script = std::move(inputs.poses);
    scene.script.resize(std::size_t(config.steps));
  }
  return scene;
}

}  // namespace

SceneKind replay_kind() {
  return {.name = "replay",
          .what = "other people's motion: meshes from files, poses from CSV or from an earlier result",
          .integrated = false,
          .read = read_replay,
          .write = write_replay,
          .size = size,
          .make = make,
          .ahead = ahead,
          .complete = complete,
          .facts = facts};
}

}  // namespace pipeline
