// The keys of kind = "replay".
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/scene/poses_csv.hpp"
#include "pipeline/scene/robot.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/scene/shape_keys.hpp"

namespace pipeline {

/// One body of a replayed scene.
struct ReplayBody {
  std::string name;             // of parts what stands before each node's; may be empty
  std::string mesh;             // file as written; empty: a shape
  std::string node;             // of that file; empty: all of it
  bool parts = false;           // every node of it is a body
  std::optional<double> scale;  // metres a unit of the file
  std::string up = "y";         // its axis that becomes y
  std::optional<Shape> shape;   // else the mesh
  bool fixed = false;
  std::optional<std::array<double, 3>> position;  // m; of fixed bodies, when it is not in the CSV
  std::array<double, 4> orientation{1, 0, 0, 0};  // w x y z, as written
  std::string poses;                              // of a moving body, a file of its own; empty: that of the scene
  std::string place, poses_place;                 // of mesh or shape, and of poses, for messages
};

/// kind = "replay": bodies and poses from files. Paths are relative to the configuration's folder.
struct ReplayScene {
  std::string poses, motion;      // a CSV file, or an earlier result with all its bodies; one or both are empty
  CsvRules rules;                 // of orientations in CSV
  bool half_turns = false;        // the CSV's quaternions that begin with 0 are meant so
  std::vector<std::string> only;  // empty: every pair counts
  std::vector<ReplayBody> bodies;
  std::vector<Robot> robots;
  std::string place, only_place;  // of poses or motion, and of only, for messages
  // What is known of the files once they were read (SceneKind::complete):
  std::optional<SceneSize> size;
  std::vector<Ahead> births;
  std::vector<BodyFacts> facts;
};

SceneKind replay_kind();

}  // namespace pipeline
