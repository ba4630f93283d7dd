// Files that a scene's keys name.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "geometry/decision/contain.hpp"
#include "geometry/mesh.hpp"
#include "pipeline/scene/document.hpp"
#include "pipeline/scene/node_input.hpp"
#include "pipeline/scene/scene_config.hpp"

namespace pipeline {

/// Where a key stands and what it is called, for messages.
std::string place_of(const Section& section, const char* key);

/// An input file: its path, relative to the configuration, and its bytes.
struct Input {
  std::string path, bytes;
};

/// Reads a file and keeps its hash. Throws FileFailure.
Input read_input(SceneConfig& config, const std::string& written);

/// The same of the file that the key at `place` names. Throws Error(kInput).
Input read_input(SceneConfig& config, const std::string& written, const std::string& place);

/// Throws Error(kInput) when a file that `now` has read again differs from what `before` read.
void refuse_changed(const SceneConfig& before, const SceneConfig& now);

/// A mesh file as a configuration asks for it.
struct MeshFile {
  std::string file, place;               // as written; of the key, for messages
  std::string node = {};                 // of a file of nodes; empty: all of it
  std::array<double, 3> scale{1, 1, 1};  // metres a unit of the file, along its axes
  char up = 'y';                         // the file's axis that becomes y
};

struct MeshInput {
  geometry::Mesh mesh;
  std::string path;                    // relative to the configuration
  std::optional<geometry::Pose> pose;  // of a node: where it stands in the file
};

/// A name of others with what no label may have as '_'.
std::string label_of(std::string name);

/// The mesh in such a file; notes what was left out or guessed. Throws Error(kInput).
MeshInput read_mesh(SceneConfig& config, const MeshFile& file, const std::string& name, NodeFiles& known);

/// Every node of the file that has a mesh, named `prefix` and its name. Throws Error(kInput), also where two get one.
std::vector<MeshInput> read_parts(SceneConfig& config, const MeshFile& file, const std::string& prefix,
                                  NodeFiles& known);

/// Notes what should be said of a mesh that others made.
void note_flaws(const geometry::Mesh& mesh, const geometry::Solid& solid, const std::string& file, SceneConfig& config);

}  // namespace pipeline
