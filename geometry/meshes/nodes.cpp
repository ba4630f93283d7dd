#include "geometry/meshes/nodes.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <charconv>
#include <cstring>
#include <optional>

#include "geometry/meshes/mesh_reading.hpp"
#include "geometry/meshes/soundness.hpp"

#ifdef ASSIMP_VERSION
#include <assimp/config.h>
#include <assimp/scene.h>

#include <assimp/DefaultLogger.hpp>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/LogStream.hpp>
#endif

namespace geometry {
namespace {

using mesh_reading::Builder;

// Of the angle between the axes of a node: below, single precision explains it.
constexpr double kSheared = 1e-5;

std::string extension_of(const std::string& file) {
  const std::size_t dot = file.find_last_of("./");
  return dot == std::string::npos || file[dot] == '/' ? "" : file.substr(dot + 1);
}

struct AtNode {
  const Node& node;
  std::string place() const { return ": node " + mesh_reading::quoted(node.name); }
};

/// Refuses a transform that no solid body can have.
void refuse_no_body(const Eigen::Matrix4d& m, const AtNode& at, const Builder& out) {
  if (!m.allFinite()) out.fail(at.place(), "its place is not finite");
  const Mat3 turn = m.topLeftCorner<3, 3>();
  const double size = turn.colwise().norm().prod(), volume = turn.determinant();
  if (volume < -1e-12 * size)
    out.fail(at.place(), "is mirrored (a scale is negative); apply the transform in the program that made it");
  if (!(volume > 1e-12 * size)) out.fail(at.place(), "is flat (a scale is 0)");
}

/// Appends the pieces of a node, moved.
void append(const NodeFile& file, const Node& node, const Eigen::Matrix4d& m, Builder& out) {
  const AtNode at{node};
  refuse_no_body(m, at, out);
  const Mat3 turn = m.topLeftCorner<3, 3>();
  for (const std::size_t p : node.pieces) {
    const Piece& piece = file.pieces[p];
    const auto base = std::uint32_t(out.mesh.vertices.size());
    for (const Vec3& v : piece.vertices) out.add_vertex(to_world(turn, m.topRightCorner<3, 1>(), v), at);
    std::vector<std::uint32_t> corners;
    for (const std::vector<std::uint32_t>& polygon : piece.polygons) {
      corners.clear();
      for (const std::uint32_t corner : polygon) {
        if (corner >= piece.vertices.size())
          out.fail(at.place(), "index " + std::to_string(corner) + " is out of range; there are " +
                                   std::to_string(piece.vertices.size()) + " vertices");
        corners.push_back(base + corner);
      }
      out.add_polygon(corners, at);
    }
  }
}

}  // namespace

bool is_node_file(const std::string& file) {
  const std::string extension = extension_of(file);
  for (const char* own : {"obj", "off", "stl", "ply"})
    if (mesh_reading::same_word(extension, own)) return false;
  return true;
}

Mesh whole_mesh(const NodeFile& file, const std::string& name, std::string* said) {
  Builder out(file.file);
  for (const Node& node : file.nodes)
    if (!node.pieces.empty()) append(file, node, node.to_file, out);
  Mesh mesh = out.finished(name);
  if (said) *said = out.said();
  return mesh;
}

NodeBody node_body(const NodeFile& file, std::size_t index, bool deep, const std::string& name, std::string* said) {
  const Node& node = file.nodes[index];
  Builder out(file.file);
  refuse_no_body(node.to_file, AtNode{node}, out);
  // Turned by what is left of its axes when their lengths, the scales, are taken out.
  Eigen::Matrix4d rigid = node.to_file;
  for (int k = 0; k < 3; ++k) rigid.col(k) /= node.to_file.col(k).head<3>().norm();
  const Mat3 turn = rigid.topLeftCorner<3, 3>();
  if ((turn.transpose() * turn - Mat3::Identity()).cwiseAbs().maxCoeff() > kSheared)
    out.fail(AtNode{node}.place(),
             "is sheared by the scales of the nodes above it; apply the transforms in the program that made it");
  Eigen::Matrix4d scale = Eigen::Matrix4d::Identity();
  for (int k = 0; k < 3; ++k) scale(k, k) = node.to_file.col(k).head<3>().norm();
  // What is under it is placed as it is beside it.
  const Eigen::Matrix4d back = scale * node.to_file.inverse();
  for (std::size_t i = index; i <= index + (deep ? node.below : 0); ++i)
    if (const Node& part = file.nodes[i]; !part.pieces.empty())
      append(file, part, i == index ? scale : Eigen::Matrix4d(back * part.to_file), out);
  NodeBody body;
  try {
    body.mesh = out.finished(name);
  } catch (const MeshFileError&) {
    out.fail(AtNode{node}.place(), "has no triangle; a body needs a surface");
  }
  const Eigen::Quaterniond q(turn);
  body.pose = {normalised({q.w(), q.x(), q.y(), q.z()}), node.to_file.topRightCorner<3, 1>()};
  if (said) *said = out.said();
  return body;
}

std::size_t node_named(const NodeFile& file, const std::string& name) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < file.nodes.size(); ++i)
    if (file.nodes[i].name == name) {
      if (found)
        throw MeshFileError(file.file + ": two nodes are named " + mesh_reading::quoted(name) + "; rename one");
      found = i;
    }
  if (found) return *found;
  std::string list;
  for (const Node& node : file.nodes)
    if (!node.pieces.empty() && list.size() < 200) list += (list.empty() ? "" : ", ") + mesh_reading::quoted(node.name);
  throw MeshFileError(file.file + ": has no node " + mesh_reading::quoted(name) + "; with meshes there are " +
                      (list.empty() ? "none" : list));
}

#ifdef ASSIMP_VERSION

namespace {

/// The file and those beside it as assimp wants to see them: from memory.
class Memory : public Assimp::IOStream {
 public:
  explicit Memory(std::string_view bytes) : bytes_(bytes) {}
  Memory(std::string bytes, int) : own_(std::move(bytes)), bytes_(own_) {}

  size_t Read(void* to, size_t size, size_t count) override {
    if (size == 0) return 0;
    const std::size_t whole = std::min(count, (bytes_.size() - at_) / size);
    std::memcpy(to, bytes_.data() + at_, whole * size);
    at_ += whole * size;
    return whole;
  }
  size_t Write(const void*, size_t, size_t) override { return 0; }
  aiReturn Seek(size_t offset, aiOrigin origin) override {
    const std::size_t base = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? at_ : bytes_.size();
    const std::size_t to = origin == aiOrigin_END ? base - offset : base + offset;
    if (to > bytes_.size()) return aiReturn_FAILURE;
    at_ = to;
    return aiReturn_SUCCESS;
  }
  size_t Tell() const override { return at_; }
  size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  std::string own_;
  std::string_view bytes_;
  std::size_t at_ = 0;
};

class Files : public Assimp::IOSystem {
 public:
  Files(std::string name, std::string_view bytes, const ReadBeside& beside)
      : name_(std::move(name)), bytes_(bytes), beside_(beside) {}

  mutable std::vector<std::pair<std::string, std::string>> missing;  // a name, and why it cannot be read

  bool Exists(const char* name) const override { return name == name_ || read(name).has_value(); }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (std::strchr(mode, 'w')) return nullptr;
    if (name == name_) return new Memory(bytes_);
    std::optional<std::string> bytes = read(name);
    return bytes ? new Memory(std::move(*bytes), 0) : nullptr;
  }
  void Close(Assimp::IOStream* file) override { delete file; }

 private:
  /// assimp tries a name in several ways, one of them below the root: that is nowhere near the file.
  std::optional<std::string> read(std::string name) const {
    if (name.starts_with("./")) name.erase(0, 2);
    if (name.starts_with('/')) return std::nullopt;
    std::string why;
    for (const std::string& meant : {name, decoded(name)}) {
      try {
        return beside_(meant);
      } catch (const std::exception& error) {
        if (why.empty()) why = error.what();
      }
      if (meant.find('%') == meant.npos) break;
    }
    const std::pair failure{name, why};
    if (std::ranges::find(missing, failure) == missing.end()) missing.push_back(failure);
    return std::nullopt;
  }

  /// "%20" is a blank where a name is a URI.
  static std::string decoded(const std::string& name) {
    std::string out;
    for (std::size_t i = 0; i < name.size(); ++i) {
      unsigned char value = 0;
      const char* first = name.data() + i + 1;
      const bool code =
          name[i] == '%' && i + 2 < name.size() && std::from_chars(first, first + 2, value, 16).ptr == first + 2;
      out += code ? char(value) : name[i];
      if (code) i += 2;
    }
    return out;
  }

  std::string name_;
  std::string_view bytes_;
  const ReadBeside& beside_;
};

/// The warnings and errors of assimp, which tells them a logger of the whole process alone.
class Complaints {
 public:
  Complaints() {
    Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
    Assimp::DefaultLogger::get()->attachStream(stream_, Assimp::Logger::Warn | Assimp::Logger::Err);
  }
  ~Complaints() { Assimp::DefaultLogger::kill(); }  // with the stream
  Complaints(const Complaints&) = delete;
  Complaints& operator=(const Complaints&) = delete;

  const std::vector<std::string>& lines() const { return stream_->lines; }

 private:
  struct Stream : Assimp::LogStream {
    std::vector<std::string> lines;
    void write(const char* message) override {
      std::string_view text = message;
      if (const std::size_t colon = text.find(": "); colon != text.npos)
        text.remove_prefix(colon + 2);  // "Warn,  T0: "
      while (!text.empty() && text.back() <= ' ') text.remove_suffix(1);
      lines.emplace_back(text);
    }
  };
  Stream* stream_ = new Stream;
};

Eigen::Matrix4d matrix_of(const aiMatrix4x4& m) {
  Eigen::Matrix4d out;
  for (unsigned r = 0; r < 4; ++r)
    for (unsigned c = 0; c < 4; ++c) out(int(r), int(c)) = double(m[r][c]);
  return out;
}

void add_node(const aiNode& from, std::size_t above, const Eigen::Matrix4d& to_file, const std::string& file,
              NodeFile& out, int depth) {
  // Nobody nests so deep; a stack ends somewhere.
  if (depth > 1000) throw MeshFileError(file + ": nodes are more than 1000 deep within each other");
  const std::size_t at = out.nodes.size();
  out.nodes.push_back({from.mName.C_Str(), above, 0, to_file * matrix_of(from.mTransformation), {}});
  for (unsigned i = 0; i < from.mNumMeshes; ++i) out.nodes[at].pieces.push_back(from.mMeshes[i]);
  for (unsigned i = 0; i < from.mNumChildren; ++i)
    add_node(*from.mChildren[i], at, out.nodes[at].to_file, file, out, depth + 1);
  out.nodes[at].below = out.nodes.size() - 1 - at;
}

Piece piece_of(const aiMesh& from) {
  Piece out;
  out.vertices.reserve(from.mNumVertices);
  for (unsigned i = 0; i < from.mNumVertices; ++i) {
    const aiVector3D& v = from.mVertices[i];
    out.vertices.emplace_back(v.x, v.y, v.z);
  }
  out.polygons.reserve(from.mNumFaces);
  for (unsigned i = 0; i < from.mNumFaces; ++i)
    out.polygons.emplace_back(from.mFaces[i].mIndices, from.mFaces[i].mIndices + from.mFaces[i].mNumIndices);
  return out;
}

/// Of what nothing here needs, or of files that assimp reads all the same.
bool is_noise(const std::string& line) {
  for (const char* of : {"material", "Material", "texture", "Texture", "Ignored file of unknown type: 3D/"})
    if (line.find(of) != line.npos) return true;
  return false;
}

}  // namespace

NodeFile parse_nodes(std::string_view bytes, const std::string& file, const ReadBeside& beside) {
  Assimp::Importer importer;
  const std::string extension = extension_of(file);
  if (extension.empty() || !importer.IsExtensionSupported("." + extension))
    throw MeshFileError(file +
                        ": is no kind of mesh file that is read; name a file .obj, .off, .stl or .ply, or .glb, "
                        ".gltf, .dae, .3mf or another that assimp reads");
  refuse_unsound(bytes, file, extension);
  const std::string name = "file." + extension;
  Files* files = new Files(name, bytes, beside);
  importer.SetIOHandler(files);  // which it deletes
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);  // bodies that nobody has made
  const Complaints complaints;
  const aiScene* scene = importer.ReadFile(name, 0);
  if (!scene || !scene->mRootNode) {
    std::string why = importer.GetErrorString();
    if (why.starts_with("No suitable reader"))
      why = "is damaged, or not what its name says: assimp finds no reader for it";
    if (const std::size_t at = why.find(name); at != why.npos) why.replace(at, name.size(), "it");
    for (const auto& [missing, error] : files->missing)
      if (why.empty() || why.find(missing) != why.npos) {
        why = mesh_reading::quoted(missing) + " " + error;
        break;
      }
    for (char& c : why)
      if (c >= 0 && c < ' ') c = ' ';
    throw MeshFileError(file + ": " + (why.empty() ? "cannot be read" : why));
  }
  NodeFile out{.file = file, .nodes = {}, .pieces = {}, .said = {}};
  for (unsigned i = 0; i < scene->mNumMeshes; ++i) out.pieces.push_back(piece_of(*scene->mMeshes[i]));
  add_node(*scene->mRootNode, 0, Eigen::Matrix4d::Identity(), file, out, 0);
  for (const Node& node : out.nodes)
    for (const std::size_t piece : node.pieces)
      if (piece >= out.pieces.size())
        throw MeshFileError(file + ": node " + mesh_reading::quoted(node.name) + " has no mesh");
  // What assimp leaves out it only says: corners that are not there, for one.
  std::vector<std::string> lines = complaints.lines();
  std::erase_if(lines, is_noise);
  for (const char* flaw : {"out of range", "out-of-range", "invalid ind", "vertices were dropped"})
    for (const std::string& line : lines)
      if (line.find(flaw) != line.npos) throw MeshFileError(file + ": assimp says: " + line);
  out.said = file + ": read by assimp " ASSIMP_VERSION " in single precision";
  if (!lines.empty())
    out.said += "; it says: " + lines.front() +
                (lines.size() > 1 ? " (and " + std::to_string(lines.size() - 1) + " more)" : "");
  for (const auto& [missing, error] : files->missing) out.said += "; done without " + mesh_reading::quoted(missing);
  bool moves = false;
  for (unsigned i = 0; i < scene->mNumMeshes; ++i)
    moves |= scene->mMeshes[i]->mNumBones > 0 || scene->mMeshes[i]->mNumAnimMeshes > 0;
  if (moves) out.said += "; bones and shape keys are not applied";
  return out;
}

#else

NodeFile parse_nodes(std::string_view, const std::string& file, const ReadBeside&) {
  throw MeshFileError(file +
                      ": only .obj, .off, .stl and .ply are read by this build, which is without assimp; "
                      "scripts/peers meshes installs it");
}

#endif

}  // namespace geometry
