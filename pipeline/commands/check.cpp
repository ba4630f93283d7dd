// `pipeline check`: what a configuration would run, how large it would be and how long it would take.
#include "pipeline/commands/command.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/run.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/detect.hpp"
#include "pipeline/system/threads.hpp"
#include "pipeline/trial.hpp"

namespace pipeline {
namespace {

constexpr double kTrial = 1.5;  // s

/// Throws Error when it would not run.
std::string checked(Config config, const std::filesystem::path& output, bool json) {
  Plan planned = plan(config);
  refuse_if_too_large(planned, output);
  std::vector<Stage> stages;
  const int threads = thread_count(0);
  if (config.study || planned.count("case_sets") > 0) {
    stages = foreseen_stages(config, planned, threads);
  } else {
    const Scene scene = make_scene(config);
    planned = plan(config, scene, threads);
    refuse_if_too_large(planned, output);
    const Heard heard = refuse_unfit(scene.bodies, config.algorithms);
    warn(leave_out(heard.silent, config));
    planned = plan(config, scene, threads);
    planned.abouts = heard.abouts;
    stages = foreseen_stages(config, scene, planned, threads, kTrial);
  }
  const Seconds time = range(stages, config);
  return (json ? plan_json : plan_text)(config, planned, time, output.string());
}

}  // namespace

void add_check(CLI::App& program, int& code) {
  struct Options {
    std::string config, file;
    std::vector<std::string> sets, plugins;
    bool json = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App& command = *program.add_subcommand("check", "Validate a configuration and say what would run");
  add_config(command, o->config, o->sets);
  add_output(command, o->file, "Result file that would be written");
  add_plugin_option(command, o->plugins);
  add_json(command, o->json);
  command.callback([o, &code] {
    const Config config = read_config(o->config, o->sets, o->plugins);
    warn(config.notes);
    if (const std::string left = left_out(config); !left.empty()) warn({left});
    put(checked(config, output_path(config, {.output = o->file}), o->json));
    code = 0;
  });
}

}  // namespace pipeline
