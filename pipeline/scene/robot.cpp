#include "pipeline/scene/robot.hpp"

#include <algorithm>
#include <numbers>

#include "geometry/meshes/shapes.hpp"
#include "geometry/portable_math.hpp"
#include "pipeline/physics/linkage.hpp"
#include "pipeline/scene/csv.hpp"
#include "pipeline/scene/poses_columns.hpp"
#include "pipeline/scene/shape_keys.hpp"
#include "pipeline/scene/step_clock.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kSegments = 32;  // of cylinders and spheres

/// A closed cylinder about z: two fans and a band.
geometry::Mesh cylinder(double radius, double length) {
  geometry::Mesh mesh;
  for (const double z : {-length / 2, length / 2})
    for (std::uint32_t i = 0; i < kSegments; ++i) {
      const double angle = 2 * std::numbers::pi * i / kSegments;
      mesh.vertices.emplace_back(radius * geometry::portable::cos(angle), radius * geometry::portable::sin(angle), z);
    }
  for (std::uint32_t i = 0; i < kSegments; ++i) {
    const std::uint32_t next = (i + 1) % kSegments;
    mesh.triangles.push_back({i, next, kSegments + next});
    mesh.triangles.push_back({i, kSegments + next, kSegments + i});
  }
  for (std::uint32_t i = 1; i + 1 < kSegments; ++i) {
    mesh.triangles.push_back({0, i + 1, i});
    mesh.triangles.push_back({kSegments, kSegments + i, kSegments + i + 1});
  }
  return mesh;
}

/// Where a mesh of a URDF is, as a configuration would write it. package://NAME/... is looked for in a folder NAME that
/// holds the URDF, or stands beside one that does.
std::string mesh_path(const SceneConfig& config, const std::string& urdf, const std::string& written, int line) {
  constexpr std::string_view kPackage = "package://", kFile = "file://";
  const fs::path folder = fs::path(urdf).parent_path();
  if (written.starts_with(kFile)) return written.substr(kFile.size());
  if (!written.starts_with(kPackage)) return (folder / written).string();
  const std::string inside = written.substr(kPackage.size());
  const std::size_t slash = inside.find('/');
  const std::string package = inside.substr(0, slash);
  const std::string rest = slash == std::string::npos ? "" : inside.substr(slash + 1);
  const fs::path root = fs::absolute(config.path).parent_path();
  for (fs::path at = (root / folder).lexically_normal();; at = at.parent_path()) {
    std::error_code none;
    const fs::path named = at.has_filename() ? at : at.parent_path();
    for (const fs::path& candidate : {named.filename() == package ? named / rest : fs::path(), named / package / rest})
      if (!candidate.empty() && fs::exists(candidate, none))
        return candidate.lexically_relative(root.lexically_normal()).string();
    if (at == at.parent_path() || at.empty()) break;
  }
  throw Error(kInput, (config.path.parent_path() / urdf).string() + ":" + std::to_string(line) + ": " +
                          in_quotes(one_line(written)) + " is not found: no folder " + in_quotes(one_line(package)) +
                          " above the file has it; put it there, or write a path from the file's folder");
}

/// The collisions of a link as one mesh in its frame.
MeshInput link_mesh(SceneConfig& config, const Robot& robot, const std::string& path, const UrdfLink& link,
                    const std::string& name, NodeFiles& known) {
  MeshInput out{.mesh = {}, .path = path + ", link '" + link.name + "'", .pose = {}};
  bool single = false;
  for (const UrdfCollision& part : link.collisions) {
    geometry::Mesh mesh;
    switch (part.kind) {
      case UrdfCollision::mesh: {
        const std::string place = path + ":" + std::to_string(part.line) + ": 'filename'";
        const std::string file = mesh_path(config, robot.urdf, part.file, part.line);
        mesh = read_mesh(config, {.file = file, .place = place, .scale = part.scale}, name, known).mesh;
        single |= geometry::is_node_file(file);
        break;
      }
      case UrdfCollision::box:
        mesh = make_mesh(BoxShape{.size = part.size}, name);
        break;
      case UrdfCollision::sphere:
        mesh = make_mesh(SphereShape{.radius = part.radius, .segments = kSegments}, name);
        break;
      case UrdfCollision::cylinder:
        mesh = cylinder(part.radius, part.length);
    }
    const auto base = std::uint32_t(out.mesh.vertices.size());
    out.mesh.vertices.resize(base + mesh.vertices.size());
    geometry::to_world(part.origin, mesh.vertices, std::span(out.mesh.vertices).subspan(base));
    for (const geometry::Facet& f : mesh.triangles)
      out.mesh.triangles.push_back({base + f[0], base + f[1], base + f[2]});
  }
  out.mesh.name = name;
  out.mesh.shape = "{\"file\": " + in_quotes(one_line(robot.urdf, 4096)) +
                   ", \"link\": " + in_quotes(one_line(link.name, 4096)) +
                   (single ? ", \"precision\": \"single\"}" : "}");
  return out;
}

struct JointUnit {
  std::string_view name;
  double factor;
  UrdfJoint::Kind kind;
};
constexpr JointUnit kUnits[] = {{"rad", 1, UrdfJoint::turning},
                                {"deg", std::numbers::pi / 180, UrdfJoint::turning},
                                {"m", 1, UrdfJoint::sliding},
                                {"cm", 1e-2, UrdfJoint::sliding},
                                {"mm", 1e-3, UrdfJoint::sliding}};

/// "shoulder [deg]" as its name and its unit; names of joints are kept as they are.
std::pair<std::string, std::string> split_unit(std::string_view column) {
  const std::size_t open = column.find_last_of("[(");
  if (open == column.npos || open == 0 || (column.back() != ']' && column.back() != ')'))
    return {std::string(column), ""};
  std::string_view name = column.substr(0, open);
  while (name.ends_with(' ')) name.remove_suffix(1);
  return {std::string(name), std::string(column.substr(open + 1, column.size() - open - 2))};
}

}  // namespace

JointValues parse_joints(std::string_view text, const std::string& file, const Urdf& urdf) {
  CsvReader csv(text, file);
  if (csv.header().empty()) csv.fail("has no header; its first line must name time and joints");
  StepClock clock(csv);
  std::vector<std::size_t> column(urdf.joints.size(), kNoColumn);
  std::vector<double> factor(urdf.joints.size(), 1);
  std::vector<std::string> left_out, names;
  for (std::size_t i = 0; i < csv.header().size(); ++i) {
    const auto [name, unit] = split_unit(csv.header()[i]);
    names.emplace_back(csv.header()[i]);
    const auto joint = std::ranges::find(urdf.joints, name, &UrdfJoint::name);
    if (joint == urdf.joints.end()) {
      if (!when_column(csv.header()[i], i, clock.columns, [&](const std::string& what) { csv.fail(what); }))
        left_out.push_back(names.back());
      continue;
    }
    const auto j = std::size_t(joint - urdf.joints.begin());
    if (joint->kind == UrdfJoint::fixed || joint->mimic)
      csv.fail("joint " + pipeline::quoted(name) + (joint->mimic ? " follows another" : " is fixed") +
               "; leave its column out");
    if (column[j] != kNoColumn) csv.fail("two columns are of joint " + pipeline::quoted(name));
    column[j] = i;
    if (unit.empty()) continue;
    const auto known =
        std::ranges::find_if(kUnits, [&](const JointUnit& u) { return u.name == unit && u.kind == joint->kind; });
    if (known == std::end(kUnits))
      csv.fail("the unit of " + pipeline::quoted(csv.header()[i]) + " must be " +
               (joint->kind == UrdfJoint::turning ? "rad or deg" : "m, cm or mm"));
    factor[j] = known->factor;
  }
  if (!clock.columns.any()) csv.fail("has neither a column 'step' nor 'time'");
  JointValues out;
  for (std::size_t j = 0; j < urdf.joints.size(); ++j) {
    const UrdfJoint& joint = urdf.joints[j];
    if (joint.kind == UrdfJoint::fixed || joint.mimic || column[j] != kNoColumn) continue;
    csv.fail("joint " + pipeline::quoted(joint.name) + " has no column; " + hint(joint.name, names));
  }
  std::vector<std::size_t> beyond(urdf.joints.size()), first(urdf.joints.size());
  while (csv.next()) {
    if (!clock.begins()) csv.fail("a second row of the same step; joints have one row a step");
    std::vector<double>& row = out.values.emplace_back(urdf.joints.size());
    for (std::size_t j = 0; j < row.size(); ++j) {
      if (column[j] == kNoColumn) continue;
      row[j] = factor[j] * csv.real(column[j], 1e9, "a number between -1e9 and 1e9");
      const auto& limits = urdf.joints[j].limits;
      if (limits && (row[j] < (*limits)[0] - 1e-6 || row[j] > (*limits)[1] + 1e-6) && beyond[j]++ == 0)
        first[j] = csv.line();
    }
  }
  if (out.values.empty()) csv.fail("there is no row below the header");
  for (std::size_t j = 0; j < urdf.joints.size(); ++j)
    if (beyond[j] > 0)
      out.beyond += (out.beyond.empty() ? "" : "; ") + ("joint '" + urdf.joints[j].name) +
                    "' is beyond its limits in " + std::to_string(beyond[j]) + " of " +
                    std::to_string(out.values.size()) + " rows, the first at line " + std::to_string(first[j]);
  out.times = clock.times();
  for (std::size_t j = 0; j < urdf.joints.size(); ++j)
    if (column[j] != kNoColumn) out.understood += (out.understood.empty() ? "joints " : ", ") + names[column[j]];
  for (std::size_t i = 0; i < left_out.size(); ++i) out.understood += (i ? ", " : "; left out: ") + left_out[i];
  return out;
}

LoadedRobot load_robot(SceneConfig& config, const Robot& robot, NodeFiles& known) {
  const Input input = read_input(config, robot.urdf, robot.place);
  const Urdf urdf = parse_urdf(input.bytes, input.path);
  // Joints as the linkage wants them: one a link, parents first; the root stands where the configuration has it.
  const auto& q = robot.orientation;
  const geometry::Quaternion base = geometry::normalised({q[0], q[1], q[2], q[3]});
  std::vector<LinkJoint> joints;
  std::vector<std::size_t> place(urdf.links.size());
  std::vector<bool> moves;
  for (const std::size_t link : urdf.order) {
    place[link] = joints.size();
    LinkJoint joint;
    if (joints.empty()) {
      joint.position = robot.position;
      joint.orientation = {base.w, base.x, base.y, base.z};
      moves.push_back(false);
    } else {
      const UrdfJoint& from = urdf.joints[urdf.links[link].joint];
      const geometry::Quaternion& turn = from.origin.q;
      joint.above = int(place[from.above]);
      joint.position = {from.origin.t.x(), from.origin.t.y(), from.origin.t.z()};
      joint.orientation = {turn.w, turn.x, turn.y, turn.z};
      joint.kind = from.kind == UrdfJoint::turning   ? LinkJoint::turning
                   : from.kind == UrdfJoint::sliding ? LinkJoint::sliding
                                                     : LinkJoint::fixed;
      joint.axis = {from.axis.x(), from.axis.y(), from.axis.z()};
      moves.push_back(moves[place[from.above]] || from.kind != UrdfJoint::fixed);
    }
    joints.push_back(joint);
  }

  JointValues trajectory;
  if (std::ranges::find(moves, true) != moves.end()) {
    if (robot.joints.empty())
      throw Error(kInput,
                  robot.place + ": " + input.path + " has joints that move; give their values, 'joints', a CSV file");
    const Input table = read_input(config, robot.joints, robot.joints_place);
    trajectory = parse_joints(table.bytes, table.path, urdf);
    config.understood.push_back(table.path + ": " + trajectory.understood);
    if (!trajectory.beyond.empty()) config.notes.push_back(table.path + ": " + trajectory.beyond);
  }

  LoadedRobot out;
  std::vector<std::size_t> bodies;  // places of links that collide
  std::string without;
  for (const std::size_t link : urdf.order) {
    const UrdfLink& of = urdf.links[link];
    if (of.collisions.empty()) {
      without += (without.empty() ? "" : ", ") + of.name;
      continue;
    }
    const std::string name = (robot.name.empty() ? "" : robot.name + ".") + label_of(of.name);
    if (!valid_label(name))
      throw Error(kInput, input.path + ":" + std::to_string(of.line) + ": body " + pipeline::quoted(name) +
                              ", of a link, must " + kLabelRule);
    out.bodies.push_back({link_mesh(config, robot, input.path, of, name, known), !moves[place[link]]});
    bodies.push_back(place[link]);
  }
  if (bodies.empty()) throw Error(kInput, input.path + ": no link has a <collision>; what is only seen meets nothing");
  if (!without.empty())
    config.understood.push_back(input.path + ": links without <collision> are no bodies: " + without);

  Linkage linkage(joints);
  out.motion.steps = std::int64_t(trajectory.values.size());
  out.motion.times = trajectory.times;
  out.motion.tracks.resize(bodies.size());
  std::vector<double> values(joints.size());
  for (std::size_t s = 0; s < std::max<std::size_t>(trajectory.values.size(), 1); ++s) {
    for (const std::size_t link : urdf.order) {
      const std::size_t j = urdf.links[link].joint;
      if (trajectory.values.empty() || j == std::size_t(-1)) continue;
      const auto& row = trajectory.values[s];
      const auto& mimic = urdf.joints[j].mimic;
      values[place[link]] = mimic ? mimic->multiplier * row[mimic->joint] + mimic->offset : row[j];
    }
    const std::vector<LinkPlace> places = linkage.places(values);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      CsvTrack& track = out.motion.tracks[b];
      if (out.bodies[b].fixed && s > 0) continue;
      track.first = 0;
      track.stays = out.bodies[b].fixed;
      const LinkPlace& at = places[bodies[b]];
      track.poses.push_back(
          {geometry::normalised({at.orientation[0], at.orientation[1], at.orientation[2], at.orientation[3]}),
           {at.position[0], at.position[1], at.position[2]}});
    }
  }
  return out;
}

}  // namespace pipeline
