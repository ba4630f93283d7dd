// Files of nodes, read in a child process: on what others break, their importer aborts, crashes or goes round for ever,
// and that ends the child alone.
#pragma once
#include <map>
#include <string>

#include "geometry/meshes/nodes.hpp"
#include "pipeline/scene/scene_config.hpp"

namespace pipeline {

/// Files of nodes that were read already, by their names as written.
using NodeFiles = std::map<std::string, geometry::NodeFile>;

/// The file of nodes of that name, and those beside it that it names, once. `place` is of the key, for messages. Throws
/// Error(kInput). To be called while this process has one thread.
const geometry::NodeFile& read_nodes(SceneConfig& config, const std::string& file, const std::string& place,
                                     NodeFiles& known);

}  // namespace pipeline
