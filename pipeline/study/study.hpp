// Studies of the integrators: a configuration's sweeps become cases, each case a row of /study.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/physics/simulate.hpp"
#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/products/study.hpp"
#include "pipeline/scene/document.hpp"
#include "pipeline/terminal/progress.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {

/// One [[sweep]] of a study: every combination of its values is a case.
struct Sweep {
  std::string name, problem;
  std::vector<std::string> integrators;
  std::vector<double> accuracies;                                   // a step in s for those that control no error
  std::vector<double> fixed_steps;                                  // s, for those that take one
  std::vector<std::string> units;                                   // "SI" or "scaled"
  std::vector<std::pair<std::string, std::vector<double>>> values;  // of the problem's parameters, all of them
};

/// study = "integration": cases instead of a scene.
struct Study {
  std::vector<Sweep> sweeps;
  std::int64_t every = 1;  // 1: every case; 2: every second, from the first
  BodyModel bodies = BodyModel::free;
  // Of each case:
  std::int64_t force_evaluations = 1000000;
  double processor_time = 60;  // s
  double energy_bound = 10;    // of the problem's energy: more gained is a failure
};

/// The study of a configuration's document, which has `study` and a title besides. Throws Error(kInput).
Study read_study(const Section& root);

/// The same as TOML, after defaults; reading it gives this Study.
void write_study(const Study& study, TomlText& out);

/// Every case, sweep by sweep: integrators, then units, then parameters in the problem's order, then accuracies and
/// fixed steps, the last quickest. The rows hold what a case is made of, nothing of what comes of it.
std::vector<StudyRow> study_cases(const Study& study);

/// Integrates one case in this process: `row` with what came of it. What an integration does wrong is in the row;
/// aborts, crashes and hangs are not caught.
StudyRow study_row(const Study& study, StudyRow row);

/// All cases, each in a child process of its own, that many at a time; those that `part` has are taken from it. Throws
/// Error(kInterrupted).
std::vector<StudyRow> study_rows(const Study& study, const std::vector<StudyRow>& cases, int processes,
                                 const Checkpoint& part, Progress& progress);

}  // namespace pipeline
