#include "pipeline/scene/mesh_input.hpp"

#include <fcntl.h>

#include "geometry/decision/shells.hpp"
#include "geometry/meshes/mesh_file.hpp"
#include "pipeline/result/provenance.hpp"
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

std::string place_of(const Section& s, const char* key) { return s.place(key) + ": '" + s.full(key) + "'"; }

Input read_input(SceneConfig& config, const std::string& written, const std::string& place) {
  const std::filesystem::path path = config.path.parent_path() / written;
  Input input{.path = one_line(path.string(), 4096), .bytes = {}};
  try {
    input.bytes = read_regular(AT_FDCWD, path, /*follow_links=*/true, machine_memory() / 2);
  } catch (const FileFailure& failure) {
    throw Error(kInput, place + " must name a file that can be read, not " + in_quotes(one_line(written)) + ": " +
                            input.path + ": " + failure.what());
  }
  config.inputs[written] = sha256(input.bytes);
  return input;
}

void refuse_changed(const SceneConfig& before, const SceneConfig& now) {
  for (const auto& [file, hash] : before.inputs)
    if (now.inputs.at(file) != hash)
      throw Error(kInput, one_line((before.path.parent_path() / file).string(), 4096) +
                              ": was changed since the configuration was read; run again");
}

MeshInput read_mesh(SceneConfig& config, const std::string& written, const std::string& place,
                    const std::string& name) {
  const Input input = read_input(config, written, place);
  std::string said;
  try {
    MeshInput out{.mesh = geometry::parse_mesh(input.bytes, input.path, name, &said), .path = input.path};
    if (!said.empty()) config.notes.push_back(said);
    out.mesh.shape = "{\"file\": " + in_quotes(one_line(written, 4096)) + "}";
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
