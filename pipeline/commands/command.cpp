#include "pipeline/commands/command.hpp"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "pipeline/commands/show.hpp"
#include "pipeline/result/product.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/run.hpp"
#include "pipeline/system/own_place.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/progress.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

constexpr std::size_t kMostLine = 1 << 16;  // characters of a message

void on_signal(int signal) {
  stop_wanted = true;
  std::signal(signal, SIG_DFL);  // a second one ends the program at once; the part stays resumable
}

}  // namespace

CLI::Validator must_name(const std::string& what) {
  return CLI::Validator([what](std::string& text) { return text.empty() ? "must name " + what + ", not nothing" : ""; },
                        "");
}

void add_config(CLI::App& command, std::string& path, std::vector<std::string>& sets) {
  command.add_option("CONFIG", path, "TOML file; or the name of one that comes with the program, such as padani")
      ->required()
      ->transform(CLI::Validator(
          [](std::string& written) {
            written = own_config(written);
            return std::string();
          },
          ""));
  command.add_option("--set", sets, "Overrule a key: --set physics.accuracy=1e-4; repeated for more")
      ->option_text("KEY=VALUE")
      ->allow_extra_args(false);
}

void add_plugin_option(CLI::App& command, std::vector<std::string>& libraries) {
  command
      .add_option("--plugin", libraries,
                  "Shared library with methods of others (algorithms/README.md); repeated for more")
      ->option_text("LIBRARY")
      ->allow_extra_args(false)
      ->check(must_name("a shared library"));
}

void add_file(CLI::App& command, std::string& path, const std::string& what) {
  command.add_option("FILE", path, what)->required();
}

void add_output(CLI::App& command, std::string& path, const std::string& what) {
  command.add_option("-o,--output", path, what)->option_text("FILE")->check(must_name("a file"));
}

void add_threads(CLI::App& command, int& threads, const std::string& what) {
  command.add_option("--threads", threads, what + "; 0, as without it: all cores")->check(CLI::Range(0, 1024));
}

void add_quiet(CLI::App& command, bool& quiet) {
  command.add_flag("--quiet", quiet, "No progress on stderr; the result is printed all the same");
}

void add_json(CLI::App& command, bool& json, const std::string& what) { command.add_flag("--json", json, what); }

void add_digests(CLI::App& command, bool& digests) {
  command.add_flag("--digests", digests,
                   "Print the digest of every group and label, not only that of the whole (--json has them all)");
}

void add_unsealed(CLI::App& command, bool& unsealed) {
  command.add_flag("--unsealed", unsealed,
                   "Read FILE although it was changed after it was written, for example by datasets of your own; its "
                   "digests must hold all the same");
}

void add_steps(CLI::App& command, std::string& steps) {
  command.add_option("--steps", steps, "Steps A up to, not including, B; without it all")
      ->option_text("A:B")
      ->check(CLI::Validator([](std::string& text) { return step_range_flaw(text); }, ""));
}

void put(const std::string& raw) {
  const std::string text = visible(raw);
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0 ||
      std::ferror(stdout))
    throw Error(kFile, std::string("stdout: cannot be written (") + std::strerror(errno) + ")");
}

void tell(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) std::fprintf(stderr, "note: %s\n", one_line(line, kMostLine).c_str());
}

void warn(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) std::fprintf(stderr, "warning: %s\n", one_line(line, kMostLine).c_str());
}

void complain(const std::string& path, const std::string& what) {
  std::fprintf(stderr, "%s\n", one_line(path + ": " + what, kMostLine).c_str());
}

void stop_on_signals() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);
}

void refuse_part(const std::string& file) {
  if (std::error_code none; std::filesystem::is_directory(file, none) && file.ends_with(".part"))
    throw Error(kFile, file + ": is an unfinished run; finish it with the same `pipeline run`, then name the result");
}

Result whole_result(const std::string& file, bool unsealed) {
  refuse_part(file);
  Result result = read_result(file, unsealed);
  if (const Product* product = stands_alone(result))
    throw Error(kFile, file + ": is " + product->what + ", without poses and answers; name a result of a scene");
  return result;
}

int finish(const Result& result, const std::string& path, bool json, bool digests) {
  put(json ? result_json(result, path) : result_text(result, digests) + "\n" + path + "\n");
  const std::vector<std::string> bad = failures(result);
  for (const std::string& line : bad) complain(path, line);
  return bad.empty() ? kDone : kFailed;
}

}  // namespace pipeline
