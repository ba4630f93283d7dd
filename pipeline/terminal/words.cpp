// Text for people and for files. See words.hpp.
#include "pipeline/terminal/words.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "pipeline/terminal/print.hpp"

namespace pipeline {
namespace {

constexpr int kMostKeyParts = 32;  // our deepest key has 5: scene.set.0.lying.0

/// Length in bytes of the UTF-8 character at the start of `text`, 0 when it is none (RFC 3629: no overlong forms, no
/// surrogates, nothing above U+10FFFF).
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t length = lead < 0xC2 ? 0 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : lead < 0xF5 ? 4 : 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  const bool overlong = (lead == 0xE0 && byte(1) < 0xA0) || (lead == 0xF0 && byte(1) < 0x90);
  const bool no_character = (lead == 0xED && byte(1) > 0x9F) || (lead == 0xF4 && byte(1) > 0x8F);
  return overlong || no_character ? 0 : length;
}

/// Whether a character that is there changes how those around it are shown: controls, which terminals obey, also those
/// of one character (U+0080 to U+009F); marks that turn the direction of text, or are not seen at all, by which a name
/// can look like another (Unicode Technical Report 36); separators of lines and paragraphs.
bool is_control(unsigned code) {
  const auto within = [&](unsigned first, unsigned last) { return first <= code && code <= last; };
  return code < 0x20 || within(0x7F, 0x9F) || code == 0xAD || code == 0x61C || code == 0x180E ||
         within(0x200B, 0x200F) || within(0x2028, 0x202E) || within(0x2060, 0x206F) || code == 0xFEFF ||
         within(0xFFF9, 0xFFFB) || within(0xE0000, 0xE007F);
}

/// The code of a character in UTF-8.
unsigned code_of(std::string_view character) {
  unsigned code = static_cast<unsigned char>(character[0]);
  if (character.size() > 1) code &= 0x7Fu >> character.size();
  for (const char c : character.substr(1)) code = code << 6 | (static_cast<unsigned char>(c) & 0x3Fu);
  return code;
}

/// The first character of `text`, which is taken off it; '?' for a control character or a byte that is no UTF-8.
std::string_view taken_character(std::string_view& text) {
  const std::size_t length = character_length(text);
  const std::string_view character =
      length == 0 || is_control(code_of(text.substr(0, length))) ? "?" : text.substr(0, length);
  text.remove_prefix(std::max<std::size_t>(length, 1));
  return character;
}

/// Edits that turn a into b: insert, delete, replace, swap neighbours (restricted Damerau-Levenshtein).
std::size_t edits(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

}  // namespace

std::string value_text(const Value& value) {
  if (const auto* v = std::get_if<bool>(&value)) return *v ? "true" : "false";
  if (const auto* v = std::get_if<std::int64_t>(&value)) return std::to_string(*v);
  if (const auto* v = std::get_if<double>(&value)) return real_text(*v);
  return in_quotes(std::get<std::string>(value));
}

std::string real_text(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value < 0 ? "-inf" : "inf";
  char buffer[32];
  const std::string text(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return text.find('.') == std::string::npos ? text + ".0" : text;
  // 1e+08 and 1e-05 as people write them: 1e8, 1e-5.
  std::string exponent = text.substr(e + 1);
  const std::string sign = exponent[0] == '-' ? "-" : "";
  exponent.erase(0, exponent.find_first_not_of("+-0"));
  return text.substr(0, e + 1) + sign + exponent;
}

std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04X", static_cast<unsigned>(c));
      out += escape;
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string one_line(std::string_view text, std::size_t most) {
  std::string out;
  for (std::size_t written = 0; !text.empty(); ++written) {
    if (written == most) return out + "...";
    out += taken_character(text);
  }
  return out;
}

std::string visible(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const bool line_end = text[0] == '\n';
    const std::string_view character = taken_character(text);
    out += line_end ? "\n" : character;
  }
  return out;
}

std::string with_controls_escaped(std::string_view json) {
  std::string out;
  while (!json.empty()) {
    const std::string_view character = json.substr(0, std::max<std::size_t>(character_length(json), 1));
    const unsigned code = code_of(character);
    if (code == '\n' || !is_control(code))
      out += character;
    else if (code < 0x10000)
      out += print("\\u%04x", code);
    else
      out += print("\\u%04x\\u%04x", 0xD7C0 + (code >> 10), 0xDC00 + (code & 0x3FF));
    json.remove_prefix(character.size());
  }
  return out;
}

std::optional<Flaw> first_flaw(std::string_view text) {
  Flaw at;
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  std::string_view open;  // the quotes or '#' that hide dots from here on, empty outside of them
  int dots = 0;           // of the key, or whatever this is, since the last separator
  // Steps over `count` characters known to be ASCII and no line end.
  const auto skip = [&](std::size_t count) {
    text.remove_prefix(count);
    at.column += count;
  };
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    const char c = text[0];
    if (length == 0) at.what = "not valid UTF-8; save the file in UTF-8";
    if (c == '\0') at.what = "a NUL byte; the file must be text";
    const bool multi_line = open.size() == 3;
    if (open.empty()) {
      if (c == '.' && ++dots >= kMostKeyParts)
        at.what = "a key of more than " + std::to_string(kMostKeyParts) + " parts";
      if (std::string_view("\n,=[]{}").find(c) != std::string_view::npos) dots = 0;
    }
    if (!at.what.empty()) return at;

    if (c == '\n') {
      if (!multi_line) open = {};  // a comment ends here; so does a string that TOML then refuses
      ++at.line;
      at.column = 1;
      text.remove_prefix(1);
    } else if (open.empty() && c == '#') {
      open = "#";
      skip(1);
    } else if (open.empty() && (c == '"' || c == '\'')) {
      const std::string_view triple = c == '"' ? "\"\"\"" : "'''";
      open = text.starts_with(triple) ? triple : triple.substr(0, 1);
      skip(open.size());
    } else if (!open.empty() && open[0] == '"' && c == '\\' && text.size() > 1 && (text[1] == '"' || text[1] == '\\')) {
      skip(2);
    } else if (!open.empty() && open[0] != '#' && text.starts_with(open)) {
      skip(open.size());
      // The closing three quotes may follow one or two that belong to the text.
      for (int i = 0; multi_line && i < 2 && !text.empty() && text[0] == open[0]; ++i) skip(1);
      open = {};
    } else {
      text.remove_prefix(length);
      ++at.column;
    }
  }
  return std::nullopt;
}

std::string nearest(std::string_view word, const std::vector<std::string>& known) {
  const std::string wanted = lower_case(word);
  std::string best;
  std::size_t fewest = std::max<std::size_t>(word.size() / 3, 1) + 1;
  for (const std::string& candidate : known) {
    // Lengths that differ by as much need as many edits; this also keeps hostile words cheap.
    if (std::max(candidate.size(), wanted.size()) - std::min(candidate.size(), wanted.size()) >= fewest) continue;
    const std::size_t needed = edits(wanted, lower_case(candidate));
    if (needed < fewest && needed < candidate.size()) {
      fewest = needed;
      best = candidate;
    }
  }
  return best;
}

std::string hint(std::string_view word, const std::vector<std::string>& known) {
  const std::string meant = nearest(word, known);
  if (!meant.empty()) return "did you mean '" + meant + "'?";
  std::string list;
  for (const std::string& candidate : known) list += (list.empty() ? "known: " : ", ") + candidate;
  return list;
}

bool valid_label(std::string_view label) {
  constexpr std::string_view kAllowed = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.+-";
  // A label names a group of the file and a folder of the run: "." and ".." mean something else there.
  return !label.empty() && label.size() <= 64 && label.find_first_not_of(kAllowed) == std::string_view::npos &&
         label != "." && label != "..";
}

std::string mebibytes_text(std::uint64_t bytes) {
  return bytes < (1u << 30) ? print("%.1f MiB", double(bytes) / (1 << 20))
                            : print("%.1f GiB", double(bytes) / (1 << 30));
}

std::string bytes_text(std::uint64_t bytes) {
  return bytes < (1u << 20) ? print("%.0f KiB", double(bytes) / 1024) : mebibytes_text(bytes);
}

}  // namespace pipeline
