// What reading a result takes: its seal, a trial in a child process, then everything once more here.
#include "pipeline/result/store.hpp"

#include <cstdio>
#include <new>
#include <utility>

#include "pipeline/result/hdf5/read.hpp"
#include "pipeline/result/hdf5/trial.hpp"
#include "pipeline/result/seal.hpp"
#include "pipeline/system/input_file.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

using std::filesystem::path;

void check_seal(Seal seal, const std::string& place) {
  if (seal == Seal::differs)
    throw Error(kFile, place + ": was changed or damaged since it was written (its seal does not hold)" +
                           unsealed_remedy(seal));
  if (seal == Seal::unknown)
    throw Error(kFile, place + ": has a seal of a form that this program does not know" + unsealed_remedy(seal));
}

}  // namespace

Result read_unguarded(const path& path, bool compare_digests) {
  const InputFile file(path, "name a result of `pipeline run`");
  return read_checked(file, path.string(), Seal::holds, true, {}, compare_digests).result;
}

Result read_result(const path& path, bool unsealed) {
  const std::string place = path.string();
  const InputFile file(path, "name a result of `pipeline run`");
  const Seal seal = seal_of(file, path);
  if (!unsealed) check_seal(seal, place);
  try_reading(file, path, seal, unsealed);
  try {
    Read read = read_checked(file, place, seal, unsealed);
    if (seal != Seal::holds)
      std::fprintf(
          stderr, "warning: %s: %s; its digests hold, its times and attributes are vouched for by nobody\n",
          one_line(place, 4096).c_str(),
          read.older ? "is not sealed, as results of older programs" : "is read although its seal does not hold");
    read.result.vouched = seal == Seal::holds || read.older;
    return std::move(read.result);
  } catch (const std::bad_alloc&) {
    throw too_little_memory(place);
  }
}

}  // namespace pipeline
