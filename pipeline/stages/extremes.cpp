#include "pipeline/stages/extremes.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "geometry/decision/contain.hpp"
#include "geometry/decision/meet.hpp"
#include "pipeline/foreign/foreign_method.hpp"
#include "pipeline/result/answer_chunk.hpp"
#include "pipeline/result/columns.hpp"
#include "pipeline/stages/chunks.hpp"
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
    out.add(all.name[body], std::uint32_t(out.meshes.size()));
    out.meshes.push_back(all.mesh_of(body));
  }
  return out;
}

}  // namespace

/// Some steps of a set as a run of their own.
struct ExtremesDetector::Stretch {
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

namespace {

using Stretch = ExtremesDetector::Stretch;

std::vector<Pose> moved(std::vector<Pose> poses, const geometry::Vec3& by) {
  for (Pose& pose : poses) pose.t += by;
  return poses;
}

bool reports(algorithms::Method& method, const std::vector<Pose>& poses) {
  const PairRun run{0, 1, 2};
  std::vector<Pair> hits;
  method.prepare(poses);
  method.answer({&run, 1}, hits);
  return !hits.empty();
}

/// The steps of `from`, which knows two bodies, after those of `to`, which knows all.
void append(Answers from, const CaseSet& set, Answers& to) {
  for (Pair& pair : from.hits.pair) pair = {std::min(set.a, set.b), std::max(set.a, set.b)};
  append_steps(from, to);
}

/// No answer: nothing is reported, so what meets is missed.
Answers silence(const Truth& truth, std::size_t steps, bool foreign) {
  Answers out;
  each_answer_column([&](const auto& column) {
    if (!column.optional) (out.*column.member).assign(steps, 0);
  });
  if (truth.containment == Containment::record) out.contained_hit.assign(steps, 0);
  out.processor_ns.assign(steps, 0);
  if (foreign) out.exchange_ns.assign(steps, 0);
  for (std::size_t s = 0; s < steps; ++s) {
    out.hits.append({});
    out.false_negative[s] = truth.scoring(s).size();
  }
  return out;
}

/// Some steps of one algorithm, as a chunk holds them.
std::string bytes_of(const Answers& answers, const ExtremeAnswers& cases) {
  ChunkWriter out;
  put_steps(answers, 0, std::int64_t(answers.hits.steps()), out);
  each_case_answer_column([&](const auto& column) { out.put(cases.*column.member); });
  out.put(cases.reason);
  return out.bytes;
}

ExtremeAnswers get_cases(ChunkReader& in, std::size_t steps) {
  ExtremeAnswers cases;
  each_case_answer_column(
      [&]<class T>(const Column<ExtremeAnswers, std::vector<T>>& column) { cases.*column.member = in.get<T>(steps); });
  cases.reason = in.text();
  return cases;
}

void append_cases(const ExtremeAnswers& more, ExtremeAnswers& cases) {
  each_case_answer_column([&](const auto& column) {
    const auto& values = more.*column.member;
    auto& all = cases.*column.member;
    all.insert(all.end(), values.begin(), values.end());
  });
  if (cases.reason.empty()) cases.reason = more.reason;
}

/// What the algorithm says of the steps of a stretch: its answers, and those of the other order and of moved bodies.
struct Said {
  Answers answers;
  ExtremeAnswers cases;
};

/// One method is there at a time: of dense meshes it may fill a gigabyte. `failure` is what it means if this throws.
Said own_answer(const Stretch& range, const CaseSet& set, const AlgorithmChoice& choice, std::int64_t repeats,
                const Machine& machine, Failed& failure) {
  Said said;
  auto method = make_method(choice, range.bodies);
  failure = kThrew;
  for (const auto& poses : range.poses) said.cases.moved.push_back(reports(*method, moved(poses, set.moved)));
  method.reset();
  const Bodies other_order = two_of(range.bodies, 1, 0);  // a method may keep a reference to its bodies
  method = make_method(choice, other_order);
  for (const auto& poses : range.poses) said.cases.swapped.push_back(reports(*method, {poses[1], poses[0]}));
  method.reset();
  Progress silent("", 0, true);
  said.answers = detect(range.bodies, range.poses, range.truth, {choice}, repeats, machine, nullptr, silent)[0];
  return said;
}

/// Answers of a detector that knows one algorithm.
Answers answers_of(Detector& detector, const Poses& poses, const Truth& truth, const Machine& machine) {
  Progress silent("", 0, true);
  std::vector<Answers> all = detector.none();
  detector.append(detector.make(0, poses, truth, machine, nullptr, silent), poses.size(), all);
  if (failed(all[0])) throw Fault(all[0].foreign->reason);
  return std::move(all[0]);
}

}  // namespace

/// A method of others, asked about two bodies in both orders.
struct ExtremesDetector::Foreign {
  std::uint32_t a, b;
  Bodies bodies, other_order = two_of(bodies, 1, 0);
  std::vector<AlgorithmChoice> choice;
  std::unique_ptr<algorithms::Method> swapped = make_method(choice[0], other_order);
  Detector detector;

  Foreign(const Stretch& range, const CaseSet& set, const AlgorithmChoice& asked, std::int64_t repeats)
      : a(set.a), b(set.b), bodies(range.bodies), choice{asked}, detector(bodies, choice, repeats, /*noise=*/false) {
    if (const auto* process = dynamic_cast<const ForeignMethod*>(swapped.get())) process->about().takes_them();
  }

  Said answer(const Stretch& range, const CaseSet& set, const Machine& machine) {
    Said said;
    Poses elsewhere;
    for (const auto& poses : range.poses) elsewhere.push_back(moved(poses, set.moved));
    const Answers there = answers_of(detector, elsewhere, range.truth, machine);
    for (std::size_t s = 0; s < elsewhere.size(); ++s) said.cases.moved.push_back(!there.hits.at(s).empty());
    swapped->forget();
    for (const auto& poses : range.poses) said.cases.swapped.push_back(reports(*swapped, {poses[1], poses[0]}));
    said.answers = answers_of(detector, range.poses, range.truth, machine);
    return said;
  }
};

ExtremesDetector::ExtremesDetector(const Bodies& bodies, const Poses& poses, const std::vector<CaseSet>& sets,
                                   const std::vector<AlgorithmChoice>& choices, std::int64_t repeats)
    : bodies_(bodies), poses_(poses), sets_(sets), choices_(choices), repeats_(repeats), foreign_(choices.size()) {}

ExtremesDetector::~ExtremesDetector() = default;

std::vector<Answers> ExtremesDetector::none() const {
  return Detector(bodies_, choices_, repeats_, /*noise=*/false).none();
}

/// Adds what a choice says of the steps of `range`, all of it or nothing. Returns whether it failed, and why.
std::uint8_t ExtremesDetector::answer(const Stretch& range, const CaseSet& set, std::size_t c, const Machine& machine,
                                      Answers& answers, ExtremeAnswers& cases) {
  const AlgorithmChoice& choice = choices_[c];
  std::unique_ptr<Foreign>& foreign = foreign_[c];
  Failed failure = kRefused;
  try {
    Said said;
    if (choice.foreign) {
      if (!foreign || foreign->a != set.a || foreign->b != set.b) {
        foreign.reset();  // two of its processes at a time
        foreign = std::make_unique<Foreign>(range, set, choice, repeats_);
      }
      failure = kThrew;
      said = foreign->answer(range, set, machine);
    } else {
      said = own_answer(range, set, choice, repeats_, machine, failure);
    }
    for (std::size_t s = 0; s < range.poses.size(); ++s) cases.reported.push_back(!said.answers.hits.at(s).empty());
    append(std::move(said.answers), set, answers);
    cases.failed.resize(cases.reported.size(), kWell);
    for (const auto column : {&ExtremeAnswers::swapped, &ExtremeAnswers::moved})
      (cases.*column).insert((cases.*column).end(), (said.cases.*column).begin(), (said.cases.*column).end());
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
  foreign.reset();  // it may have ended
  return failure;
}

void ExtremesDetector::answer_all(const Stretch& range, const CaseSet& set, std::size_t c, const Machine& machine,
                                  Answers& answers, ExtremeAnswers& cases) {
  const std::uint8_t failure = answer(range, set, c, machine, answers, cases);
  if (failure == kWell) return;
  const std::size_t steps = range.poses.size();
  if (failure == kThrew && steps > 1) {  // which step was it?
    for (std::size_t s = 0; s < steps; ++s) {
      Stretch one = range;
      one.poses = {range.poses[s]};
      one.truth.hits = one.truth.contained = {};
      one.truth.hits.append(range.truth.hits.at(s));
      if (range.truth.lists_contained()) one.truth.contained.append(range.truth.contained.at(s));
      answer_all(one, set, c, machine, answers, cases);
    }
    return;
  }
  append(silence(range.truth, steps, choices_[c].foreign != nullptr), set, answers);
  cases.failed.resize(cases.failed.size() + steps, failure);
  for (const auto column : {&ExtremeAnswers::reported, &ExtremeAnswers::swapped, &ExtremeAnswers::moved})
    (cases.*column).resize(cases.failed.size(), 0);
}

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

std::string ExtremesDetector::make(const Truth& truth, std::int64_t first, std::int64_t last, const Machine& machine,
                                   Progress& progress) {
  std::vector<Answers> answers(choices_.size());
  std::vector<ExtremeAnswers> cases(choices_.size());
  for (const CaseSet& set : sets_) {
    const std::int64_t from = std::max(first, set.first_step), to = std::min(last, set.first_step + set.steps);
    if (from >= to) continue;
    const Stretch stretch(bodies_, poses_, truth, set, from, to);
    for (std::size_t c = 0; c < choices_.size(); ++c) {
      stop_if_wanted();
      answer_all(stretch, set, c, machine, answers[c], cases[c]);
    }
    progress.add(std::uint64_t(to - from));
  }
  ChunkWriter out;
  for (std::size_t c = 0; c < choices_.size(); ++c) out.put(bytes_of(answers[c], cases[c]));
  put_machine(machine, out);
  return std::move(out.bytes);
}

ExtremesDetected detect_extremes(const Bodies& bodies, const Poses& poses, const Truth& truth,
                                 const std::vector<CaseSet>& sets, const std::vector<AlgorithmChoice>& choices,
                                 std::int64_t repeats, const Machine& machine, const Checkpoint* part,
                                 Progress& progress) {
  ExtremesDetected all;
  ExtremesDetector detector(bodies, poses, sets, choices, repeats);
  all.answers = detector.none();
  for (Answers& answers : all.answers) answers.machine = machine;
  all.cases.resize(choices.size());
  const auto steps = std::int64_t(poses.size());
  ChunkStage stage{.name = "answers", .steps = steps, .make = [&](ChunkSteps at) {
                     return detector.make(truth, at.first, at.last, machine, progress);
                   }};
  const std::vector<std::string> chunks = all_chunks(std::move(stage), part, progress);
  for (std::size_t chunk = 0; chunk < chunks.size(); ++chunk) {
    const std::size_t count = steps_of_chunk(chunk, steps).count();
    ChunkReader in(chunks[chunk]);
    std::vector<Answers> answers;
    for (std::size_t c = 0; c < choices.size(); ++c) {
      const std::string bytes = in.text();
      ChunkReader one(bytes);
      answers.push_back(get_steps(one, std::int64_t(count), bodies.size()));
      append_cases(get_cases(one, count), all.cases[c]);
    }
    const Machine made_by = get_machine(in);
    for (std::size_t c = 0; c < choices.size(); ++c) append_chunk(answers[c], made_by, all.answers[c]);
  }
  for (std::size_t c = 0; c < choices.size(); ++c)
    if (choices[c].foreign && std::ranges::any_of(all.cases[c].failed, [](std::uint8_t one) { return one != kWell; }))
      all.answers[c].foreign->reason = all.cases[c].reason;
  return all;
}

}  // namespace pipeline
