// What a configuration says of a scene: the keys of its kind, and what a kind may read and set of the rest.
#pragma once
#include <any>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "geometry/bodies.hpp"
#include "pipeline/physics/simulate.hpp"
#include "pipeline/result/result.hpp"

namespace pipeline {

/// The physical radius of a contact sphere: the shape's, or that of the greatest ball inside its mesh.
enum class ContactRadius { nominal, inscribed };

struct SceneKind;  // pipeline/scene/scene.hpp

constexpr std::int64_t kSeed = 1;                     // of a configuration that names none
constexpr double kLeastRate = 1e-6, kMostRate = 1e6;  // samples per second

/// The part of a configuration that a scene is made of. A kind of scene sees this and nothing else of it.
struct SceneConfig {
  std::filesystem::path path;  // of the configuration, as given
  std::int64_t seed = kSeed;
  std::string seed_place;                 // where it was written; empty: it was not
  std::int64_t steps = 600;               // samples, step 0 included
  double rate = 60;                       // samples per second
  const SceneKind* scene_kind = nullptr;  // a row of scene_kinds(); null: there is no scene
  std::any scene;                         // its keys and what follows from them, a struct of that kind's own
  Physics physics;                        // only when integrated
  ContactRadius contact_radius = ContactRadius::inscribed;
  Containment containment = Containment::ignore;
  double closed_within = geometry::kClosedWithin;  // of a mesh's size, as in Bodies

  // Of scenes that name files:
  std::string steps_place;  // where steps was written; empty: it was not
  bool rate_given = false;
  std::map<std::string, std::string> inputs;  // every file read, as written -> its SHA-256
  std::vector<std::string> notes;             // what should be said of them, one line each
  std::vector<std::string> understood;        // how they were read where it could have been otherwise, one line each

  template <class Keys>
  const Keys& keys() const {
    return std::any_cast<const Keys&>(scene);
  }
};

}  // namespace pipeline
