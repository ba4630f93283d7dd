// Writes a layout as HDF5.
//
// HDF5 writes into memory and the program writes the bytes: a full disk is then an ordinary failed write with its
// errno, while HDF5 1.10 can neither flush nor close a file when the disk is full.
#include <algorithm>
#include <map>

#include "pipeline/result/digest.hpp"
#include "pipeline/result/hdf5/h5.hpp"
#include "pipeline/result/hdf5/reader.hpp"
#include "pipeline/result/layout.hpp"
#include "pipeline/result/seal.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/terminal/error.hpp"

namespace pipeline {
namespace {

using std::filesystem::path;

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
  // The oldest format that holds everything: any reader since HDF5 1.8 reads it. Superblock 0, whose bytes in
  // memory are those of a closed file: later ones have a flag that only closing clears, and a checksum over it.
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

}  // namespace pipeline
