// Files of many meshes: glTF, GLB, DAE, 3MF and whatever else assimp reads. A file is a tree of nodes, each with a
// place in its parent and meshes of its own; the transforms are joined here, in doubles. Facets keep their order: nodes
// in the order of the file, a parent before its children, polygons as the importer gives them.
//
// assimp is a peer: a build without it refuses such files and says so. It keeps coordinates and transforms in single
// precision, whatever the file has, and undoes no index: where it gives every facet corners of its own, as of DAE, they
// stay so. Lengths are metres, as in glTF; a unit that a DAE names is applied by assimp. Nothing is turned: which axis
// a file calls up changes nothing.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/mesh.hpp"
#include "geometry/meshes/mesh_file.hpp"

namespace geometry {

/// The bytes of a file that another names, by that name; throws std::exception when there are none.
using ReadBeside = std::function<std::string(const std::string& name)>;

/// A mesh as such a file has it.
struct Piece {
  std::vector<Vec3> vertices;
  std::vector<std::vector<std::uint32_t>> polygons;
};

struct Node {
  std::string name;
  std::size_t above = 0, below = 0;  // its parent, and how many nodes that follow are under it
  Eigen::Matrix4d to_file = Eigen::Matrix4d::Identity();
  std::vector<std::size_t> pieces;
};

struct NodeFile {
  std::string file;  // for messages
  std::vector<Node> nodes;
  std::vector<Piece> pieces;
  std::string said;  // one line; empty: there is nothing to say
};

/// A node as a body: its mesh in its own frame, scales applied, and where it stands in the file.
struct NodeBody {
  Mesh mesh;
  Pose pose;
};

/// Whether a file of that name is of nodes, by its extension. True for everything that no reader of mesh_file.hpp has.
bool is_node_file(const std::string& file);

/// Throws MeshFileError for what cannot be read, "file: ..." or "file: node 'arm': ...".
NodeFile parse_nodes(std::string_view bytes, const std::string& file, const ReadBeside& beside);

/// All of it as one mesh, in the frame of the file.
Mesh whole_mesh(const NodeFile& file, const std::string& name, std::string* said = nullptr);

/// One node, `deep` with all that is under it. Throws MeshFileError when it has no triangle, or is mirrored or sheared.
NodeBody node_body(const NodeFile& file, std::size_t node, bool deep, const std::string& name,
                   std::string* said = nullptr);

/// The node of that name; throws MeshFileError, also where two have it.
std::size_t node_named(const NodeFile& file, const std::string& name);

}  // namespace geometry
