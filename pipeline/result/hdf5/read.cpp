#include "pipeline/result/hdf5/read.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <new>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "pipeline/result/attributes.hpp"
#include "pipeline/result/digest.hpp"
#include "pipeline/result/hdf5/reader.hpp"
#include "pipeline/result/layout.hpp"
#include "pipeline/result/product.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/system/input_file.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

using std::filesystem::path;

// No configuration can ask for more.
constexpr std::uint64_t kMostSteps = 10'000'000, kMostBodies = 1'000'000;

/// A name that is part of a path within the file.
void check_name(const std::string& place, const std::string& name) {
  if (name.empty() || name == "." || name == ".." || name.find('/') != std::string::npos)
    throw h5::Failure(place + ": '" + name + "' is no name");
}

/// An attribute that holds a JSON object; throws when it does not.
std::string json_object(const Reader& from, const std::string& path, const std::string& name) {
  std::string text = from.attribute<std::string>(path, name);
  if (!is_shallow(text) || !nlohmann::json::parse(text, nullptr, false).is_object())
    throw h5::Failure("attribute " + name + " of " + path + ": is no JSON object");
  return text;
}

void read_texts(const Reader& from, const std::string& path, const auto& texts, auto& row) {
  for (const auto& [name, member, kind] : texts) {
    if (kind == Text::optional && !from.has_attribute(path, name)) continue;
    row.*member = kind == Text::json ? json_object(from, path, name) : from.attribute<std::string>(path, name);
  }
}

/// Throws when an attribute is none of a few words.
void check_word(const std::string& path, const std::string& name, const std::string& text,
                std::initializer_list<std::string_view> words) {
  if (std::ranges::find(words, text) == words.end())
    throw h5::Failure("attribute " + name + " of " + path + ": '" + one_line(text) + "' is not known");
}

double sphere_radius(const std::string& shape) {
  const auto json = nlohmann::json::parse(shape);
  const auto is = [&](const char* key, auto kind) { return json.contains(key) && (json[key].*kind)(); };
  const bool sphere = is("kind", &nlohmann::json::is_string) && json["kind"] == "sphere";
  return sphere && is("radius", &nlohmann::json::is_number) ? json["radius"].get<double>() : 0.0;
}

geometry::Mesh read_mesh(const Reader& from, const std::string& name) {
  check_name("/meshes", name);
  const std::string path = "/meshes/" + name;
  geometry::Mesh mesh;
  mesh.name = name;
  mesh.vertices = from.values<geometry::Vec3>(path + "/vertices", Type::f64, {kAny, 3});
  mesh.triangles = from.values<geometry::Facet>(path + "/triangles", Type::u32, {kAny, 3});
  for (const geometry::Facet& facet : mesh.triangles)
    if (std::ranges::any_of(facet, [&](std::uint32_t corner) { return corner >= mesh.vertices.size(); }))
      throw h5::Failure(path + ": a triangle has no such vertex");
  mesh.shape = json_object(from, path, "shape");
  mesh.surface_deviation = from.attribute<double>(path, "surface_deviation");
  mesh.sphere_radius = sphere_radius(mesh.shape);
  if (!from.has(path + "/contact_spheres")) return mesh;
  for (const auto& [x, y, z, radius] :
       from.values<std::array<double, 4>>(path + "/contact_spheres", Type::f64, {kAny, 4}))
    mesh.contact_spheres.push_back({{x, y, z}, radius});
  mesh.contact_deviation = from.attribute<double>(path, "contact_deviation");
  return mesh;
}

geometry::Bodies read_bodies(const Reader& from) {
  geometry::Bodies bodies;
  const std::uint64_t count = from.size("/body", kMostBodies);
  bodies.name = from.texts("/body", {count});
  std::map<std::string, std::uint32_t> number;
  for (const std::string& name : from.names_in("/meshes", count)) {
    number.emplace(name, static_cast<std::uint32_t>(bodies.meshes.size()));
    bodies.meshes.push_back(read_mesh(from, name));
  }
  for (const std::string& name : from.texts("/bodies/mesh", {count})) {
    const auto found = number.find(name);
    if (found == number.end()) throw h5::Failure("/bodies/mesh: there is no mesh '" + name + "'");
    bodies.mesh.push_back(found->second);
  }
  bodies.fixed = from.values<std::uint8_t>("/bodies/fixed", {count});
  if (from.has("/bodies/chosen")) bodies.chosen = from.values<std::uint8_t>("/bodies/chosen", {count});
  return bodies;
}

std::vector<std::vector<geometry::Pose>> read_motion(const Reader& from, std::uint64_t steps, std::uint64_t bodies) {
  const auto position = from.values<double>("/motion/position", {steps, bodies, 3});
  const auto orientation = from.values<double>("/motion/orientation", {steps, bodies, 4});
  std::vector<std::vector<geometry::Pose>> motion(steps, std::vector<geometry::Pose>(bodies));
  const double* t = position.data();
  const double* q = orientation.data();
  for (auto& poses : motion)
    for (geometry::Pose& pose : poses) {
      pose = {{q[0], q[1], q[2], q[3]}, {t[0], t[1], t[2]}};
      t += 3;
      q += 4;
    }
  return motion;
}

ForeignFacts read_facts(const Reader& from, const std::string& path, std::uint64_t steps) {
  ForeignFacts facts;
  read_texts(from, path, kForeignTexts, facts);
  facts.threads = from.attribute<std::int64_t>(path, "threads");
  facts.steps_done = from.attribute<std::int64_t>(path, "steps_done");
  const std::string status = from.attribute<std::string>(path, "status");
  check_word(path, "status", status, {"complete", "failed"});
  const bool complete = status == "complete";
  if (complete != facts.reason.empty() || facts.steps_done < 0 || std::uint64_t(facts.steps_done) > steps)
    throw h5::Failure("attributes of " + path + ": status, reason and steps_done do not fit each other");
  return facts;
}

std::vector<Answers> read_answers(const Reader& from, std::uint64_t steps, std::uint64_t bodies) {
  std::vector<Answers> all;
  std::set<std::string> known;
  for (const std::string& label : from.texts("/algorithm", {kAny})) {
    check_name("/algorithm", label);
    if (!known.insert(label).second) throw h5::Failure("/algorithm: '" + label + "' is there twice");
    const std::string path = "/answers/" + label;
    Answers answers;
    answers.label = label;
    read_texts(from, path, kAnswerTexts, answers);
    check_word(path, "promise", answers.promise, {"none", "conservative", "exact"});
    check_word(path, "scope", answers.scope, {"pair", "scene"});
    if (from.has_attribute(path, "transport")) answers.foreign = read_facts(from, path, steps);
    read_texts(from, path, kMachineTexts, answers.machine);
    const auto whole = [&](const char* name, auto& value) {
      using T = std::remove_reference_t<decltype(value)>;
      if (from.has_attribute(path, name)) value = static_cast<T>(from.attribute<std::int64_t>(path, name));
    };
    whole("pinned", answers.machine.pinned);
    for (const auto& [name, cost, column] : kCosts) whole(name, answers.costs.*cost);
    answers.hits = from.pairs(path, steps, bodies);
    all.push_back(std::move(answers));
  }
  each_answer_column([&](const auto& column) { from.answers("/results", column, steps, all); });
  return all;
}

std::vector<Summary> read_summary(const Reader& from, std::uint64_t algorithms) {
  std::vector<Summary> rows(algorithms);
  each_summary_column([&](const auto& column) { from.rows("/summary", column, rows); });
  return rows;
}

/// What files have since they say which of a contained pair is inside.
void read_contained_inside(const Reader& from, Result& result) {
  const std::vector<Pair>& pairs = result.truth.contained.pair;
  result.truth.contained_inside = from.values<std::uint32_t>("/truth/contained_inside", {pairs.size()});
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (const std::uint32_t body = (*result.truth.contained_inside)[i]; body != pairs[i].a && body != pairs[i].b)
      throw h5::Failure("/truth/contained_inside: names a body that is not of the pair");
  result.bodies.closed_within = from.attribute<double>("/truth", "closed_within");
  for (const geometry::Mesh& mesh : result.bodies.meshes)
    result.truth.closed_within.push_back(from.attribute<double>("/meshes/" + mesh.name, "closed_within"));
}

Provenance read_provenance(const Reader& from) {
  Provenance out;
  read_texts(from, "/", kOriginTexts, out);
  read_texts(from, "/run", kRunTexts, out);
  out.wall_time_s = from.attribute<double>("/run", "wall_time_s");
  return out;
}

Result read_all(const Reader& from) {
  Result result;
  result.title = from.attribute<std::string>("/", "title");
  result.config_text = from.texts("/config", {}).at(0);
  result.config_effective = from.attribute<std::string>("/config", "effective");
  result.provenance = read_provenance(from);
  result.digest = from.attribute<std::string>("/", "digest");
  for (const Product& product : products())
    if (product.place == Product::Place::alone && from.has(product.sign)) return product.read(from, result), result;
  result.rate = from.attribute<double>("/time", "rate");
  const std::uint64_t steps = from.size("/step", kMostSteps);
  result.bodies = read_bodies(from);
  const std::uint64_t bodies = result.bodies.size();
  result.first_step = from.values<std::int64_t>("/bodies/first_step", {bodies});
  result.motion = read_motion(from, steps, bodies);
  result.truth.hits = from.pairs("/truth", steps, bodies);
  if (from.has("/truth/contained_pair")) {
    const auto kept = containment_of(from.attribute<std::string>("/truth", "containment"));
    if (!kept || *kept == Containment::ignore) throw h5::Failure("/truth: its containment is not known");
    result.truth.containment = *kept;
    result.truth.contained = from.pairs("/truth", steps, bodies, "contained_");
    if (from.has("/truth/contained_inside")) read_contained_inside(from, result);
  }
  result.truth.time_ns = from.values<std::int64_t>("/truth/time_ns", {steps});
  if (from.has("/algorithm")) {
    result.answers = read_answers(from, steps, bodies);
    result.summary = read_summary(from, result.answers.size());
  }
  for (const Product& product : products())
    if (product.place != Product::Place::alone && from.has(product.sign)) product.read(from, result);
  return result;
}

/// Opens a file of ours for reading, or says why it is not one.
h5::File open_result(const path& path, const std::string& place) {
  h5::silence();
  errno = 0;
  if (H5Fis_hdf5(path.c_str()) <= 0 && !h5::out_of_memory())
    throw Error(kFile, place + ": is not an HDF5 file; name a result of `pipeline run`");
  const h5::Properties access(H5Pcreate(H5P_FILE_ACCESS), "make properties");
  // Results are never changed in place, so nothing need be locked; locking fails on some network disks.
  h5::check(H5Pset_file_locking(access.id(), false, true), "read without locking");
  const hid_t opened = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id());
  if (opened < 0 && h5::out_of_memory()) throw std::bad_alloc();
  if (opened < 0) {
    const bool truncated = h5::reason().find("truncated") != std::string::npos;
    throw Error(kFile, place + (truncated ? ": is truncated, its end is missing" : ": is damaged" + h5::reason()) +
                           "; copy it again, or run again with --force");
  }
  h5::File result(opened, "open");
  if (H5Aexists(result.id(), "schema_version") <= 0)
    throw Error(kFile, place +
                           ": is an HDF5 file of another program (it has no attribute schema_version); "
                           "name a result of `pipeline run`");
  return result;
}

void check_schema(const Reader& reader, const std::string& place) {
  const auto version = reader.attribute<std::int64_t>("/", "schema_version");
  if (version > kSchemaVersion)
    throw Error(kFile, place + ": has schema version " + std::to_string(version) + ", this program reads up to " +
                           std::to_string(kSchemaVersion) + "; use a newer program");
  if (version < 1)
    throw Error(kFile, place + ": has schema version " + std::to_string(version) +
                           ", which never existed; run again with --force");
}

/// The content has the digests that the file says, of every group and of the whole; and what was not read but follows
/// from what was (counts of hits, of born bodies, times of steps) is in the file as it would be written.
void check_content(const Reader& from, const Result& result, bool compare_digests) {
  const std::vector<Group> groups = layout(result);
  for (const auto& [path, digest] : digests(groups))
    if (compare_digests && from.attribute<std::string>(path, "digest") != digest)
      throw h5::Failure((path == "/" ? "its content" : path) + " does not have its digest");
  for (const Group& group : groups)
    for (const Dataset& dataset : group.datasets) {
      if (!is_digested(dataset) || from.was_read(dataset.path)) continue;
      const bool same = dataset.type == Type::text
                            ? from.texts(dataset.path, dataset.shape) == dataset.text
                            : std::ranges::equal(from.bytes(dataset.path, dataset.type, dataset.shape), dataset.bytes);
      if (!same) throw h5::Failure(dataset.path + ": contradicts the rest");
    }
}

/// What lies at the root beside what a result holds.
std::vector<std::string> foreign_objects(const Reader& from, const Result& result) {
  std::set<std::string> ours;
  for (const Group& group : layout(result)) {
    ours.insert(group.path.substr(1, group.path.find('/', 1) - 1));
    if (group.path == "/")
      for (const Dataset& dataset : group.datasets) ours.insert(dataset.path.substr(1));
  }
  std::vector<std::string> foreign;
  constexpr std::uint64_t kMostObjects = 10'000;
  for (const std::string& name : from.names_in("/", kMostObjects))
    if (!ours.contains(name)) foreign.push_back(name);
  return foreign;
}

}  // namespace

std::string unsealed_remedy(Seal seal) {
  return seal == Seal::unknown ? "; use a newer program, or copy it again"
                               : "; copy it again, run again with --force, or read it with --unsealed, which vouches "
                                 "for neither times nor attributes";
}

Read read_checked(const InputFile& file, const std::string& place, Seal seal, bool unsealed,
                  const std::function<void(std::uint64_t)>& wanted, bool compare_digests) {
  const auto damaged = [&](const std::string& what) {
    return Error(kFile, place + ": is damaged: " + what + "; copy it again, or run again with --force");
  };
  try {
    const h5::File opened = [&] {
      try {
        return open_result(file.opened_path(), place);
      } catch (const Error&) {  // HDF5 asks for the real path of what it opens: one that was replaced has none
        if (!file.in_place()) throw Error(kFile, place + ": was changed by another program meanwhile; read it again");
        throw;
      }
    }();
    h5::check_links(opened.id());
    const Reader reader(opened.id(), file.size(), wanted);
    check_schema(reader, place);
    const bool older = !reader.has_attribute("/", kSealed);
    if (seal == Seal::none && !older && !unsealed)
      throw Error(
          kFile, place + ": was changed or damaged since it was written (its seal is missing)" + unsealed_remedy(seal));
    Read read{read_all(reader), older};
    check_content(reader, read.result, compare_digests);
    if (seal != Seal::holds) read.result.foreign = foreign_objects(reader, read.result);
    return read;
  } catch (const h5::Failure& failure) {
    // HDF5's words for it, wherever in it malloc gave nothing: that alone is no damage.
    if (std::strstr(failure.what(), "memory allocation failed")) throw std::bad_alloc();
    throw damaged(failure.what());
  } catch (const std::length_error&) {
    throw damaged("a dataset has an impossible size");
  }
}

}  // namespace pipeline
