// The digest: what a result says, in 128 bits. Equal answers have equal digests on every machine, however the file was
// compressed, chunked or ordered.
//
// XXH3-128 with seed 0 over a stream of bytes; printed as 32 lower-case hexadecimal digits, the high half first (as
// `xxhsum -H2` prints). In the stream every integer is a little-endian uint64, and a text is its length in bytes
// followed by its UTF-8 bytes. A dataset contributes, in this order:
//
//   text     its absolute path
//   text     its type: "f8", "i8", "u8", "u4", "u1" (kind and bytes, little-endian) or "text"; "u8" of offsets (those whose
//            names end in "offset"), which files of schema version 1 store so
//   integer  its rank, then its size along each dimension; a scalar has rank 0
//   values   row-major; numbers as little-endian bytes of their type, every NaN as 0x7ff8000000000000; texts as texts
//
// Which datasets: all but /config, those of /machines, those named *_ns (clocks) or *_bytes (heap) and scales; of the
// scales /step, /body and /algorithm only (the others number or name the entries of a dimension). Attributes do not
// count.
//
// The digest of /motion, /truth and each /answers/<label> is over the datasets directly in that group, in order of path
// (byte by byte). The digest of / is over, for each of those groups in order of path, text path, text digest; then
// over all the other datasets in order of path.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "pipeline/result/dataset.hpp"

namespace pipeline {

/// The name of the function, as the file gives it.
inline constexpr char kDigestAlgorithm[] = "XXH3-128";

/// A digest in the making.
class Digest {
 public:
  Digest();

  void add(std::span<const std::byte> bytes);
  void add(std::span<const double> reals);  // every NaN in its one form
  void add(std::uint64_t integer);
  void add(std::string_view text);
  void add(const Dataset& dataset);

  /// Of what was added so far, 32 digits.
  std::string hex() const;

 private:
  struct Free {
    void operator()(void* state) const;
  };
  std::unique_ptr<void, Free> state_;  // XXH3_state_t, which only digest.cpp knows
};

/// Whether the dataset is part of a digest.
bool is_digested(const Dataset& dataset);

/// The digest of every digested group, "/" among them.
std::map<std::string, std::string> digests(std::span<const Group> groups);

}  // namespace pipeline
