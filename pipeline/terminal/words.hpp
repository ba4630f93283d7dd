// Words for messages, and values as text: shared by whatever reads what the user wrote.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace pipeline {

/// A value as a user writes it; of a knob too.
using Value = std::variant<bool, std::int64_t, double, std::string>;

/// A value in the notation that TOML and JSON share.
std::string value_text(const Value& value);

/// TOML as it is written: lines "key = value" under tables.
struct TomlText {
  std::string text;

  void table(std::string_view header) { text += '\n' + std::string(header) + '\n'; }
  void line(std::string_view key, const Value& value) { text += std::string(key) + " = " + value_text(value) + '\n'; }
  template <class Values>
  void list(std::string_view key, const Values& values) {
    text += std::string(key) + " = [";
    bool first = true;
    for (const auto& value : values) {
      text += (first ? "" : ", ") + value_text(value);
      first = false;
    }
    text += "]\n";
  }
};

/// The shortest decimal text that reads back as the same double; always with a point or an exponent ("60.0", "1e8"),
/// so that TOML and JSON readers take it for a real. Not finite: "inf", "-inf", "nan" (TOML only).
std::string real_text(double value);

/// `text` in double quotes with the escapes that TOML and JSON share. `text` must be UTF-8.
std::string in_quotes(std::string_view text);

/// `text` fit for one line of a message: control characters, marks that turn or hide text and invalid UTF-8 become '?',
/// and of more than `most` characters the rest becomes "...".
std::string one_line(std::string_view text, std::size_t most = 60);

/// `text` fit for a terminal: as one_line, but of any length, and line ends stay. Titles, hosts and reasons of files of
/// others may hold sequences that move the cursor, set the window's title or worse.
std::string visible(std::string_view text);

/// JSON of which visible() changes nothing: control characters that JSON allows as they are become escapes.
std::string with_controls_escaped(std::string_view json);

/// A byte at which `text` cannot be TOML, or could harm its parser.
struct Flaw {
  std::size_t line = 1, column = 1;  // from 1, columns in characters; a byte order mark takes none
  std::string what;
};

/// The first of: invalid UTF-8, a NUL, a dotted key of more than 32 parts. The last is valid TOML, but toml++ 3.3 nests
/// one table per part without a limit and its destructor overflows the stack (seen at 100000 parts).
std::optional<Flaw> first_flaw(std::string_view text);

/// The member of `known` that `word` was probably meant to be, or "" when none is near enough: at most one edit per
/// three characters (swapped neighbours are one edit; case does not count).
std::string nearest(std::string_view word, const std::vector<std::string>& known);

/// The remedy for an unknown word: "did you mean 'x'?", or "known: x, y".
std::string hint(std::string_view word, const std::vector<std::string>& known);

/// A size of memory or disk, "85.1 MiB"; in KiB below one of these.
std::string mebibytes_text(std::uint64_t bytes);
std::string bytes_text(std::uint64_t bytes);

/// The rule for labels and names of bodies, meshes and sweeps.
bool valid_label(std::string_view label);
constexpr char kLabelRule[] = "be 1 to 64 characters of A-Z a-z 0-9 _ . + - and neither '.' nor '..'";

}  // namespace pipeline
