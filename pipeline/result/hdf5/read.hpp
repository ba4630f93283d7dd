// Reads a result back and checks that it is one: what the trial in a child process and the program itself do alike.
#pragma once
#include <cstdint>
#include <functional>
#include <string>

#include "pipeline/result/result.hpp"
#include "pipeline/result/seal.hpp"
#include "pipeline/system/input_file.hpp"

namespace pipeline {

struct Read {
  Result result;
  bool older = false;  // from before there were seals
};

/// Reads and checks everything but a seal that is there. Before memory is taken for values, `wanted` hears of them.
/// Throws Error(kFile), std::bad_alloc.
Read read_checked(const InputFile& file, const std::string& place, Seal seal, bool unsealed,
                  const std::function<void(std::uint64_t)>& wanted = {}, bool compare_digests = true);

/// What is to be done about a seal that does not hold or is missing.
std::string unsealed_remedy(Seal seal);

}  // namespace pipeline
