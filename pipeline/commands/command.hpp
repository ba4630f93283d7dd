// What commands share: words of their options, what they print, and results as most of them need one.
//
// A command is one file. It adds itself to the program, with its options, their checks and the callback that does the
// work; cli.cpp lists it.
#pragma once
#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "pipeline/result/result.hpp"
#include "pipeline/terminal/step_range.hpp"

namespace pipeline {

/// Adds a command to `program`. Its callback leaves the exit code in `code`, or throws Error.
using AddCommand = void (*)(CLI::App& program, int& code);

// Options that mean the same everywhere.
void add_config(CLI::App& command, std::string& path, std::vector<std::string>& sets);  // CONFIG and --set
void add_plugin_option(CLI::App& command, std::vector<std::string>& libraries);
void add_file(CLI::App& command, std::string& path, const std::string& what = "Result file");
void add_output(CLI::App& command, std::string& path, const std::string& what);
void add_threads(CLI::App& command, int& threads, const std::string& what);
void add_quiet(CLI::App& command, bool& quiet);
void add_json(CLI::App& command, bool& json, const std::string& what = "Print JSON");
void add_digests(CLI::App& command, bool& digests);
void add_unsealed(CLI::App& command, bool& unsealed);
void add_steps(CLI::App& command, std::string& steps);

/// A check of an option's text: not empty. "must name WHAT, not nothing".
CLI::Validator must_name(const std::string& what);

/// Results are lost when stdout is: a full disk behind a redirection must not look like success. Texts of files of
/// others reach no terminal but through here.
void put(const std::string& text);

/// Lines on stderr: "note: ..." and "warning: ..."; what is wrong with the file `path`.
void tell(const std::vector<std::string>& lines);
void warn(const std::vector<std::string>& lines);
void complain(const std::string& path, const std::string& what);

/// Ctrl-C and SIGTERM stop the work within a step (stop_wanted); a limit on the size of files is told by write.
void stop_on_signals();

/// Throws Error(kFile) when `file` is the part of a run that is not finished: it has nothing to judge or add to yet.
void refuse_part(const std::string& file);

/// A result for commands that need a whole one of a scene; a study of integrators has nothing to judge.
Result whole_result(const std::string& file, bool unsealed);

/// Prints a result that was made and what is wrong with it; the exit code.
int finish(const Result& result, const std::string& path, bool json, bool digests);

}  // namespace pipeline
