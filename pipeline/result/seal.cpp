#include "pipeline/result/seal.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <vector>

#include "pipeline/result/digest.hpp"
#include "pipeline/terminal/error.hpp"

namespace pipeline {
namespace {

constexpr std::string_view kMagic = "\ncollision benchmark result, seal ";
constexpr std::string_view kVersion = "1: ";
constexpr std::size_t kDigits = 20;  // of 2^64 - 1
constexpr std::size_t kBlock = 1 << 20;

std::string line(const Digest& digest, std::uint64_t bytes) {
  const std::string number = std::to_string(bytes);
  return std::string(kMagic) + std::string(kVersion) + kDigestAlgorithm + " " + digest.hex() + " of " +
         std::string(kDigits - number.size(), '0') + number + " bytes\n";
}

/// Up to `size` bytes at `at`; fewer at the file's end.
void read_at(const InputFile& file, const std::filesystem::path& path, std::uint64_t at, std::span<std::byte>& into) {
  std::size_t filled = 0;
  while (filled < into.size()) {
    const ssize_t got =
        pread(file.descriptor(), into.data() + filled, into.size() - filled, static_cast<off_t>(at + filled));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      throw Error(kFile, path.string() + ": cannot be read (" + std::strerror(errno) + "); name a result that can be");
    if (got == 0) break;
    filled += static_cast<std::size_t>(got);
  }
  into = into.first(filled);
}

}  // namespace

std::string seal_of(std::span<const std::byte> bytes) {
  Digest digest;
  digest.add(bytes);
  return line(digest, bytes.size());
}

Seal seal_of(const InputFile& file, const std::filesystem::path& path) {
  static const std::size_t kLength = line(Digest(), 0).size();
  if (file.size() < kLength) return Seal::none;
  const std::uint64_t sealed = file.size() - kLength;
  std::vector<std::byte> block(std::clamp<std::uint64_t>(sealed, kLength, kBlock));
  std::span<std::byte> end = std::span(block).first(kLength);
  read_at(file, path, sealed, end);
  const std::string found(reinterpret_cast<const char*>(end.data()), end.size());
  if (!found.starts_with(kMagic)) return Seal::none;
  if (!found.substr(kMagic.size()).starts_with(kVersion)) return Seal::unknown;

  Digest digest;
  for (std::uint64_t at = 0; at < sealed;) {
    std::span<std::byte> part = std::span(block).first(std::min<std::uint64_t>(block.size(), sealed - at));
    read_at(file, path, at, part);
    if (part.empty()) return Seal::differs;  // cut off meanwhile
    digest.add(part);
    at += part.size();
  }
  return found == line(digest, sealed) ? Seal::holds : Seal::differs;
}

}  // namespace pipeline
