#include "pipeline/foreign/foreign.hpp"

#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace fs = std::filesystem;

const algorithms::Algorithm& program_row() {
  static const algorithms::Algorithm row{
      .name = "program", .what = "a program of others, asked on its stdin and stdout", .operations_unit = ""};
  return row;
}

Foreign program(const Command& command, const Budget& budget) {
  Foreign out;
  out.row = program_row();
  out.transport = "program";
  out.command = command;
  out.budget = budget;
  out.warm_up = 20;  // engines compile what runs often
  out.start = [command, budget](const geometry::Bodies& bodies, const std::string& label, const std::string& knobs) {
    return started(command, label, bodies, knobs, budget);
  };
  return out;
}

std::map<std::string, fs::path> files_of(const Command& command) {
  std::map<std::string, fs::path> out;
  if (const fs::path program = program_of(command); !program.empty()) out[command.words.front()] = program;
  for (std::size_t i = 1; i < command.words.size(); ++i) {
    std::error_code none;
    if (const fs::path file = command.folder / command.words[i]; fs::is_regular_file(file, none))
      out[command.words[i]] = file;
  }
  return out;
}

std::string text_of(const Command& command) {
  std::string out;
  for (const std::string& word : command.words) {
    const bool plain = !word.empty() && word.find_first_of(" \t\"'") == std::string::npos;
    out += (out.empty() ? "" : " ") + (plain ? one_line(word, 200) : in_quotes(word));
  }
  return out;
}

}  // namespace pipeline
