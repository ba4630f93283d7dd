// A TOML document as its reader sees it: tables whose keys are asked for by name, rule and preset, and whose errors
// name the place. The .cpp is the only file that sees toml++.
#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace toml {
inline namespace v3 {
class node;
class table;
}  // namespace v3
}  // namespace toml

namespace pipeline {

/// Which reals are allowed. Only finite ones ever are.
struct Range {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool above = false;  // `least` itself is not allowed
  bool below = false;  // `most` itself is not allowed

  bool holds(double x) const;
  std::string rule() const;  // "a number above 0 and at most 5"
};

/// A key as its reader asks for it.
struct AskedKey {
  std::string path;    // dotted; an entry of an array by its number
  std::string type;    // "integer", "number", "text", "boolean", "array"; "": its name is allowed, no more is known
  std::string preset;  // as TOML; empty: there is none
  std::string rule;    // what follows "must be", e.g. "a number above 0"
};

/// A tree of tables, arrays and values, and where each part of it was written.
class Document {
 public:
  using Scalar = std::variant<bool, std::int64_t, double, std::string>;

  /// TOML `text`; messages call it `file`. Throws Error(kInput), "file:line:column: ...".
  Document(const std::string& text, const std::string& file);

  /// A table of texts and of values in the notation of --set, all at one place. Throws Error(kInput), "place: ...".
  Document(const std::map<std::string, std::string>& texts, const std::map<std::string, std::string>& values,
           const std::string& place);

  ~Document();
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  /// Applies the --set argument "KEY=VALUE". KEY is dotted, an entry of an array is a number from 0; VALUE is TOML, or
  /// a bare word as text. Missing tables are made, entries of arrays must exist. Throws Error(kUsage) without '=' or
  /// KEY, otherwise Error(kInput); "--set KEY=VALUE: ...".
  void set(const std::string& argument);

  /// Tells `ear` of every key that is asked for from now on, whether it is there or not.
  void listen(std::function<void(const AskedKey&)> ear) { ear_ = std::move(ear); }

 private:
  friend class Section;
  /// Where `node` under the dotted `path` was written: file:line:column, or the --set that put it there.
  std::string place(std::string path, const toml::node* node) const;
  std::string place(std::string path, std::uint32_t line, std::uint32_t column) const;

  std::string file_;
  std::unique_ptr<toml::table> root_;
  std::map<std::string, std::string> set_places_;  // dotted path → "--set ..."
  std::function<void(const AskedKey&)> ear_;
};

/// One table of a document, or none: then every key is absent. An absent key gives its preset; whatever breaks a rule
/// is thrown as Error(kInput), "place: 'dotted.key' must RULE, not VALUE; REMEDY". Not to be used after its document.
class Section {
 public:
  /// The whole document.
  explicit Section(const Document& document);

  /// Refuses every key that is not in `known`, naming the nearest. Returns itself.
  const Section& only(const std::vector<std::string>& known) const;

  bool exists() const { return table_ != nullptr; }
  bool has(std::string_view key) const { return node(key) != nullptr; }

  /// The names of its keys, sorted.
  std::vector<std::string> keys() const;

  /// The table of that key.
  Section section(std::string_view key) const;
  /// The tables of [[key]], none when it is absent.
  std::vector<Section> sections(std::string_view key) const;

  std::string text(std::string_view key, const std::string& preset) const;
  std::string choice(std::string_view key, const std::string& preset, const std::vector<std::string>& known) const;
  /// An array, not empty, of members of `known`.
  std::vector<std::string> choices(std::string_view key, const std::vector<std::string>& preset,
                                   const std::vector<std::string>& known) const;
  /// An array of texts; empty when it is absent.
  std::vector<std::string> texts(std::string_view key) const;
  bool boolean(std::string_view key, bool preset) const;
  std::int64_t integer(std::string_view key, std::int64_t preset, std::int64_t least,
                       std::int64_t most = std::numeric_limits<std::int64_t>::max()) const;
  double real(std::string_view key, double preset, const Range& range) const;
  /// Arrays of exactly that many; `values` are presets before and the answer after.
  void integers(std::string_view key, std::span<std::int64_t> values, std::int64_t least, std::int64_t most) const;
  void reals(std::string_view key, std::span<double> values, const Range& range) const;
  /// An array of at least one number.
  std::vector<double> numbers(std::string_view key, const std::vector<double>& preset, const Range& range) const;
  /// A number or an array, not empty, of numbers; none when it is absent. `whole`: without a fraction.
  std::vector<double> numbers(std::string_view key, const Range& range, bool whole = false) const;
  /// An array of [member of `known`, number]; none when it is absent.
  std::vector<std::pair<std::string, double>> named_reals(std::string_view key, const std::vector<std::string>& known,
                                                          const Range& range) const;
  /// The value as it is; empty when it is absent, a date, an array or a table.
  std::optional<Document::Scalar> scalar(std::string_view key) const;

  /// Throws "'key' must RULE, not VALUE; REMEDY" for a key that is there.
  [[noreturn]] void refuse(std::string_view key, const std::string& rule, const std::string& remedy = "") const;
  /// Refuses a key of which `values`, its list, names one twice.
  template <class Values>
  void refuse_twice(std::string_view key, const Values& values) const {
    for (auto value = values.begin(); value != values.end(); ++value)
      if (std::find(values.begin(), value, *value) != value) refuse(key, "name each only once", "remove the second");
  }
  /// Throws `text` with the place of the table.
  [[noreturn]] void fail(const std::string& text) const;
  /// Where a key that is there was written: file:line:column, or the --set.
  std::string place(std::string_view key) const;
  /// The dotted key, as --set spells it.
  std::string full(std::string_view key) const;

 private:
  Section(const Document& document, const toml::table* table, std::string path);
  const toml::node* node(std::string_view key) const;
  /// Where somebody listens.
  void tell(std::string_view key, const char* type, const std::string& preset, const std::string& rule) const;
  [[noreturn]] void refuse_node(std::string_view key, const toml::node& node, const std::string& rule,
                                const std::string& remedy = "") const;
  std::int64_t integer_of(std::string_view key, const toml::node& node, std::int64_t least, std::int64_t most) const;
  double real_of(std::string_view key, const toml::node& node, const Range& range) const;

  const Document* document_;
  const toml::table* table_;
  std::string path_;  // dotted, empty for the whole document
};

}  // namespace pipeline
