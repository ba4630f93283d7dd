// The keys of kind = "replay" with their rules, and the way back to TOML. No file that they name is touched.
#pragma once
#include "pipeline/scene/kinds/replay.hpp"

namespace pipeline {

void read_replay(const Section& s, SceneConfig& config);
void write_replay(const SceneConfig& config, TomlText& out);

/// The keys of a body that say which mesh it has: bodies of which they are equal share one.
void write_mesh_or_shape(const ReplayBody& body, TomlText& out);

}  // namespace pipeline
