// Reads checked datasets of an HDF5 file: what a result is made of.
#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "pipeline/result/dataset.hpp"
#include "pipeline/result/hdf5/h5.hpp"
#include "pipeline/result/result.hpp"

namespace pipeline {

inline hid_t h5_type(Type type, const h5::Type& text) {
  switch (type) {
    case Type::f64:
      return H5T_IEEE_F64LE;
    case Type::i64:
    case Type::offset:
      return H5T_STD_I64LE;
    case Type::u64:
      return H5T_STD_U64LE;
    case Type::u32:
      return H5T_STD_U32LE;
    case Type::u8:
      return H5T_STD_U8LE;
    case Type::text:
      return text.id();
  }
  return H5I_INVALID_HID;
}

/// Any size, in an expected shape.
inline constexpr std::uint64_t kAny = ~std::uint64_t{0};
using Shape = std::vector<std::uint64_t>;

/// Reads datasets of an open file. Throws h5::Failure when one is missing, has another type or shape, or a size that a
/// file of `file_bytes` cannot hold: before it is allocated.
class Reader {
 public:
  /// Before so many more bytes are read, `wanted` hears of them.
  Reader(hid_t file, std::uint64_t file_bytes, std::function<void(std::uint64_t)> wanted = {})
      : file_(file), file_bytes_(file_bytes), wanted_(std::move(wanted)) {}

  bool has(const std::string& path) const { return h5::exists(file_, path); }
  bool has_attribute(const std::string& object, const std::string& name) const {
    return H5Aexists_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT) > 0;
  }

  template <typename T>
  T attribute(const std::string& object, const std::string& name) const {
    return h5::read_attribute<T>(file_, object, name);
  }

  /// The size of a dataset of one dimension, at most `most`; nothing of it is read.
  std::uint64_t size(const std::string& path, std::uint64_t most) const {
    const h5::Dataset dataset(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), "open " + path);
    const h5::Space space(H5Dget_space(dataset.id()), "shape " + path);
    const bool one = h5::check(H5Sget_simple_extent_ndims(space.id()), "shape " + path) == 1;
    const hssize_t entries = h5::check(H5Sget_simple_extent_npoints(space.id()), "count " + path);
    if (!one || static_cast<std::uint64_t>(entries) > most)
      throw h5::Failure(path + ": has " + std::to_string(entries) + " entries, at most " + std::to_string(most) +
                        " make sense");
    return static_cast<std::uint64_t>(entries);
  }

  /// Values of `type`, which T must match or be made of.
  template <typename T>
  std::vector<T> values(const std::string& path, Type type, const Shape& expected) const {
    const h5::Dataset dataset(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), "open " + path);
    const std::uint64_t elements = opened_elements(dataset, path, type, expected);
    std::vector<T> out(elements * size_of(type) / sizeof(T));
    if (!out.empty())
      h5::check(H5Dread(dataset.id(), h5_type(type, text_), H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()), "read " + path);
    return out;
  }

  template <typename T>
  std::vector<T> values(const std::string& path, const Shape& expected) const {
    return values<T>(path, type_of<T>(), expected);
  }

  /// The values as they lie in memory.
  std::vector<std::byte> bytes(const std::string& path, Type type, const Shape& expected) const {
    return values<std::byte>(path, type, expected);
  }

  std::vector<std::string> texts(const std::string& path, const Shape& expected) const {
    const h5::Dataset dataset(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), "open " + path);
    std::vector<char*> data(opened_elements(dataset, path, Type::text, expected));
    std::vector<std::string> out;
    if (data.empty()) return out;
    h5::check(H5Dread(dataset.id(), text_.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data()), "read " + path);
    for (const char* text : data) out.emplace_back(text ? text : "");
    const h5::Space space(H5Dget_space(dataset.id()), "shape " + path);
    H5Dvlen_reclaim(text_.id(), space.id(), H5P_DEFAULT, data.data());
    return out;
  }

  /// Lists of pairs of a group; sorted within a step, a < b < bodies.
  PairLists pairs(const std::string& group, std::uint64_t steps, std::uint64_t bodies,
                  const std::string& prefix = "") const {
    PairLists out;
    out.offset = values<std::uint64_t>(group + "/" + prefix + (prefix.empty() ? "pair_offset" : "offset"), Type::offset,
                                       {steps + 1});
    out.pair = values<Pair>(group + "/" + prefix + "pair", Type::u32, {kAny, 2});
    if (!sound(out, steps, bodies)) throw h5::Failure(group + ": pairs or offsets are not in order");
    return out;
  }

  /// A column of the rows, from a dataset of as many values. An optional one that is not there is left out.
  template <typename Row, typename T, typename Stored>
  void rows(const std::string& group, const Column<Row, T, Stored>& column, std::vector<Row>& out) const {
    const std::string path = group + "/" + column.name;
    if (is_optional<T> && !has(path)) return;
    const auto fill = [&](auto stored) {
      for (std::size_t r = 0; r < out.size(); ++r) out[r].*column.member = static_cast<T>(std::move(stored[r]));
    };
    if constexpr (std::is_same_v<Stored, std::string>)
      fill(texts(path, {out.size()}));
    else
      fill(values<Stored>(path, {out.size()}));
  }

  /// A column of every algorithm's answers, from a table of rows x algorithms. Likewise.
  template <typename Answer, typename T>
  void answers(const std::string& group, const Column<Answer, std::vector<T>>& column, std::uint64_t rows,
               std::vector<Answer>& out) const {
    const std::string path = group + "/" + column.name;
    if (column.optional && !has(path)) return;
    const std::vector<T> table = values<T>(path, {rows, out.size()});
    for (std::size_t a = 0; a < out.size(); ++a)
      for (std::size_t r = 0; r < rows; ++r) (out[a].*column.member).push_back(table[r * out.size() + a]);
  }

  std::vector<std::string> names_in(const std::string& group, std::uint64_t most) const {
    return h5::names_in(file_, group, most);
  }

  bool was_read(const std::string& path) const { return read_.contains(path); }

 private:
  /// What a dataset would take is checked against what is stored of it, and that against the file. Deflate makes at
  /// most 1032 bytes of one.
  void check_storage(const h5::Dataset& dataset, const std::string& path, std::uint64_t elements, Type type) const {
    constexpr std::uint64_t kMostInflation = 1032;
    const h5::Properties made(H5Dget_create_plist(dataset.id()), "find how " + path + " is stored");
    if (H5Pget_layout(made.id()) == H5D_VIRTUAL || H5Pget_external_count(made.id()) != 0)
      throw h5::Failure(path + ": its values are in another file; a result has none such");
    int deflates = 0;
    for (int i = 0; i < H5Pget_nfilters(made.id()); ++i) {
      unsigned flags;
      std::size_t values = 0;
      const H5Z_filter_t filter =
          H5Pget_filter2(made.id(), static_cast<unsigned>(i), &flags, &values, nullptr, 0, nullptr, nullptr);
      deflates += filter == H5Z_FILTER_DEFLATE;
      if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_FLETCHER32)
        throw h5::Failure(path + ": is packed by filter " + std::to_string(filter) + "; a result uses deflate only");
    }
    const std::uint64_t size = type == Type::text ? 16 : size_of(type);  // of a text its place
    const std::uint64_t stored = elements ? H5Dget_storage_size(dataset.id()) : 0;
    if (read_.insert(path).second) stored_ += stored;
    if (deflates > 1 || stored_ > file_bytes_ || elements / kMostInflation > stored / size)
      throw h5::Failure(path + ": of " + std::to_string(elements) + " values only " + std::to_string(stored) +
                        " bytes are stored");
    if (wanted_) wanted_(elements * size);
  }

  /// The number of elements, after checking type and shape.
  std::uint64_t opened_elements(const h5::Dataset& dataset, const std::string& path, Type type,
                                const Shape& expected) const {
    const h5::Space space(H5Dget_space(dataset.id()), "shape " + path);
    const h5::Type stored(H5Dget_type(dataset.id()), "find the type of " + path);
    Shape shape(h5::check(H5Sget_simple_extent_ndims(space.id()), "shape " + path));
    static_assert(std::is_same_v<hsize_t, unsigned long long> && sizeof(hsize_t) == sizeof(std::uint64_t));
    std::vector<hsize_t> sizes(shape.size());
    H5Sget_simple_extent_dims(space.id(), sizes.data(), nullptr);
    std::ranges::copy(sizes, shape.begin());
    bool same = shape.size() == expected.size();
    for (std::size_t d = 0; same && d < shape.size(); ++d) same = expected[d] == kAny || expected[d] == shape[d];
    // Files of schema version 1 have unsigned offsets.
    const bool older = type == Type::offset && H5Tequal(stored.id(), H5T_STD_U64LE) > 0;
    if (!same || (!older && H5Tequal(stored.id(), h5_type(type, text_)) <= 0))
      throw h5::Failure(path + ": its shape or type is not that of a result");
    std::uint64_t elements = 1;
    for (const std::uint64_t size : shape)
      if (__builtin_mul_overflow(elements, size, &elements)) throw h5::Failure(path + ": has an impossible size");
    check_storage(dataset, path, elements, type);
    return elements;
  }

  hid_t file_;
  std::uint64_t file_bytes_;
  std::function<void(std::uint64_t)> wanted_;
  mutable std::uint64_t stored_ = 0;         // bytes of the file that were read from
  mutable std::set<std::string> read_ = {};  // datasets
  h5::Type text_ = h5::text_type();
};

}  // namespace pipeline
