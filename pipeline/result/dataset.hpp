// Named arrays and groups of them: what a file is made of before it is HDF5, and how values in memory become them.
// Knows names, units and dimensions; knows no HDF5.
#pragma once
#include <algorithm>
#include <cassert>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <ranges>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "pipeline/result/columns.hpp"
#include "pipeline/result/result.hpp"

namespace pipeline {

/// What the elements of a dataset are. Numbers are little-endian. An offset, where a part of a ragged list begins, is
/// never negative and is stored as a signed integer, with which everybody's arrays calculate; to a digest it is
/// unsigned, as it was stored before schema version 2.
enum class Type { f64, i64, u64, u32, u8, text, offset };

/// Bytes of one element; 0 for text.
std::size_t size_of(Type type);

template <typename T>
constexpr Type type_of() {
  if constexpr (std::same_as<T, double>) return Type::f64;
  if constexpr (std::same_as<T, std::int64_t>) return Type::i64;
  if constexpr (std::same_as<T, std::uint64_t>) return Type::u64;
  if constexpr (std::same_as<T, std::uint32_t>) return Type::u32;
  if constexpr (std::same_as<T, std::uint8_t>) return Type::u8;
}

/// A named scalar of a group or dataset.
struct Attribute {
  std::string name;
  std::variant<std::string, std::int64_t, double, std::uint8_t> value;
};

/// What a dataset is to the dimensions of others.
enum class Scale {
  none,
  values,  // a scale with values: step numbers, names
  bare     // gives a dimension its name and size only; no values are stored (netCDF's "dimension without a variable")
};

/// One array. Moves only: `bytes` may point into `owned`, or into the Result it was made from.
struct Dataset {
  std::string path;  // absolute
  Type type = Type::f64;
  std::vector<std::uint64_t> shape;  // empty: a scalar
  std::vector<std::string> dims;     // for every dimension the path of its scale; a scale names itself
  std::string units, long_name;
  std::span<const std::byte> bytes;  // row-major; empty for text and bare scales
  std::vector<std::string> text;     // row-major; of text only
  Scale scale = Scale::none;
  bool grows = false;  // of scales: the dimension is unlimited
  std::vector<Attribute> attributes;
  std::vector<std::byte> owned;
  /// Of what is too large to be laid out beside what it is made of: gives the rows first, ..., last - 1. Then `bytes`
  /// is empty.
  std::function<std::vector<std::byte>(std::uint64_t first, std::uint64_t last)> rows;

  Dataset() = default;
  Dataset(Dataset&&) = default;
  Dataset& operator=(Dataset&&) = default;

  std::uint64_t elements() const;
};

/// Tells `each` the values of a dataset of numbers, part after part: the first row of a part and its bytes. What lies
/// in memory is one part; of others every part but the last has a multiple of `multiple` rows.
void each_part(const Dataset& dataset, std::uint64_t multiple,
               const std::function<void(std::uint64_t first, std::span<const std::byte> bytes)>& each);

/// One group, its attributes and the datasets directly in it.
struct Group {
  std::string path;
  std::vector<Attribute> attributes;
  std::vector<Dataset> datasets;
  bool digested = false;  // it carries a digest of its own
};

/// The last name of a path.
std::string_view base_name(std::string_view path);

// ---- Making them ----

/// A dimension: its size and the path of its scale.
struct Dimension {
  std::string scale;
  std::uint64_t size;
};

/// Sizes that the groups share.
struct Sizes {
  explicit Sizes(const Result& result)
      : step{"/step", result.steps()},
        boundary{"/boundary", result.steps() + 1},
        body{"/body", result.bodies.size()},
        algorithm{"/algorithm", result.answers.size()} {}

  Dimension step, boundary, body, algorithm;
  Dimension axis{"/axis", 3}, component{"/component", 4}, side{"/side", 2};
};

Dataset described(std::string path, Type type, const std::vector<Dimension>& dims, std::string units,
                  std::string long_name);
/// A dataset of what lies in memory elsewhere, row by row.
template <typename T>
Dataset viewed(std::string path, std::span<const T> values, const std::vector<Dimension>& dims, std::string units,
               std::string long_name, Type type = type_of<T>()) {
  Dataset dataset = described(std::move(path), type, dims, std::move(units), std::move(long_name));
  dataset.bytes = std::as_bytes(values);
  assert(dataset.bytes.size() == dataset.elements() * size_of(type) && "values fill the shape");
  return dataset;
}

/// A dataset of values made here.
template <typename T>
Dataset owning(std::string path, const std::vector<T>& values, const std::vector<Dimension>& dims, std::string units,
               std::string long_name) {
  Dataset dataset = described(std::move(path), type_of<T>(), dims, std::move(units), std::move(long_name));
  const auto bytes = std::as_bytes(std::span(values));
  dataset.owned.assign(bytes.begin(), bytes.end());
  dataset.bytes = dataset.owned;
  assert(dataset.bytes.size() == dataset.elements() * size_of(dataset.type) && "values fill the shape");
  return dataset;
}

Dataset texts(std::string path, std::vector<std::string> values, const std::vector<Dimension>& dims,
              std::string long_name);

/// Makes a scale of a dataset; `grows`: of an unlimited dimension.
Dataset scale(Dataset dataset, bool grows = false);

/// A scale without values.
Dataset bare_scale(const Dimension& dim, std::string long_name, bool grows = false);

/// Lists of pairs, with the scale of their ragged dimension, after what the group has.
void add_pairs(Group& group, const PairLists& hits, const std::string& what, const Sizes& n,
               const std::string& prefix = "");

/// What stands for a value that a row does not have.
template <typename T>
constexpr T kAbsent{};
template <>
inline constexpr double kAbsent<double> = std::numeric_limits<double>::quiet_NaN();

/// A column of rows.
template <typename Row, typename T, typename Stored>
Dataset of_rows(const std::string& group, const Column<Row, T, Stored>& column, const std::vector<Row>& rows,
                const Dimension& row) {
  std::vector<Stored> values;
  for (const Row& one : rows) {
    if constexpr (is_optional<T>)
      values.push_back(static_cast<Stored>((one.*column.member).value_or(kAbsent<Stored>)));
    else
      values.push_back(static_cast<Stored>(one.*column.member));
  }
  const std::string path = group + "/" + column.name;
  if constexpr (std::same_as<Stored, std::string>)
    return texts(path, std::move(values), {row}, column.long_name);
  else
    return owning(path, values, {row}, column.units, column.long_name);
}

/// Whether the file has the column: not an optional one of which nobody has values.
template <typename Row, typename T, typename Stored>
bool is_there(const Column<Row, T, Stored>& column, const std::vector<Row>& rows) {
  if constexpr (is_optional<T>)
    return std::ranges::any_of(rows, [&](const Row& row) { return (row.*column.member).has_value(); });
  else if constexpr (std::ranges::range<T> && !std::same_as<T, std::string>)
    return !column.optional || std::ranges::any_of(rows, [&](const Row& row) { return !(row.*column.member).empty(); });
  else
    return true;
}

/// A table of rows x algorithms from a column of every algorithm's answers.
template <typename Answer, typename T>
Dataset of_answers(const std::string& group, const Column<Answer, std::vector<T>>& column,
                   const std::vector<Answer>& answers, const Dimension& row, const Dimension& algorithm) {
  std::vector<T> table(row.size * answers.size());
  for (std::size_t a = 0; a < answers.size(); ++a) {
    const std::vector<T>& values = answers[a].*column.member;
    if (column.optional && values.empty()) continue;
    assert(values.size() == row.size && "a value for every row");
    for (std::size_t r = 0; r < row.size; ++r) table[r * answers.size() + a] = values[r];
  }
  return owning(group + "/" + column.name, table, {row, algorithm}, column.units, column.long_name);
}

}  // namespace pipeline
