// `pipeline detect`: algorithms on the motion and truth of an existing result.
#include "pipeline/commands/command.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/run.hpp"

namespace pipeline {

void add_detect(CLI::App& program, int& code) {
  struct Options : RunOptions {
    std::string file;
    std::vector<std::string> added;
    bool json = false, digests = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App& command =
      *program.add_subcommand("detect", "Add or repeat algorithms on the motion and truth of an existing result");
  add_file(command, o->file);
  command
      .add_option("--algorithm", o->added,
                  "One algorithm; repeated for more. Without it those of the file's configuration")
      ->option_text("NAME[:knob=value,...][@LABEL]")
      ->allow_extra_args(false);
  add_plugin_option(command, o->plugins);
  command.add_flag("--force", o->force, "Replace answers whose label exists");
  add_quiet(command, o->quiet);
  add_digests(command, o->digests);
  add_unsealed(command, o->unsealed);
  add_json(command, o->json, "Print the summary as JSON");
  command.callback([o, &code] {
    stop_on_signals();
    warn(suspicions());
    refuse_part(o->file);
    code = finish(detect_again(o->file, o->added, *o), o->file, o->json, o->digests);
  });
}

}  // namespace pipeline
