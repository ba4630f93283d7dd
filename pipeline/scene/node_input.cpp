#include "pipeline/scene/node_input.hpp"

#include <cstring>
#include <set>

#include "pipeline/scene/mesh_input.hpp"
#include "pipeline/system/child.hpp"
#include "pipeline/terminal/error.hpp"

namespace pipeline {
namespace {

// A sound file takes a second or so a megabyte; on some broken ones the importer never ends.
ChildLimits limits_of(std::size_t bytes) {
  const double seconds = 10 + double(bytes) * 1e-5;
  return {.processor_seconds = seconds, .wall_seconds = 60 + 20 * seconds};
}

// ---- From one process to the other: plain values one behind another. Both are this program.

struct Writer {
  std::string bytes;

  template <class T>
  void value(const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void text(const std::string& text) {
    value(text.size());
    bytes += text;
  }
  template <class T>
  void list(const std::vector<T>& list) {
    value(list.size());
    bytes.append(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(T));
  }
};

struct Taker {
  std::string_view rest;

  template <class T>
  T value() {
    T value;
    std::memcpy(static_cast<void*>(&value), take(sizeof value).data(), sizeof value);
    return value;
  }
  std::string text() { return std::string(take(value<std::size_t>())); }
  template <class T>
  std::vector<T> list() {
    std::vector<T> out(value<std::size_t>());
    const std::string_view bytes = take(out.size() * sizeof(T));
    if (!bytes.empty()) std::memcpy(static_cast<void*>(out.data()), bytes.data(), bytes.size());
    return out;
  }
  std::string_view take(std::size_t size) {
    const std::string_view out = rest.substr(0, size);
    rest.remove_prefix(size);
    return out;
  }
};

void put(const geometry::NodeFile& file, Writer& out) {
  out.text(file.said);
  out.value(file.nodes.size());
  for (const geometry::Node& node : file.nodes) {
    out.text(node.name);
    out.value(node.above);
    out.value(node.below);
    out.value(node.to_file);
    out.list(node.pieces);
  }
  out.value(file.pieces.size());
  for (const geometry::Piece& piece : file.pieces) {
    out.list(piece.vertices);
    out.value(piece.polygons.size());
    for (const auto& polygon : piece.polygons) out.list(polygon);
  }
}

geometry::NodeFile take(Taker& in, const std::string& path) {
  geometry::NodeFile out{.file = path, .nodes = {}, .pieces = {}, .said = in.text()};
  out.nodes.resize(in.value<std::size_t>());
  for (geometry::Node& node : out.nodes) {
    node.name = in.text();
    node.above = in.value<std::size_t>();
    node.below = in.value<std::size_t>();
    node.to_file = in.value<Eigen::Matrix4d>();
    node.pieces = in.list<std::size_t>();
  }
  out.pieces.resize(in.value<std::size_t>());
  for (geometry::Piece& piece : out.pieces) {
    piece.vertices = in.list<geometry::Vec3>();
    piece.polygons.resize(in.value<std::size_t>());
    for (auto& polygon : piece.polygons) polygon = in.list<std::uint32_t>();
  }
  return out;
}

}  // namespace

const geometry::NodeFile& read_nodes(SceneConfig& config, const std::string& file, const std::string& place,
                                     NodeFiles& known) {
  if (const auto found = known.find(file); found != known.end()) return found->second;
  const Input input = read_input(config, file, place);
  const auto path_of = [&](const std::string& name) {
    return (std::filesystem::path(file).parent_path() / name).lexically_normal().string();
  };
  // What is wrong with the file, or that nothing is; the files beside it that were read; the nodes.
  const auto work = [&](std::size_t) {
    Writer out;
    std::set<std::string> beside;
    try {
      const geometry::NodeFile nodes = geometry::parse_nodes(input.bytes, input.path, [&](const std::string& name) {
        std::string bytes = read_input(config, path_of(name)).bytes;
        beside.insert(name);
        return bytes;
      });
      out.text("");
      out.value(beside.size());
      for (const std::string& name : beside) out.text(name);
      put(nodes, out);
    } catch (const geometry::MeshFileError& error) {
      out = {};
      out.text(error.what());
    }
    return out.bytes;
  };
  std::string flaw;
  in_children(1, 1, limits_of(input.bytes.size()), work,
              [&](std::size_t, const std::string& bytes, const std::string& failure) {
                if (!failure.empty()) {
                  flaw = input.path + ": assimp cannot read it and " + failure;
                  return;
                }
                Taker in{bytes};
                flaw = in.text();
                if (!flaw.empty()) return;
                for (std::size_t count = in.value<std::size_t>(); count > 0; --count)
                  read_input(config, path_of(in.text()), place);  // inputs of ours too
                known.emplace(file, take(in, input.path));
              });
  if (!flaw.empty()) throw Error(kInput, flaw);
  if (const std::string& said = known.at(file).said; !said.empty()) config.notes.push_back(said);
  return known.at(file);
}

}  // namespace pipeline
