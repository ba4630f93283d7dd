// From a configuration to bodies: meshes, their physical side, and where they are.
//
// A kind of scene is a row of scene_kinds() and a file of its own: its keys, their text, its size and its bodies. To
// add one, write kinds/<kind>.hpp and kinds/<kind>.cpp, and its line in kinds/all.cpp.
#pragma once
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "geometry/bodies.hpp"
#include "geometry/decision/contain.hpp"
#include "pipeline/physics/simulate.hpp"
#include "pipeline/result/products/extremes.hpp"
#include "pipeline/scene/document.hpp"
#include "pipeline/scene/scene_config.hpp"
#include "pipeline/scene/script.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {

struct Scene {
  geometry::Bodies bodies;
  // Integrated scenes:
  std::vector<RigidBody> rigid;   // B, what the integrator needs to know
  std::vector<BodyState> states;  // B, at t = 0, before the events of step 0
  // Scripted scenes:
  std::vector<std::vector<geometry::Pose>> script;  // S x B
  std::vector<Pass> passes;                         // those that the script holds from end to end
  std::vector<CaseSet> case_sets;                   // of extremes: at every step one pair is there
  std::vector<ExtremeCase> cases;                   // S, of extremes: how the pair is placed
};

/// What happens in a scene and is known beforehand: at step `first`, and `times` times in all, every `every` steps.
struct Ahead {
  std::string what;  // "landing of set 3, 216 spheres"; or "births", of which there are several
  double first = 0;
  std::uint64_t times = 1;
  double every = 0;
  std::uint64_t bodies =
      0;  // that move otherwise from then on, each time: before they stand, fall freely or are not born

  double lasts = std::numeric_limits<double>::infinity();  // steps until they calm down

  double step(std::uint64_t time) const { return first + every * double(time); }
  /// How many of them are at steps below `steps`.
  std::uint64_t before(double steps) const;
};

/// How large a scene is, without making it.
struct SceneSize {
  std::uint64_t bodies = 0, meshes = 0;
  std::uint64_t mesh_vertices = 0, mesh_triangles = 0;  // of the distinct meshes
  std::uint64_t body_vertices = 0;                      // over all bodies
  std::map<std::string, std::uint64_t> asked = {};      // of products: how many; their rows know the names
  std::optional<std::uint64_t> pairs = {};              // asked about at a step; absent: all that the bodies make
  std::vector<geometry::Bodies> alone =
      {};  // of extremes: the distinct pairs of bodies, one of which is there at a step
  // Of integrated scenes, at most: contact spheres of all bodies, and bytes taken while they are placed.
  std::uint64_t contact_spheres = 0, placing_bytes = 0;
};

/// What a body is that was read from files, for whoever wants to see whether it was read as it was meant.
struct BodyFacts {
  std::string name, mesh;
  bool fixed = false, closed = false;
  std::uint64_t facets = 0;
  geometry::Vec3 size = geometry::Vec3::Zero();  // m, of the box around it in its own frame
  double path = 0;                               // m, the greatest side of the box around its positions
  std::string doubt = {};                        // what looks wrong; empty: nothing does
};

/// One kind of scene, as data.
struct SceneKind {
  std::string name;                                           // scene.kind
  std::string what;                                           // one line
  bool integrated;                                            // else its poses are a script: no integrator, no /physics
  void (*read)(const Section& section, SceneConfig& config);  // [scene] and presets that depend on the kind
  void (*write)(const SceneConfig& config, TomlText& out);    // the same keys with their values
  SceneSize (*size)(const SceneConfig& config);
  Scene (*make)(const SceneConfig& config);

  // Integrated scenes, where something happens besides integration:

  /// Changes the states at a step: a birth makes a NaN state finite. Returns whether it changed any. A function of its
  /// arguments alone, so that a resumed run has the same bits. Throws Error(kInput) for a birth that has no place.
  bool (*events)(const SceneConfig& config, std::int64_t step, std::vector<BodyState>& states) = nullptr;
  /// What no state of the scene may be, and is: one line naming the body. Empty: all is well. Asked at every step.
  std::string (*breach)(const SceneConfig& config, const std::vector<BodyState>& states) = nullptr;
  // Of scripted scenes: how many steps the script has. A configuration may ask for fewer, not for more.
  std::int64_t (*steps)(const SceneConfig& config) = nullptr;
  /// Whether anything is drawn from the seed; null: never.
  bool (*draws)(const SceneConfig& config) = nullptr;
  std::string draw_by = {};  // the key that has something drawn, and its value; empty: there is none
  /// What is known beforehand, whatever the steps of the configuration; null: nothing is.
  std::vector<Ahead> (*ahead)(const SceneConfig& config) = nullptr;
  /// Of integrated scenes: changes the initial states, after the events of step 0, to such as there are when all of
  /// `ahead` has happened; `pressed`: to where bodies are as near each other as they ever come. A guess, of which only
  /// times are foretold. Null: they are like the first.
  void (*hurry)(const SceneConfig& config, std::vector<BodyState>& states, bool pressed) = nullptr;
  /// Reads the files that the scene names and puts what follows from them into `config`, but not what they hold: `make`
  /// reads them again, and refuses those that were changed since. Null: it names none.
  void (*complete)(SceneConfig& config) = nullptr;
  /// The bodies that files made, as read then. Null: there are none.
  std::vector<BodyFacts> (*facts)(const SceneConfig& config) = nullptr;
};

const std::vector<SceneKind>& scene_kinds();

/// The scene of a configuration.
Scene make_scene(const SceneConfig& config);

/// What a run of the configuration's steps leaves out of its scene, as one line; empty: nothing that is known, or no
/// scene.
std::string left_out(const SceneConfig& config);

/// The state of a body that is not born yet: NaN throughout.
BodyState unborn_state();
bool is_born(const BodyState& state);

/// The pose of a state: its quaternion normalised by the rule of the truth; geometry::unborn() of an unborn one.
geometry::Pose pose_of(const BodyState& state);

// Limits that the kinds share.
constexpr std::int64_t kMostSegments = 1024;   // 4 million triangles per sphere
constexpr std::int64_t kMostBodies = 1000000;  // of a scene: 5e11 pairs per step
constexpr double kMostLength = 1e6;            // m: beyond, a double's last digit is no longer below a nanometre
constexpr double kLeastLength = 1e-6;          // m
constexpr Range kLength{.least = kLeastLength, .most = kMostLength};
constexpr Range kCoordinate{.least = -kMostLength, .most = kMostLength};
constexpr Range kDensity{.least = 1e-6, .most = 1e6};  // kg/m^3

/// A solid sphere's physical side. The contact radius only says where it is touched: mass and inertia are those of the
/// nominal sphere.
RigidBody solid_sphere(const geometry::Mesh& mesh, double density, ContactRadius contact_radius);

/// What is wrong when containment counts and every mesh is open; `mesh` and `solid` are those of the first.
std::string all_open_text(const std::string& mesh, const geometry::Solid& solid);

}  // namespace pipeline
