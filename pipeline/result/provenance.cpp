#include "pipeline/result/provenance.hpp"

#include <gnu/libc-version.h>
#include <openssl/evp.h>
#include <unistd.h>

#include <ctime>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>

#include "build_info.hpp"
#include "pipeline/physics/simulate.hpp"
#include "pipeline/system/file_bytes.hpp"

namespace pipeline {
namespace fs = std::filesystem;
namespace {

std::string first_line(const fs::path& path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  return line;
}

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

std::string host() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

std::string now_utc() {
  const std::time_t now = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
  return text;
}

std::string libraries_json() {
  nlohmann::json libraries;
  const std::string built = BUILD_LIBRARIES;  // "name=version,…"
  for (std::size_t at = 0; at < built.size();) {
    const std::size_t equals = built.find('=', at), comma = std::min(built.find(',', at), built.size());
    libraries[built.substr(at, equals - at)] = built.substr(equals + 1, comma - equals - 1);
    at = comma + 1;
  }
  for (const auto& [name, version] : simulation_libraries()) libraries[name] = version;
  libraries["glibc"] = gnu_get_libc_version();
  return libraries.dump();
}

/// What changes the processor's frequency; empty where nothing does, or nothing is known of it.
std::string scaling_governor() {
  const std::string governor = first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  return governor == "performance" ? "" : governor;
}

}  // namespace

std::string version_line() { return BUILD_VERSION " (" BUILD_GIT_COMMIT ", " BUILD_TYPE ", " BUILD_COMPILER ")"; }

Provenance provenance() {
  Provenance p;
  p.creator = "collision_benchmark " BUILD_VERSION;
  p.git_commit = BUILD_GIT_COMMIT;
  p.build_type = BUILD_TYPE;
  p.compiler = BUILD_COMPILER;
  p.flags = BUILD_FLAGS;
  p.library_versions = libraries_json();
  p.inputs_sha256 = "{}";
  p.date = now_utc();
  p.host = host();
  p.processor = processor();
  return p;
}

Machine machine() {
  const std::string governor = scaling_governor();
  return {.host = host(),
          .processor = processor() + (governor.empty() ? "" : ", frequency governor " + governor),
          .build = BUILD_GIT_COMMIT " " BUILD_TYPE " " BUILD_COMPILER,
          .date = now_utc()};
}

std::vector<std::string> suspicions() {
  std::vector<std::string> lines;
#ifndef NDEBUG
  lines.push_back("this is a debug build: times mean nothing");
#endif
  if (const std::string governor = scaling_governor(); !governor.empty())
    lines.push_back("the processor changes its frequency (governor '" + governor + "'): times are less certain");
  for (const auto& [name, version] : simulation_libraries())
    if (version.find("openblas") != std::string::npos)
      lines.push_back("Simbody runs on " + version + ": motion may differ from that of another processor");
  return lines;
}

std::string sha256(std::string_view bytes) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  EVP_Digest(bytes.data(), bytes.size(), digest, &size, EVP_sha256(), nullptr);
  return hex({digest, size});
}

std::string program_sha256() {
  std::ifstream in("/proc/self/exe", std::ios::binary);
  return sha256(std::string{std::istreambuf_iterator<char>(in), {}});
}

std::uint64_t machine_memory() { return std::uint64_t(sysconf(_SC_PHYS_PAGES)) * std::uint64_t(sysconf(_SC_PAGESIZE)); }

std::uint64_t free_disk(const fs::path& path) {
  std::error_code error;
  fs::path folder = fs::absolute(path).parent_path();
  while (!folder.empty() && !fs::exists(folder, error) && folder != folder.parent_path()) folder = folder.parent_path();
  const fs::space_info space = fs::space(folder, error);
  // Pseudo file systems have no size at all: what is wrong there is better said by whoever tries to write.
  return error || space.capacity == 0 ? std::numeric_limits<std::uint64_t>::max() : space.available;
}

}  // namespace pipeline
