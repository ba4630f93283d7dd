#include "pipeline/trial.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

#include "geometry/decision/meet.hpp"
#include "pipeline/stages/detect.hpp"
#include "pipeline/stages/motion.hpp"
#include "pipeline/system/threads.hpp"
#include "pipeline/terminal/print.hpp"

namespace pipeline {
namespace {

using geometry::Bodies;
using geometry::Pose;

// Recorded rates, of a machine of 2020; a trial of what they stand for would take as long as the thing itself.
constexpr std::uint64_t kLarge = 64 << 20;  // bytes; a method that takes more is not made for a trial
constexpr double kSetUp = 2e-9;             // s a byte of what it takes at most: facets cut, trees built
constexpr double kAnswer = 0.1e-9;          // s a byte of what it holds, a pass over a step
constexpr double kStore = 12e-9;            // s a byte of the result: digest, shuffle, deflate
constexpr double kCaseSet = 25e-6;          // s an algorithm and step of extremes
constexpr double kEvaluation = 2.5e-6;      // s of a study's case for every evaluation of its budget
constexpr int kEdgeAnswers = 34;            // of a pass: bisections at both ends

/// Seconds of the processor's time, of this thread: others may be busy.
double spent(double start = 0) { return processor_seconds() - start; }

/// Seconds of one step of truth and of all methods.
struct StepSeconds {
  double truth = 0, detect = 0;
};

StepSeconds mixed(const StepSeconds& a, const StepSeconds& b, double share) {
  return {a.truth + (b.truth - a.truth) * share, a.detect + (b.detect - a.detect) * share};
}

/// Asks truth and methods about some steps; sets up once.
class Asked {
 public:
  Asked(const Bodies& bodies, const std::vector<AlgorithmChoice>& choices, std::int64_t repeats, const Plan& plan,
        double seconds)
      : bodies_(bodies), repeats_(repeats), seconds_(seconds) {
    const double began = spent();
    if (geometry::bvhs_bytes(bodies).greatest <= kLarge) {
      bvhs_ = geometry::build_bvhs(bodies);
      decision_.emplace(bodies, bvhs_);
    }
    truth_set_up = spent(began);
    methods_.resize(choices.size());
    // Scattered, so that those that there is no time for are like the others.
    for (std::size_t i = 0; i < choices.size(); ++i) {
      const std::size_t c = scattered(i);
      if (choices[c].foreign) continue;  // its time is no time of ours, and starting it is a thing of its own
      const algorithms::Memory& memory = plan.labels[c].memory;
      if (memory.greatest > kLarge) {
        set_up += kSetUp * double(memory.greatest);
        continue;
      }
      if (spent(began) > seconds / 2) {
        set_up *= double(choices.size()) / double(i);
        break;
      }
      const double before = spent();
      try {
        methods_[c] = make_method(choices[c], bodies);
      } catch (const std::invalid_argument&) {  // said elsewhere
      }
      set_up += spent(before);
    }
    for (const LabelPlan& label : plan.labels)
      if (label.memory.greatest > kLarge) large_ += kAnswer * double(label.memory.held) * double(1 + repeats);
  }

  StepSeconds step(std::span<const Pose> poses) {
    StepSeconds out;
    const std::vector<geometry::PairRun> runs = geometry::pair_runs(bodies_, poses);
    std::vector<geometry::Pair> hits;
    if (decision_)
      for (int again = 0; again < 2; ++again) {  // the second time as one step after another
        hits.clear();
        const double start = spent();
        decision_->prepare(poses);
        decision_->hits(runs, hits);
        decision_->remember();
        out.truth = spent(start);
      }
    const double start = spent();
    std::size_t asked = 0, able = 0;
    for (std::size_t i = 0; i < methods_.size(); ++i) {
      const auto& method = methods_[scattered(i)];
      if (!method) continue;
      ++able;
      if (asked > 0 && spent(start) > seconds_ / 2) continue;
      ++asked;
      hits.clear();
      const double begin = spent();
      method->prepare(poses);
      method->count(runs, hits);
      method->remember();
      const double counted = spent(begin);
      hits.clear();
      const double again = spent();
      method->prepare(poses);
      method->answer(runs, hits);
      out.detect += counted + double(repeats_) * spent(again);
    }
    if (asked > 0) out.detect *= double(able) / double(asked);
    out.detect += large_;
    return out;
  }

  double truth_set_up = 0, set_up = 0;  // s

 private:
  std::size_t scattered(std::size_t i) const {
    std::size_t step = std::max<std::size_t>(1, std::size_t(0.618 * double(methods_.size())));
    while (std::gcd(step, methods_.size()) != 1) ++step;
    return i * step % methods_.size();
  }

  const Bodies& bodies_;
  std::vector<geometry::Bvh> bvhs_;
  std::optional<geometry::Decision> decision_;
  std::vector<std::unique_ptr<algorithms::Method>> methods_;  // #choices; null: not made
  std::int64_t repeats_;
  double seconds_, large_ = 0;
};

Stage even(const std::string& name, std::uint64_t items, double seconds) {
  Stage stage{name, {0}};
  for (std::uint64_t i = 0; i < items; ++i) stage.until.push_back(seconds * double(i + 1) / double(items));
  return stage;
}

/// A stage whose step costs what `of` says.
template <class Of>
Stage stage(const std::string& name, std::int64_t steps, double first, Of of) {
  Stage out{name, {0}};
  for (std::int64_t s = 0; s < steps; ++s) out.until.push_back(out.until.back() + (s == 0 ? first : 0) + of(s));
  return out;
}

/// By step, to what share of the bodies that anything happens to it has happened. Those that have calmed down count
/// less and less: the motion is then integrated in longer steps, and what is near each other mostly meets, which is
/// found sooner than that it does not.
std::vector<double> lively_shares(const Config& config) {
  constexpr double kCalming = 0.5;  // of Ahead::lasts, to 1/e; measured on the third set of padani.toml
  const auto steps = std::size_t(config.steps);
  std::vector<double> share(steps, 0);
  if (!config.scene_kind->ahead) return share;
  double all = 0;
  for (const Ahead& event : config.scene_kind->ahead(config)) {
    if (event.bodies == 0) continue;
    all += double(event.bodies) * double(event.times);
    for (std::size_t s = 0; s < steps; ++s) {
      const double since = double(s) - event.first - event.lasts;
      const double left = since > 0 ? std::exp(-since / std::max(1.0, kCalming * event.lasts)) : 1;
      share[s] += left * double(event.bodies) * double(event.before(double(s + 1)));
    }
  }
  for (double& value : share) value /= std::max(all, 1.0);
  return share;
}

/// Steps of the integrator in a sample while bodies that several spheres touch land and tumble: a trial of a moment
/// sees the first of them alone. The time of a contact by Hertz, of that mass, sphere and speed, measures them.
double landing_steps(const Config& config, const Scene& scene, const std::vector<BodyState>& hurried) {
  constexpr double kInContact = 45;  // fits what heap.toml and cup.toml took: 30 and 16 s
  const double stiffness = config.physics.material.stiffness;
  double contacts = 0, bodies = 0;
  for (std::size_t b = 0; b < scene.rigid.size(); ++b) {
    const RigidBody& body = scene.rigid[b];
    if (body.fixed || body.spheres.empty()) continue;
    ++bodies;
    double radius = 0, speed = 0;
    for (const ContactSphere& sphere : body.spheres) radius += sphere.radius / double(body.spheres.size());
    for (const double part : hurried[b].velocity) speed = std::hypot(speed, 2 * part);  // half of it was taken
    if (speed == 0) continue;
    const double time = 2.87 * std::pow(body.mass * body.mass / (radius * stiffness * stiffness * speed), 0.2);
    contacts += 1 / (config.rate * time);
  }
  return bodies == 0 ? 0 : kInContact * contacts / bodies;
}

/// Steps evenly over the motion.
std::vector<std::size_t> sampled_steps(std::size_t steps) {
  constexpr std::size_t kSamples = 8;
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < std::min(kSamples, steps); ++i)
    out.push_back((2 * i + 1) * steps / (2 * std::min(kSamples, steps)));
  return out;
}

/// Truth and detection of poses that are known, as costs between samples.
std::vector<StepSeconds> sampled(Asked& asked, const std::vector<std::vector<Pose>>& poses, double seconds) {
  const double start = spent();
  std::vector<std::size_t> at;
  std::vector<StepSeconds> cost;
  for (const std::size_t s : sampled_steps(poses.size())) {
    if (!cost.empty() && spent(start) > seconds) break;
    at.push_back(s);
    cost.push_back(asked.step(poses[s]));
  }
  std::vector<StepSeconds> out;
  std::size_t next = 0;
  for (std::size_t s = 0; s < poses.size(); ++s) {
    while (next + 1 < at.size() && 2 * s > at[next] + at[next + 1]) ++next;
    out.push_back(cost[next]);
  }
  return out;
}

double store_seconds(const Plan& plan) { return 0.02 + kStore * double(plan.result_bytes); }

}  // namespace

std::vector<Stage> foreseen_stages(const Config& config, const Scene& scene, const Plan& plan, int threads,
                                   double seconds) {
  if (!scene.case_sets.empty()) return foreseen_stages(config, plan, threads);
  const std::int64_t steps = config.steps;
  Asked asked(scene.bodies, config.algorithms, config.repeats, plan, seconds / 3);
  std::vector<Stage> out;
  std::vector<StepSeconds> cost;
  if (config.scene_kind->integrated) {
    const auto states = [&](bool hurried, bool pressed) {
      std::vector<BodyState> out = scene.states;
      if (config.scene_kind->events) config.scene_kind->events(config, 0, out);
      if (hurried && config.scene_kind->hurry) config.scene_kind->hurry(config, out, pressed);
      return out;
    };
    const MotionTrial early = try_motion(config, scene, states(false, false), seconds / 4);
    MotionTrial late = try_motion(config, scene, states(true, false), seconds / 4);
    late.step = std::max(late.step, landing_steps(config, scene, states(true, false)) * late.inner);
    std::vector<Pose> pressed;
    for (const BodyState& state : states(true, true)) pressed.push_back(pose_of(state));
    const StepSeconds first = asked.step(early.poses), last = asked.step(pressed);
    const std::vector<double> moving = lively_shares(config);
    const double restarts = plan.restarts / double(steps);
    out.push_back(stage("motion", steps, 0, [&](std::int64_t s) {
      const double lively = moving[std::size_t(s)];
      return early.step + (late.step - early.step) * lively +
             restarts * (early.begin + (late.begin - early.begin) * lively);
    }));
    for (std::int64_t s = 0; s < steps; ++s) cost.push_back(mixed(first, last, moving[std::size_t(s)]));
  } else {
    out.push_back(even("motion", std::uint64_t(steps), 0));
    cost = sampled(asked, scene.script, seconds / 2);
  }
  const int workers = std::min(threads, thread_count(0));
  out.push_back(
      stage("truth", steps, asked.truth_set_up, [&](std::int64_t s) { return cost[std::size_t(s)].truth / workers; }));
  out.push_back(stage("detect", steps, asked.set_up, [&](std::int64_t s) { return cost[std::size_t(s)].detect; }));
  if (const std::uint64_t passes = plan.count("passes")) {
    const double answers = out.back().seconds() / double(steps) / double(1 + config.repeats);
    out.push_back(even("passes", passes * (1 + config.algorithms.size()), double(passes) * kEdgeAnswers * answers));
  }
  out.push_back(even("store", 1, store_seconds(plan)));
  return out;
}

std::vector<Stage> foreseen_stages(const Bodies& bodies, const std::vector<std::vector<Pose>>& poses,
                                   const std::vector<AlgorithmChoice>& choices, std::int64_t repeats,
                                   std::uint64_t passes, const Plan& plan, double seconds) {
  Asked asked(bodies, choices, repeats, plan, seconds / 2);
  const std::vector<StepSeconds> cost = sampled(asked, poses, seconds / 2);
  std::vector<Stage> out;
  out.push_back(stage("detect", std::int64_t(poses.size()), asked.set_up,
                      [&](std::int64_t s) { return cost[std::size_t(s)].detect; }));
  if (passes > 0)
    out.push_back(
        even("passes", passes * choices.size(),
             double(passes) * kEdgeAnswers * out.back().seconds() / double(poses.size()) / double(1 + repeats)));
  out.push_back(even("store", 1, store_seconds(plan)));
  return out;
}

std::vector<Stage> foreseen_stages(const Config& config, const Plan& plan, int threads) {
  if (config.study) {
    const double all = double(plan.count("cases")) * double(config.study->force_evaluations) * kEvaluation;
    return {even("cases", plan.count("cases"), all / std::min(threads, thread_count(0))),
            even("store", 1, store_seconds(plan))};
  }
  const auto steps = std::uint64_t(config.steps);
  const double answers = kCaseSet * double(steps) * double(config.algorithms.size());
  const double set_ups = 3 * kSetUp * plan.alone_bytes * double(plan.count("case_sets"));  // three a set and algorithm
  return {even("motion", steps, 0), even("truth", steps, kCaseSet * double(steps)),
          even("cases", steps, kCaseSet * double(steps)), even("detect", steps, answers + set_ups),
          even("store", 1, store_seconds(plan))};
}

struct Looks::Implementation {
  Asked asked;
  Stage foreseen;
  std::vector<std::size_t> at;  // steps that were asked about
  std::vector<double> cost;     // s
};

Looks::Looks(const Bodies& bodies, const std::vector<AlgorithmChoice>& choices, std::int64_t repeats, const Plan& plan,
             Stage detect) {
  constexpr double kSeconds = 0.6;
  implementation_.reset(new Implementation{Asked(bodies, choices, repeats, plan, kSeconds), std::move(detect), {}, {}});
}

Looks::~Looks() = default;

Stage Looks::look(const std::vector<std::vector<Pose>>& poses) {
  auto& [asked, foreseen, at, cost] = *implementation_;
  const auto step_of = [&](std::size_t s) { return foreseen.until[s + 1] - foreseen.until[s]; };
  at.push_back(poses.size() - 1);
  cost.push_back(asked.step(poses.back()).detect);
  double found = 0, expected = 0;
  for (std::size_t i = at.size() < 2 ? 0 : at.size() - 2; i < at.size(); ++i) {
    found += cost[i];
    expected += step_of(at[i]);
  }
  const double factor = expected > 0 ? std::clamp(found / expected, 1 / 3., 3.) : 1;
  std::size_t next = 0;
  return stage("detect", std::int64_t(foreseen.until.size()) - 1, 0, [&](std::int64_t step) {
    const auto s = std::size_t(step);
    if (s > at.back()) return factor * step_of(s);
    while (at[next] < s) ++next;
    if (next == 0) return cost[0];
    const double part = double(s - at[next - 1]) / double(at[next] - at[next - 1]);
    return cost[next - 1] + part * (cost[next] - cost[next - 1]);
  });
}

Seconds range(const std::vector<Stage>& stages, const Config& config) {
  // How far whole runs of configs/ were from what was foreseen for them, on a machine busy with other work too:
  // pipeline/README.md.
  const double spread = config.study ? 3 : 2;
  double sum = 0;
  for (const Stage& stage : stages) sum += stage.seconds();
  return {sum / spread, sum * spread};
}

std::string duration_text(double seconds) {
  if (seconds < 1) return print("%.1f s", seconds);
  if (seconds < 100) return print("%.0f s", seconds);
  if (seconds < 100 * 60) return print("%.0f min", seconds / 60);
  return seconds < 48 * 3600 ? print("%.1f h", seconds / 3600) : print("%.1f days", seconds / 86400);
}

}  // namespace pipeline
