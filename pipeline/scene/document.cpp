// TOML behind a plain interface. See document.hpp.
#include "pipeline/scene/document.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

/// What the user wrote, for a message.
std::string text_of(const toml::node& node) {
  if (const auto* value = node.as_string()) return one_line(in_quotes(one_line(value->get(), 50)));
  if (const auto* value = node.as_integer()) return std::to_string(value->get());
  if (const auto* value = node.as_floating_point()) return real_text(value->get());
  if (const auto* value = node.as_boolean()) return value->get() ? "true" : "false";
  if (node.is_table()) return "a table";
  if (const auto* values = node.as_array()) {
    std::string out = "[";
    for (const toml::node& value : *values) {
      if (out.size() > 60) break;
      out += (out.size() > 1 ? ", " : "") + text_of(value);
    }
    return one_line(out + "]");
  }
  std::ostringstream out;
  if (const auto* value = node.as_date()) out << "the date " << value->get();
  if (const auto* value = node.as_time()) out << "the time " << value->get();
  if (const auto* value = node.as_date_time()) out << "the date " << value->get();
  return out.str();
}

/// "a", "a or b", "a, b or c", each in quotes.
std::string alternatives(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i)
    out += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + in_quotes(words[i]);
  return out;
}

std::string integer_rule(std::int64_t least, std::int64_t most) {
  const bool open = most == std::numeric_limits<std::int64_t>::max();
  return open ? "an integer of at least " + std::to_string(least)
              : "an integer between " + std::to_string(least) + " and " + std::to_string(most);
}

/// An array as TOML.
template <class Values>
std::string array_text(const Values& values) {
  std::string out;
  for (const auto& value : values) out += (out.empty() ? "" : ", ") + value_text(value);
  return out.empty() ? out : '[' + out + ']';
}

/// toml++'s own words in one line.
std::string reason(const toml::parse_error& error) {
  std::string why(error.description());
  if (why.starts_with("Error while parsing ")) why.replace(0, std::strlen("Error while parsing"), "in");
  if (why.find("could not determine value type") != std::string::npos) why += "; text stands in quotes";
  return one_line(why, 200);
}

std::unique_ptr<toml::table> parsed(std::string_view text, const std::string& file) {
  const auto where = [&](std::size_t line, std::size_t column) {
    return file + ':' + std::to_string(line) + ':' + std::to_string(column) + ": ";
  };
  // Before toml++, which calls a bad byte by the place of the character before it, and whose depth is unlimited.
  if (const auto flaw = first_flaw(text)) throw Error(kInput, where(flaw->line, flaw->column) + flaw->what);
  try {
    return std::make_unique<toml::table>(toml::parse(text));
  } catch (const toml::parse_error& error) {
    const auto& from = error.source().begin;
    throw Error(kInput, where(from.line, from.column) + "not valid TOML: " + reason(error));
  }
}

/// VALUE of --set KEY=VALUE as the member "value" of a table that has no other.
toml::table parsed_value(const std::string& value, const std::string& place) {
  if (const auto flaw = first_flaw(value)) throw Error(kInput, place + ": " + flaw->what);
  const std::size_t first = value.find_first_not_of(" \t");
  const bool bare = first == std::string::npos || std::strchr("\"'[{", value[first]) == nullptr;
  try {
    toml::table table = toml::parse("value = " + value);
    if (table.size() == 1) return table;
  } catch (const toml::parse_error& error) {
    if (bare) return toml::table{{"value", value}};
    throw Error(kInput, place + ": not a TOML value: " + reason(error));
  }
  throw Error(kInput, place + ": must be one value, not several lines");  // "5\nseed = 2"
}

bool is_index(std::string_view part) {
  return !part.empty() && part.size() < 10 && part.find_first_not_of("0123456789") == std::string_view::npos;
}

/// The member or entry of that name, or nullptr.
template <class Node>
Node* child(Node& node, const std::string& part) {
  if (auto* table = node.as_table()) return table->get(part);
  if (auto* array = node.as_array()) return is_index(part) ? array->get(std::stoul(part)) : nullptr;
  return nullptr;
}

/// The parts of a dotted key, empty ones included.
std::vector<std::string> parts(const std::string& key) {
  std::vector<std::string> out;
  for (std::size_t begin = 0; begin <= key.size();) {
    const std::size_t end = std::min(key.find('.', begin), key.size());
    out.push_back(key.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

/// The dotted key of an array's entry.
std::string entry_of(std::string_view key, std::size_t i) { return std::string(key) + '.' + std::to_string(i); }

}  // namespace

bool Range::holds(double x) const {
  return std::isfinite(x) && (above ? x > least : x >= least) && (below ? x < most : x <= most);
}

std::string Range::rule() const {
  const auto brief = [](double x) {
    const std::string text = real_text(x);
    return text.ends_with(".0") ? text.substr(0, text.size() - 2) : text;
  };
  const bool low = std::isfinite(least), high = std::isfinite(most);
  std::string out = low && high ? "a number" : "a finite number";
  if (low) out += (above ? " above " : " of at least ") + brief(least);
  if (low && high) out += " and";
  if (high) out += (below ? " below " : " at most ") + brief(most);
  return out;
}

// ---- Document ----------------------------------------------------------------------------------------------------

Document::Document(const std::string& text, const std::string& file) : file_(file), root_(parsed(text, file)) {}

Document::Document(const std::map<std::string, std::string>& texts, const std::map<std::string, std::string>& values,
                   const std::string& place)
    : file_(place), root_(std::make_unique<toml::table>()) {
  set_places_[""] = place;
  for (const auto& [key, text] : texts) root_->insert_or_assign(key, text);
  for (const auto& [key, value] : values)
    parsed_value(value, place).get("value")->visit([&](auto& v) { root_->insert_or_assign(key, std::move(v)); });
}

Document::~Document() = default;

void Document::set(const std::string& argument) {
  const std::string place = "--set " + one_line(argument);
  const std::size_t equals = argument.find('=');
  if (equals == std::string::npos) throw Error(kUsage, place + ": must be KEY=VALUE, e.g. --set steps=100");
  std::string key = argument.substr(0, equals);
  key.erase(key.find_last_not_of(" \t") + 1);
  key.erase(0, std::min(key.find_first_not_of(" \t"), key.size()));
  if (key.empty()) throw Error(kUsage, place + ": must be KEY=VALUE, e.g. --set steps=100, not without a key");
  if (const auto flaw = first_flaw(key)) throw Error(kInput, place + ": " + flaw->what);

  toml::table holder = parsed_value(argument.substr(equals + 1), place);
  toml::node& value = *holder.get("value");
  const std::vector<std::string> way = parts(key);
  toml::node* node = root_.get();
  std::string path;  // of `node`
  for (std::size_t i = 0; i < way.size(); ++i) {
    const std::string& part = way[i];
    const bool last = i + 1 == way.size();
    const std::string outer = one_line(path);
    if (part.empty()) throw Error(kInput, place + ": must have no empty part in the key; write TABLE.KEY=VALUE");
    path += (path.empty() ? "" : ".") + part;
    if (toml::table* table = node->as_table()) {
      if (last) {
        value.visit([&](auto& v) { table->insert_or_assign(part, std::move(v)); });
      } else if (!table->contains(part)) {
        if (is_index(way[i + 1]))
          throw Error(kInput, place + ": '" + one_line(path) + "' must be in the configuration before its entry " +
                                  way[i + 1] + " can change; write it there or set all of '" + one_line(path) + "'");
        table->insert(part, toml::table{});
        set_places_[path] = place;
      }
    } else if (toml::array* array = node->as_array()) {
      if (!child(*node, part))
        throw Error(kInput, place + ": '" + outer + "' must be followed by a number below its " +
                                std::to_string(array->size()) + " entries, not '" + one_line(part) + "'");
      if (last) {
        const auto at = array->begin() + std::stol(part);
        value.visit([&](auto& v) { array->insert(array->erase(at), std::move(v)); });
      }
    } else {
      throw Error(kInput,
                  place + ": '" + outer + "' is " + text_of(*node) + " and has no key '" + one_line(part) + "'");
    }
    node = child(*node, part);
  }
  // What an earlier --set put below is gone.
  std::erase_if(set_places_, [&](const auto& entry) { return entry.first.starts_with(path + '.'); });
  set_places_[path] = place;
}

std::string Document::place(std::string path, const toml::node* node) const {
  const toml::source_position none{};
  const toml::source_position& at = node && node != root_.get() ? node->source().begin : none;
  return place(std::move(path), at.line, at.column);
}

std::string Document::place(std::string path, std::uint32_t line, std::uint32_t column) const {
  while (true) {
    if (const auto set = set_places_.find(path); set != set_places_.end()) return set->second;
    if (path.empty()) break;
    path.erase(path.find('.') == std::string::npos ? 0 : path.rfind('.'));
  }
  return line == 0 ? file_ : file_ + ':' + std::to_string(line) + ':' + std::to_string(column);
}

// ---- Section -----------------------------------------------------------------------------------------------------

Section::Section(const Document& document) : Section(document, document.root_.get(), "") {}

Section::Section(const Document& document, const toml::table* table, std::string path)
    : document_(&document), table_(table), path_(std::move(path)) {}

std::string Section::full(std::string_view key) const { return (path_.empty() ? "" : path_ + '.') + std::string(key); }

void Section::tell(std::string_view key, const char* type, const std::string& preset, const std::string& rule) const {
  document_->ear_({full(key), type, preset, rule});
}

const toml::node* Section::node(std::string_view key) const { return table_ ? table_->get(key) : nullptr; }

void Section::refuse_node(std::string_view key, const toml::node& node, const std::string& rule,
                          const std::string& remedy) const {
  throw Error(kInput, document_->place(full(key), &node) + ": '" + full(key) + "' must " + rule + ", not " +
                          text_of(node) + (remedy.empty() ? "" : "; " + remedy));
}

void Section::refuse(std::string_view key, const std::string& rule, const std::string& remedy) const {
  refuse_node(key, *node(key), rule, remedy);
}

void Section::fail(const std::string& text) const {
  throw Error(kInput, document_->place(path_, table_) + ": " + text);
}

const Section& Section::only(const std::vector<std::string>& known) const {
  for (const std::string& key : known)
    if (document_->ear_) tell(key, "", "", "");
  if (!table_) return *this;
  const toml::key* unknown = nullptr;  // the first in the file, to be mended from the top
  const auto position = [](const toml::key& key) {
    return std::pair(key.source().begin.line, key.source().begin.column);
  };
  for (const auto& [key, node] : *table_)
    if (std::ranges::find(known, key.str()) == known.end() && (!unknown || position(key) < position(*unknown)))
      unknown = &key;
  if (unknown) {
    const std::string key = full(unknown->str());
    const auto [line, column] = position(*unknown);
    throw Error(kInput, document_->place(key, line, column) + ": unknown key '" + one_line(key) + "'; " +
                            hint(unknown->str(), known));
  }
  return *this;
}

Section Section::section(std::string_view key) const {
  const toml::node* node = this->node(key);
  if (node && !node->is_table()) refuse(key, "be a table", "write [" + full(key) + "] on a line of its own");
  return Section(*document_, node ? node->as_table() : nullptr, full(key));
}

std::vector<Section> Section::sections(std::string_view key) const {
  std::vector<Section> out;
  const toml::node* node = this->node(key);
  if (!node) return out;
  const std::string remedy = "write [[" + full(key) + "]] above each of them";
  if (!node->is_array()) refuse(key, "be an array of tables", remedy);
  for (const toml::node& entry : *node->as_array()) {
    const std::string name = entry_of(key, out.size());
    if (!entry.is_table()) refuse_node(name, entry, "be a table", remedy);
    out.push_back(Section(*document_, entry.as_table(), full(name)));
  }
  return out;
}

std::string Section::text(std::string_view key, const std::string& preset) const {
  if (document_->ear_) tell(key, "text", preset.empty() ? "" : in_quotes(preset), "text");
  const toml::node* node = this->node(key);
  if (!node) return preset;
  if (!node->is_string()) refuse(key, "be text", "text stands in quotes");
  return node->as_string()->get();
}

std::string Section::choice(std::string_view key, const std::string& preset,
                            const std::vector<std::string>& known) const {
  if (document_->ear_) tell(key, "text", preset.empty() ? "" : in_quotes(preset), alternatives(known));
  const std::string rule = "be " + alternatives(known);
  if (has(key) && !node(key)->is_string()) refuse(key, rule);
  const std::string value = has(key) ? node(key)->as_string()->get() : preset;
  if (!has(key) || std::ranges::find(known, value) != known.end()) return value;
  const std::string meant = nearest(value, known);
  refuse(key, rule, meant.empty() ? "" : "did you mean '" + meant + "'?");
}

std::vector<std::string> Section::choices(std::string_view key, const std::vector<std::string>& preset,
                                          const std::vector<std::string>& known) const {
  if (document_->ear_)
    tell(key, "array", array_text(preset), "an array of at least one text, each " + alternatives(known));
  if (!has(key)) return preset;
  const toml::array* array = node(key)->as_array();
  if (!array || array->empty()) refuse(key, "be an array of at least one text, each " + alternatives(known));
  std::vector<std::string> out;
  for (const toml::node& entry : *array) {
    if (!entry.is_string() || std::ranges::find(known, entry.as_string()->get()) == known.end())
      refuse_node(entry_of(key, out.size()), entry, "be " + alternatives(known));
    out.push_back(entry.as_string()->get());
  }
  return out;
}

std::vector<std::string> Section::texts(std::string_view key) const {
  if (document_->ear_) tell(key, "array", "", "an array of texts");
  std::vector<std::string> out;
  if (!has(key)) return out;
  const toml::array* array = node(key)->as_array();
  if (!array) refuse(key, "be an array of texts");
  for (const toml::node& entry : *array) {
    if (!entry.is_string()) refuse_node(entry_of(key, out.size()), entry, "be text");
    out.push_back(entry.as_string()->get());
  }
  return out;
}

bool Section::boolean(std::string_view key, bool preset) const {
  if (document_->ear_) tell(key, "boolean", preset ? "true" : "false", "true or false");
  if (!has(key)) return preset;
  const auto* value = node(key)->as_boolean();
  if (!value) refuse(key, "be true or false");
  return value->get();
}

std::string Section::place(std::string_view key) const { return document_->place(full(key), node(key)); }

std::int64_t Section::integer_of(std::string_view key, const toml::node& node, std::int64_t least,
                                 std::int64_t most) const {
  const auto* value = node.as_integer();
  if (value && least <= value->get() && value->get() <= most) return value->get();
  refuse_node(key, node, "be " + integer_rule(least, most));
}

double Section::real_of(std::string_view key, const toml::node& node, const Range& range) const {
  double value = std::numeric_limits<double>::quiet_NaN();
  if (const auto* real = node.as_floating_point()) value = real->get();
  if (const auto* integer = node.as_integer()) value = static_cast<double>(integer->get());
  if (!range.holds(value)) refuse_node(key, node, "be " + range.rule());
  return value;
}

std::int64_t Section::integer(std::string_view key, std::int64_t preset, std::int64_t least, std::int64_t most) const {
  if (document_->ear_) tell(key, "integer", preset < least ? "" : std::to_string(preset), integer_rule(least, most));
  return has(key) ? integer_of(key, *node(key), least, most) : preset;
}

double Section::real(std::string_view key, double preset, const Range& range) const {
  if (document_->ear_) tell(key, "number", range.holds(preset) ? real_text(preset) : "", range.rule());
  return has(key) ? real_of(key, *node(key), range) : preset;
}

void Section::integers(std::string_view key, std::span<std::int64_t> values, std::int64_t least,
                       std::int64_t most) const {
  if (document_->ear_)
    tell(key, "array", array_text(values),
         "an array of " + std::to_string(values.size()) + ", each " + integer_rule(least, most));
  if (!has(key)) return;
  const toml::array* array = node(key)->as_array();
  if (!array || array->size() != values.size())
    refuse(key, "be an array of " + std::to_string(values.size()) + " integers");
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = integer_of(entry_of(key, i), *array->get(i), least, most);
}

void Section::reals(std::string_view key, std::span<double> values, const Range& range) const {
  const bool preset = std::ranges::all_of(values, [&](double value) { return range.holds(value); });
  if (document_->ear_)
    tell(key, "array", preset ? array_text(values) : "",
         "an array of " + std::to_string(values.size()) + ", each " + range.rule());
  if (!has(key)) return;
  const toml::array* array = node(key)->as_array();
  if (!array || array->size() != values.size())
    refuse(key, "be an array of " + std::to_string(values.size()) + " numbers");
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = real_of(entry_of(key, i), *array->get(i), range);
}

std::vector<double> Section::numbers(std::string_view key, const std::vector<double>& preset,
                                     const Range& range) const {
  if (document_->ear_) tell(key, "array", array_text(preset), "an array of at least one, each " + range.rule());
  if (!has(key)) return preset;
  const toml::array* array = node(key)->as_array();
  if (!array || array->empty()) refuse(key, "be an array of at least one number");
  std::vector<double> out;
  for (const toml::node& entry : *array) out.push_back(real_of(entry_of(key, out.size()), entry, range));
  return out;
}

std::vector<double> Section::numbers(std::string_view key, const Range& range, bool whole) const {
  if (document_->ear_)
    tell(key, whole ? "integer" : "number", "", range.rule() + (whole ? ", whole" : "") + ", or an array of such");
  std::vector<double> out;
  if (!has(key)) return out;
  const auto add = [&](std::string_view name, const toml::node& entry) {
    out.push_back(real_of(name, entry, range));
    if (whole && out.back() != std::floor(out.back())) refuse_node(name, entry, "be a whole number");
  };
  const toml::array* array = node(key)->as_array();
  if (!array) add(key, *node(key));
  if (array && array->empty()) refuse(key, "be a number or an array of at least one");
  if (array)
    for (const toml::node& entry : *array) add(entry_of(key, out.size()), entry);
  return out;
}

std::vector<std::pair<std::string, double>> Section::named_reals(std::string_view key,
                                                                 const std::vector<std::string>& known,
                                                                 const Range& range) const {
  if (document_->ear_) tell(key, "array", "", "an array of [" + alternatives(known) + ", " + range.rule() + "]");
  std::vector<std::pair<std::string, double>> out;
  if (!has(key)) return out;
  const std::string form = "[" + alternatives(known) + ", number]";
  const toml::array* array = node(key)->as_array();
  if (!array) refuse(key, "be an array of " + form);
  for (const toml::node& entry : *array) {
    const std::string name = entry_of(key, out.size());
    const toml::array* two = entry.as_array();
    if (!two || two->size() != 2 || !two->get(0)->is_string()) refuse_node(name, entry, "be " + form);
    const std::string& word = two->get(0)->as_string()->get();
    if (std::ranges::find(known, word) == known.end())
      refuse_node(name + ".0", *two->get(0), "be " + alternatives(known));
    out.emplace_back(word, real_of(name + ".1", *two->get(1), range));
  }
  return out;
}

std::vector<std::string> Section::keys() const {
  std::vector<std::string> out;
  if (table_)
    for (const auto& [key, node] : *table_) out.emplace_back(key.str());
  std::ranges::sort(out);
  return out;
}

std::optional<Document::Scalar> Section::scalar(std::string_view key) const {
  const toml::node* node = this->node(key);
  if (!node) return std::nullopt;
  if (const auto* v = node->as_boolean()) return v->get();
  if (const auto* v = node->as_integer()) return v->get();
  if (const auto* v = node->as_floating_point()) return v->get();
  if (const auto* v = node->as_string()) return v->get();
  return std::nullopt;
}

}  // namespace pipeline
