// A configuration as values, read from TOML and validated completely before anything runs.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/scene/scene_config.hpp"
#include "pipeline/stages/choice.hpp"
#include "pipeline/stages/plugin.hpp"
#include "pipeline/study/study.hpp"

namespace pipeline {

struct Config : SceneConfig {
  std::string text;       // as read
  std::string effective;  // the whole configuration after defaults and --set, as TOML; reading it gives this Config
  std::string title;
  std::optional<Study> study;        // instead of a scene: then nothing else but texts and notes
  std::optional<double> gap_margin;  // m; absent: distances are not asked for
  std::int64_t repeats = 3;
  bool noise = false;               // the first label is timed a second time
  std::optional<std::int64_t> pin;  // the one processor that times are taken on
  std::vector<Plugin> plugins;      // of [[plugin]] and --plugin
  std::vector<AlgorithmChoice> algorithms;
};

/// Reads and validates, the files that the scene names included; steps and rate that are not given become theirs. A
/// seed of which nothing would be drawn is refused, or noted where it is the preset. `sets` are --set arguments,
/// "dotted.key=TOML value" (a bare word is taken as a string), `plugins` are --plugin arguments. Throws Error(kInput)
/// with file:line:column (or the --set), the value, the rule and the nearest known key.
Config read_config(const std::filesystem::path& path, const std::vector<std::string>& sets = {},
                   const std::vector<std::string>& plugins = {});

/// Every key that the reading of a configuration asks for, in that order. Throws as parse_config.
std::vector<AskedKey> asked_keys(const std::string& text);

/// Reads TOML text as if from `path`, and no file that it names: of libraries only rows that are in the table are
/// known. For tests.
Config parse_config(const std::string& text, const std::filesystem::path& path,
                    const std::vector<std::string>& sets = {});

/// The configuration that a result file holds. A file starts no library: methods of those that were not given by hand
/// are left out, and noted. Throws Error(kFile) naming the file.
Config recorded_config(const std::string& effective, const std::string& file);

/// The configuration that an unfinished run, `part`, keeps of itself; files that it names are looked for from `from`,
/// where it was read. A part starts no program and no library: one of methods of others is refused, Error(kInput).
Config kept_config(const std::string& effective, const std::filesystem::path& from, const std::string& part);

/// An --algorithm argument, "NAME[:knob=value,...][@LABEL]", for a truth of that containment: what a knob `containment`
/// follows when it is not given. Throws Error(kInput) naming the argument.
AlgorithmChoice parse_algorithm(const std::string& argument, Containment containment = Containment::ignore);

/// Finds the files of programs and takes their SHA-256. Throws Error(kInput) for a command without a program; of
/// optional ones the labels are returned, each with what it lacks.
std::map<std::string, std::string> find_files(std::vector<AlgorithmChoice>& choices);

/// Takes the algorithms of these labels, each with what it lacks, out of the configuration, as if it had not named
/// them; a note for each. Throws Error(kInput) when none is left.
std::vector<std::string> leave_out(const std::map<std::string, std::string>& missing, Config& config);

/// Reads the files that stand for meshes, unless that was done already. `closed_within` as in Bodies. What should be
/// said of them is returned, a line each. Throws Error(kInput) for one that is no closed surface.
std::vector<std::string> read_proxies(std::vector<AlgorithmChoice>& choices, double closed_within);

}  // namespace pipeline
