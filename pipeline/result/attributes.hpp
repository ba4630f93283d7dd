// The attributes of the root, of /run and of every /answers/<label> that are texts or costs, each in one place: its
// name and the member that it is kept in. Whoever writes, reads, checkpoints or prints them loops.
#pragma once
#include <optional>
#include <string>

#include "pipeline/result/result.hpp"

namespace pipeline {

/// What a label costs: an attribute of its answers and a column of /summary.
inline constexpr struct {
  const char* name;
  double Costs::*cost;
  std::optional<double> Summary::*column;
} kCosts[] = {{"setup_ns", &Costs::setup_ns, &Summary::setup_ns},
              {"memory_bytes", &Costs::memory_bytes, &Summary::memory_bytes},
              {"memory_greatest_bytes", &Costs::memory_greatest_bytes, &Summary::memory_greatest_bytes}};

/// A text that is an attribute of a group.
enum class Text { any, json, optional };  // json: of an object; optional: not in the file where it is empty
template <typename Row>
struct TextAttribute {
  const char* name;
  std::string Row::*member;
  Text kind = Text::any;
};

/// Of /answers/<label>.
inline constexpr TextAttribute<Answers> kAnswerTexts[] = {{"name", &Answers::name},
                                                          {"thesis_key", &Answers::thesis_key},
                                                          {"knobs", &Answers::knobs, Text::json},
                                                          {"promise", &Answers::promise},
                                                          {"scope", &Answers::scope},
                                                          {"operations_unit", &Answers::operations_unit},
                                                          {"library", &Answers::library, Text::optional}};
inline constexpr TextAttribute<Machine> kMachineTexts[] = {
    {"host", &Machine::host}, {"processor", &Machine::processor}, {"build", &Machine::build}, {"date", &Machine::date}};
inline constexpr TextAttribute<ForeignFacts> kForeignTexts[] = {{"transport", &ForeignFacts::transport},
                                                                {"command", &ForeignFacts::command},
                                                                {"files_sha256", &ForeignFacts::files, Text::json},
                                                                {"version", &ForeignFacts::version},
                                                                {"language", &ForeignFacts::language},
                                                                {"precision", &ForeignFacts::precision},
                                                                {"tests", &ForeignFacts::tests, Text::optional},
                                                                {"licence", &ForeignFacts::licence, Text::optional},
                                                                {"reason", &ForeignFacts::reason}};

/// Of the root, and of /run.
inline constexpr TextAttribute<Provenance> kOriginTexts[] = {
    {"creator", &Provenance::creator},
    {"git_commit", &Provenance::git_commit},
    {"build_type", &Provenance::build_type},
    {"compiler", &Provenance::compiler},
    {"flags", &Provenance::flags},
    {"library_versions", &Provenance::library_versions, Text::json},
    {"config_sha256", &Provenance::config_sha256},
    {"inputs_sha256", &Provenance::inputs_sha256, Text::json}};
inline constexpr TextAttribute<Provenance> kRunTexts[] = {
    {"date", &Provenance::date}, {"host", &Provenance::host}, {"processor", &Provenance::processor}};

}  // namespace pipeline
