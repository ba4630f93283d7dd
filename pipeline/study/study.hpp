// Studies of the integrators: a configuration's sweeps become cases, each case a row of /study.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/config.hpp"
#include "pipeline/result/checkpoint.hpp"
#include "pipeline/result/result.hpp"
#include "pipeline/scene/document.hpp"
#include "pipeline/terminal/progress.hpp"

namespace pipeline {

/// A configuration with `study`, from its document. Throws Error(kInput).
Config study_config(const Section& root, const std::string& text, const std::filesystem::path& path,
                    const std::string& title);

/// Every case, sweep by sweep: integrators, then units, then parameters in the problem's order, then accuracies and
/// fixed steps, the last quickest. The rows hold what a case is made of, nothing of what comes of it.
std::vector<StudyRow> study_cases(const Study& study);

/// Integrates one case in this process: `row` with what came of it. What an integration does wrong is in the row;
/// aborts, crashes and hangs are not caught.
StudyRow study_row(const Study& study, StudyRow row);

/// All cases, each in a child process of its own, so many at a time; those that `part` has are taken from it. Throws
/// Error(kInterrupted).
std::vector<StudyRow> study_rows(const Study& study, const std::vector<StudyRow>& cases, int processes,
                                 const Part& part, Progress& progress);

}  // namespace pipeline
