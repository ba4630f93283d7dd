#include "pipeline/scene/mesh_input.hpp"

#include <fcntl.h>

#include "geometry/decision/shells.hpp"
#include "geometry/meshes/mesh_file.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/scene/csv.hpp"
#include "pipeline/system/file_bytes.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

/// How many, with the noun in the number it needs.
std::string counted(std::size_t n, const std::string& one, const std::string& many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

/// Says what the parity rule makes hollow.
void note_hollows(const geometry::Mesh& mesh, const geometry::Solid& solid, const std::string& file,
                  SceneConfig& config) {
  const geometry::Shells found = geometry::shells_of(mesh, solid);
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (found.repeated_facets > 0)
    add(counted(found.repeated_facets, "facet stands", "facets stand") + " where another stands already");
  if (found.meeting > 0)
    add(std::to_string(found.meeting) + " of its " + std::to_string(found.shells) + " shells touch or cross another");
  if (found.nested_alike > 0)
    add(counted(found.nested_alike, "shell lies", "shells lie") + " inside another that faces the same way");
  if (!text.empty()) config.notes.push_back(file + ": " + text + "; what lies in two shells counts as outside");
}

}  // namespace

std::string label_of(std::string name) {
  for (char& c : name)
    if (!valid_label(std::string(1, c)) && c != '.') c = '_';
  return name;
}

std::string place_of(const Section& s, const char* key) { return s.place(key) + ": '" + s.full(key) + "'"; }

Input read_input(SceneConfig& config, const std::string& written) {
  const std::filesystem::path path = config.path.parent_path() / written;
  Input input{.path = one_line(path.string(), 4096), .bytes = {}};
  input.bytes = read_regular(AT_FDCWD, path, /*follow_links=*/true, machine_memory() / 2);
  config.inputs[written] = sha256(input.bytes);
  return input;
}

Input read_input(SceneConfig& config, const std::string& written, const std::string& place) {
  try {
    return read_input(config, written);
  } catch (const FileFailure& failure) {
    throw Error(kInput, place + " must name a file that can be read, not " + in_quotes(one_line(written)) + ": " +
                            one_line((config.path.parent_path() / written).string(), 4096) + ": " + failure.what());
  }
}

void refuse_changed(const SceneConfig& before, const SceneConfig& now) {
  for (const auto& [file, hash] : before.inputs)
    if (now.inputs.at(file) != hash)
      throw Error(kInput, one_line((before.path.parent_path() / file).string(), 4096) +
                              ": was changed since the configuration was read; run again");
}

namespace {

void note(SceneConfig& config, const std::string& said) {
  if (!said.empty()) config.notes.push_back(said);
}

/// Turned so that `up` is y: exactly, by exchanging coordinates.
geometry::Vec3 turned(const geometry::Vec3& v, char up) {
  if (up == 'z') return {v.x(), v.z(), -v.y()};
  if (up == 'x') return {-v.y(), v.x(), v.z()};
  return v;
}

/// Scale and axis of the configuration, and what the file is, as JSON.
void finish(MeshInput& input, const MeshFile& file, const std::string& node) {
  const auto& s = file.scale;
  const bool scaled = s != std::array<double, 3>{1, 1, 1}, even = s[0] == s[1] && s[1] == s[2];
  if (scaled || file.up != 'y')
    for (geometry::Vec3& v : input.mesh.vertices) v = turned({s[0] * v.x(), s[1] * v.y(), s[2] * v.z()}, file.up);
  if (input.pose) {
    input.pose->t = s[0] * turned(input.pose->t, file.up);
    geometry::Quaternion& q = input.pose->q;
    const geometry::Vec3 axis = turned({q.x, q.y, q.z}, file.up);
    q = {q.w, axis.x(), axis.y(), axis.z()};
  }
  std::string& shape = input.mesh.shape;
  shape = "{\"file\": " + in_quotes(one_line(file.file, 4096));
  if (!node.empty()) shape += ", \"node\": " + in_quotes(one_line(node, 4096));
  if (scaled && even) shape += ", \"scale\": " + real_text(s[0]);
  if (scaled && !even)
    shape += ", \"scale\": [" + real_text(s[0]) + ", " + real_text(s[1]) + ", " + real_text(s[2]) + "]";
  if (file.up != 'y') shape += std::string(", \"up\": \"") + file.up + "\"";
  if (geometry::is_node_file(file.file)) shape += ", \"precision\": \"single\"";
  shape += "}";
}

MeshInput node_input(SceneConfig& config, const geometry::NodeFile& nodes, std::size_t node, bool deep,
                     const std::string& name) {
  std::string said;
  geometry::NodeBody body = geometry::node_body(nodes, node, deep, name, &said);
  note(config, said);
  return {
      .mesh = std::move(body.mesh), .path = nodes.file + ", node '" + nodes.nodes[node].name + "'", .pose = body.pose};
}

}  // namespace

MeshInput read_mesh(SceneConfig& config, const MeshFile& file, const std::string& name, NodeFiles& known) {
  try {
    MeshInput out;
    std::string said;
    if (geometry::is_node_file(file.file)) {
      const geometry::NodeFile& nodes = read_nodes(config, file.file, file.place, known);
      if (file.node.empty())
        out = {.mesh = geometry::whole_mesh(nodes, name, &said), .path = nodes.file, .pose = {}};
      else
        out = node_input(config, nodes, geometry::node_named(nodes, file.node), true, name);
    } else {
      const Input input = read_input(config, file.file, file.place);
      out = {.mesh = geometry::parse_mesh(input.bytes, input.path, name, &said), .path = input.path, .pose = {}};
    }
    note(config, said);
    finish(out, file, file.node);
    return out;
  } catch (const geometry::MeshFileError& error) {
    throw Error(kInput, error.what());
  }
}

std::vector<MeshInput> read_parts(SceneConfig& config, const MeshFile& file, const std::string& prefix,
                                  NodeFiles& known) {
  try {
    const geometry::NodeFile& nodes = read_nodes(config, file.file, file.place, known);
    std::map<std::string, std::string> taken;  // the node, by the name of its body
    std::vector<MeshInput> out;
    for (std::size_t i = 0; i < nodes.nodes.size(); ++i) {
      const std::string& node = nodes.nodes[i].name;
      if (nodes.nodes[i].pieces.empty()) continue;
      const std::string name = prefix + label_of(node);
      const auto [at, fresh] = taken.emplace(name, node);
      if (!fresh)
        throw Error(kInput, nodes.file + ": " +
                                (at->second == node
                                     ? "two nodes are named " + pipeline::quoted(node)
                                     : "nodes " + pipeline::quoted(at->second) + " and " + pipeline::quoted(node) +
                                           " both become body " + pipeline::quoted(name)) +
                                "; rename one");
      if (!valid_label(name))
        throw Error(kInput, nodes.file + ": body " + pipeline::quoted(name) + ", of a node, must " + kLabelRule);
      if (name != prefix + node)
        config.understood.push_back(nodes.file + ": node " + pipeline::quoted(node) + " is body " +
                                    pipeline::quoted(name));
      out.push_back(node_input(config, nodes, i, false, name));
      finish(out.back(), file, node);
    }
    if (out.empty()) throw Error(kInput, nodes.file + ": has no node with a mesh");
    return out;
  } catch (const geometry::MeshFileError& error) {
    throw Error(kInput, error.what());
  }
}

void note_flaws(const geometry::Mesh& mesh, const geometry::Solid& solid, const std::string& file,
                SceneConfig& config) {
  const bool contained = config.containment != Containment::ignore;
  if (!solid.closed)
    config.notes.push_back(file + ": the surface is open, " + geometry::open_text(solid) + "; it is used as it is" +
                           (contained ? ", and nothing can be inside it" : ""));
  if (contained) note_hollows(mesh, solid, file, config);
  if (const std::size_t flat = geometry::degenerate_facets(mesh); flat > 0)
    config.notes.push_back(file + ": " + std::to_string(flat) + (flat == 1 ? " triangle has" : " triangles have") +
                           " no area; used as they are");
}

}  // namespace pipeline
