// `pipeline run`: one configuration, from scene to file.
#include "pipeline/run.hpp"

#include "pipeline/commands/command.hpp"
#include "pipeline/commands/show.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/terminal/error.hpp"

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
  command.add_flag("--motion-only", o->motion_only,
                   "Make the motion and leave FILE.part to `pipeline work`; the same run without it assembles");
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
    const std::string output = output_path(config, *o).string();
    const Result result = run(config, *o);
    if (!o->motion_only) {
      code = finish(result, output, o->json, o->digests);
      return;
    }
    const CheckpointStatus status = checkpoint_status(output + ".part");
    put((o->json ? checkpoint_json : checkpoint_text)(status, output + ".part"));
    code = kDone;
  });
}

}  // namespace pipeline
