// The keys of a study, and its cases.
#include <algorithm>
#include <cmath>
#include <set>

#include "pipeline/physics/simulate.hpp"
#include "pipeline/study/problem.hpp"
#include "pipeline/study/study.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

constexpr std::uint64_t kMostCases = 100000;

double& parameter(StudyRow& row, const std::string& name) {
  for (const auto& column : kStudyParameters)
    if (name == column.name) return row.*column.member;
  throw std::logic_error("no parameter '" + name + "'");
}

const IntegratorFacts& facts_of(const std::string& integrator) {
  return *std::ranges::find_if(integrators(), [&](const IntegratorFacts& facts) { return facts.name == integrator; });
}

Sweep sweep(const Section& s) {
  std::vector<std::string> names;
  for (const Problem& problem : problems()) names.push_back(problem.name);
  if (!s.has("problem")) s.fail("missing key '" + s.full("problem") + "'; " + hint("", names));
  Sweep out;
  out.problem = s.choice("problem", "", names);
  const Problem& problem = *std::ranges::find(problems(), out.problem, &Problem::name);

  std::vector<std::string> known{"name", "problem", "integrator", "accuracy", "fixed_step", "units"};
  for (const auto& [name, preset] : problem.presets) known.push_back(name);
  s.only(known);
  out.name = s.text("name", out.problem);
  if (!valid_label(out.name)) s.refuse("name", kLabelRule);
  out.integrators = s.choices("integrator", integrator_names(), integrator_names());
  out.accuracies = s.numbers("accuracy", {.least = 0, .most = 1, .above = true, .below = true});
  out.fixed_steps = s.numbers("fixed_step", {.least = 0, .above = true});
  if (!s.has("accuracy") && !s.has("fixed_step")) out.accuracies = {1e-3};
  out.units = s.choices("units", {"SI"}, {"SI", "scaled"});
  s.refuse_twice("integrator", out.integrators);
  s.refuse_twice("accuracy", out.accuracies);
  s.refuse_twice("fixed_step", out.fixed_steps);
  s.refuse_twice("units", out.units);
  for (const auto& [name, preset] : problem.presets) {
    const ParameterRule rule = parameter_rule(problem.name, name);
    std::vector<double> values = s.numbers(name, rule.range, rule.whole);
    if (values.empty()) values = {preset};
    s.refuse_twice(name, values);
    out.values.emplace_back(name, std::move(values));
  }
  return out;
}

/// The cases of a sweep; `add` is told each.
template <class Add>
void expand(const Sweep& sweep, const Add& add) {
  for (const std::string& integrator : sweep.integrators) {
    const IntegratorFacts& facts = facts_of(integrator);
    for (const std::string& units : sweep.units) {
      StudyRow row;
      row.sweep = sweep.name;
      row.problem = sweep.problem;
      row.integrator = integrator;
      row.units = units;
      if (facts.order > 0) row.nominal_order = facts.order;
      std::vector<std::size_t> at(sweep.values.size(), 0);
      for (bool more = true; more;) {
        for (std::size_t i = 0; i < at.size(); ++i)
          parameter(row, sweep.values[i].first) = sweep.values[i].second[at[i]];
        complete(row);
        for (const double accuracy : sweep.accuracies) {
          // The accuracy of an integrator without error control is its step, as in [physics].
          const bool is_step = !facts.error_control;
          if (is_step && std::ranges::count(sweep.fixed_steps, accuracy) > 0) continue;
          row.accuracy = is_step ? StudyRow::kNone : accuracy;
          row.fixed_step = is_step ? accuracy : StudyRow::kNone;
          add(row);
        }
        if (facts.fixed_step)
          for (const double step : sweep.fixed_steps) {
            row.accuracy = StudyRow::kNone;
            row.fixed_step = step;
            add(row);
          }
        more = false;
        for (std::size_t i = at.size(); i-- > 0 && !more;) {
          more = ++at[i] < sweep.values[i].second.size();
          if (!more) at[i] = 0;
        }
      }
    }
  }
}

}  // namespace

Study read_study(const Section& root) {
  root.only({"title", "study", "every", "bodies", "budget", "sweep"});
  root.choice("study", "", {"integration"});
  Study study;
  study.every = root.integer("every", study.every, 1);
  study.bodies = root.choice("bodies", "free", {"free", "tree"}) == "tree" ? BodyModel::tree : BodyModel::free;
  const Section budget = root.section("budget");
  budget.only({"force_evaluations", "processor_time", "energy_bound"});
  study.force_evaluations = budget.integer("force_evaluations", study.force_evaluations, 1);
  study.processor_time = budget.real("processor_time", study.processor_time, {.least = 0.1, .most = 1e5});
  study.energy_bound = budget.real("energy_bound", study.energy_bound, {.least = 0, .above = true});
  std::set<std::string> taken;
  double all = 0;
  for (const Section& s : root.sections("sweep")) {
    study.sweeps.push_back(sweep(s));
    const Sweep& added = study.sweeps.back();
    if (!taken.insert(added.name).second)
      s.refuse(s.has("name") ? "name" : "problem", "be the only sweep of its name", "give it a name of its own");
    double cases =
        double(added.integrators.size() * added.units.size() * (added.accuracies.size() + added.fixed_steps.size()));
    for (const auto& [name, values] : added.values) cases *= double(values.size());
    all += cases;
    if (all > double(kMostCases)) s.fail("a study must have at most " + std::to_string(kMostCases) + " cases");
    bool any = false;
    expand(added, [&](const StudyRow&) { any = true; });
    if (!any) s.fail("the sweep must have a case: its integrators take no fixed step; give 'accuracy'");
  }
  if (study.sweeps.empty()) root.fail("missing [[sweep]]; write [[sweep]] and below it problem = \"pendulum\"");
  return study;
}

void write_study(const Study& study, TomlText& out) {
  out.line("study", std::string("integration"));
  out.line("every", study.every);
  out.line("bodies", std::string(study.bodies == BodyModel::tree ? "tree" : "free"));
  out.table("[budget]");
  out.line("force_evaluations", study.force_evaluations);
  out.line("processor_time", study.processor_time);
  out.line("energy_bound", study.energy_bound);
  const auto texts = [&](const char* key, const std::vector<std::string>& values) {
    out.list(key, std::vector<Value>(values.begin(), values.end()));
  };
  for (const Sweep& s : study.sweeps) {
    out.table("[[sweep]]");
    out.line("name", s.name);
    out.line("problem", s.problem);
    texts("integrator", s.integrators);
    if (!s.accuracies.empty()) out.list("accuracy", s.accuracies);
    if (!s.fixed_steps.empty()) out.list("fixed_step", s.fixed_steps);
    texts("units", s.units);
    for (const auto& [name, values] : s.values)
      if (!std::isnan(values[0])) out.list(name, values);  // else it follows from others
  }
}

std::vector<StudyRow> study_cases(const Study& study) {
  std::vector<StudyRow> out;
  std::int64_t number = 0;
  for (const Sweep& sweep : study.sweeps)
    expand(sweep, [&](const StudyRow& row) {
      if (number++ % study.every == 0) out.push_back(row);
    });
  return out;
}

}  // namespace pipeline
