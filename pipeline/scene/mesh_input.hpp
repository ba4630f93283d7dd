// Files that a scene's keys name.
#pragma once
#include <string>

#include "geometry/decision/contain.hpp"
#include "geometry/mesh.hpp"
#include "pipeline/scene/document.hpp"
#include "pipeline/scene/scene_config.hpp"

namespace pipeline {

/// Where a key stands and what it is called, for messages.
std::string place_of(const Section& section, const char* key);

/// An input file: its path, relative to the configuration, and its bytes.
struct Input {
  std::string path, bytes;
};

/// Reads the file that the key at `place` names and keeps its hash. Throws Error(kInput).
Input read_input(SceneConfig& config, const std::string& written, const std::string& place);

/// Throws Error(kInput) when a file that `now` has read again differs from what `before` read.
void refuse_changed(const SceneConfig& before, const SceneConfig& now);

struct MeshInput {
  geometry::Mesh mesh;
  std::string path;  // relative to the configuration
};

/// The mesh in such a file; notes what was left out or guessed. Throws Error(kInput).
MeshInput read_mesh(SceneConfig& config, const std::string& written, const std::string& place, const std::string& name);

/// Notes what should be said of a mesh that others made.
void note_flaws(const geometry::Mesh& mesh, const geometry::Solid& solid, const std::string& file, SceneConfig& config);

}  // namespace pipeline
