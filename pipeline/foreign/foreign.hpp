// A method of others as a configuration names it: what is known of it before it is started, and how that is done.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/foreign/foreign_method.hpp"

namespace pipeline {

struct Foreign {
  algorithms::Algorithm row;  // without `make`; what it says of itself, its hello knows better
  std::string transport;      // "program" or "library"
  Command command;            // of a program
  Budget budget;
  int warm_up = 0;                           // times that its first step is asked before the clock counts
  std::map<std::string, std::string> files;  // as written -> SHA-256, of what it is made of and can be found
  std::function<std::unique_ptr<ForeignMethod>(const geometry::Bodies& bodies, const std::string& label,
                                               const std::string& knobs)>
      start;  // throws Fault
};

/// A program; `row` of every one.
Foreign program(const Command& command, const Budget& budget);
const algorithms::Algorithm& program_row();

/// The files that a command names, as written and where they are: the program, and every word that is a file.
std::map<std::string, std::filesystem::path> files_of(const Command& command);

/// "python3 mine.py", words with blanks in quotes.
std::string text_of(const Command& command);

}  // namespace pipeline
