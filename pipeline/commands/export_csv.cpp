#include "pipeline/commands/export_csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>

#include "geometry/decision/hull.hpp"
#include "geometry/meshes/shapes.hpp"
#include "pipeline/commands/export_folder.hpp"
#include "pipeline/stages/proxies.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/progress.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace fs = std::filesystem;
namespace {

constexpr char kBodies[] = "bodies.csv";

template <class Number>
void put(std::string& text, Number value) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  text.append(digits.data(), end);
}

/// Names of others' files may hold commas, line ends or slashes.
void refuse_names(const Result& result) {
  const auto refuse = [](const std::string& what, const std::string& name) {
    if (!valid_label(name))
      throw Error(kFile, what + " " + in_quotes(one_line(name)) + ": cannot stand in CSV; a name must " + kLabelRule);
  };
  for (const std::string& name : result.bodies.name) refuse("body", name);
  for (const geometry::Mesh& mesh : result.bodies.meshes) refuse("mesh", mesh.name);
  if (const Proxies* proxies = result.products.find<Proxies>())
    for (const MeshProxy& row : proxies->rows) refuse("label", row.label);
}

/// The vertices and triangles of a mesh, behind `first` vertices.
std::string obj_part(const geometry::Mesh& mesh, std::uint64_t first) {
  std::string text;
  for (const geometry::Vec3& vertex : mesh.vertices) {
    text += 'v';
    for (int axis = 0; axis < 3; ++axis) {
      text += ' ';
      put(text, vertex[axis]);
    }
    text += '\n';
  }
  for (const geometry::Facet& facet : mesh.triangles) {
    text += 'f';
    for (const std::uint32_t corner : facet) {
      text += ' ';
      put(text, first + corner + 1);
    }
    text += '\n';
  }
  return text;
}

}  // namespace

std::string obj_text(const geometry::Mesh& mesh) { return obj_part(mesh, 0); }

std::string proxy_text(const MeshProxy& row) {
  std::string text;
  std::uint64_t number = 0, before = 0;  // of parts, of vertices
  const auto add = [&](const geometry::Mesh& part) {
    text += "o part_" + std::to_string(++number) + "\n" + obj_part(part, before);
    before += part.vertices.size();
  };
  std::vector<geometry::Mesh> balls;
  for (const geometry::ContactBall& ball : row.balls) {
    constexpr int kSegments = 24;
    geometry::Mesh& mesh = balls.emplace_back(geometry::sphere("ball", ball.radius, kSegments));
    for (geometry::Vec3& v : mesh.vertices) v += ball.centre;
  }
  if (row.kind == "capsule") {
    std::vector<geometry::Vec3> points = balls[0].vertices;
    points.insert(points.end(), balls[1].vertices.begin(), balls[1].vertices.end());
    geometry::Hull hull = geometry::convex_hull(points);
    geometry::Mesh mesh;
    for (const std::uint32_t i : hull.corners) mesh.vertices.push_back(points[i]);
    mesh.triangles = std::move(hull.triangles);
    balls = {std::move(mesh)};
  }
  for (const geometry::Mesh& mesh : row.kind == "solids" ? solids_of(row) : balls) add(mesh);
  return text;
}

std::string bodies_text(const Result& result) {
  const geometry::Bodies& bodies = result.bodies;
  std::string text = "number,body,mesh,fixed,chosen,first_step\n";
  for (std::uint32_t b = 0; b < bodies.size(); ++b) {
    put(text, b);
    text += "," + bodies.name[b] + "," + bodies.mesh_of(b).name;
    text += bodies.fixed[b] ? ",1" : ",0";
    text += bodies.chosen.empty() || bodies.chosen[b] ? ",1," : ",0,";
    put(text, result.first_step[b]);
    text += '\n';
  }
  return text;
}

std::string poses_text(const Result& result) {
  std::string text = "step,body,px,py,pz,qw,qx,qy,qz\n";
  for (std::size_t step = 0; step < result.steps(); ++step) {
    stop_if_wanted();
    for (std::uint32_t b = 0; b < result.bodies.size(); ++b) {
      const geometry::Pose& pose = result.motion[step][b];
      if (!geometry::is_born(pose) || (result.bodies.fixed[b] && step > 0)) continue;
      put(text, step);
      text += ',' + result.bodies.name[b];
      for (const double value : {pose.t.x(), pose.t.y(), pose.t.z(), pose.q.w, pose.q.x, pose.q.y, pose.q.z}) {
        text += ',';
        put(text, value);
      }
      text += '\n';
    }
  }
  return text;
}

std::vector<fs::path> write_csv(const Result& result, const CsvExportOptions& options) {
  refuse_names(result);
  refuse_folder(options.folder, options.force, "--csv");
  std::vector<fs::path> made;
  fs::path place = options.folder;
  try {
    ExportFolder folder(options.folder), meshes(options.folder / "meshes");
    std::map<std::string, ExportFolder> proxies;  // by label
    place = options.folder / kBodies;             // the last to be written: without it an export does not look whole
    if (!remove_regular(folder.folder(), kBodies)) throw FileFailure("is in the way and cannot be removed");
    const auto write = [&](ExportFolder& into, const fs::path& path, const std::string& text) {
      stop_if_wanted();
      place = options.folder / path;
      into.file(path.filename(), text);
      made.push_back(path);
    };
    for (const geometry::Mesh& mesh : result.bodies.meshes)
      write(meshes, fs::path("meshes") / (mesh.name + ".obj"), obj_text(mesh));
    if (const Proxies* all = result.products.find<Proxies>())
      for (const MeshProxy& row : all->rows) {
        if (row.kind == "none") continue;
        const fs::path within = fs::path("proxies") / row.label;
        place = options.folder / within;
        write(proxies.try_emplace(row.label, options.folder / within).first->second, within / (row.mesh + ".obj"),
              proxy_text(row));
      }
    write(folder, "poses.csv", poses_text(result));
    write(folder, kBodies, bodies_text(result));
    for (auto& [label, into] : proxies) into.keep();
    meshes.keep();
    folder.keep();
  } catch (const FileFailure& failure) {
    throw Error(kFile, place.string() + ": " + failure.what() + "; free or allow the place, or choose another --csv");
  }
  return made;
}

}  // namespace pipeline
