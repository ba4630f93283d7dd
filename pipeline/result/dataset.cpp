#include "pipeline/result/dataset.hpp"

#include <bit>
#include <functional>
#include <numeric>

namespace pipeline {

static_assert(std::endian::native == std::endian::little, "values are stored as they lie in memory");
static_assert(sizeof(Pair) == 8 && sizeof(geometry::Facet) == 12 && sizeof(geometry::Vec3) == 24,
              "pairs, facets and vertices are stored as they lie in memory");

std::size_t size_of(Type type) {
  switch (type) {
    case Type::f64:
    case Type::i64:
    case Type::u64:
    case Type::offset:
      return 8;
    case Type::u32:
      return 4;
    case Type::u8:
      return 1;
    case Type::text:
      return 0;
  }
  return 0;
}

std::uint64_t Dataset::elements() const {
  return std::accumulate(shape.begin(), shape.end(), std::uint64_t{1}, std::multiplies<>());
}

void each_part(const Dataset& dataset, std::uint64_t multiple,
               const std::function<void(std::uint64_t first, std::span<const std::byte> bytes)>& each) {
  if (!dataset.rows) return each(0, dataset.bytes);
  constexpr std::uint64_t kPart = 1 << 20;  // bytes, about
  const std::uint64_t rows = dataset.shape.at(0);
  const std::uint64_t row_bytes = dataset.elements() / std::max<std::uint64_t>(rows, 1) * size_of(dataset.type);
  const std::uint64_t part =
      multiple * std::max<std::uint64_t>(1, kPart / std::max<std::uint64_t>(multiple * row_bytes, 1));
  for (std::uint64_t first = 0; first < rows; first += part) {
    const std::uint64_t last = std::min(first + part, rows);
    const std::vector<std::byte> bytes = dataset.rows(first, last);
    assert(bytes.size() == (last - first) * row_bytes && "the rows asked for");
    each(first, bytes);
  }
}

std::string_view base_name(std::string_view path) { return path.substr(path.rfind('/') + 1); }

Dataset described(std::string path, Type type, const std::vector<Dimension>& dims, std::string units,
                  std::string long_name) {
  Dataset dataset;
  dataset.path = std::move(path);
  dataset.type = type;
  for (const Dimension& dim : dims) {
    dataset.shape.push_back(dim.size);
    dataset.dims.push_back(dim.scale);
  }
  dataset.units = std::move(units);
  dataset.long_name = std::move(long_name);
  return dataset;
}

Dataset texts(std::string path, std::vector<std::string> values, const std::vector<Dimension>& dims,
              std::string long_name) {
  Dataset dataset = described(std::move(path), Type::text, dims, "1", std::move(long_name));
  dataset.text = std::move(values);
  assert(dataset.text.size() == dataset.elements() && "texts fill the shape");
  return dataset;
}

Dataset scale(Dataset dataset, bool grows) {
  dataset.scale = Scale::values;
  dataset.grows = grows;
  return dataset;
}

Dataset bare_scale(const Dimension& dim, std::string long_name, bool grows) {
  Dataset dataset = described(dim.scale, Type::i64, {dim}, "1", std::move(long_name) + " (a dimension without values)");
  dataset.scale = Scale::bare;
  dataset.grows = grows;
  return dataset;
}

void add_pairs(Group& group, const PairLists& hits, const std::string& what, const Sizes& n,
               const std::string& prefix) {
  const Dimension entry{group.path + "/" + prefix + "entry", hits.pair.size()};
  const std::string offset = prefix.empty() ? "pair_offset" : prefix + "offset";
  group.datasets.push_back(bare_scale(entry, "pairs of all steps, one step after another", true));
  group.datasets.push_back(viewed(group.path + "/" + offset, std::span(hits.offset), {n.boundary}, "1",
                                  "the pairs of step s are entries " + offset + "[s] to " + offset + "[s + 1] - 1",
                                  Type::offset));
  group.datasets.push_back(
      viewed(group.path + "/" + prefix + "pair", std::span(hits.pair), {entry, n.side}, "1", what, Type::u32));
}

}  // namespace pipeline
