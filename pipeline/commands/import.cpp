// `pipeline import`: answers that were made elsewhere, scored by the truth of an existing result.
#include "pipeline/commands/command.hpp"
#include "pipeline/imported.hpp"

namespace pipeline {

void add_import(CLI::App& program, int& code) {
  struct Options : ImportOptions {
    std::string file, answers_text, times_text;
    bool json = false, digests = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App& command =
      *program.add_subcommand("import", "Score answers that were made elsewhere, and put them into an existing result");
  add_file(command, o->file);
  command.add_option("ANSWERS", o->answers_text, "CSV with the columns step,a,b: pairs that are reported")->required();
  command.add_option("--label", o->label, "Label of the answers")->option_text("NAME")->required();
  command.add_option("--times", o->times_text, "CSV with the columns step,ns: the time of every step")
      ->option_text("TIMES")
      ->check(must_name("a file"));
  command
      .add_option("--language", o->language,
                  "What the method is written in; says too that the times were taken on this machine")
      ->option_text("TEXT");
  command.add_option("--promise", o->promise, "none, conservative or exact: judged by the truth")
      ->check(CLI::IsMember({"none", "conservative", "exact"}));
  command.add_option("--scope", o->scope, "pair: visited every pair; scene: has a broad phase of its own")
      ->check(CLI::IsMember({"pair", "scene"}));
  command.add_flag("--force", o->force, "Replace answers of that label");
  add_digests(command, o->digests);
  add_unsealed(command, o->unsealed);
  add_json(command, o->json, "Print the summary as JSON");
  command.callback([o, &code] {
    stop_on_signals();
    refuse_part(o->file);
    o->answers = o->answers_text;
    o->times = o->times_text;
    code = finish(import_answers(o->file, *o), o->file, o->json, o->digests);
  });
}

}  // namespace pipeline
