#include "pipeline/result/hdf5/trial.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <new>
#include <stdexcept>

#include "pipeline/result/hdf5/h5.hpp"
#include "pipeline/result/hdf5/read.hpp"
#include "pipeline/system/child.hpp"

namespace pipeline {
namespace {

/// What an honest file may take to be read. HDF5's own tables and ours grow with the file (7 bytes a byte were seen, of
/// 5,000 meshes); values are there as read, as poses, and as they are digested.
constexpr std::uint64_t kFreeMemory = 256 << 20, kMemoryPerByte = 16, kMemoryPerValueByte = 6;
// A processor ten times slower than today's inflates and digests this many bytes per second.
constexpr std::uint64_t kSlowBytes = 4 << 20, kSlowValueBytes = 20 << 20;
constexpr std::uint64_t kFreeSeconds = 2;

/// Ends this process's own greed: memory at once, by failing allocations; time by SIGXCPU.
class Greed {
 public:
  explicit Greed(std::uint64_t file_bytes) {
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    memory_ = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) + kFreeMemory + kMemoryPerByte * file_bytes;
    seconds_ = kFreeSeconds + file_bytes / kSlowBytes;
    rlimit now;
    if (getrlimit(RLIMIT_AS, &now) == 0) given_ = now.rlim_cur;
  }
  /// Whether the program was started with less memory than an honest file may take.
  bool is_short() const { return given_ < memory_ + kMemoryPerValueByte * values_; }
  void limit() const {
    rlimit now;
    if (getrlimit(RLIMIT_AS, &now) != 0) return;
    now.rlim_cur = std::min<rlim_t>(given_, memory_ + kMemoryPerValueByte * values_);
    setrlimit(RLIMIT_AS, &now);
    if (getrlimit(RLIMIT_CPU, &now) != 0) return;
    now.rlim_cur = std::min<rlim_t>(now.rlim_max, seconds_ + values_ / kSlowValueBytes);
    setrlimit(RLIMIT_CPU, &now);
  }
  void allow(std::uint64_t value_bytes) {
    values_ += value_bytes;
    limit();
  }

 private:
  std::uint64_t memory_ = 0, seconds_ = 0, values_ = 0;
  rlim_t given_ = RLIM_INFINITY;
};

}  // namespace

Error too_little_memory(const std::string& place) {
  return Error(kFile,
               place + ": needs more memory than there is; free some, or raise the limit of this shell (ulimit -v)");
}

void try_reading(const InputFile& file, const std::filesystem::path& path, Seal seal, bool unsealed) {
  const std::string place = path.string();
  // Deflate makes at most 1032 bytes of one; the child itself sets what its file is worth.
  ChildLimits limits;
  limits.processor_seconds = static_cast<double>(kFreeSeconds + file.size() / kSlowBytes) +
                             static_cast<double>(file.size()) * 1032 / static_cast<double>(kSlowValueBytes);
  limits.wall_seconds = 60 + 10 * limits.processor_seconds;  // of a slow disk, beside other work
  const auto work = [&](std::size_t) -> std::string {
    Greed greed(file.size());
    greed.limit();
    const auto answer = [&](const Error& error) { return std::to_string(error.code()) + " " + error.what(); };
    try {
      {
        const InputFile again(path, "try again");  // the parent's own descriptor is closed in its children
        if (!again.same_as(file))
          throw Error(kFile, place + ": was changed by another program meanwhile; read it again");
        read_checked(again, place, seal, unsealed, [&](std::uint64_t bytes) { greed.allow(bytes); });
      }
      H5close();  // what the library does at its end belongs to the trial
      return "";
    } catch (const Error& error) {
      // Short of memory, HDF5 1.10.8 says that anything is wrong, or corrupts its own.
      return answer(greed.is_short() ? too_little_memory(place) : error);
    } catch (const std::bad_alloc&) {
      if (greed.is_short()) return answer(too_little_memory(place));
      throw std::runtime_error("it wanted more memory than its size explains");
    }
  };
  in_children(1, 1, limits, work, [&](std::size_t, const std::string& said, const std::string& failure) {
    if (!failure.empty() && Greed(file.size()).is_short()) throw too_little_memory(place);
    if (!failure.empty())
      throw Error(kFile, place + ": is damaged (a trial of reading it: " + failure +
                             "); copy it again, or run again with --force");
    if (!said.empty()) throw Error(static_cast<ExitCode>(std::atoi(said.c_str())), said.substr(said.find(' ') + 1));
  });
}

}  // namespace pipeline
