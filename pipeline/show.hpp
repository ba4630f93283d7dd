// Results and tables of the program as text for people and as JSON for programs.
#pragma once
#include <string>

#include "pipeline/config.hpp"
#include "pipeline/part.hpp"
#include "pipeline/result.hpp"
#include "pipeline/run.hpp"

namespace pipeline {

/// What is in a result: title, size, summary table, provenance, digests.
std::string result_text(const Result& result);
std::string result_json(const Result& result, const std::string& path);

/// How far an unfinished run is.
std::string part_text(const PartStatus& status, const std::string& path);
std::string part_json(const PartStatus& status, const std::string& path);

/// What a configuration would run, and how large.
std::string plan_text(const Config& config, const Plan& plan, const std::string& output);
std::string plan_json(const Config& config, const Plan& plan, const std::string& output);

/// The tables behind `pipeline list WHAT`; what is algorithms, scenes, shapes, integrators or problems.
std::string list_text(const std::string& what);
std::string list_json(const std::string& what);

}  // namespace pipeline
