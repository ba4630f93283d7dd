// A library of methods, each of which does one thing that a stranger's may do: most of them break a rule of
// algorithms/plugin.h, from the third step on, so that two steps are answered before. The rest tell what they were
// given.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "plugin.h"

struct collision_method {
  std::uint32_t bodies = 0;
  int prepared = 0;      // times
  double last_x = -1e9;  // of the first body: another one is another step
  int step = -1;
  const collision_pose* poses = nullptr;
  std::uint64_t learned = 0, remembered = 0;
};

namespace {

using Method = collision_method;

Method* create(const collision_bodies* bodies, const collision_value*, char*) {
  auto* method = new Method;
  method->bodies = bodies->body_count;
  return method;
}

// The number of a step is told by when the poses change: every repeat prepares anew.
int prepare(Method* method, const collision_pose* poses, double, char*) {
  double sum = 0;
  for (std::uint32_t body = 0; body < method->bodies; ++body)
    for (const double x : poses[body].position)
      if (!std::isnan(x)) sum += x * (body + 1);
  if (sum != method->last_x) ++method->step;
  method->last_x = sum;
  method->poses = poses;
  ++method->prepared;
  return 0;
}

void destroy(Method* method) { delete method; }

/// Every pair that is asked about: a right answer of a kind.
int all_pairs(Method*, const collision_run* runs, std::uint64_t run_count, collision_hits* hits) {
  for (std::uint64_t i = 0; i < run_count; ++i)
    for (std::uint32_t b = runs[i].first; b < runs[i].last; ++b)
      if (collision_hit(hits, runs[i].a, b)) return 1;
  return 0;
}

using Fault = int (*)(Method* method, const collision_run* runs, std::uint64_t run_count, collision_hits* hits,
                      char* error);

template <Fault fault>
int answer(Method* method, const collision_run* runs, std::uint64_t run_count, collision_hits* hits, char* error) {
  if (method->step < 2) return all_pairs(method, runs, run_count, hits);
  return fault(method, runs, run_count, hits, error);
}

template <Fault fault>
int count(Method* method, const collision_run* runs, std::uint64_t run_count, collision_hits* hits,
          std::uint64_t* operations, char* error) {
  *operations = 7;
  return answer<fault>(method, runs, run_count, hits, error);
}

// ---- What goes wrong -----------------------------------------------------------------------------------------------

int throws(Method*, const collision_run*, std::uint64_t, collision_hits*, char*) {
  throw std::runtime_error("thrown on purpose");
}
int throws_a_number(Method*, const collision_run*, std::uint64_t, collision_hits*, char*) { throw 7; }
int fails(Method*, const collision_run*, std::uint64_t, collision_hits*, char* error) {
  return collision_fail(error, "no more strength");
}
int fails_silently(Method*, const collision_run*, std::uint64_t, collision_hits*, char*) { return 1; }
int fails_at_length(Method*, const collision_run*, std::uint64_t, collision_hits*, char* error) {
  std::memset(error, 'x', COLLISION_ERROR_SIZE);  // without a NUL
  return -1;
}
int aborts(Method*, const collision_run*, std::uint64_t, collision_hits*, char*) {
  std::fprintf(stderr, "Assertion `sense > 0' failed.\n");
  std::abort();
}
int crashes(Method*, const collision_run*, std::uint64_t, collision_hits*, char*) {
  volatile int* nowhere = nullptr;
  return *nowhere;
}
int exits(Method*, const collision_run*, std::uint64_t, collision_hits*, char*) { std::_Exit(0); }
int hangs(Method*, const collision_run*, std::uint64_t, collision_hits*, char*) {
  for (volatile bool ever = true; ever;) continue;
  return 0;
}
int leaks(Method*, const collision_run*, std::uint64_t, collision_hits*, char*) {
  for (volatile bool ever = true; ever;) {
    constexpr std::size_t block = 64 << 20;
    auto* bytes = static_cast<char*>(std::malloc(block));
    if (!bytes) std::abort();
    std::memset(bytes, 1, block);
  }
  return 0;
}
int prints(Method* method, const collision_run* runs, std::uint64_t run_count, collision_hits* hits, char*) {
  for (int i = 0; i < 10000; ++i) std::printf("noise %d\n", i);
  std::fflush(stdout);
  return all_pairs(method, runs, run_count, hits);
}
int reports_unknown(Method*, const collision_run*, std::uint64_t, collision_hits* hits, char*) {
  return collision_hit(hits, 0, 4000000);
}
int reports_twice(Method*, const collision_run* runs, std::uint64_t, collision_hits* hits, char*) {
  return collision_hit(hits, runs[0].a, runs[0].first) || collision_hit(hits, runs[0].a, runs[0].first);
}
int reports_itself(Method*, const collision_run*, std::uint64_t, collision_hits* hits, char*) {
  return collision_hit(hits, 1, 1);
}
int reports_backwards(Method*, const collision_run* runs, std::uint64_t, collision_hits* hits, char*) {
  return collision_hit(hits, runs[0].first, runs[0].a);
}
/// A pair with a body that is not born; where all are, the first pair: nothing is wrong then.
int reports_unborn(Method* method, const collision_run* runs, std::uint64_t, collision_hits* hits, char*) {
  for (std::uint32_t body = 1; body < method->bodies; ++body)
    if (std::isnan(method->poses[body].position[0])) return collision_hit(hits, 0, body);
  return collision_hit(hits, runs[0].a, runs[0].first);
}
int overruns(Method*, const collision_run*, std::uint64_t, collision_hits* hits, char*) {
  hits->size = hits->capacity + 1;
  return 0;
}
/// Other answers in every repeat.
int wavers(Method* method, const collision_run* runs, std::uint64_t, collision_hits* hits, char*) {
  return method->prepared % 2 ? collision_hit(hits, runs[0].a, runs[0].first) : 0;
}
int nothing_wrong(Method* method, const collision_run* runs, std::uint64_t run_count, collision_hits* hits, char*) {
  return all_pairs(method, runs, run_count, hits);
}

// ---- What tells ----------------------------------------------------------------------------------------------------

std::string told;

/// Refuses whatever it gets, and says what that was.
Method* tell(const collision_bodies* bodies, const collision_value* knobs, char* error) {
  told = "flag " + std::to_string(knobs[0].integer) + ", integer " + std::to_string(knobs[1].integer) + ", real " +
         std::to_string(knobs[2].real) + ", choice " + knobs[3].text;
  for (std::uint32_t body = 0; body < bodies->body_count; ++body) {
    const collision_mesh& mesh = bodies->mesh[bodies->body_mesh[body]];
    told += "; " + std::string(bodies->name[body]) + " is a " + mesh.name + " of " + std::to_string(mesh.vertex_count) +
            " and " + std::to_string(mesh.triangle_count) + (bodies->fixed[body] ? ", fixed" : "") +
            (bodies->chosen && bodies->chosen[body] ? ", chosen" : "");
  }
  collision_fail(error, told.c_str());
  return nullptr;
}

Method* create_throws(const collision_bodies*, const collision_value*, char*) {
  throw std::runtime_error("thrown while it is set up");
}

Method* create_crashes(const collision_bodies*, const collision_value*, char*) { std::abort(); }

/// Learns in every call; operations are what it has remembered.
int learn(Method* method, const collision_run*, std::uint64_t, collision_hits*, std::uint64_t* operations, char*) {
  method->learned = method->remembered + 1;
  *operations = method->remembered;
  return 0;
}
int learn_unseen(Method* method, const collision_run*, std::uint64_t, collision_hits*, char*) {
  method->learned = method->remembered + 1;
  return 0;
}

// ---- The table -----------------------------------------------------------------------------------------------------

const char* const kSpeeds[] = {"fast", "slow", nullptr};
const collision_knob kKnobs[] = {
    {"flag", "1", "a flag", COLLISION_FLAG, {1, 0, nullptr}, 0, 0, nullptr},
    {"integer", "1", "an integer", COLLISION_INTEGER, {20, 0, nullptr}, 1, 100, nullptr},
    {"real", "m", "a real", COLLISION_REAL, {0, 0.25, nullptr}, 0, HUGE_VAL, nullptr},
    {"choice", "1", "a choice", COLLISION_CHOICE, {0, 0, "fast"}, 0, 0, kSpeeds},
};

collision_row row_of(const char* name) {
  collision_row row = {};
  row.name = name;
  row.what = "one of the tests' odd methods";
  row.unit = "calls";
  row.precision = "double";
  row.create = create;
  row.prepare = prepare;
  row.destroy = destroy;
  return row;
}

template <Fault fault>
collision_row odd(const char* name) {
  collision_row row = row_of(name);
  row.answer = answer<fault>;
  row.count = count<fault>;
  return row;
}

std::vector<collision_row> rows() {
  std::vector<collision_row> out = {
      odd<throws>("odd_throws"),
      odd<throws_a_number>("odd_throws_a_number"),
      odd<fails>("odd_fails"),
      odd<fails_silently>("odd_fails_silently"),
      odd<fails_at_length>("odd_fails_at_length"),
      odd<aborts>("odd_aborts"),
      odd<crashes>("odd_crashes"),
      odd<exits>("odd_exits"),
      odd<hangs>("odd_hangs"),
      odd<leaks>("odd_leaks"),
      odd<prints>("odd_prints"),
      odd<reports_unknown>("odd_unknown"),
      odd<reports_twice>("odd_twice"),
      odd<reports_itself>("odd_itself"),
      odd<reports_backwards>("odd_backwards"),
      odd<reports_unborn>("odd_unborn"),
      odd<overruns>("odd_overruns"),
      odd<wavers>("odd_wavers"),
      odd<nothing_wrong>("odd_good"),
  };
  collision_row plain = odd<nothing_wrong>("odd_uncounted");
  plain.count = nullptr;
  plain.unit = nullptr;
  out.push_back(plain);

  collision_row teller = odd<nothing_wrong>("odd_teller");
  teller.create = tell;
  teller.knobs = kKnobs;
  teller.knob_count = 4;
  out.push_back(teller);

  collision_row thrower = odd<nothing_wrong>("odd_create_throws");
  thrower.create = create_throws;
  out.push_back(thrower);

  collision_row crasher = odd<nothing_wrong>("odd_create_crashes");
  crasher.create = create_crashes;
  out.push_back(crasher);

  collision_row learner = row_of("odd_learner");
  learner.answer = learn_unseen;
  learner.count = learn;
  learner.remember = [](Method* method) { method->remembered = method->learned; };
  learner.forget = [](Method* method) { method->remembered = 0; };
  out.push_back(learner);
  return out;
}

}  // namespace

COLLISION_EXPORT const collision_table* collision_plugin() {
  static const std::vector<collision_row> all = rows();
  static const std::vector<const collision_row*> pointers = [] {
    std::vector<const collision_row*> out;
    for (const collision_row& row : all) out.push_back(&row);
    return out;
  }();
  static const collision_table table = {COLLISION_ABI, static_cast<std::uint32_t>(all.size()), pointers.data(),
                                        "odd 1"};
  return &table;
}
