// Writes a layout as HDF5, and reads a result back.
//
// HDF5 writes into memory and the program writes the bytes: a full disk is then an ordinary failed write with its
// errno, while HDF5 1.10 can neither flush nor close a file when the disk is full.
#include "pipeline/result/store.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <new>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "pipeline/result/digest.hpp"
#include "pipeline/result/h5_reader.hpp"
#include "pipeline/result/layout.hpp"
#include "pipeline/result/product.hpp"
#include "pipeline/result/seal.hpp"
#include "pipeline/system/child.hpp"
#include "pipeline/system/input_file.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

using std::filesystem::path;

// ---- writing HDF5 ----

// Measured on 600 steps x 275 bodies x 11 algorithms with 460 hits: levels 1, 4, 6 give 9.4, 9.1, 9.1 MB in 1.05, 1.24,
// 1.6 s (two busy cores); chunks of 64, 256, 512, 1000 KiB at level 1 give 10.4, 9.5, 9.4, 9.3 MB in about the same
// time.
constexpr unsigned kDeflate = 1;
// A chunk in bytes, about: below HDF5's chunk cache of 1 MiB, so that readers of parts do not inflate a chunk twice.
constexpr std::uint64_t kChunkBytes = 512 << 10;
// Datasets of fixed size below this lie unchunked.
constexpr std::uint64_t kSmallBytes = 4096;

/// Chunks are cut along the first dimension only, into equal parts.
std::vector<hsize_t> chunk_of(const Dataset& dataset) {
  std::vector<hsize_t> chunk(dataset.shape.begin(), dataset.shape.end());
  const std::uint64_t rows = std::max<std::uint64_t>(chunk[0], 1);
  std::uint64_t row_bytes = dataset.type == Type::text ? 16 : size_of(dataset.type);  // of a text its place
  for (std::size_t d = 1; d < chunk.size(); ++d) row_bytes *= chunk[d];
  const std::uint64_t most = std::max<std::uint64_t>(kChunkBytes / row_bytes, 1);
  const std::uint64_t parts = (rows + most - 1) / most;
  chunk[0] = (rows + parts - 1) / parts;
  return chunk;
}

/// Puts groups into an open file. Scales are in the root, which comes first, or in the group that uses them.
class Writer {
 public:
  explicit Writer(hid_t file) : file_(file) {}

  void add(const Group& group) {
    if (group.path != "/") make_group(group.path);
    for (const Attribute& attribute : group.attributes) add(group.path, attribute);
    for (const Dataset& dataset : group.datasets) add(group.path, dataset);
    // A group's own scales are of no use to others; thousands of open ones make HDF5 slow.
    if (group.path != "/") std::erase_if(scales_, [&](const auto& scale) { return scale.first.rfind('/') != 0; });
  }

  void add(const std::string& object_path, const Attribute& attribute) {
    const h5::Handle<H5Oclose> object(H5Oopen(file_, object_path.c_str(), H5P_DEFAULT), "open " + object_path);
    h5::write_attribute(object.id(), attribute.name, attribute.value);
  }

 private:
  void make_group(const std::string& path) {
    const h5::Properties links(H5Pcreate(H5P_LINK_CREATE), "make properties");
    h5::check(H5Pset_create_intermediate_group(links.id(), 1), "make groups above " + path);
    const h5::Properties properties(H5Pcreate(H5P_GROUP_CREATE), "make properties");
    h5::check(H5Pset_link_creation_order(properties.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED),
              "keep the order of " + path);
    h5::check(H5Pset_obj_track_times(properties.id(), false), "leave out times");
    const std::string above = path.substr(0, path.rfind('/'));
    if (!above.empty() && !h5::exists(file_, above)) make_group(above);
    h5::Group(H5Gcreate2(file_, path.c_str(), links.id(), properties.id(), H5P_DEFAULT), "make " + path);
  }

  void add(const std::string& group, const Dataset& dataset) {
    const std::string& path = dataset.path;
    const h5::Space space = space_of(dataset);
    const h5::Properties properties = properties_of(dataset);
    const hid_t type = h5_type(dataset.type, text_);
    h5::Dataset made(H5Dcreate2(file_, path.c_str(), type, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
                     "make " + path);
    if (dataset.rows) {
      write_rows(dataset, made.id(), type, space);
    } else if (!dataset.bytes.empty()) {
      h5::check(H5Dwrite(made.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, dataset.bytes.data()), "write " + path);
    } else if (!dataset.text.empty()) {
      std::vector<const char*> texts;
      for (const std::string& text : dataset.text) texts.push_back(text.c_str());
      h5::check(H5Dwrite(made.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()), "write " + path);
    }
    h5::write_attribute(made.id(), "units", dataset.units);
    h5::write_attribute(made.id(), "long_name", dataset.long_name);
    for (const Attribute& attribute : dataset.attributes)
      h5::write_attribute(made.id(), attribute.name, attribute.value);

    if (dataset.scale != Scale::none) {
      std::string name(base_name(path));
      if (dataset.scale == Scale::bare) {
        // The words by which netCDF, h5netcdf and xarray know a dimension without a variable, then its size in 10
        // places.
        const std::string size = std::to_string(dataset.shape[0]);
        name = "This is a netCDF dimension but not a netCDF variable.";
        name.append(10 - std::min<std::size_t>(size.size(), 10), ' ').append(size);
      }
      h5::check(H5DSset_scale(made.id(), name.c_str()), "make a scale of " + path);
      scales_.try_emplace(path, OpenScale{std::move(made), dataset.grows});
      return;
    }
    for (unsigned d = 0; d < dataset.dims.size(); ++d) {
      const std::string& scale = dataset.dims[d];
      h5::check(H5DSattach_scale(made.id(), scales_.at(scale).dataset.id(), d), "attach " + scale + " to " + path);
      link(scale, group);
    }
  }

  /// Whole chunks at a time, so that none is made twice.
  void write_rows(const Dataset& dataset, hid_t made, hid_t type, const h5::Space& space) {
    each_part(dataset, chunk_of(dataset)[0], [&](std::uint64_t first, std::span<const std::byte> bytes) {
      std::vector<hsize_t> start(dataset.shape.size(), 0), count(dataset.shape.begin(), dataset.shape.end());
      start[0] = first;
      count[0] = bytes.size() / (dataset.elements() / dataset.shape[0] * size_of(dataset.type));
      const h5::Space part(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr),
                           "shape a part of " + dataset.path);
      h5::check(H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
                "select a part of " + dataset.path);
      h5::check(H5Dwrite(made, type, part.id(), space.id(), H5P_DEFAULT, bytes.data()), "write " + dataset.path);
    });
  }

  /// Links a scale into a group that uses it, so that the group can be opened alone.
  void link(const std::string& scale, const std::string& group) {
    const std::string name = (group == "/" ? "" : group) + "/" + std::string(base_name(scale));
    if (!h5::exists(file_, name))
      h5::check(H5Lcreate_hard(file_, scale.c_str(), file_, name.c_str(), H5P_DEFAULT, H5P_DEFAULT), "link " + name);
  }

  bool grows(const Dataset& dataset, std::size_t dimension) const {
    if (dataset.scale != Scale::none) return dataset.grows;
    return scales_.at(dataset.dims[dimension]).grows;
  }

  h5::Space space_of(const Dataset& dataset) const {
    if (dataset.shape.empty()) return h5::scalar();
    std::vector<hsize_t> size(dataset.shape.begin(), dataset.shape.end()), most = size;
    for (std::size_t d = 0; d < most.size(); ++d)
      if (grows(dataset, d)) most[d] = H5S_UNLIMITED;
    return {H5Screate_simple(static_cast<int>(size.size()), size.data(), most.data()), "shape " + dataset.path};
  }

  h5::Properties properties_of(const Dataset& dataset) const {
    h5::Properties properties(H5Pcreate(H5P_DATASET_CREATE), "make properties");
    h5::check(H5Pset_obj_track_times(properties.id(), false), "leave out times");
    if (dataset.shape.empty()) return properties;
    bool growing = false;
    for (std::size_t d = 0; d < dataset.shape.size(); ++d) growing = growing || grows(dataset, d);
    if (!growing && dataset.bytes.size() < kSmallBytes) return properties;
    const auto chunk = chunk_of(dataset);
    h5::check(H5Pset_chunk(properties.id(), static_cast<int>(chunk.size()), chunk.data()), "chunk " + dataset.path);
    h5::check(H5Pset_shuffle(properties.id()), "shuffle " + dataset.path);
    h5::check(H5Pset_deflate(properties.id(), kDeflate), "deflate " + dataset.path);
    return properties;
  }

  struct OpenScale {
    h5::Dataset dataset;
    bool grows;
  };

  hid_t file_;
  h5::Type text_ = h5::text_type();
  std::map<std::string, OpenScale> scales_;  // by path
};

/// Writes the file, with its seal when it is `vouched` for. The same groups give the same bytes.
void write(const std::vector<Group>& groups, const std::map<std::string, std::string>& digests, bool vouched,
           OutputFile& target) {
  h5::silence();
  const h5::Properties access(H5Pcreate(H5P_FILE_ACCESS), "make properties");
  h5::check(H5Pset_fapl_core(access.id(), 16 << 20, false), "write into memory");
  // The oldest format that holds everything: any reader since HDF5 1.8 reads it. From superblock 2 on, 1.10.8's
  // H5Fget_file_image clears a flag without renewing the checksum: its image cannot be opened.
  h5::check(H5Pset_libver_bounds(access.id(), H5F_LIBVER_EARLIEST, H5F_LIBVER_V18), "choose the format");
  const h5::Properties creation(H5Pcreate(H5P_FILE_CREATE), "make properties");
  h5::check(H5Pset_link_creation_order(creation.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED), "keep order");
  h5::check(H5Pset_obj_track_times(creation.id(), false), "leave out times");
  const h5::File file(H5Fcreate("result", H5F_ACC_TRUNC, creation.id(), access.id()), "make a file in memory");

  Writer writer(file.id());
  for (const Group& group : groups) writer.add(group);
  for (const auto& [group, digest] : digests) writer.add(group, {"digest", digest});
  writer.add("/", {"digest_algorithm", std::string(kDigestAlgorithm)});
  writer.add("/", {kSealed, "by the checksum in the last line of the file, over all bytes before it"});

  h5::check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "flush");
  const auto size = static_cast<std::size_t>(h5::check(H5Fget_file_image(file.id(), nullptr, 0), "size the file"));
  void* memory = nullptr;  // of this driver, where its pointer to the file lies
  h5::check(H5Fget_vfd_handle(file.id(), H5P_DEFAULT, &memory), "find the file in memory");
  const std::span<const std::byte> bytes(*static_cast<std::byte**>(memory), size);
  target.write(bytes, vouched ? seal_of(bytes) : "");  // the attribute stays: that the seal is missing is known
}

// ---- reading ----

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

/// An attribute that is one of a few words.
std::string one_of(const Reader& from, const std::string& path, const std::string& name,
                   std::initializer_list<std::string_view> words) {
  std::string text = from.attribute<std::string>(path, name);
  if (std::ranges::find(words, text) == words.end())
    throw h5::Failure("attribute " + name + " of " + path + ": '" + one_line(text) + "' is not known");
  return text;
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
  const auto text = [&](const char* name) { return from.attribute<std::string>(path, name); };
  ForeignFacts facts;
  facts.transport = text("transport");
  facts.command = text("command");
  facts.files = json_object(from, path, "files_sha256");
  facts.version = text("version");
  facts.language = text("language");
  facts.precision = text("precision");
  facts.threads = from.attribute<std::int64_t>(path, "threads");
  facts.reason = text("reason");
  facts.steps_done = from.attribute<std::int64_t>(path, "steps_done");
  const bool complete = one_of(from, path, "status", {"complete", "failed"}) == "complete";
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
    const auto text = [&](const char* name) { return from.attribute<std::string>(path, name); };
    Answers answers;
    answers.label = label;
    answers.name = text("name");
    answers.knobs = json_object(from, path, "knobs");
    answers.promise = one_of(from, path, "promise", {"none", "conservative", "exact"});
    answers.thesis_key = text("thesis_key");
    answers.operations_unit = text("operations_unit");
    answers.scope = one_of(from, path, "scope", {"pair", "scene"});
    if (from.has_attribute(path, "library")) answers.library = text("library");
    if (from.has_attribute(path, "transport")) answers.foreign = read_facts(from, path, steps);
    answers.machine = {text("host"), text("processor"), text("build"), text("date")};
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
  const auto root = [&](const char* name) { return from.attribute<std::string>("/", name); };
  const auto run = [&](const char* name) { return from.attribute<std::string>("/run", name); };
  Provenance out;
  out.creator = root("creator");
  out.git_commit = root("git_commit");
  out.build_type = root("build_type");
  out.compiler = root("compiler");
  out.flags = root("flags");
  out.library_versions = json_object(from, "/", "library_versions");
  out.config_sha256 = root("config_sha256");
  out.inputs_sha256 = json_object(from, "/", "inputs_sha256");
  out.date = run("date");
  out.host = run("host");
  out.processor = run("processor");
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

std::string unsealed_remedy(Seal seal) {
  return seal == Seal::unknown ? "; use a newer program, or copy it again"
                               : "; copy it again, run again with --force, or read it with --unsealed, which vouches "
                                 "for neither times nor attributes";
}

void check_seal(Seal seal, const std::string& place) {
  if (seal == Seal::differs)
    throw Error(kFile, place + ": was changed or damaged since it was written (its seal does not hold)" +
                           unsealed_remedy(seal));
  if (seal == Seal::unknown)
    throw Error(kFile, place + ": has a seal of a form that this program does not know" + unsealed_remedy(seal));
}

struct Read {
  Result result;
  bool older = false;  // from before there were seals
};

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

/// Reads and checks everything but a seal that is there. Before memory is taken for values, `wanted` hears of them.
Read read_checked(const InputFile& file, const std::string& place, Seal seal, bool unsealed,
                  const std::function<void(std::uint64_t)>& wanted = {}, bool compare_digests = true) {
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

/// What an honest file may take to be read. HDF5's own tables and ours grow with the file (7 bytes a byte were seen, of
/// 5,000 meshes); values are there as read, as poses, and as they are digested.
constexpr std::uint64_t kFreeMemory = 256 << 20, kMemoryPerByte = 16, kMemoryPerValueByte = 6;
// A processor ten times slower than today's inflates and digests so many bytes per second.
constexpr std::uint64_t kSlowBytes = 4 << 20, kSlowValueBytes = 20 << 20;
constexpr std::uint64_t kFreeSeconds = 2;

/// Ends this process's own greed: memory at once, by failing allocations; time by SIGXCPU.
class Greed {
 public:
  explicit Greed(std::uint64_t file_bytes) {
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    memory_ = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) + kFreeMemory + kMemoryPerByte * file_bytes;
    seconds_ = kFreeSeconds + file_bytes / kSlowBytes;
    rlimit now;
    if (getrlimit(RLIMIT_AS, &now) == 0) given_ = now.rlim_cur;
  }
  /// Whether the program was started with less memory than an honest file may take.
  bool is_short() const { return given_ < memory_ + kMemoryPerValueByte * values_; }
  void limit() const {
    rlimit now;
    if (getrlimit(RLIMIT_AS, &now) != 0) return;
    now.rlim_cur = std::min<rlim_t>(given_, memory_ + kMemoryPerValueByte * values_);
    setrlimit(RLIMIT_AS, &now);
    if (getrlimit(RLIMIT_CPU, &now) != 0) return;
    now.rlim_cur = std::min<rlim_t>(now.rlim_max, seconds_ + values_ / kSlowValueBytes);
    setrlimit(RLIMIT_CPU, &now);
  }
  void allow(std::uint64_t value_bytes) {
    values_ += value_bytes;
    limit();
  }

 private:
  std::uint64_t memory_ = 0, seconds_ = 0, values_ = 0;
  rlim_t given_ = RLIM_INFINITY;
};

Error too_little_memory(const std::string& place) {
  return Error(kFile,
               place + ": needs more memory than there is; free some, or raise the limit of this shell (ulimit -v)");
}

/// Reads the file in a child process: HDF5 1.10.8 crashes, loops or asks for all memory on some damaged files, and such
/// a file may well have a seal that somebody made. Throws what reading it here would throw.
void try_reading(const InputFile& file, const path& path, Seal seal, bool unsealed) {
  const std::string place = path.string();
  // Deflate makes at most 1032 bytes of one; the child itself sets what its file is worth.
  ChildLimits limits;
  limits.processor_seconds = static_cast<double>(kFreeSeconds + file.size() / kSlowBytes) +
                             static_cast<double>(file.size()) * 1032 / static_cast<double>(kSlowValueBytes);
  limits.wall_seconds = 60 + 10 * limits.processor_seconds;  // of a slow disk, beside other work
  const auto work = [&](std::size_t) -> std::string {
    Greed greed(file.size());
    greed.limit();
    const auto answer = [&](const Error& error) { return std::to_string(error.code()) + " " + error.what(); };
    try {
      {
        const InputFile again(path, "try again");  // the parent's own descriptor is closed in its children
        if (!again.same_as(file))
          throw Error(kFile, place + ": was changed by another program meanwhile; read it again");
        read_checked(again, place, seal, unsealed, [&](std::uint64_t bytes) { greed.allow(bytes); });
      }
      H5close();  // what the library does at its end belongs to the trial
      return "";
    } catch (const Error& error) {
      // Short of memory, HDF5 1.10.8 says that anything is wrong, or corrupts its own.
      return answer(greed.is_short() ? too_little_memory(place) : error);
    } catch (const std::bad_alloc&) {
      if (greed.is_short()) return answer(too_little_memory(place));
      throw std::runtime_error("it wanted more memory than its size explains");
    }
  };
  in_children(1, 1, limits, work, [&](std::size_t, const std::string& said, const std::string& failure) {
    if (!failure.empty() && Greed(file.size()).is_short()) throw too_little_memory(place);
    if (!failure.empty())
      throw Error(kFile, place + ": is damaged (a trial of reading it: " + failure +
                             "); copy it again, or run again with --force");
    if (!said.empty()) throw Error(static_cast<ExitCode>(std::atoi(said.c_str())), said.substr(said.find(' ') + 1));
  });
}

}  // namespace

std::map<std::string, std::string> digests(const Result& result) { return digests(layout(result)); }

void write_result(Result& result, OutputFile& target) {
  try {
    const auto groups = layout(result);
    const auto all = digests(groups);
    write(groups, all, result.vouched, target);
    result.digest = all.at("/");
  } catch (const h5::Failure& failure) {
    throw Error(kFile, std::string("the result: ") + failure.what() + "; please report this");
  }
}

void write_result(Result& result, const path& path) {
  OutputFile target(path, Existing::replace);
  write_result(result, target);
}

Result read_unguarded(const path& path, bool compare_digests) {
  const InputFile file(path, "name a result of `pipeline run`");
  return read_checked(file, path.string(), Seal::holds, true, {}, compare_digests).result;
}

Result read_result(const path& path, bool unsealed) {
  const std::string place = path.string();
  const InputFile file(path, "name a result of `pipeline run`");
  const Seal seal = seal_of(file, path);
  if (!unsealed) check_seal(seal, place);
  try_reading(file, path, seal, unsealed);
  try {
    Read read = read_checked(file, place, seal, unsealed);
    if (seal != Seal::holds)
      std::fprintf(
          stderr, "warning: %s: %s; its digests hold, its times and attributes are vouched for by nobody\n",
          one_line(place, 4096).c_str(),
          read.older ? "is not sealed, as results of older programs" : "is read although its seal does not hold");
    read.result.vouched = seal == Seal::holds || read.older;
    return std::move(read.result);
  } catch (const std::bad_alloc&) {
    throw too_little_memory(place);
  }
}

}  // namespace pipeline
