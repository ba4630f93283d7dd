// A result that was edited through HDF5 as the input says: refused in one line, or still what it was. Then the same as
// if the digests had been made anew, as only somebody does who means to: refused, or a result that can be shown.
//
// The HDF5 library itself is not fuzzed: 1.10.8 crashes on some damaged files, which is why the program reads a file in
// a child process first, behind its seal. tests/damage.py damages its bytes.
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "fuzz.hpp"
#include "pipeline/commands/show.hpp"
#include "pipeline/result/hdf5/h5.hpp"
#include "pipeline/result/product.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/terminal/error.hpp"
#include "tests/support/synthetic_result.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using namespace pipeline;
using fuzz::require;

/// The input, taken from its front; zeros follow its end.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  bool any() const { return left_ > 0; }
  std::uint8_t byte() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }
  template <class T>
  const T& of(const std::vector<T>& choices) {
    return choices[byte() % choices.size()];
  }
  std::string text() {
    std::string out(byte() % 16u, '\0');
    for (char& c : out) c = static_cast<char>(byte());
    return out;
  }
  template <class T>
  T number() {
    std::array<std::uint8_t, sizeof(T)> bytes;
    for (std::uint8_t& b : bytes) b = byte();
    T out;
    std::memcpy(&out, bytes.data(), sizeof out);
    return out;
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

/// A result, and what is in its file.
struct Base {
  std::string image, digest;
  std::vector<std::string> datasets, objects;  // paths; objects: groups too
};

/// A scene's result with the least of every product, and one result for each product that is alone.
std::vector<Result> results() {
  std::vector<Result> out = {synthetic_result(2, 5, 1, 2)};
  out[0].bodies.meshes[0] = geometry::box("sphere_16", {1, 1, 1});  // smaller
  Truth& truth = out[0].truth;
  truth.containment = Containment::record;
  for (std::uint32_t step = 0; step < 2; ++step) truth.contained.append(std::vector<Pair>{{0, 3 + step}});
  truth.contained_inside = {3, 0};
  truth.closed_within = {0, 0.5};
  out[0].answers[0].contained_hit = {0, 1};
  out[0].summary[0].contained_hit = 1;
  for (const Product& product : products())
    if (product.place == Product::Place::alone) {
      Result& alone = out.emplace_back();
      alone.title = product.name;
      alone.provenance = out[0].provenance;
      product.sample(alone);
    } else {
      product.sample(out[0]);
    }
  return out;
}

herr_t keep(hid_t, const char* name, const H5O_info_t* info, void* to) {
  Base& base = *static_cast<Base*>(to);
  const std::string path = std::string(name) == "." ? "/" : std::string("/") + name;
  base.objects.push_back(path);
  if (info->type == H5O_TYPE_DATASET) base.datasets.push_back(path);
  return 0;
}

hid_t opened(const std::string& image) {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_core(access, 1 << 16, false);
  H5Pset_file_image(access, const_cast<char*>(image.data()), image.size());
  const hid_t file = H5Fopen("in memory", H5F_ACC_RDWR, access);
  H5Pclose(access);
  return file;
}

Base base_of(Result result, const std::filesystem::path& place) {
  Base out;
  write_result(result, place);
  read_unguarded(place, true);  // throws where it is none
  std::ifstream in(place, std::ios::binary);
  out.image.assign(std::istreambuf_iterator<char>(in), {});
  out.image.erase(out.image.rfind("\ncollision benchmark result, seal "));
  out.digest = result.digest;
  const hid_t file = opened(out.image);
  require(file >= 0, "the result can be opened");
  H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, keep, &out, H5O_INFO_BASIC);
  H5Fclose(file);
  return out;
}

/// Some bytes of a dataset's values become others.
void overwrite(hid_t file, const std::string& path, Input& input) {
  const hid_t dataset = H5Dopen2(file, path.c_str(), H5P_DEFAULT);
  if (dataset < 0) return;
  const hid_t type = H5Dget_type(dataset), space = H5Dget_space(dataset);
  const auto count = std::size_t(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space)));
  if (H5Tis_variable_str(type) > 0) {
    std::string text = input.text() + '\0';
    std::vector<const char*> all(count, text.c_str());
    H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data());
  } else if (count > 0) {
    std::string values(count * H5Tget_size(type), '\0');
    H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    std::size_t at = input.number<std::uint16_t>() % values.size();
    for (const char c : input.text())
      if (at < values.size()) values[at++] = c;
    H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  }
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(dataset);
}

/// A dataset of another type and shape takes the place.
void replace(hid_t file, const std::string& path, Input& input) {
  const h5::Type text = h5::text_type();
  const std::vector<hid_t> types = {H5T_STD_U8LE,   H5T_STD_U32LE,  H5T_STD_U64LE, H5T_STD_I64LE,
                                    H5T_IEEE_F64LE, H5T_IEEE_F32LE, H5T_STD_I32BE, text.id()};
  const hid_t type = input.of(types);
  const int rank = input.byte() % 4;
  hsize_t sizes[4] = {};
  for (int i = 0; i < rank; ++i) sizes[i] = input.byte() % 9u;
  const hid_t space = rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, sizes, nullptr);
  H5Ldelete(file, path.c_str(), H5P_DEFAULT);
  const hid_t dataset = H5Dcreate2(file, path.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Sclose(space);
  if (dataset < 0) return;
  H5Dclose(dataset);
  overwrite(file, path, input);
}

/// An attribute becomes another, of another type, or goes.
void change_attribute(hid_t file, const std::string& path, Input& input) {
  const hid_t object = H5Oopen(file, path.c_str(), H5P_DEFAULT);
  if (object < 0) return;
  char name[80] = "more";
  H5Aget_name_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, input.byte() % 16u, name, sizeof name, H5P_DEFAULT);
  H5Adelete(object, name);
  try {
    switch (input.byte() % 5) {
      case 0:
        h5::write_attribute(object, name, input.text().c_str());
        break;
      case 1:
        h5::write_attribute(object, name, input.number<std::int64_t>());
        break;
      case 2:
        h5::write_attribute(object, name, input.number<double>());
        break;
      case 3:
        h5::write_attribute(object, name, input.byte());
        break;
      default:
        break;
    }
  } catch (const h5::Failure&) {
  }
  H5Oclose(object);
}

std::string edited(const Base& base, Input& input) {
  const hid_t file = opened(base.image);
  for (int i = 0; i < 8 && input.any(); ++i) {
    switch (input.byte() % 5) {
      case 0:
        overwrite(file, input.of(base.datasets), input);
        break;
      case 1:
        replace(file, input.of(base.datasets), input);
        break;
      case 2:
        change_attribute(file, input.of(base.objects), input);
        break;
      case 3:
        H5Ldelete(file, input.of(base.objects).c_str(), H5P_DEFAULT);
        break;
      default: {
        const std::string& from = input.of(base.objects);
        const std::string& to = input.of(base.objects);
        H5Ldelete(file, to.c_str(), H5P_DEFAULT);
        H5Lcreate_hard(file, from.c_str(), H5L_SAME_LOC, to.c_str(), H5P_DEFAULT, H5P_DEFAULT);
      }
    }
  }
  H5Fflush(file, H5F_SCOPE_GLOBAL);
  std::string image(std::size_t(std::max<ssize_t>(0, H5Fget_file_image(file, nullptr, 0))), '\0');
  H5Fget_file_image(file, image.data(), image.size());
  H5Fclose(file);
  return image;
}

void require_usable(const Result& result) {
  result_text(result, true);
  result_json(result, "a.h5");
  for (const std::uint32_t mesh : result.bodies.mesh) require(mesh < result.bodies.meshes.size(), "a body has a mesh");
  for (const geometry::Mesh& mesh : result.bodies.meshes)
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t corner : triangle) require(corner < mesh.vertices.size(), "an index is in range");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const TemporaryFolder place;
  static const std::vector<Base> bases = [] {
    h5::silence();
    std::vector<Base> out;
    for (const Result& result : results()) out.push_back(base_of(result, place / "base.h5"));
    return out;
  }();
  Input input(data, size);
  const Base& base = input.of(bases);
  const std::filesystem::path path = place / "edited.h5";
  std::ofstream(path, std::ios::binary | std::ios::trunc) << edited(base, input);
  for (const bool compare_digests : {true, false}) {
    try {
      const Result result = read_unguarded(path, compare_digests);
      if (compare_digests) require(result.digest == base.digest, "what its digests cover is as it was");
      require_usable(result);
    } catch (const Error& error) {
      require(error.code() == kFile, "a result is code 4");  // a text of the file is in it as it is: main() cuts it
    }
  }
  return 0;
}
