// A configuration as values, read from TOML and validated completely before anything runs.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "algorithms/algorithm.hpp"
#include "pipeline/result.hpp"
#include "pipeline/shape_keys.hpp"
#include "pipeline/simulate.hpp"

namespace pipeline {

/// One set of the falling scene: spheres lying on the plate and others above them.
struct FallingSet {
  std::array<std::int64_t, 2> lying{1, 1};     // counts along x and z
  std::array<std::int64_t, 3> above{1, 1, 1};  // counts along x, y and z
  std::array<double, 2> corner{0, 0};          // x and z of the first sphere, m
  double spacing = 2.1;                        // m
  double height = 5;                           // y of the lowest sphere above, m
};

/// kind = "falling": a fixed plate with its top at y = 0 and sets of spheres.
struct FallingScene {
  std::int64_t segments = 16;              // of the sphere's mesh
  double radius = 1;                       // m
  double density = 1000;                   // kg/m^3
  std::array<double, 3> plate{60, 2, 60};  // size, m
  double shift = 0.15;                     // m, of the spheres above in x and z, or all balances on points
  double jitter = 0;                       // m, of the spheres above along each axis at most, drawn from the seed
  std::vector<FallingSet> sets;            // the thesis's three when the configuration names none
};

/// kind = "box": spheres are born one by one in a closed cube and pushed again and again.
struct BoxScene {
  std::int64_t segments = 16;  // of the sphere's mesh
  double radius = 0.5;         // m
  double density = 1000;       // kg/m^3
  double half_width = 5;       // of the room inside, m
  double thickness = 1;        // of the six plates around it, m
  struct {
    std::int64_t count = 80, from = 0, every = 5;  // steps; every 0: all at once
  } births;
  struct {
    std::int64_t from = 50, every = 50;                           // steps
    double speed = 5;                                             // m/s, added to the velocity; 0: no pushes
    std::vector<std::string> directions{"+x", "-x", "+z", "-z"};  // of each sphere's own frame, in turn
  } push;
};

/// One obstacle of the playground. Where it stands follows from all of them.
struct PlaygroundObstacle {
  std::string name;
  Shape shape;
  geometry::Quaternion orientation;
};

/// One straight path of the hero, taken through each of `targets`.
struct PlaygroundPath {
  enum class Hero { along, across, given };

  std::string name;                  // of an axis: "x", "y" or "z"
  std::vector<std::string> targets;  // names of obstacles
  std::optional<int> axis;           // 0 to 2: parallel to it, from end to end of what bounding spheres reach, and 1 m
  double offset = 0;                 // m, along the axis after `axis`
  geometry::Vec3 from = geometry::Vec3::Zero(), to = geometry::Vec3::Zero();  // m, from the target; without an axis
  Hero hero = Hero::along;           // its own y axis lies along `axis`, or along the second axis after it, or as given
  geometry::Quaternion orientation;  // as given
};

/// kind = "playground": the hero passes through obstacles on straight paths.
struct PlaygroundScene {
  double step = 0.25;                         // m, at most, from sample to sample
  Shape hero = CapsuleShape{3, 0.6, 0.6};     // the thesis's
  std::vector<PlaygroundObstacle> obstacles;  // the thesis's eleven when the configuration names none
  std::vector<PlaygroundPath> paths;          // the twelve when the configuration names none
};

struct ReplayInputs;  // pipeline/scene_replay.cpp: what the files hold

/// One body of a replayed scene.
struct ReplayBody {
  std::string name;
  std::string mesh;            // file as written; empty: a shape
  std::optional<Shape> shape;  // else the mesh
  bool fixed = false;
  std::optional<std::array<double, 3>> position;  // m; of fixed bodies, when it is not in the CSV
  std::array<double, 4> orientation{1, 0, 0, 0};  // w x y z, as written
  std::string place;                              // of mesh or shape, for messages
};

/// kind = "replay": bodies and poses from files. Paths are relative to the configuration's folder.
struct ReplayScene {
  std::string poses, motion;      // a CSV file, or an earlier result with all its bodies; the other is empty
  bool half_turns = false;        // the CSV's quaternions that begin with 0 are meant so
  std::vector<std::string> only;  // empty: every pair counts
  std::vector<ReplayBody> bodies;
  std::string place, only_place;               // of poses or motion, and of only, for messages
  std::shared_ptr<const ReplayInputs> inputs;  // read_config fills it
};

/// kind = "extremes": pairs around exact touching, at every scale and offset that go together.
struct ExtremesScene {
  std::vector<std::string> pairs;                                  // names; all there are
  std::vector<double> scales{1e-9, 1e-6, 1e-3, 1, 1e3, 1e6, 1e9};  // m, half the extent of a body, about
  std::vector<double> offsets{0, 1e3, 1e6, 1e9};                   // m, of each coordinate
  std::int64_t orientations = 1;                                   // random ones of each pair, scale and offset
};

/// The physical radius of a contact sphere: the shape's, or that of the greatest ball inside its mesh.
enum class ContactRadius { nominal, inscribed };

/// One [[algorithm]].
struct AlgorithmChoice {
  std::string name;
  std::string label;        // defaults to the name
  algorithms::Knobs knobs;  // all of them, presets filled in
};

/// One [[sweep]] of a study: every combination of its values is a case.
struct Sweep {
  std::string name, problem;
  std::vector<std::string> integrators;
  std::vector<double> accuracies;                                   // a step in s for those that control no error
  std::vector<double> fixed_steps;                                  // s, for those that take one
  std::vector<std::string> units;                                   // "SI" or "scaled"
  std::vector<std::pair<std::string, std::vector<double>>> values;  // of the problem's parameters, all of them
};

/// study = "integration": cases instead of a scene.
struct Study {
  std::vector<Sweep> sweeps;
  std::int64_t every = 1;  // of all cases only each so manieth is run, from the first
  BodyModel bodies = BodyModel::free;
  // Of each case:
  std::int64_t force_evaluations = 1000000;
  double processor_time = 60;  // s
  double energy_bound = 10;    // of the problem's energy: more gained is a failure
};

struct SceneKind;  // pipeline/scene.hpp

constexpr std::int64_t kSeed = 1;

struct Config {
  std::filesystem::path path;  // as given
  std::string text;            // as read
  std::string effective;  // the whole configuration after defaults and --set, as TOML; reading it gives this Config
  std::string title;
  std::int64_t seed = kSeed;
  std::string seed_place;                 // where it was written; empty: it was not
  std::int64_t steps = 600;               // samples, step 0 included
  double rate = 60;                       // samples per second
  std::optional<Study> study;             // then it has no scene and nothing of what follows but texts and notes
  const SceneKind* scene_kind = nullptr;  // a row of scene_kinds()
  std::variant<FallingScene, BoxScene, PlaygroundScene, ReplayScene, ExtremesScene> scene;  // of that kind
  Physics physics;  // only when the scene is integrated
  ContactRadius contact_radius = ContactRadius::inscribed;
  Containment containment = Containment::ignore;
  double closed_within = geometry::kClosedWithin;  // of a mesh's size, as in Bodies
  std::optional<double> gap_margin;                // m; absent: distances are not asked for
  std::int64_t repeats = 3;
  std::vector<AlgorithmChoice> algorithms;

  // Of scenes that name files:
  std::string steps_place;  // where steps was written; empty: it was not
  bool rate_given = false;
  std::map<std::string, std::string> inputs;  // every file read, as written -> its SHA-256
  std::vector<std::string> notes;             // what should be said of them, one line each
};

/// Reads and validates, the files that the scene names included; steps and rate that are not given become theirs. A
/// seed of which nothing would be drawn is refused, or noted where it is the preset. `sets` are --set arguments,
/// "dotted.key=TOML value" (a bare word is taken as a string). Throws Error(kInput) with file:line:column (or the
/// --set), the value, the rule and the nearest known key.
Config read_config(const std::filesystem::path& path, const std::vector<std::string>& sets = {});

/// Reads TOML text as if from `path`, and no file that it names. For tests, and for recorded_config.
Config parse_config(const std::string& text, const std::filesystem::path& path,
                    const std::vector<std::string>& sets = {});

/// The configuration that a result file holds. Throws Error(kFile) naming the file.
Config recorded_config(const std::string& effective, const std::string& file);

/// An --algorithm argument, "NAME[:knob=value,...][@LABEL]", for a truth of that containment: what a knob `containment`
/// follows when it is not given. Throws Error(kInput) naming the argument.
AlgorithmChoice parse_algorithm(const std::string& argument, Containment containment = Containment::ignore);

/// The rule for labels and names of bodies.
bool valid_label(std::string_view label);
constexpr char kLabelRule[] = "be 1 to 64 characters of A-Z a-z 0-9 _ . + - and neither '.' nor '..'";

/// Knobs as a JSON object, keys sorted.
std::string knobs_json(const algorithms::Knobs& knobs);

}  // namespace pipeline
