#include "pipeline/commands/export.hpp"

#include <openssl/evp.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>
#include <vector>

#include "pipeline/commands/command.hpp"
#include "pipeline/commands/export_csv.hpp"
#include "pipeline/commands/export_folder.hpp"
#include "pipeline/result/output_file.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/stages/truth.hpp"
#include "pipeline/system/file_bytes.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/progress.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace fs = std::filesystem;
namespace {

static_assert(std::endian::native == std::endian::little, "the files say LittleEndian and hold the memory's bytes");

constexpr std::size_t kBlock = std::size_t{1} << 22;  // bytes that are deflated at once

std::string base64(std::span<const unsigned char> bytes) {
  constexpr std::size_t kPart = 3 << 20;  // OpenSSL counts in int; a multiple of 3 needs no padding within
  std::string out(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  std::size_t written = 0;
  for (; !bytes.empty(); bytes = bytes.subspan(std::min(kPart, bytes.size()))) {
    const auto part = bytes.first(std::min(kPart, bytes.size()));
    written += std::size_t(
        EVP_EncodeBlock(reinterpret_cast<unsigned char*>(out.data()) + written, part.data(), int(part.size())));
  }
  out.resize(written);
  return out;
}

/// An array as vtkZLibDataCompressor writes it: base64 of the counts (blocks, bytes of a block, bytes of a last block
/// that is shorter, deflated bytes of each), then base64 of the deflated blocks.
template <class T>
std::string deflated(std::span<const T> values) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
  const std::size_t size = values.size_bytes(), blocks = (size + kBlock - 1) / kBlock;
  std::vector<std::uint64_t> header{blocks, kBlock, size % kBlock};
  std::vector<unsigned char> out;
  for (std::size_t done = 0; done < size; done += kBlock) {
    const std::size_t take = std::min(kBlock, size - done), before = out.size();
    uLongf room = compressBound(uLong(take));
    out.resize(before + room);
    if (compress2(out.data() + before, &room, bytes + done, uLong(take), Z_BEST_SPEED) != Z_OK) throw std::bad_alloc();
    out.resize(before + room);
    header.push_back(room);
  }
  return base64({reinterpret_cast<const unsigned char*>(header.data()), 8 * header.size()}) + base64(out);
}

/// Arrays in their order: the elements that name them, and the data they point at.
class Appended {
 public:
  template <class T>
  std::string array(const std::string& name, const char* type, std::span<const T> values,
                    const std::string& more = "") {
    const std::string element = "<DataArray type=\"" + std::string(type) + "\" Name=\"" + name + "\"" + more +
                                " format=\"appended\" offset=\"" + std::to_string(data_.size()) + "\"/>\n";
    data_ += deflated(values);
    return element;
  }
  const std::string& data() const { return data_; }

 private:
  std::string data_;
};

/// How many of the pairs each body is in.
std::vector<std::uint32_t> per_body(std::span<const Pair> pairs, std::size_t bodies) {
  std::vector<std::uint32_t> count(bodies);
  for (const Pair& pair : pairs) {
    ++count[pair.a];
    ++count[pair.b];
  }
  return count;
}

std::uint64_t triangles_at(const Result& result, std::size_t step) {
  std::uint64_t sum = 0;
  for (std::uint32_t b = 0; b < result.bodies.size(); ++b)
    if (geometry::is_born(result.motion[step][b])) sum += result.bodies.mesh_of(b).triangles.size();
  return sum;
}

std::string file_name(const ExportOptions& options, std::size_t step) {
  const std::string digits = std::to_string(step);
  return options.name + "_" + std::string(6 - std::min<std::size_t>(6, digits.size()), '0') + digits + ".vtp";
}

bool is_step(const ExportOptions& options, const std::string& name) {
  if (!name.starts_with(options.name + "_") || !name.ends_with(".vtp")) return false;
  const std::string step = name.substr(options.name.size() + 1, name.size() - options.name.size() - 5);
  return step.size() >= 6 && step.find_first_not_of("0123456789") == std::string::npos;
}

/// What an earlier export of the same name left in the folder, its index first: without it the rest does not look
/// whole.
std::vector<std::string> earlier(const ExportOptions& options, int folder) {
  std::vector<std::string> found;
  for (const std::string& name : names_in(folder)) {
    const auto killed = new_file_of(name);
    if (name == options.name + ".pvd")
      found.insert(found.begin(), name);
    else if (is_step(options, name) || (killed && is_step(options, *killed)))
      found.push_back(name);
  }
  return found;
}

/// For use in names of XML, where a label of another program's file may hold anything.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : one_line(text, text.size())) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

}  // namespace

std::string export_name(const fs::path& path) {
  std::string name = path.stem().string();
  for (char& c : name)
    if (!std::strchr("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.+-", c)) c = '_';
  return name;
}

std::string vtp(const Result& result, std::size_t step) {
  const geometry::Bodies& bodies = result.bodies;
  const std::vector<geometry::Pose>& poses = result.motion[step];
  std::vector<geometry::Vec3> points;
  std::vector<std::int64_t> corners;
  std::vector<std::uint32_t> body;  // per triangle
  for (std::uint32_t b = 0; b < bodies.size(); ++b) {
    if (!geometry::is_born(poses[b])) continue;
    const geometry::Mesh& mesh = bodies.mesh_of(b);
    const std::size_t base = points.size();
    points.resize(base + mesh.vertices.size());
    geometry::to_world(poses[b], mesh.vertices, std::span(points).subspan(base));
    for (const geometry::Facet& facet : mesh.triangles)
      for (const std::uint32_t corner : facet) corners.push_back(std::int64_t(base + corner));
    body.insert(body.end(), mesh.triangles.size(), b);
  }
  std::vector<std::int64_t> ends(body.size());  // where the corners of each triangle end
  for (std::size_t i = 0; i < ends.size(); ++i) ends[i] = std::int64_t(3 * (i + 1));

  Appended data;
  const auto per_triangle = [&](const std::string& name, std::span<const Pair> pairs) {
    const std::vector<std::uint32_t> count = per_body(pairs, bodies.size());
    std::vector<std::uint32_t> values(body.size());
    std::ranges::transform(body, values.begin(), [&](std::uint32_t b) { return count[b]; });
    return data.array<std::uint32_t>(name, "UInt32", values);
  };

  // Who with whom; none of an array that would be empty.
  static_assert(sizeof(Pair) == 2 * sizeof(std::uint32_t));
  std::string pairs_of_step;
  const auto add_pairs = [&](const std::string& name, std::span<const Pair> pairs) {
    if (pairs.empty()) return;
    const std::span<const std::uint32_t> numbers(&pairs.data()->a, 2 * pairs.size());
    pairs_of_step += data.array<std::uint32_t>(
        name, "UInt32", numbers, " NumberOfComponents=\"2\" NumberOfTuples=\"" + std::to_string(pairs.size()) + "\"");
  };

  const std::vector<Pair> truth = result.truth.scoring(step);
  std::string cells = data.array<std::uint32_t>("body", "UInt32", body) + per_triangle("truth_hits", truth);
  add_pairs("truth_pairs", truth);
  for (const Answers& answers : result.answers) {
    std::vector<Pair> wrong = without(answers.hits.at(step), truth);
    if (result.truth.containment == Containment::record) wrong = without(wrong, result.truth.contained.at(step));
    const std::vector<Pair> missed = without(truth, answers.hits.at(step));
    const std::string label = escaped(answers.label);
    cells += per_triangle("false_positive_" + label, wrong) + per_triangle("false_negative_" + label, missed);
    add_pairs("false_positive_pairs_" + label, wrong);
    add_pairs("false_negative_pairs_" + label, missed);
  }

  const double time[] = {double(step) / result.rate};
  const std::uint64_t number[] = {step};
  std::string names;
  for (const std::string& name : bodies.name) names += name + '\0';
  std::string fields = data.array<double>("TimeValue", "Float64", time, " NumberOfTuples=\"1\"") +
                       data.array<std::uint64_t>("step", "UInt64", number, " NumberOfTuples=\"1\"");
  const std::string text =
      data.array<char>("name", "String", names, " NumberOfTuples=\"" + std::to_string(bodies.size()) + "\"");
  fields += "<Array" + text.substr(std::strlen("<DataArray"));  // of VTK's arrays only numbers are DataArrays

  static_assert(sizeof(geometry::Vec3) == 3 * sizeof(double));
  const std::span<const double> coordinates(reinterpret_cast<const double*>(points.data()), 3 * points.size());
  const std::string point_array = data.array<double>("Points", "Float64", coordinates, " NumberOfComponents=\"3\"");
  const std::string connectivity = data.array<std::int64_t>("connectivity", "Int64", corners);
  const std::string offsets = data.array<std::int64_t>("offsets", "Int64", ends);
  return "<?xml version=\"1.0\"?>\n"
         "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" "
         "compressor=\"vtkZLibDataCompressor\">\n<PolyData>\n<FieldData>\n" +
         fields + pairs_of_step + "</FieldData>\n<Piece NumberOfPoints=\"" + std::to_string(points.size()) +
         "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" +
         std::to_string(body.size()) + "\">\n<CellData Scalars=\"body\">\n" + cells + "</CellData>\n<Points>\n" +
         point_array + "</Points>\n<Polys>\n" + connectivity + offsets +
         "</Polys>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"base64\">\n_" + data.data() +
         "\n</AppendedData>\n</VTKFile>\n";
}

std::uint64_t export_bytes(const Result& result, const ExportOptions& options) {
  refuse_folder(options.folder, options.force, "--vtk");
  std::uint64_t sum = 0, most = 0;
  std::size_t largest = options.steps.first;
  for (std::size_t step = options.steps.first; step < options.steps.last; ++step) {
    const std::uint64_t triangles = triangles_at(result, step);
    if (triangles > most) largest = step;
    most = std::max(most, triangles);
    sum += triangles;
  }
  const std::uint64_t size = vtp(result, largest).size();
  const std::uint64_t bytes =
      most ? std::uint64_t(double(size) * (double(sum) / double(most))) : size * options.steps.size();
  if (bytes > free_disk(options.folder))
    throw Error(kInput, options.folder.string() + ": the export needs about " + std::to_string(bytes >> 20) +
                            " MiB, there are " + std::to_string(free_disk(options.folder) >> 20) +
                            " MiB free; choose another --vtk or fewer --steps");
  return bytes;
}

fs::path write_vtk(const Result& result, const ExportOptions& options) {
  refuse_folder(options.folder, options.force, "--vtk");
  const fs::path path = options.folder / (options.name + ".pvd");
  fs::path place = options.folder;
  try {
    ExportFolder written(options.folder);
    OutputFile index_file(path, Existing::replace);  // two exports of one name do not mix
    for (const std::string& name : earlier(options, written.folder())) {
      place = options.folder / name;
      if (!remove_regular(written.folder(), name)) throw FileFailure("is in the way and cannot be removed");
    }

    Progress progress("export", options.steps.size(), options.quiet);
    std::string index =
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
        "byte_order=\"LittleEndian\">\n<Collection>\n";
    for (std::size_t step = options.steps.first; step < options.steps.last; ++step) {
      stop_if_wanted();
      const std::string name = file_name(options, step);
      place = options.folder / name;
      written.file(name, vtp(result, step));
      index +=
          "<DataSet timestep=\"" + real_text(double(step) / result.rate) + "\" part=\"0\" file=\"" + name + "\"/>\n";
      progress.add(1);
    }
    index += "</Collection>\n</VTKFile>\n";
    index_file.write(std::as_bytes(std::span(index)));
    written.keep();
  } catch (const FileFailure& failure) {
    throw Error(kFile, place.string() + ": " + failure.what() + "; free or allow the place, or choose another --vtk");
  }
  return path;
}

void add_export(CLI::App& program, int& code) {
  struct Options : ExportOptions {
    std::string file, steps_text = ":", folder_text, csv_text;
    bool unsealed = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App& command = *program.add_subcommand("export", "Write a result for other programs: ParaView, or any engine");
  add_file(command, o->file);
  command.add_option("--vtk", o->folder_text, "Folder for the files and their .pvd index")
      ->option_text("DIR")
      ->check(must_name("a folder"));
  command.add_option("--csv", o->csv_text, "Folder for meshes as OBJ, bodies.csv and poses.csv of all steps")
      ->option_text("DIR")
      ->check(must_name("a folder"))
      ->excludes("--vtk");
  add_steps(command, o->steps_text);
  command.add_flag("--force", o->force, "Replace an earlier export in the folder");
  command.add_flag("--quiet", o->quiet, "No progress on stderr; the index's path is printed alone");
  add_unsealed(command, o->unsealed);
  command.callback([o, &code, &command] {
    if (o->folder_text.empty() && o->csv_text.empty())
      throw Error(kUsage, "--vtk or --csv is required; see pipeline export --help");
    if (!o->csv_text.empty() && command.count("--steps") > 0)
      throw Error(kUsage, "--steps: is of --vtk; --csv writes all steps");
    stop_on_signals();
    const Result result = whole_result(o->file, o->unsealed);
    if (!o->csv_text.empty()) {
      for (const fs::path& made : write_csv(result, {o->csv_text, o->force}))
        put((fs::path(o->csv_text) / made).string() + "\n");
      code = kDone;
      return;
    }
    o->folder = o->folder_text;
    o->name = export_name(o->file);
    o->steps = step_range(o->steps_text, result.steps(), o->file);
    const std::uint64_t mebibytes = (export_bytes(result, *o) >> 20) + 1;
    if (!o->quiet) put(std::to_string(o->steps.size()) + " steps, about " + std::to_string(mebibytes) + " MiB\n");
    put(write_vtk(result, *o).string() + "\n");
    code = kDone;
  });
}

}  // namespace pipeline
