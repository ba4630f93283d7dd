// `pipeline describe`: the command line about itself: the manual page, completion for bash and zsh, and the words that
// completion asks for. All of it is read off the definitions that parse the command line.
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <filesystem>

#include "algorithms/contract/algorithm.hpp"
#include "pipeline/commands/command.hpp"
#include "pipeline/result/provenance.hpp"
#include "pipeline/result/store.hpp"
#include "pipeline/system/own_place.hpp"
#include "pipeline/terminal/error.hpp"

namespace pipeline {
namespace {

std::vector<const CLI::App*> commands_of(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App*) { return true; });
}

/// "-o", "--output" of an option; none of a positional.
std::vector<std::string> words_of(const CLI::Option& option) {
  std::vector<std::string> out;
  for (const std::string& name : option.get_snames()) out.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) out.push_back("--" + name);
  return out;
}

bool is_flag(const CLI::Option& option) { return option.get_items_expected_max() == 0; }

/// What stands for the value: FILE of --output FILE.
std::string value_of(const CLI::Option& option) {
  if (option.get_positional()) return option.get_name(true);
  return is_flag(option) ? "" : option.get_option_text().empty() ? option.get_type_name() : option.get_option_text();
}

// ---- The manual page

/// `text` as roff takes it.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\n')
      out += ' ';
    else
      out += c;
  }
  return out.starts_with('.') || out.starts_with('\'') ? "\\&" + out : out;
}

std::string option_page(const CLI::Option& option) {
  std::string heads;
  for (const std::string& word : words_of(option))
    heads += (heads.empty() ? "" : ", ") + ("\\fB" + roff(word) + "\\fR");
  const std::string value = value_of(option);
  if (!value.empty()) heads += (heads.empty() ? "" : " ") + ("\\fI" + roff(value) + "\\fR");
  return ".TP\n" + heads + "\n" + roff(option.get_description()) + "\n";
}

std::string synopsis(const CLI::App& command) {
  std::string out = ".br\n\\fBpipeline " + roff(command.get_name()) + "\\fR";
  for (const CLI::Option* option : command.get_options())
    if (option->get_positional()) {
      const std::string name = "\\fI" + roff(option->get_name(true)) + "\\fR";
      out += option->get_required() ? " " + name : " [" + name + "]";
    }
  return out + " [\\fIoptions\\fR]\n";
}

std::string page_of(const CLI::App& program) {
  const std::string version = version_line();
  std::string out = ".TH PIPELINE 1 \"\" \"collision-benchmark " + roff(version.substr(0, version.find(' '))) +
                    "\" \"User commands\"\n.SH NAME\npipeline \\- " + roff(program.get_description()) +
                    "\n.SH SYNOPSIS\n";
  for (const CLI::App* command : commands_of(program)) out += synopsis(*command);
  out += ".SH COMMANDS\n";
  for (const CLI::App* command : commands_of(program)) {
    out += ".SS " + command->get_name() + "\n" + roff(command->get_description()) + ".\n";
    for (const CLI::Option* option : command->get_options())
      if (option->get_positional()) out += option_page(*option);
    for (const CLI::Option* option : command->get_options())
      if (!option->get_positional()) out += option_page(*option);
  }
  out += ".SH OPTIONS\n";
  for (const CLI::Option* option : program.get_options()) out += option_page(*option);
  out += ".SH EXIT STATUS\n";
  for (const auto& [code, what] : {std::pair{kDone, "done"},
                                   {kFailed, "the run failed, or the score or check differs"},
                                   {kUsage, "the command line's grammar"},
                                   {kInput, "what the user wrote: configuration, meshes, tables, values of options"},
                                   {kFile, "result and baseline files"},
                                   {kInterrupted, "interrupted; the same command resumes a run"}})
    out += ".TP\n" + std::to_string(code) + "\n" + roff(what) + "\n";
  out +=
      ".SH FILES\nConfigurations that come with the program may be given by name alone; \\fBpipeline describe "
      "places\\fR says where they are, and the adapters, examples and header for methods of your own.\n"
      ".SH SEE ALSO\n.BR collision\\-analysis (1),\n.BR h5dump (1)\n";
  return out;
}

// ---- Completion

/// What a value can be: a set of words that `describe` lists, names of files, or nothing known.
std::string kind_of(const CLI::Option& option) {
  const std::string value = value_of(option);
  if (value == "CONFIG") return "configs";
  if (option.check_lname("algorithm")) return "algorithms";
  if (option.check_lname("label")) return "labels";
  for (const char* file : {"FILE", "LIBRARY", "BASELINE", "ANSWERS", "TIMES", "DIR", "FOLDER"})
    if (value.find(file) != value.npos) return "files";
  return "";
}

/// In single quotes for a shell.
std::string shell(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? "'\\''" : c == '\n' ? " " : std::string(1, c);
  return out + "'";
}

/// Members of an option's set, "{run,show}" in its type.
std::vector<std::string> members_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  std::vector<std::string> out;
  const std::size_t open = type.find('{'), close = type.find('}');
  if (open == type.npos || close == type.npos) return out;
  std::string inside = type.substr(open + 1, close - open - 1);
  for (std::size_t begin = 0; begin <= inside.size();) {
    const std::size_t end = std::min(inside.find(',', begin), inside.size());
    out.push_back(inside.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : " ") + word;
  return out;
}

/// A shell's commands that complete the value of an option, by its kind.
std::string bash_value(const CLI::Option& option) {
  if (const auto members = members_of(option); !members.empty())
    return "COMPREPLY=($(compgen -W " + shell(joined(members)) + " -- \"$word\"))";
  const std::string kind = kind_of(option);
  if (kind == "files") return "compopt -o filenames; COMPREPLY=($(compgen -f -- \"$word\"))";
  if (kind == "configs")
    return "compopt -o filenames; COMPREPLY=($(compgen -f -- \"$word\") $(compgen -W \"$(pipeline describe configs)\" "
           "-- "
           "\"$word\"))";
  if (kind == "labels")
    return "COMPREPLY=($(compgen -W \"$(pipeline describe labels \"${COMP_WORDS[2]}\" 2>/dev/null)\" -- \"$word\"))";
  if (kind == "algorithms") return "COMPREPLY=($(compgen -W \"$(pipeline describe algorithms)\" -- \"$word\"))";
  return "COMPREPLY=()";
}

std::string bash_of(const CLI::App& program) {
  std::string names;
  for (const CLI::App* command : commands_of(program)) names += (names.empty() ? "" : " ") + command->get_name();
  std::string general;
  for (const CLI::Option* option : program.get_options()) general += " " + joined(words_of(*option));
  std::string out =
      "# bash completion for pipeline; made by `pipeline describe bash`\n"
      "_pipeline() {\n"
      "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
      "  COMPREPLY=()\n"
      "  if [ \"$COMP_CWORD\" = 1 ]; then\n    COMPREPLY=($(compgen -W " +
      shell(names + general) + " -- \"$word\"))\n    return\n  fi\n  case ${COMP_WORDS[1]} in\n";
  for (const CLI::App* command : commands_of(program)) {
    out += "  " + command->get_name() + ")\n    case $before in\n";
    std::string all;
    std::string positional = "COMPREPLY=()";
    bool first = true;
    for (const CLI::Option* option : command->get_options()) {
      if (option->get_positional()) {
        if (first) positional = bash_value(*option);
        first = false;
        continue;
      }
      const std::vector<std::string> words = words_of(*option);
      all += (all.empty() ? "" : " ") + joined(words);
      if (is_flag(*option)) continue;
      std::string pattern;
      for (const std::string& word : words) pattern += (pattern.empty() ? "" : "|") + word;
      out += "    " + pattern + ") " + bash_value(*option) + "; return;;\n";
    }
    out += "    esac\n    if [[ $word == -* ]]; then COMPREPLY=($(compgen -W " + shell(all) +
           " -- \"$word\"))\n    else " + positional + "\n    fi;;\n";
  }
  return out + "  esac\n}\ncomplete -F _pipeline pipeline\n";
}

/// The action of _arguments for an option's value.
std::string zsh_value(const CLI::Option& option) {
  if (const auto members = members_of(option); !members.empty()) return "(" + joined(members) + ")";
  const std::string kind = kind_of(option);
  if (kind == "files") return "_files";
  if (kind == "configs") return "_pipeline_configs";
  if (kind == "labels") return "_pipeline_labels";
  if (kind == "algorithms") return "_pipeline_algorithms";
  return "";
}

/// A description within _arguments: no brackets and colons of its own.
std::string zsh_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string zsh_of(const CLI::App& program) {
  std::string out =
      "#compdef pipeline\n# made by `pipeline describe zsh`\n"
      "_pipeline_configs() { _alternative 'files:file:_files' \"names:name:($(pipeline describe configs))\" }\n"
      "_pipeline_algorithms() { compadd -- $(pipeline describe algorithms) }\n"
      "_pipeline_labels() { compadd -- $(pipeline describe labels \"${words[2]}\" 2>/dev/null) }\n"
      "_pipeline() {\n  local line state\n  _arguments -C \\\n";
  for (const CLI::Option* option : program.get_options())
    for (const std::string& word : words_of(*option))
      out += "    " + shell(word + "[" + zsh_text(option->get_description()) + "]") + " \\\n";
  out += "    '1:command:->command' '*::argument:->argument'\n  case $state in\n  command)\n    local -a commands=(\n";
  for (const CLI::App* command : commands_of(program))
    out += "      " + shell(command->get_name() + ":" + zsh_text(command->get_description())) + "\n";
  out += "    )\n    _describe command commands;;\n  argument)\n    case $line[1] in\n";
  for (const CLI::App* command : commands_of(program)) {
    out += "    " + command->get_name() + ")\n      _arguments";
    int place = 0;
    for (const CLI::Option* option : command->get_options()) {
      const std::string value = value_of(*option);
      if (option->get_positional()) {
        out += " \\\n        " + shell(std::to_string(++place) + ":" + zsh_text(value) + ":" + zsh_value(*option));
        continue;
      }
      for (const std::string& word : words_of(*option))
        out += " \\\n        " + shell("*" + word + "[" + zsh_text(option->get_description()) + "]" +
                                       (is_flag(*option) ? "" : ":" + zsh_text(value) + ":" + zsh_value(*option)));
    }
    out += ";;\n";
  }
  return out + "    esac;;\n  esac\n}\n_pipeline \"$@\"\n";
}

// ---- Words

std::string configs() {
  std::vector<std::string> names;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(own_folder("configs"), none))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::ranges::sort(names);
  std::string out;
  for (const std::string& name : names) out += name + "\n";
  return out;
}

std::string algorithm_names() {
  std::string out;
  for (const algorithms::Algorithm& row : algorithms::all()) out += std::string(row.name) + "\n";
  return out;
}

std::string labels(const std::string& file) {
  if (file.empty()) throw Error(kUsage, "describe labels: must be told a result file");
  std::string out;
  for (const Answers& answers : read_result(file).answers) out += answers.label + "\n";
  return out;
}

std::string places() {
  std::string out;
  for (const auto& [what, folder] : {std::pair{"configs", "configs"},
                                     {"adapters", "algorithms/program"},
                                     {"examples", "algorithms/plugin"},
                                     {"engines", "algorithms/peers/web"}})
    if (const std::filesystem::path path = own_folder(folder); !path.empty())
      out += std::string(what) + std::string(10 - std::string(what).size(), ' ') + path.string() + "\n";
  return out;
}

}  // namespace

std::string description(const CLI::App& program, const std::string& what, const std::string& file) {
  if (what == "man") return page_of(program);
  if (what == "bash") return bash_of(program);
  if (what == "zsh") return zsh_of(program);
  if (what == "configs") return configs();
  if (what == "algorithms") return algorithm_names();
  if (what == "labels") return labels(file);
  return places();
}

void add_describe(CLI::App& program, int& code) {
  struct Options {
    std::string what, file;
  };
  const auto o = std::make_shared<Options>();
  CLI::App& command =
      *program.add_subcommand("describe", "Print the manual page, completion for a shell, or where things are");
  command.add_option("WHAT", o->what, "man, bash, zsh, places, configs, algorithms, or labels of FILE")
      ->required()
      ->check(CLI::IsMember({"man", "bash", "zsh", "places", "configs", "algorithms", "labels"}));
  command.add_option("FILE", o->file, "Result file, of labels");
  command.callback([o, &program, &code] {
    put(description(program, o->what, o->file));
    code = 0;
  });
}

}  // namespace pipeline
