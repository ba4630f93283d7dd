// XXH3-128 from libxxhash; the order and form of what goes in is in the header.
#include "pipeline/result/digest.hpp"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <new>
#include <vector>

#include "pipeline/system/file_bytes.hpp"

namespace pipeline {
namespace {

std::string_view type_name(Type type) {
  switch (type) {
    case Type::f64:
      return "f8";
    case Type::i64:
      return "i8";
    case Type::u64:
    case Type::offset:
      return "u8";
    case Type::u32:
      return "u4";
    case Type::u8:
      return "u1";
    case Type::text:
      return "text";
  }
  return {};
}

/// Adds doubles with every NaN in its one form.
void add_doubles(Digest& digest, std::span<const std::byte> bytes) {
  constexpr std::uint64_t kNaN = 0x7ff8000000000000;
  std::array<std::uint64_t, 4096> block;
  for (std::size_t at = 0; at < bytes.size(); at += sizeof block) {
    const std::size_t size = std::min(sizeof block, bytes.size() - at);
    std::memcpy(block.data(), bytes.data() + at, size);
    const auto part = std::span(block).first(size / sizeof(std::uint64_t));
    for (std::uint64_t& value : part)
      if (std::isnan(std::bit_cast<double>(value))) value = kNaN;
    digest.add(std::as_bytes(part));
  }
}

void add_in_order(Digest& digest, std::vector<const Dataset*> datasets) {
  std::ranges::sort(datasets, {}, [](const Dataset* dataset) -> const std::string& { return dataset->path; });
  for (const Dataset* dataset : datasets) digest.add(*dataset);
}

XXH3_state_t* xxh(void* state) { return static_cast<XXH3_state_t*>(state); }

}  // namespace

void Digest::Free::operator()(void* state) const { XXH3_freeState(xxh(state)); }

Digest::Digest() : state_(XXH3_createState()) {
  if (!state_) throw std::bad_alloc();
  XXH3_128bits_reset(xxh(state_.get()));
}

void Digest::add(std::span<const std::byte> bytes) {
  if (!bytes.empty()) XXH3_128bits_update(xxh(state_.get()), bytes.data(), bytes.size());
}

void Digest::add(std::span<const double> reals) { add_doubles(*this, std::as_bytes(reals)); }

void Digest::add(std::uint64_t integer) {
  static_assert(std::endian::native == std::endian::little);
  add(std::as_bytes(std::span(&integer, 1)));
}

void Digest::add(std::string_view text) {
  add(std::uint64_t{text.size()});
  add(std::as_bytes(std::span(text)));
}

void Digest::add(const Dataset& dataset) {
  add(std::string_view(dataset.path));
  add(type_name(dataset.type));
  add(std::uint64_t{dataset.shape.size()});
  for (const std::uint64_t size : dataset.shape) add(size);
  each_part(dataset, 1, [&](std::uint64_t, std::span<const std::byte> bytes) {
    if (dataset.type == Type::f64)
      add_doubles(*this, bytes);
    else
      add(bytes);
  });
  for (const std::string& text : dataset.text) add(std::string_view(text));
}

std::string Digest::hex() const {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(xxh(state_.get())));
  return pipeline::hex(canonical.digest);
}

bool is_digested(const Dataset& dataset) {
  if (dataset.path == "/config" || dataset.path.ends_with("_ns") || dataset.path.ends_with("_bytes") ||
      dataset.path.starts_with("/machines/"))
    return false;
  return dataset.scale == Scale::none || dataset.path == "/step" || dataset.path == "/body" ||
         dataset.path == "/algorithm";
}

std::map<std::string, std::string> digests(std::span<const Group> groups) {
  std::map<std::string, std::string> out;
  std::vector<const Dataset*> others;
  for (const Group& group : groups) {
    std::vector<const Dataset*> mine;
    for (const Dataset& dataset : group.datasets)
      if (is_digested(dataset)) mine.push_back(&dataset);
    if (group.digested && group.path != "/") {
      Digest digest;
      add_in_order(digest, mine);
      out[group.path] = digest.hex();
    } else {
      others.insert(others.end(), mine.begin(), mine.end());
    }
  }
  Digest root;
  for (const auto& [path, hex] : out) {
    root.add(std::string_view(path));
    root.add(std::string_view(hex));
  }
  add_in_order(root, others);
  out["/"] = root.hex();
  return out;
}

}  // namespace pipeline
