#include "pipeline/cli.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/config.hpp"
#include "pipeline/detect.hpp"
#include "pipeline/error.hpp"
#include "pipeline/progress.hpp"
#include "pipeline/provenance.hpp"
#include "pipeline/run.hpp"
#include "pipeline/scene.hpp"
#include "pipeline/show.hpp"
#include "pipeline/store.hpp"
#include "pipeline/words.hpp"

namespace pipeline {
namespace {

void on_signal(int signal) {
  stop_wanted = true;
  std::signal(signal, SIG_DFL);  // a second one ends the program at once; the part stays resumable
}

/// Results are lost when stdout is: a full disk behind a redirection must not look like success.
void put(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw Error(kFile, "stdout: cannot be written");
}

void warn(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) std::fprintf(stderr, "warning: %s\n", line.c_str());
}

int finish(const Result& result, const std::string& path, bool json) {
  put(json ? result_json(result, path) : result_text(result) + "\n" + path + "\n");
  const std::vector<std::string> bad = failures(result);
  for (const std::string& line : bad) std::fprintf(stderr, "%s: %s\n", path.c_str(), line.c_str());
  return bad.empty() ? kDone : kFailed;
}

int dispatch(int argc, const char* const* argv) {
  CLI::App app{"Benchmark of discrete collision detection between triangle meshes: error against run time."};
  app.name("pipeline");
  app.set_version_flag("--version", version_line());
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.require_subcommand(1);

  std::string config_path, file, what;
  std::vector<std::string> sets, added;
  RunOptions options;
  std::string output;
  bool json = false;

  CLI::App* run_command = app.add_subcommand("run", "Simulate, decide, detect, score and store one configuration");
  run_command->add_option("CONFIG", config_path, "TOML file, see configs/")->required();
  run_command->add_option("-o,--output", output, "Result file (default: results/<config name>.h5)");
  run_command->add_option("--set", sets, "Overrule a key: --set physics.accuracy=1e-4")->allow_extra_args(false);
  run_command->add_option("--threads", options.threads, "Threads of the truth stage (0: all cores)")
      ->check(CLI::Range(0, 1024));
  run_command->add_flag("--force", options.force, "Replace an existing result, discard another unfinished run");
  run_command->add_flag("--quiet", options.quiet, "No progress on stderr");
  run_command->add_flag("--json", json, "Print the summary as JSON");

  CLI::App* check_command = app.add_subcommand("check", "Validate a configuration and say what would run");
  check_command->add_option("CONFIG", config_path, "TOML file")->required();
  check_command->add_option("-o,--output", output, "Result file that would be written");
  check_command->add_option("--set", sets, "Overrule a key")->allow_extra_args(false);
  check_command->add_flag("--json", json, "Print JSON");

  CLI::App* detect_command =
      app.add_subcommand("detect", "Add or repeat algorithms on the motion and truth of an existing result");
  detect_command->add_option("FILE", file, "Result file")->required();
  detect_command
      ->add_option("--algorithm", added,
                   "NAME[:knob=value,...][@LABEL]; repeatable. None: those of the file's configuration")
      ->allow_extra_args(false);
  detect_command->add_flag("--force", options.force, "Replace answers whose label exists");
  detect_command->add_flag("--quiet", options.quiet, "No progress on stderr");
  detect_command->add_flag("--json", json, "Print the summary as JSON");

  CLI::App* list_command = app.add_subcommand("list", "List what configurations can name");
  list_command->add_option("WHAT", what, "algorithms, scenes, shapes, integrators or problems")
      ->required()
      ->check(CLI::IsMember({"algorithms", "scenes", "shapes", "integrators", "problems"}));
  list_command->add_flag("--json", json, "Print JSON");

  CLI::App* show_command = app.add_subcommand("show", "Summary, provenance and digests of a result");
  show_command->add_option("FILE", file, "Result file, or the FILE.part of an unfinished run")->required();
  show_command->add_flag("--json", json, "Print JSON");

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {  // --help, --version
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    // CLI11's exit codes are not ours, and its message takes two lines.
    throw Error(kUsage, std::string(error.what()) + "; see pipeline --help");
  }

  if ((run_command->count("--output") || check_command->count("--output")) && output.empty())
    throw Error(kUsage, "-o: must name a file, not nothing");
  options.output = output;
  if (*list_command) {
    put(json ? list_json(what) : list_text(what));
    return kDone;
  }
  if (*check_command) {
    const Config config = read_config(config_path, sets);
    warn(config.notes);
    const std::filesystem::path target = output_path(config, options);
    const Plan planned = plan(config);
    refuse_if_too_large(planned, target);
    if (!config.study) refuse_unfit(config.scene_kind->make(config).bodies, config.algorithms);
    put(json ? plan_json(config, planned, target.string()) : plan_text(config, planned, target.string()));
    return kDone;
  }
  if (*show_command) {
    if (std::filesystem::is_directory(file)) {
      const PartStatus status = part_status(file);
      put(json ? part_json(status, file) : part_text(status, file));
    } else {
      if (std::error_code none; std::filesystem::exists(file, none) && !std::filesystem::is_regular_file(file, none))
        throw Error(kFile, file + ": is neither a file nor a folder");
      const Result result = read_result(file);
      put(json ? result_json(result, file) : result_text(result));
    }
    return kDone;
  }

  warn(suspicions());
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on the size of files is told by write, like a full disk
  if (*run_command) {
    const Config config = read_config(config_path, sets);
    warn(config.notes);
    return finish(run(config, options), output_path(config, options).string(), json);
  }
  return finish(detect_again(file, added, options), file, json);
}

}  // namespace

int command_line(int argc, const char* const* argv) {
  try {
    return dispatch(argc, argv);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", one_line(error.what(), 1 << 16).c_str());
    return error.code();
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "out of memory: fewer steps, bodies or segments make a run smaller\n");
    return kInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "the program failed: %s\n", one_line(error.what(), 1 << 16).c_str());
    return kFailed;
  }
}

}  // namespace pipeline
