// What a configuration says of a scene: the keys of every kind, and what a kind may read and set of the rest.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "geometry/bodies.hpp"
#include "pipeline/physics/simulate.hpp"
#include "pipeline/result/result.hpp"
#include "pipeline/scene/shape_keys.hpp"

namespace pipeline {

/// A body of the falling scene as its configuration writes it: a built-in shape or a mesh file.
struct FallingBody {
  std::string mesh;            // file as written; empty: a shape
  std::optional<Shape> shape;  // else the mesh
  double density = 0;          // kg/m^3
  std::int64_t contact_spheres = 0;
  std::string place;  // of mesh or shape, for messages
};

/// What stands in the falling scene beside the plate, and never moves.
struct FallingObstacle {
  std::string name;
  FallingBody body;
  std::array<double, 3> position{};               // m
  std::array<double, 4> orientation{1, 0, 0, 0};  // w x y z, as written
};

/// One set of the falling scene: bodies lying on the plate and others above them.
struct FallingSet {
  std::array<std::int64_t, 2> lying{1, 1};     // counts along x and z
  std::array<std::int64_t, 3> above{1, 1, 1};  // counts along x, y and z
  std::array<double, 2> corner{0, 0};          // x and z of the first sphere, m
  double spacing = 2.1;                        // m
  double height = 5;                           // y of the lowest sphere above, m
  std::vector<FallingBody> shapes;             // that its bodies have in turn; empty: the scene's sphere
  bool turned = false;                         // those above are turned at random
};

struct FallingInputs;  // pipeline/scene/falling.cpp: the meshes of files

/// kind = "falling": a fixed plate with its top at y = 0, obstacles, and sets of spheres or other bodies.
struct FallingScene {
  std::int64_t segments = 16;              // of the sphere's mesh
  double radius = 1;                       // m
  double density = 1000;                   // kg/m^3
  std::array<double, 3> plate{60, 2, 60};  // size, m
  double shift = 0.15;                     // m, of the spheres above in x and z, or all balances on points
  double jitter = 0;                       // m, of the spheres above along each axis at most, drawn from the seed
  std::int64_t contact_spheres = 32;       // at most, of a mesh that is no sphere
  std::vector<FallingSet> sets;            // the thesis's three when the configuration names none
  std::vector<FallingObstacle> obstacles;
  std::shared_ptr<const FallingInputs> inputs;  // read_config fills it
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

struct ReplayInputs;  // pipeline/scene/replay.cpp: what the files hold

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

struct SceneKind;  // pipeline/scene/scene.hpp

constexpr std::int64_t kSeed = 1;  // of a configuration that names none

/// The part of a configuration that a scene is made of. A kind of scene sees this and nothing else of it.
struct SceneConfig {
  std::filesystem::path path;  // of the configuration, as given
  std::int64_t seed = kSeed;
  std::string seed_place;                 // where it was written; empty: it was not
  std::int64_t steps = 600;               // samples, step 0 included
  double rate = 60;                       // samples per second
  const SceneKind* scene_kind = nullptr;  // a row of scene_kinds()
  std::variant<FallingScene, BoxScene, PlaygroundScene, ReplayScene, ExtremesScene> scene;  // of that kind
  Physics physics;                                                                          // only when integrated
  ContactRadius contact_radius = ContactRadius::inscribed;
  Containment containment = Containment::ignore;
  double closed_within = geometry::kClosedWithin;  // of a mesh's size, as in Bodies

  // Of scenes that name files:
  std::string steps_place;  // where steps was written; empty: it was not
  bool rate_given = false;
  std::map<std::string, std::string> inputs;  // every file read, as written -> its SHA-256
  std::vector<std::string> notes;             // what should be said of them, one line each
};

}  // namespace pipeline
