// What an approximate algorithm is to the rest of the program: a row of data.
//
// To add one: a file pair whose .cpp ends in a function that returns its row, and one line in all.cpp.
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "algorithms/contract/proxy.hpp"
#include "geometry/bodies.hpp"

namespace algorithms {

using geometry::Bodies;
using geometry::Pair;
using geometry::PairRun;
using geometry::Pose;

/// conservative: never misses a pair that truly meets (outside rounding); exact: neither misses one nor reports
/// another.
enum class Promise { none, conservative, exact };

/// pair: visits every pair; scene: has a broad phase of its own.
enum class Scope { pair, scene };

std::string_view text(Promise promise);
std::string_view text(Scope scope);

/// The value of a knob.
using Value = std::variant<bool, std::int64_t, double, std::string>;

/// What a knob is to others than its method.
enum class Role {
  plain,
  prefilter,    // names the row that answers first; what it may name is known to the whole table alone
  then,         // names the row that answers last and whose promise is kept; likewise
  density,      // whether facets are cut before they are sampled: only rows that sample facets have it
  containment,  // whether a body inside another is a hit: where nobody says, as in the truth that scores
  files,        // a text "mesh=file;mesh=file": what is in the files reaches a row in a way of its own (proxy.hpp)
};

/// A parameter of an algorithm. The type of `preset` is the knob's type.
struct Knob {
  std::string name;
  Value preset;                                             // used when the configuration is silent
  std::string unit;                                         // "1" for counts and flags
  std::string what;                                         // one line
  double least = -std::numeric_limits<double>::infinity();  // of numbers, inclusive
  double most = std::numeric_limits<double>::infinity();
  std::vector<std::string> choices = {};  // of texts; empty: not a text
  bool (*valid)(const Value&) = nullptr;  // a further rule, stated in `rule`
  std::string rule = {};                  // what follows "must" in the message, e.g. "divide 180"
  Role role = Role::plain;
};

/// Every knob of an algorithm with its value.
using Knobs = std::map<std::string, Value, std::less<>>;

/// The value of the knob `name`, of the type of its preset. Throws std::out_of_range or std::bad_variant_access: both
/// are errors of the program, since a row's `make` is given every knob of the row.
template <class T>
const T& value_of(const Knobs& knobs, std::string_view name) {
  const auto found = knobs.find(name);
  if (found == knobs.end()) throw std::out_of_range("no knob '" + std::string(name) + "'");
  return std::get<T>(found->second);
}

/// One algorithm, set up for the bodies of a run. Not shared between threads.
class Method {
 public:
  virtual ~Method() = default;

  /// The work that depends on one body only, for all bodies of a step. With `enlarge` > 0 boxes and radii grow by
  /// enlarge * (size + |t|): asked of conservative methods only, to tell a rounding miss from a broken promise.
  virtual void prepare(std::span<const Pose> poses, double enlarge = 0) = 0;

  /// Appends to `hits` the pairs among `runs` that the algorithm reports, each once, in any order. After prepare.
  virtual void answer(std::span<const PairRun> runs, std::vector<Pair>& hits) = 0;

  /// The same answers, and how many elementary tests `answer` makes for them (unit: Algorithm::operations_unit), its
  /// cheap rejections one each and its prefilter's included: not those of the published procedure where it leaves some
  /// out. The same on every machine. Not timed.
  virtual std::uint64_t count(std::span<const PairRun> runs, std::vector<Pair>& hits) = 0;

  /// What the last `answer` or `count` learned becomes the memory that the next ones start from. Until then they leave
  /// the memory as it is, however often they are asked, so that every repeat of a step does the same work. Not timed:
  /// it may only swap what was learned in. A memory may make answers cheaper, never other ones.
  virtual void remember() {}

  /// Empties the memory: the next step is answered as the first of all.
  virtual void forget() {}
};

/// Bytes of heap that a method takes.
struct Memory {
  std::uint64_t held = 0;      // once it has answered about every body
  std::uint64_t greatest = 0;  // at any time: while it is made, or later
};

/// Somebody else's library that answers for a row.
struct Library {
  std::string name = {};     // empty: the row is of this project
  std::string package = {};  // Debian's, to build with it
  std::string version = {};  // that this build has; empty: it is without
  std::string sha256 = {};   // of a shared library of others, whose code belongs into a child process; empty: ours
  bool plugin = false;       // it answers from a plug-in of this project, which lies beside the program
  std::string tests = {};    // what it takes bodies for: "convex hulls", ...; empty: not said
  std::string licence = {}, language = {};
};

/// One row of the table of algorithms.
struct Algorithm {
  std::string name;                 // file name, TOML name and HDF5 name
  std::string thesis_key = {};      // the letter of the thesis, or empty
  std::string what;                 // one line
  std::string operations_unit;      // what `count` counts
  Promise promise = Promise::none;  // with the presets
  Scope scope = Scope::pair;
  std::string precision = "double";  // of the arithmetic that decides
  Library library = {};
  std::vector<Knob> knobs = {};
  std::function<std::unique_ptr<Method>(const Bodies& bodies, const Knobs& knobs)> make = nullptr;
  bool fits_all = false;  // `make` refuses no bodies, however bad: nobody need make it only to ask
  /// What `make` would take, told from sizes alone: quick however much that is. Within a factor of 1.5 from 100 KiB on.
  /// Throws what `make` throws for knobs that do not fit the meshes. Null: not known, counted as a copy of the meshes.
  std::function<Memory(const Bodies& bodies, const Knobs& knobs)> memory = nullptr;
  /// What its methods test in place of each distinct mesh, in their order: the very shapes that `make` makes. Throws
  /// what `make` throws. Null: the mesh itself, or nothing that stays the same from pose to pose.
  std::function<std::vector<Proxy>(const Bodies& bodies, const Knobs& knobs)> proxies = nullptr;
};

/// What a method of the row would take, also where the row does not say.
Memory memory(const Algorithm& row, const Bodies& bodies, const Knobs& knobs);

/// Every algorithm that this build can ask, in the thesis's order; those of other sources follow.
const std::vector<Algorithm>& all();

/// Those whose library this build is without, or has as a plug-in that nobody asked for yet: known by name, without
/// `make`.
const std::vector<Algorithm>& missing();

/// Rows of shared libraries of others that were added, in order. None is ever moved.
const std::deque<Algorithm>& added();

/// Adds a row whose name no other has.
void add(Algorithm row);

/// The row of that name, or nullptr; of all() and added(), and of missing() as long as it is not added.
const Algorithm* find(std::string_view name);
const Algorithm* find_missing(std::string_view name);

/// What a row of missing() needs and how to get it: "FCL; scripts/peers installs it ...".
std::string remedy(const Algorithm& row);

/// What its methods promise with these knobs: where one of them names the row that answers last, what that one does.
Promise promise(const Algorithm& row, const Knobs& knobs);

/// Whether its methods sample facets with these knobs: its own, its prefilter's or those of the row that answers last.
bool samples_facets(const Algorithm& row, const Knobs& knobs);

/// The knobs of `algorithm`, all at their presets.
Knobs presets(const Algorithm& algorithm);

/// `value` as the knob's type when it is allowed (an integer serves a real knob); otherwise throws
/// std::invalid_argument with the rule, e.g. "must be between 1 and 1000000".
Value checked(const Knob& knob, const Value& value);

}  // namespace algorithms
