// `pipeline work`: fill chunks of an unfinished run, beside others.
#include "pipeline/work.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "pipeline/commands/command.hpp"
#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/print.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {

void add_work(CLI::App& program, int& code) {
  struct Options : WorkOptions {
    std::string file, given;
    double seconds = kLease.count();
    bool json = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App& command = *program.add_subcommand(
      "work", "Fill chunks of truth and answers of an unfinished run, beside other workers on a shared folder");
  command.add_option("FILE", o->file, "FILE.part of a run: `pipeline run CONFIG --motion-only` makes one")->required();
  command
      .add_option(
          "--config", o->given,
          "The run's configuration, needed where it names programs or libraries: no part starts those by itself")
      ->option_text("CONFIG")
      ->check(must_name("a configuration"));
  command.add_option("--set", o->sets, "Overrule a key of --config, as the run did; repeated for more")
      ->option_text("KEY=VALUE")
      ->allow_extra_args(false)
      ->needs("--config");
  add_plugin_option(command, o->plugins);
  command.get_option("--plugin")->needs("--config");
  add_threads(command, o->threads, "Threads that decide the truth");
  command
      .add_option("--lease", o->seconds,
                  "Seconds after which others take over a chunk of this worker when it shows no life (60)")
      ->option_text("SECONDS")
      ->check(CLI::Range(1.0, 86400.0));
  add_quiet(command, o->quiet);
  add_json(command, o->json, "Print what was done as JSON");
  command.callback([o, &code] {
    stop_on_signals();
    warn(suspicions());
    o->config = o->given;
    o->lease = Lease::Seconds(o->seconds);
    const WorkDone done = work(o->file, *o);
    if (o->json)
      put(dumped(nlohmann::ordered_json{{"file", o->file},
                                        {"truth_chunks", done.truth},
                                        {"answer_chunks", done.answers},
                                        {"assembled", done.assembled}}));
    else
      put(o->file + print(": %zu chunks of truth and %zu of answers made here; ", done.truth, done.answers) +
          (done.assembled ? "the run has all it needs\n"
                          : "nothing is missing: the same `pipeline run` assembles the result\n"));
    code = kDone;
  });
}

}  // namespace pipeline
