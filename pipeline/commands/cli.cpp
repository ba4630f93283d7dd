#include "pipeline/commands/cli.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <string>

#include "pipeline/commands/command.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {

void add_run(CLI::App&, int&);
void add_check(CLI::App&, int&);
void add_detect(CLI::App&, int&);
void add_list(CLI::App&, int&);
void add_show(CLI::App&, int&);
void add_verify(CLI::App&, int&);
void add_score(CLI::App&, int&);
void add_export(CLI::App&, int&);
void add_import(CLI::App&, int&);
void add_work(CLI::App&, int&);
void add_describe(CLI::App&, int&);

namespace {

/// Every command, in the order of --help: each is the file of its name.
constexpr AddCommand kCommands[] = {add_run,   add_check,  add_detect, add_list, add_show,    add_verify,
                                    add_score, add_export, add_import, add_work, add_describe};

constexpr std::size_t kMostLine = 1 << 16;  // characters of a message

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

int dispatch(int argc, const char* const* argv) {
  CLI::App app{"Benchmark of discrete collision detection between triangle meshes: error against run time."};
  app.name("pipeline");
  app.set_version_flag("--version", version_line());
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.require_subcommand(1);
  int code = kDone;
  for (const AddCommand add : kCommands) add(app, code);
  try {
    app.parse(argc, argv);                 // and calls the command
  } catch (const CLI::Success& success) {  // --help, --version
    code = app.exit(success);
    put("");
  } catch (const CLI::ParseError& error) {
    if (app.get_subcommands().empty() && argc > 1 && argv[1][0] != '-')
      throw Error(kUsage, std::string(argv[1]) + ": is no subcommand; see pipeline --help");
    throw Error(kUsage, usage_text(app, error));  // CLI11's exit codes are not ours, and its message takes two lines
  }
  return code;
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
