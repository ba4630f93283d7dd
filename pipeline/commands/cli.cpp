#include "pipeline/commands/cli.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/commands/export.hpp"
#include "pipeline/commands/list.hpp"
#include "pipeline/commands/score.hpp"
#include "pipeline/commands/show.hpp"
#include "pipeline/commands/verify.hpp"
#include "pipeline/config.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/result/product.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/run.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/detect.hpp"
#include "pipeline/system/threads.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/progress.hpp"
#include "pipeline/terminal/step_range.hpp"
#include "pipeline/terminal/words.hpp"
#include "pipeline/trial.hpp"

namespace pipeline {
namespace {

constexpr std::size_t kMostLine = 1 << 16;  // characters of a message
constexpr char kQuiet[] = "No progress on stderr; the result is printed all the same";
constexpr char kDigests[] = "Print the digest of every group and label, not of the whole alone (--json has them all)";

void on_signal(int signal) {
  stop_wanted = true;
  std::signal(signal, SIG_DFL);  // a second one ends the program at once; the part stays resumable
}

/// Results are lost when stdout is: a full disk behind a redirection must not look like success. Texts of files of
/// others reach no terminal but through here.
void put(const std::string& raw) {
  const std::string text = visible(raw);
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0 ||
      std::ferror(stdout))
    throw Error(kFile, std::string("stdout: cannot be written (") + std::strerror(errno) + ")");
}

void warn(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) std::fprintf(stderr, "warning: %s\n", one_line(line, kMostLine).c_str());
}

/// What is wrong with the words of the command line, and whose help tells more: of the last command that they name.
std::string usage_text(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = &app;
  std::string called = app.get_name();
  while (!command->get_subcommands().empty()) {
    command = command->get_subcommands().front();
    called += " " + command->get_name();
  }
  std::string text = error.what();
  if (dynamic_cast<const CLI::ExtrasError*>(&error)) {  // CLI11 lists them in an order that is not the command line's
    text.clear();
    for (const std::string& word : app.remaining(true)) text += (text.empty() ? "" : " ") + word;
    text += ": not expected here";
    for (const CLI::Option* option : command->get_options())
      if (option->count() > 0 && option->get_items_expected_max() > 1)
        text += "; " + option->get_name() + " takes one value, and is repeated for more";
  }
  return text + "; see " + called + " --help";
}

int finish(const Result& result, const std::string& path, bool json, bool digests) {
  put(json ? result_json(result, path) : result_text(result, digests) + "\n" + path + "\n");
  const std::vector<std::string> bad = failures(result);
  for (const std::string& line : bad) std::fprintf(stderr, "%s\n", one_line(path + ": " + line, kMostLine).c_str());
  return bad.empty() ? kDone : kFailed;
}

/// The part of a run that is not finished has nothing to judge or add to yet.
void refuse_part(const std::string& file) {
  if (std::error_code none; std::filesystem::is_directory(file, none) && file.ends_with(".part"))
    throw Error(kFile, file + ": is an unfinished run; finish it with the same `pipeline run`, then name the result");
}

/// A result for commands that need a whole one of a scene: what stands alone has nothing to judge.
Result whole_result(const std::string& file, bool unsealed) {
  refuse_part(file);
  Result result = read_result(file, unsealed);
  if (const Product* product = stands_alone(result))
    throw Error(kFile, file + ": is " + product->what + ", without poses and answers; name a result of a scene");
  return result;
}

struct VerifyOptions {
  std::string steps = ":";
  std::uint64_t pairs = 10'000;
  bool all = false, unsealed = false;
};

int verify_file(const std::string& file, const VerifyOptions& options, int threads, bool quiet, bool json) {
  check_step_range(options.steps);
  const Result result = whole_result(file, options.unsealed);
  const StepRange steps = step_range(options.steps, result.steps(), file);
  const Verified verified =
      verify(result, steps, options.all ? std::nullopt : std::optional(options.pairs), thread_count(threads), quiet);
  put(json ? verified_json(verified, result, file) : verified_text(verified, result));
  if (!verified.difference) return kDone;
  std::fprintf(stderr, "%s\n", one_line(file + ": " + difference_text(verified, result), kMostLine).c_str());
  return kFailed;
}

int score_file(const std::string& file, const std::string& baseline, const ScoreOptions& options, bool json,
               bool unsealed) {
  const Score scored = score(whole_result(file, unsealed), baseline, options);
  put(json ? score_json(scored, file, baseline) : score_text(scored, baseline));
  if (options.write || scored.same()) return kDone;
  std::fprintf(stderr, "%s: differs from %s; if that is meant, record it with --write\n", file.c_str(),
               baseline.c_str());
  return kFailed;
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
  bool json = false, digests = false;

  CLI::App* run_command = app.add_subcommand("run", "Simulate, decide, detect, score and store one configuration");
  run_command->add_option("CONFIG", config_path, "TOML file, see configs/")->required();
  run_command->add_option("-o,--output", output, "Result file (default: results/<config name>.h5)");
  run_command->add_option("--set", sets, "Overrule a key: --set physics.accuracy=1e-4; repeated for more")
      ->option_text("KEY=VALUE")
      ->allow_extra_args(false);
  run_command
      ->add_option("--threads", options.threads,
                   "Threads of the truth stage, cases of a study at a time (0: all cores)")
      ->check(CLI::Range(0, 1024));
  run_command->add_flag("--force", options.force, "Replace an existing result, discard another unfinished run");
  run_command->add_flag("--quiet", options.quiet, kQuiet);
  run_command->add_flag("--digests", digests, kDigests);
  run_command->add_flag("--json", json, "Print the summary as JSON");

  CLI::App* check_command = app.add_subcommand("check", "Validate a configuration and say what would run");
  check_command->add_option("CONFIG", config_path, "TOML file")->required();
  check_command->add_option("-o,--output", output, "Result file that would be written");
  check_command->add_option("--set", sets, "Overrule a key; repeated for more")
      ->option_text("KEY=VALUE")
      ->allow_extra_args(false);
  check_command->add_flag("--json", json, "Print JSON");

  CLI::App* detect_command =
      app.add_subcommand("detect", "Add or repeat algorithms on the motion and truth of an existing result");
  detect_command->add_option("FILE", file, "Result file")->required();
  detect_command
      ->add_option("--algorithm", added, "One algorithm; repeated for more. None: those of the file's configuration")
      ->option_text("NAME[:knob=value,...][@LABEL]")
      ->allow_extra_args(false);
  detect_command->add_flag("--force", options.force, "Replace answers whose label exists");
  detect_command->add_flag("--quiet", options.quiet, kQuiet);
  detect_command->add_flag("--digests", digests, kDigests);
  detect_command->add_flag("--json", json, "Print the summary as JSON");

  CLI::App* list_command = app.add_subcommand("list", "List what configurations can name");
  list_command->add_option("WHAT", what, "algorithms, scenes, shapes, integrators or problems")
      ->required()
      ->check(CLI::IsMember({"algorithms", "scenes", "shapes", "integrators", "problems"}));
  list_command->add_flag("--json", json, "Print JSON");

  CLI::App* show_command = app.add_subcommand("show", "Summary, provenance and digest of a result");
  show_command->add_option("FILE", file, "Result file, or the FILE.part of an unfinished run")->required();
  show_command->add_flag("--digests", digests, kDigests);
  show_command->add_flag("--json", json, "Print JSON");

  VerifyOptions verify_options;
  CLI::App* verify_command =
      app.add_subcommand("verify", "Recheck the truth of a result with an independent oracle in exact arithmetic");
  verify_command->add_option("FILE", file, "Result file")->required();
  verify_command->add_option("--steps", verify_options.steps,
                             "A:B, from step A up to, not including, B; all by default");
  verify_command
      ->add_option("--pairs", verify_options.pairs, "So many sampled pairs whose boxes touch (10000), always the same")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 62));
  verify_command->add_flag("--all", verify_options.all, "All pairs")->excludes("--pairs");
  verify_command->add_option("--threads", options.threads, "0: all cores")->check(CLI::Range(0, 1024));
  verify_command->add_flag("--quiet", options.quiet, kQuiet);
  verify_command->add_flag("--json", json, "Print JSON");

  std::string baseline;
  double tolerance = 0;
  ScoreOptions score_options;
  CLI::App* score_command = app.add_subcommand("score", "Compare a result with a recorded baseline, or record one");
  score_command->add_option("FILE", file, "Result file")->required();
  score_command->add_option("--against", baseline, "Baseline, a JSON file")->required();
  score_command->add_flag("--write", score_options.write, "Record: make or replace the baseline");
  CLI::Option* times_flag = score_command->add_flag("--times", score_options.times,
                                                    "Compare (or record) times too, as ratios within the run");
  CLI::Option* tolerance_option =
      score_command
          ->add_option("--tolerance", tolerance, "A time ratio changed by more than this factor is a difference")
          ->check(CLI::Range(1.0, 1e6))
          ->needs(times_flag);
  score_command->add_flag("--json", json, "Print JSON");
  ExportOptions vtk;
  std::string steps = ":", vtk_folder;
  CLI::App* export_command = app.add_subcommand("export", "Write steps as VTP files that ParaView opens");
  export_command->add_option("FILE", file, "Result file")->required();
  export_command->add_option("--vtk", vtk_folder, "Folder for the files and their .pvd index")->required();
  export_command->add_option("--steps", steps, "A:B, from step A up to, not including, B; all by default");
  export_command->add_flag("--force", vtk.force, "Replace an earlier export in the folder");
  export_command->add_flag("--quiet", vtk.quiet, "No progress on stderr; the index's path is printed alone");
  for (CLI::App* command : {show_command, detect_command, verify_command, score_command, export_command})
    command->add_flag("--unsealed", options.unsealed,
                      "Read FILE although it was changed since it was written, as by own datasets; digests still hold");

  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {  // --help, --version
    const int code = app.exit(success);
    put("");
    return code;
  } catch (const CLI::ParseError& error) {
    if (app.get_subcommands().empty() && argc > 1 && argv[1][0] != '-')
      throw Error(kUsage, std::string(argv[1]) + ": is no subcommand; see pipeline --help");
    // CLI11's exit codes are not ours, and its message takes two lines.
    throw Error(kUsage, usage_text(app, error));
  }

  if ((run_command->count("--output") || check_command->count("--output")) && output.empty())
    throw Error(kUsage, "-o: must name a file, not nothing");
  options.output = output;
  if (*tolerance_option) {
    if (!(tolerance >= 1)) throw Error(kUsage, "--tolerance: must be a factor of at least 1");  // Range lets nan pass
    score_options.tolerance = tolerance;
  }
  if (*score_command) return score_file(file, baseline, score_options, json, options.unsealed);
  if (*list_command) {
    put(json ? list_json(what) : list_text(what));
    return kDone;
  }
  if (*check_command) {
    const Config config = read_config(config_path, sets);
    warn(config.notes);
    if (const std::string left = left_out(config); !left.empty()) warn({left});
    const std::filesystem::path target = output_path(config, options);
    Plan planned = plan(config);
    refuse_if_too_large(planned, target);
    std::vector<Stage> stages;
    const int threads = thread_count(0);
    if (config.study || planned.count("case_sets") > 0) {
      stages = foreseen_stages(config, planned, threads);
    } else {
      constexpr double kTrial = 1.5;  // s
      const Scene scene = make_scene(config);
      planned = plan(config, scene, threads);
      refuse_if_too_large(planned, target);
      refuse_unfit(scene.bodies, config.algorithms);
      stages = foreseen_stages(config, scene, planned, threads, kTrial);
    }
    const Seconds time = range(stages, config);
    put(json ? plan_json(config, planned, time, target.string()) : plan_text(config, planned, time, target.string()));
    return kDone;
  }
  if (*show_command) {
    if (std::filesystem::is_directory(file)) {
      const CheckpointStatus status = checkpoint_status(file);
      put(json ? checkpoint_json(status, file) : checkpoint_text(status, file));
    } else {
      const Result result = read_result(file, options.unsealed);
      put(json ? result_json(result, file) : result_text(result, digests));
    }
    return kDone;
  }

  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on the size of files is told by write, like a full disk
  verify_options.unsealed = options.unsealed;
  if (*verify_command) return verify_file(file, verify_options, options.threads, options.quiet, json);
  if (*export_command) {
    if (vtk_folder.empty()) throw Error(kUsage, "--vtk: must name a folder, not nothing");
    check_step_range(steps);
    const Result result = whole_result(file, options.unsealed);
    vtk.folder = vtk_folder;
    vtk.name = export_name(file);
    vtk.steps = step_range(steps, result.steps(), file);
    const std::uint64_t mebibytes = (export_bytes(result, vtk) >> 20) + 1;
    if (!vtk.quiet) put(std::to_string(vtk.steps.size()) + " steps, about " + std::to_string(mebibytes) + " MiB\n");
    put(write_vtk(result, vtk).string() + "\n");
    return kDone;
  }
  warn(suspicions());
  if (*run_command) {
    const Config config = read_config(config_path, sets);
    warn(config.notes);
    if (const std::string left = left_out(config); !left.empty()) warn({left});
    return finish(run(config, options), output_path(config, options).string(), json, digests);
  }
  refuse_part(file);
  return finish(detect_again(file, added, options), file, json, digests);
}

}  // namespace

int command_line(int argc, const char* const* argv) {
  try {
    return dispatch(argc, argv);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", one_line(error.what(), kMostLine).c_str());
    return error.code();
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "out of memory: fewer steps, bodies or segments make a run smaller\n");
    return kInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "the program failed: %s\n", one_line(error.what(), kMostLine).c_str());
    return kFailed;
  }
}

}  // namespace pipeline
