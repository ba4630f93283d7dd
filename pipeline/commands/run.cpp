// `pipeline run`: one configuration, from scene to file.
#include "pipeline/run.hpp"

#include "pipeline/commands/command.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/scene/scene.hpp"

namespace pipeline {

void add_run(CLI::App& program, int& code) {
  struct Options : RunOptions {
    std::string config, file;
    std::vector<std::string> sets;
    bool json = false, digests = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App& command = *program.add_subcommand("run", "Simulate, decide, detect, score and store one configuration");
  add_config(command, o->config, o->sets);
  add_output(command, o->file, "Result file; without it results/<name of CONFIG>.h5");
  add_plugin_option(command, o->plugins);
  add_threads(command, o->threads, "Threads of the truth stage, and cases of a study at a time");
  command.add_flag("--force", o->force, "Replace an existing result, discard another unfinished run");
  add_quiet(command, o->quiet);
  add_digests(command, o->digests);
  add_json(command, o->json, "Print the summary as JSON");
  command.callback([o, &code] {
    stop_on_signals();
    warn(suspicions());
    o->output = o->file;
    const Config config = read_config(o->config, o->sets, o->plugins);
    if (!o->quiet) tell(config.understood);
    warn(config.notes);
    if (const std::string left = left_out(config); !left.empty()) warn({left});
    code = finish(run(config, *o), output_path(config, *o).string(), o->json, o->digests);
  });
}

}  // namespace pipeline
