#include "pipeline/stages/extremes.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "geometry/decision/contain.hpp"
#include "geometry/decision/meet.hpp"
#include "pipeline/stages/detect.hpp"
#include "pipeline/terminal/error.hpp"

namespace pipeline {
namespace {

using geometry::Bodies;
using geometry::PairRun;
using geometry::Pose;
using Poses = std::vector<std::vector<Pose>>;

enum Failed : std::uint8_t { kWell = 0, kRefused = 1, kThrew = 2 };

/// The two bodies of a set alone; body 0 is the first of them.
Bodies two_of(const Bodies& all, std::uint32_t first, std::uint32_t second) {
  Bodies out;
  for (const std::uint32_t body : {first, second}) {
    out.mesh.push_back(std::uint32_t(out.meshes.size()));
    out.meshes.push_back(all.mesh_of(body));
    out.name.push_back(all.name[body]);
    out.fixed.push_back(0);
  }
  return out;
}

/// Some steps of a set as a run of their own.
struct Stretch {
  Bodies bodies;
  Poses poses;
  Truth truth;

  Stretch(const Bodies& all, const Poses& motion, const Truth& decided, const CaseSet& set, std::int64_t first,
          std::int64_t last)
      : bodies(two_of(all, set.a, set.b)) {
    truth.containment = decided.containment;
    const auto alone = [](std::span<const Pair> pairs) { return std::vector<Pair>(pairs.empty() ? 0 : 1, {0, 1}); };
    for (std::size_t s = std::size_t(first); s < std::size_t(last); ++s) {
      poses.push_back({motion[s][set.a], motion[s][set.b]});
      truth.hits.append(alone(decided.hits.at(s)));
      if (truth.lists_contained()) truth.contained.append(alone(decided.contained.at(s)));
    }
  }
};

bool reports(algorithms::Method& method, const std::vector<Pose>& poses) {
  const PairRun run{0, 1, 2};
  std::vector<Pair> hits;
  method.prepare(poses);
  method.answer({&run, 1}, hits);
  return !hits.empty();
}

/// The columns of `from` after those of `to`.
void append(const Answers& from, const CaseSet& set, Answers& to) {
  const Pair pair{std::min(set.a, set.b), std::max(set.a, set.b)};
  for (std::size_t s = 0; s < from.hits.steps(); ++s) to.hits.append(std::vector<Pair>(from.hits.at(s).size(), pair));
  const auto add = [](const auto& values, auto& column) { column.insert(column.end(), values.begin(), values.end()); };
  add(from.time_ns, to.time_ns);
  add(from.time_median_ns, to.time_median_ns);
  add(from.prepare_ns, to.prepare_ns);
  add(from.operations, to.operations);
  add(from.true_positive, to.true_positive);
  add(from.false_positive, to.false_positive);
  add(from.false_negative, to.false_negative);
  add(from.rounding_miss, to.rounding_miss);
  add(from.contained_hit, to.contained_hit);
}

/// No answer: nothing is reported, so what meets is missed.
Answers silence(const Truth& truth, std::size_t steps) {
  Answers out;
  for (std::size_t s = 0; s < steps; ++s) {
    out.hits.append({});
    out.false_negative.push_back(truth.scoring(s).size());
  }
  out.time_ns.assign(steps, 0);
  out.time_median_ns = out.prepare_ns = out.time_ns;
  out.operations.assign(steps, 0);
  out.true_positive = out.false_positive = out.rounding_miss = out.operations;
  if (truth.containment == Containment::record) out.contained_hit = out.operations;
  return out;
}

/// Adds what the algorithm says of the steps of `range`, all of it or nothing. Returns whether it failed, and why. One
/// method is there at a time: of dense meshes it may fill a gigabyte.
Failed answer(const Stretch& range, const CaseSet& set, const AlgorithmChoice& choice, std::int64_t repeats,
              const Machine& machine, Answers& answers, ExtremeAnswers& cases) {
  Failed failure = kRefused;
  try {
    const algorithms::Algorithm& row = *algorithms::find(choice.name);
    ExtremeAnswers said;
    auto method = row.make(range.bodies, choice.knobs);
    failure = kThrew;
    for (std::vector<Pose> poses : range.poses) {
      for (Pose& pose : poses) pose.t += set.moved;
      said.moved.push_back(reports(*method, poses));
    }
    method.reset();
    const Bodies other_order = two_of(range.bodies, 1, 0);  // a method may keep a reference to its bodies
    method = row.make(other_order, choice.knobs);
    for (const auto& poses : range.poses) said.swapped.push_back(reports(*method, {poses[1], poses[0]}));
    method.reset();
    Progress silent("", 0, true);
    const Answers found =
        detect(range.bodies, range.poses, range.truth, {choice}, repeats, machine, nullptr, silent)[0];
    append(found, set, answers);
    for (std::size_t s = 0; s < range.poses.size(); ++s) cases.reported.push_back(!found.hits.at(s).empty());
    cases.failed.resize(cases.reported.size(), kWell);
    for (const auto column : {&ExtremeAnswers::swapped, &ExtremeAnswers::moved})
      (cases.*column).insert((cases.*column).end(), (said.*column).begin(), (said.*column).end());
    return kWell;
  } catch (const OutOfMemory&) {
    throw;
  } catch (const std::bad_alloc&) {  // of this machine, not of the algorithm
    throw OutOfMemory(choice, range.bodies);
  } catch (const Error& error) {
    if (error.code() != kInput) throw;  // Ctrl-C, a full disk
    if (cases.reason.empty()) cases.reason = error.what();
  } catch (const std::exception& error) {
    if (cases.reason.empty()) cases.reason = error.what();
  }
  return failure;
}

void answer_all(const Stretch& range, const CaseSet& set, const AlgorithmChoice& choice, std::int64_t repeats,
                const Machine& machine, Answers& answers, ExtremeAnswers& cases) {
  const Failed failure = answer(range, set, choice, repeats, machine, answers, cases);
  if (failure == kWell) return;
  const std::size_t steps = range.poses.size();
  if (failure == kThrew && steps > 1) {  // which step was it?
    for (std::size_t s = 0; s < steps; ++s) {
      Stretch one = range;
      one.poses = {range.poses[s]};
      one.truth.hits = one.truth.contained = {};
      one.truth.hits.append(range.truth.hits.at(s));
      if (range.truth.lists_contained()) one.truth.contained.append(range.truth.contained.at(s));
      answer_all(one, set, choice, repeats, machine, answers, cases);
    }
    return;
  }
  append(silence(range.truth, steps), set, answers);
  cases.failed.resize(cases.failed.size() + steps, failure);
  for (const auto column : {&ExtremeAnswers::reported, &ExtremeAnswers::swapped, &ExtremeAnswers::moved})
    (cases.*column).resize(cases.failed.size(), 0);
}

/// The columns that a chunk holds, in the order they are written and read.
template <class Visit>
void for_each_column(Answers& a, ExtremeAnswers& c, Visit visit) {
  visit(a.time_ns);
  visit(a.time_median_ns);
  visit(a.prepare_ns);
  visit(a.operations);
  visit(a.true_positive);
  visit(a.false_positive);
  visit(a.false_negative);
  visit(a.rounding_miss);
  visit(a.contained_hit);
  visit(c.reported);
  visit(c.swapped);
  visit(c.moved);
  visit(c.failed);
}

std::string bytes_of(Answers& answers, ExtremeAnswers& cases) {
  ChunkWriter out;
  out.put(answers.hits.offset);
  out.put(answers.hits.pair);
  for_each_column(answers, cases, [&](const auto& column) { out.put(column); });
  out.put(cases.reason);
  return out.bytes;
}

void add_chunk(Answers& from, ExtremeAnswers& from_cases, Answers& to, ExtremeAnswers& to_cases) {
  for (std::size_t s = 0; s < from.hits.steps(); ++s) to.hits.append(from.hits.at(s));
  std::vector<const void*> columns;
  for_each_column(from, from_cases, [&](const auto& column) { columns.push_back(&column); });
  std::size_t next = 0;
  for_each_column(to, to_cases, [&]<class T>(std::vector<T>& column) {
    const auto& more = *static_cast<const std::vector<T>*>(columns[next++]);
    column.insert(column.end(), more.begin(), more.end());
  });
  if (to_cases.reason.empty()) to_cases.reason = from_cases.reason;
}

}  // namespace

std::vector<ExtremeCase> extreme_rows(const Bodies& bodies, const Poses& poses, const Truth& truth,
                                      const std::vector<CaseSet>& sets, std::vector<ExtremeCase> cases,
                                      Progress& progress) {
  assert(cases.size() == poses.size() && "a case per step");
  for (const CaseSet& set : sets) {
    stop_if_wanted();
    const Bodies two = two_of(bodies, set.a, set.b);
    const std::vector<geometry::Bvh> bvhs = geometry::build_bvhs(two);
    const bool contained_meets = truth.containment == Containment::meet;
    std::vector<geometry::Solid> solids;
    if (contained_meets)
      for (const geometry::Mesh& mesh : two.meshes) solids.push_back(geometry::solid_of(mesh, bodies.closed_within));
    geometry::Decision decision(two, bvhs, solids);
    const auto meet = [&](std::vector<Pose> at) { return decision.meet(at, {0, 1}); };
    const auto scores = [&](std::vector<Pose> at) {  // by the truth that scores
      const PairRun run{0, 1, 2};
      std::vector<geometry::Contained> contained;
      return !decision.hits(at, {&run, 1}, contained_meets ? &contained : nullptr).empty() || !contained.empty();
    };
    for (std::size_t s = std::size_t(set.first_step); s < std::size_t(set.first_step + set.steps); ++s) {
      ExtremeCase& row = cases[s];
      const Pose &a = poses[s][set.a], &b = poses[s][set.b];
      row.truth = !truth.scoring(s).empty();
      row.truth_moved = scores({{a.q, a.t + set.moved}, {b.q, b.t + set.moved}});
      const bool surfaces = !truth.hits.at(s).empty();
      const geometry::Vec3 away = double(kNearUlps) * set.outward;
      row.near_touching = std::abs(row.gap_ulps) <= kNearUlps || meet({a, {b.q, b.t + away}}) != surfaces ||
                          meet({a, {b.q, b.t - away}}) != surfaces;
      progress.add(1);
    }
  }
  return cases;
}

ExtremesDetected detect_extremes(const Bodies& bodies, const Poses& poses, const Truth& truth,
                                 const std::vector<CaseSet>& sets, const std::vector<AlgorithmChoice>& choices,
                                 std::int64_t repeats, const Machine& machine, const Part* part, Progress& progress) {
  ExtremesDetected all;
  {
    Progress silent("", 0, true);
    all.answers = detect(bodies, {}, {}, choices, repeats, machine, nullptr, silent);  // what does not depend on steps
  }
  all.cases.resize(choices.size());
  const std::int64_t steps = std::int64_t(poses.size());
  for (std::int64_t first = 0; first < steps; first += kChunkSteps) {
    const std::int64_t last = std::min(first + kChunkSteps, steps);
    const std::string name = chunk_name("answers", first);
    if (const auto kept = part ? part->load(name) : std::nullopt) {
      ChunkReader in(*kept);
      for (std::size_t c = 0; c < choices.size(); ++c) {
        const std::string bytes = in.text();
        ChunkReader one(bytes);
        Answers answers;
        ExtremeAnswers cases;
        answers.hits.offset = one.get<std::uint64_t>();
        answers.hits.pair = one.get<Pair>();
        one.require(sound(answers.hits, std::uint64_t(last - first), bodies.size()));
        for_each_column(answers, cases, [&]<class T>(std::vector<T>& column) {
          column = one.get<T>();
          const bool absent = column.empty() && static_cast<const void*>(&column) == &answers.contained_hit;
          one.require(absent || column.size() == std::size_t(last - first));
        });
        cases.reason = one.text();
        add_chunk(answers, cases, all.answers[c], all.cases[c]);
      }
      progress.add(std::uint64_t(last - first), false);
      continue;
    }
    std::vector<Answers> answers(choices.size());
    std::vector<ExtremeAnswers> cases(choices.size());
    for (const CaseSet& set : sets) {
      const std::int64_t from = std::max(first, set.first_step), to = std::min(last, set.first_step + set.steps);
      if (from >= to) continue;
      const Stretch stretch(bodies, poses, truth, set, from, to);
      for (std::size_t c = 0; c < choices.size(); ++c) {
        stop_if_wanted();
        answer_all(stretch, set, choices[c], repeats, machine, answers[c], cases[c]);
      }
      progress.add(std::uint64_t(to - from));
    }
    ChunkWriter out;
    for (std::size_t c = 0; c < choices.size(); ++c) {
      if (part) out.put(bytes_of(answers[c], cases[c]));
      add_chunk(answers[c], cases[c], all.answers[c], all.cases[c]);
    }
    if (part) part->save(name, out.bytes);
  }
  return all;
}

double ExtremesCount::error() const {
  if (cases == failed) return std::numeric_limits<double>::quiet_NaN();
  const std::uint64_t wrong = false_positive + false_negative;
  return wrong == 0 ? 0 : double(wrong) / double(true_positive + wrong);
}

ExtremesInstability instability(const Extremes& extremes, std::size_t algorithm) {
  ExtremesInstability out;
  const ExtremeAnswers& said = extremes.answers[algorithm];
  for (std::size_t s = 0; s < extremes.rows.size(); ++s) {
    if (said.failed[s]) continue;
    const ExtremeCase& row = extremes.rows[s];
    out.swapped += said.swapped[s] != said.reported[s];
    out.moved += said.moved[s] != said.reported[s] && row.truth_moved == row.truth;
  }
  return out;
}

}  // namespace pipeline
