#include "pipeline/commands/verify.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "geometry/decision/oracle.hpp"
#include "geometry/random.hpp"
#include "pipeline/commands/command.hpp"
#include "pipeline/system/threads.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/print.hpp"
#include "pipeline/terminal/progress.hpp"

namespace pipeline {
namespace {

using geometry::Bodies;
using geometry::Pose;
using geometry::Triangle;
namespace oracle = geometry::brute_force;

constexpr std::uint64_t kSeed = 1;

/// The classes of which samples are drawn.
enum Sampled : std::size_t { kMeet, kContained, kNear, kClasses };
using Counts = std::array<std::uint64_t, kClasses>;

/// The definition of which pairs count, once more.
bool is_there(const Pose& pose) {
  const double all[] = {pose.q.w, pose.q.x, pose.q.y, pose.q.z, pose.t[0], pose.t[1], pose.t[2]};
  return std::ranges::none_of(all, [](double x) { return std::isnan(x); });
}
bool is_chosen(const Bodies& bodies, std::uint32_t body) { return bodies.chosen.empty() || bodies.chosen[body]; }
bool counts(const Bodies& bodies, std::span<const Pose> poses, Pair pair) {
  return is_there(poses[pair.a]) && is_there(poses[pair.b]) && !(bodies.fixed[pair.a] && bodies.fixed[pair.b]) &&
         (is_chosen(bodies, pair.a) || is_chosen(bodies, pair.b));
}

/// How many count: pairs of those there that are not both fixed, less the same among those not chosen.
std::uint64_t pairs_that_count(const Bodies& bodies, std::span<const Pose> poses) {
  std::uint64_t all = 0, all_fixed = 0, others = 0, others_fixed = 0;
  for (std::uint32_t body = 0; body < bodies.size(); ++body) {
    if (!is_there(poses[body])) continue;
    const bool other = !is_chosen(bodies, body);
    ++all, others += other;
    if (bodies.fixed[body]) ++all_fixed, others_fixed += other;
  }
  const auto two_of = [](std::uint64_t n) { return n * (n - 1) / 2; };  // 0 of 0 and of 1, also modulo 2^64
  return two_of(all) - two_of(all_fixed) - (two_of(others) - two_of(others_fixed));
}

/// A step as the oracle sees it before it decides anything.
struct Step {
  std::vector<oracle::Extent> extents;   // B; meaningless where a body is not there
  std::vector<Pair> touching;            // pairs that count and whose extents touch, sorted
  std::optional<std::uint32_t> endless;  // the first body with a world vertex that is not finite; then nothing else
};

Step look_at(const Bodies& bodies, std::span<const Pose> poses) {
  Step step;
  step.extents.resize(bodies.size());
  std::vector<std::uint32_t> order;
  for (std::uint32_t body = 0; body < bodies.size(); ++body) {
    if (!is_there(poses[body])) continue;
    step.extents[body] = oracle::world_extent(bodies.mesh_of(body), poses[body]);
    if (!oracle::is_finite(step.extents[body])) {
      step.endless = body;
      return step;
    }
    order.push_back(body);
  }
  std::ranges::sort(order, {}, [&](std::uint32_t body) { return std::pair(step.extents[body].min.x(), body); });
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const oracle::Extent &one = step.extents[order[i]], &two = step.extents[order[j]];
      if (two.min.x() > one.max.x()) break;
      if (!oracle::touch(one, two)) continue;
      const Pair pair{std::min(order[i], order[j]), std::max(order[i], order[j])};
      if (counts(bodies, poses, pair)) step.touching.push_back(pair);
    }
  std::ranges::sort(step.touching);
  return step;
}

bool lists(std::span<const Pair> sorted, Pair pair) { return std::ranges::binary_search(sorted, pair); }

std::span<const Pair> contained_at(const Truth& truth, std::size_t step) {
  return truth.lists_contained() ? truth.contained.at(step) : std::span<const Pair>();
}

/// How a pair that is listed as contained is listed.
Relation listed_containment(const Truth& truth, std::size_t step, Pair pair) {
  if (!truth.contained_inside) return Relation::contained;
  const std::span<const Pair> here = truth.contained.at(step);
  const std::size_t at = std::size_t(std::ranges::lower_bound(here, pair) - here.begin());
  const std::uint32_t inside = (*truth.contained_inside)[truth.contained.offset[step] + at];
  return inside == pair.a ? Relation::a_inside : Relation::b_inside;
}

/// The closed surfaces of the meshes, by their numbers; null: open.
using Surfaces = std::vector<std::optional<geometry::Mesh>>;

/// Whether `inner` lies inside body b; their surfaces as read do not meet.
bool lies_inside(const std::vector<Triangle>& inner, const Bodies& bodies, const Surfaces& surfaces, std::uint32_t b,
                 const Pose& pose) {
  const auto& surface = surfaces[bodies.mesh[b]];
  if (!surface) return false;
  const std::vector<Triangle> outer = oracle::world_triangles(*surface, pose);
  const bool as_read = surface->triangles == bodies.mesh_of(b).triangles;
  return (as_read || !oracle::meet(inner, outer)) && oracle::contained(inner, outer);
}

std::vector<Pair> near_pairs(const Step& step, const Truth& truth, std::size_t s) {
  std::vector<Pair> out;
  for (const Pair& pair : step.touching)
    if (!lists(truth.hits.at(s), pair) && !lists(contained_at(truth, s), pair)) out.push_back(pair);
  return out;
}

/// What is known of a step after the extents were compared.
struct Facts {
  Counts there{};
  std::uint64_t far = 0;
  std::optional<std::uint32_t> endless;
  std::optional<Difference> difference;  // the first listed pair that is none, or whose extents do not touch
};

Facts facts_of(const Result& result, std::size_t s) {
  const std::span<const Pose> poses = result.motion[s];
  const Step step = look_at(result.bodies, poses);
  Facts facts;
  facts.endless = step.endless;
  if (step.endless) return facts;
  const std::span<const Pair> hits = result.truth.hits.at(s), contained = contained_at(result.truth, s);
  facts.there = {hits.size(), contained.size(), near_pairs(step, result.truth, s).size()};
  facts.far = pairs_that_count(result.bodies, poses) - step.touching.size();
  const auto judge = [&](std::span<const Pair> listed, Relation as) {
    for (const Pair& pair : listed) {
      if (lists(step.touching, pair)) continue;
      if (!facts.difference || pair < facts.difference->pair)
        facts.difference = {s, pair, as, counts(result.bodies, poses, pair) ? Relation::apart : Relation::no_pair};
      return;
    }
  };
  judge(hits, Relation::meet);
  judge(contained, Relation::contained);
  if (facts.difference && facts.difference->truth == Relation::contained)
    facts.difference->truth = listed_containment(result.truth, s, facts.difference->pair);
  return facts;
}

/// Which of n pairs, numbered over all steps, are asked about: sorted; nothing means all.
using Sample = std::optional<std::vector<std::uint64_t>>;

/// `wanted` of n, all equally likely (R. Floyd's method: J. Bentley, "Programming pearls: a sample of brilliance",
/// 1987).
Sample sample(std::uint64_t n, std::uint64_t wanted, std::uint64_t stream) {
  if (wanted >= n) return std::nullopt;
  geometry::Random random = geometry::Random::of(kSeed, stream);
  std::set<std::uint64_t> out;
  for (std::uint64_t j = n - wanted; j < n; ++j)
    if (!out.insert(random.next() % (j + 1)).second) out.insert(j);
  return std::vector(out.begin(), out.end());
}

/// Equal shares of `wanted`; what a class does not need goes to the others.
Counts shares(const Counts& there, std::uint64_t wanted) {
  std::array<std::size_t, kClasses> order{kMeet, kContained, kNear};
  std::ranges::stable_sort(order, {}, [&](std::size_t c) { return there[c]; });
  Counts out{};
  for (std::size_t i = 0; i < kClasses; ++i) {
    out[order[i]] = std::min(there[order[i]], wanted / (kClasses - i));
    wanted -= out[order[i]];
  }
  return out;
}

struct Question {
  Pair pair;
  Relation listed;
};

/// What the oracle said at a step: questions asked per class, and the difference that ended it.
struct Asked {
  Counts checked{};
  std::optional<Difference> difference;
};

Asked ask(const Result& result, const Surfaces& surfaces, std::size_t s, const Facts& facts,
          const std::array<Sample, kClasses>& samples, const Counts& before) {
  const std::span<const Pose> poses = result.motion[s];
  std::vector<Question> questions;
  const auto draw = [&](Sampled c, std::span<const Pair> from, Relation listed) {
    if (!samples[c]) {
      for (const Pair& pair : from) questions.push_back({pair, listed});
      return;
    }
    auto at = std::ranges::lower_bound(*samples[c], before[c]);
    for (; at != samples[c]->end() && *at < before[c] + from.size(); ++at)
      questions.push_back({from[*at - before[c]], listed});
  };
  draw(kMeet, result.truth.hits.at(s), Relation::meet);
  draw(kContained, contained_at(result.truth, s), Relation::contained);
  // Not looked at again when none of its pairs is drawn: the extents take a while.
  const bool near_drawn =
      !samples[kNear] || std::ranges::lower_bound(*samples[kNear], before[kNear]) !=
                             std::ranges::lower_bound(*samples[kNear], before[kNear] + facts.there[kNear]);
  if (near_drawn && facts.there[kNear] > 0)
    draw(kNear, near_pairs(look_at(result.bodies, poses), result.truth, s), Relation::apart);
  std::ranges::stable_sort(questions, {}, &Question::pair);

  Asked out;
  std::optional<std::uint32_t> placed;  // the body `a` is of
  std::vector<Triangle> a;
  for (const auto& [pair, listed] : questions) {
    stop_if_wanted();
    if (facts.difference && facts.difference->pair <= pair) break;  // found already, and without the oracle
    if (placed != pair.a) a = oracle::world_triangles(result.bodies.mesh_of(pair.a), poses[pair.a]);
    placed = pair.a;
    const std::vector<Triangle> b = oracle::world_triangles(result.bodies.mesh_of(pair.b), poses[pair.b]);
    Relation found = Relation::apart;
    if (oracle::meet(a, b))
      found = Relation::meet;
    else if (result.truth.lists_contained() && lies_inside(a, result.bodies, surfaces, pair.b, poses[pair.b]))
      found = Relation::a_inside;
    else if (result.truth.lists_contained() && lies_inside(b, result.bodies, surfaces, pair.a, poses[pair.a]))
      found = Relation::b_inside;
    ++out.checked[listed == Relation::meet ? kMeet : listed == Relation::contained ? kContained : kNear];
    const Relation truth = listed == Relation::contained ? listed_containment(result.truth, s, pair) : listed;
    const bool either = truth == Relation::contained && (found == Relation::a_inside || found == Relation::b_inside);
    if (found != truth && !either) {
      out.difference = {s, pair, truth, found};
      return out;
    }
  }
  out.difference = facts.difference;
  return out;
}

/// Calls work(step) for all steps, in order; steps after one for which it gave false may be left out.
template <class Work>
void for_each_step(StepRange steps, int threads, Progress& progress, Work work) {
  std::atomic<std::uint64_t> next = steps.first;
  const auto stop = [&] { next = steps.last; };
  const auto loop = [&] {
    for (std::uint64_t s = next++; s < steps.last; s = next++) {
      stop_if_wanted();
      if (!work(s)) stop();
      progress.add(1);
    }
  };
  on_threads(std::size_t(std::min<std::uint64_t>(std::uint64_t(std::max(threads, 1)), steps.size())), loop, stop);
}

std::string aligned(const std::string& name, std::uint64_t pairs, const std::string& checked) {
  std::string count = std::to_string(pairs);
  count.insert(0, 12 - std::min<std::size_t>(12, count.size()), ' ');
  return name + std::string(42 - name.size(), ' ') + count + "  " + checked + "\n";
}

}  // namespace

std::string text_of(Relation relation) {
  constexpr const char* kTexts[] = {"apart",
                                    "meet",
                                    "contained",
                                    "contained, the first in the second",
                                    "contained, the second in the first",
                                    "no pair that counts"};
  return kTexts[std::size_t(relation)];
}

Verified verify(const Result& result, StepRange steps, std::optional<std::uint64_t> pairs, int threads, bool quiet) {
  std::vector<Facts> facts(steps.size());
  {
    Progress progress("extents", steps.size(), quiet);
    for_each_step(steps, threads, progress, [&](std::uint64_t s) {
      facts[s - steps.first] = facts_of(result, s);
      return !facts[s - steps.first].endless;
    });
  }
  Verified out;
  out.steps = steps;
  std::vector<Counts> before(steps.size() + 1);
  for (std::uint64_t i = 0; i < steps.size(); ++i) {
    if (facts[i].endless)
      throw Error(kFailed,
                  "step " + std::to_string(steps.first + i) + ": the world vertices of '" +
                      result.bodies.name[*facts[i].endless] +
                      "' are not finite, so that nothing can be decided about it; leave the step out by --steps");
    for (std::size_t c = 0; c < kClasses; ++c) before[i + 1][c] = before[i][c] + facts[i].there[c];
    out.far += facts[i].far;
  }
  const Counts& there = before.back();
  out.meet.pairs = there[kMeet];
  out.contained.pairs = there[kContained];
  out.near.pairs = there[kNear];

  std::array<Sample, kClasses> samples;
  if (pairs) {
    const Counts wanted = shares(there, *pairs);
    for (std::size_t c = 0; c < kClasses; ++c) samples[c] = sample(there[c], wanted[c], c);
  }
  Surfaces surfaces;
  if (result.truth.lists_contained())
    for (const geometry::Mesh& mesh : result.bodies.meshes)
      surfaces.push_back(oracle::closed_surface(mesh, result.bodies.closed_within));
  std::vector<Asked> asked(steps.size());
  {
    Progress progress("oracle", steps.size(), quiet);
    for_each_step(steps, threads, progress, [&](std::uint64_t s) {
      const std::uint64_t i = s - steps.first;
      asked[i] = ask(result, surfaces, s, facts[i], samples, before[i]);
      return !asked[i].difference;
    });
  }
  for (const Asked& step : asked) {
    out.meet.checked += step.checked[kMeet];
    out.contained.checked += step.checked[kContained];
    out.near.checked += step.checked[kNear];
    if (step.difference) {
      out.difference = step.difference;
      break;  // steps after it may or may not have been asked about
    }
  }
  return out;
}

std::string difference_text(const Verified& verified, const Result& result) {
  const Difference& d = *verified.difference;
  return "step " + std::to_string(d.step) + ", '" + result.bodies.name[d.pair.a] + "' and '" +
         result.bodies.name[d.pair.b] + "' (" + std::to_string(d.pair.a) + ", " + std::to_string(d.pair.b) +
         "): the truth says " + text_of(d.truth) + ", the oracle says " + text_of(d.oracle);
}

std::string verified_text(const Verified& verified, const Result& result) {
  std::string text = result.title + "\nsteps " + std::to_string(verified.steps.first) + ":" +
                     std::to_string(verified.steps.last) + " of " + std::to_string(result.steps()) + ", " +
                     std::to_string(verified.pairs()) + " pairs\n\n";
  const auto row = [&](const char* name, const Verified::Class& c) {
    text += aligned(name, c.pairs, std::to_string(c.checked) + " checked in exact arithmetic");
  };
  row("listed as meeting", verified.meet);
  if (result.truth.lists_contained()) row("listed as contained", verified.contained);
  row("listed as neither, boxes touch", verified.near);
  text += aligned("listed as neither, boxes do not touch", verified.far, "all proved apart by their coordinates");
  text += '\n';
  text += std::to_string(verified.checked()) + " pairs checked in exact arithmetic: ";
  text += verified.difference ? "1 difference, the first in order; what follows it was not judged\n"
                              : "the oracle agrees about all of them\n";
  return text;
}

std::string verified_json(const Verified& verified, const Result& result, const std::string& path) {
  using Json = nlohmann::ordered_json;
  const auto of = [](const Verified::Class& c) { return Json{{"pairs", c.pairs}, {"checked", c.checked}}; };
  Json json = {{"file", path},
               {"title", result.title},
               {"steps", {verified.steps.first, verified.steps.last}},
               {"pairs", verified.pairs()},
               {"checked", verified.checked()},
               {"meet", of(verified.meet)},
               {"contained", of(verified.contained)},
               {"boxes_touch", of(verified.near)},
               {"boxes_apart", {{"pairs", verified.far}}},
               {"containment_checked", result.truth.lists_contained()},
               {"difference", nullptr}};
  if (const auto& d = verified.difference)
    json["difference"] = {{"step", d->step},
                          {"pair", {d->pair.a, d->pair.b}},
                          {"bodies", {result.bodies.name[d->pair.a], result.bodies.name[d->pair.b]}},
                          {"truth", text_of(d->truth)},
                          {"oracle", text_of(d->oracle)}};
  return dumped(json);
}

void add_verify(CLI::App& program, int& code) {
  struct Options {
    std::string file, steps = ":";
    std::uint64_t pairs = 10'000;
    int threads = 0;
    bool all = false, quiet = false, unsealed = false, json = false;
  };
  const auto o = std::make_shared<Options>();
  CLI::App& command =
      *program.add_subcommand("verify", "Recheck the truth of a result with an independent oracle in exact arithmetic");
  add_file(command, o->file);
  add_steps(command, o->steps);
  CLI::Option* pairs =
      command
          .add_option("--pairs", o->pairs,
                      "How many of the pairs whose boxes touch are drawn, always the same ones; without it 10000")
          ->option_text("N")
          ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 62));
  command.add_flag("--all", o->all, "All pairs")->excludes(pairs);
  add_threads(command, o->threads, "Threads, which change nothing but the time");
  add_quiet(command, o->quiet);
  add_unsealed(command, o->unsealed);
  add_json(command, o->json);
  command.callback([o, &code] {
    stop_on_signals();
    const Result result = whole_result(o->file, o->unsealed);
    const StepRange steps = step_range(o->steps, result.steps(), o->file);
    const Verified verified =
        verify(result, steps, o->all ? std::nullopt : std::optional(o->pairs), thread_count(o->threads), o->quiet);
    put(o->json ? verified_json(verified, result, o->file) : verified_text(verified, result));
    code = verified.difference ? kFailed : kDone;
    if (verified.difference) complain(o->file, difference_text(verified, result));
  });
}

}  // namespace pipeline
