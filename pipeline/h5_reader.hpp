// Reads checked datasets of an HDF5 file: what store.cpp makes a result of. Part of store.cpp but for its length.
#pragma once
#include <algorithm>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "pipeline/h5.hpp"
#include "pipeline/layout.hpp"
#include "pipeline/result.hpp"

namespace pipeline {

inline hid_t h5_type(Type type, const h5::Type& text) {
  switch (type) {
    case Type::f64:
      return H5T_IEEE_F64LE;
    case Type::i64:
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

/// Reads datasets of an open file. Throws h5::Failure when one is missing or has another type or shape.
class Reader {
 public:
  explicit Reader(hid_t file) : file_(file) {}

  bool has(const std::string& path) const { return h5::exists(file_, path); }
  bool has_attribute(const std::string& object, const std::string& name) const {
    return H5Aexists_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT) > 0;
  }

  template <typename T>
  T attribute(const std::string& object, const std::string& name) const {
    return h5::read_attribute<T>(file_, object, name);
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
    out.offset = values<std::uint64_t>(group + "/" + prefix + (prefix.empty() ? "pair_offset" : "offset"), {steps + 1});
    out.pair = values<Pair>(group + "/" + prefix + "pair", Type::u32, {kAny, 2});
    bool sound = out.offset.front() == 0 && out.offset.back() == out.pair.size() &&
                 std::ranges::is_sorted(out.offset) &&
                 std::ranges::all_of(out.pair, [&](const Pair& pair) { return pair.a < pair.b && pair.b < bodies; });
    for (std::uint64_t s = 0; sound && s < steps; ++s)
      sound = std::ranges::adjacent_find(out.at(s), std::ranges::greater_equal()) == out.at(s).end();
    if (!sound) throw h5::Failure(group + ": pairs or offsets are not in order");
    return out;
  }

  /// A column of the rows, from a dataset of as many values.
  template <typename Row, typename T, typename Stored>
  void rows(const std::string& group, const Column<Row, T, Stored>& column, std::vector<Row>& out) const {
    const std::string path = group + "/" + column.name;
    const auto fill = [&](auto stored) {
      for (std::size_t r = 0; r < out.size(); ++r) out[r].*column.member = static_cast<T>(std::move(stored[r]));
    };
    if constexpr (std::is_same_v<Stored, std::string>)
      fill(texts(path, {out.size()}));
    else
      fill(values<Stored>(path, {out.size()}));
  }

  /// A column of every algorithm's answers, from a table of rows x algorithms.
  template <typename Answer, typename T>
  void answers(const std::string& group, const Column<Answer, std::vector<T>>& column, std::uint64_t rows,
               std::vector<Answer>& out) const {
    const std::vector<T> table = values<T>(group + "/" + column.name, {rows, out.size()});
    for (std::size_t a = 0; a < out.size(); ++a)
      for (std::size_t r = 0; r < rows; ++r) (out[a].*column.member).push_back(table[r * out.size() + a]);
  }

  std::vector<std::string> names_in(const std::string& group) const { return h5::names_in(file_, group); }

 private:
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
    if (!same || H5Tequal(stored.id(), h5_type(type, text_)) <= 0)
      throw h5::Failure(path + ": its shape or type is not that of a result");
    std::uint64_t elements = 1;
    for (const std::uint64_t size : shape) elements *= size;
    return elements;
  }

  hid_t file_;
  h5::Type text_ = h5::text_type();
};

}  // namespace pipeline
