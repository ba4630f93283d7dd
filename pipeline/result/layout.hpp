// A result as named arrays: the one description of the file's contents, which the writer puts into HDF5 and the digest
// reads from memory. Knows names, units and dimensions; knows no HDF5.
#pragma once
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pipeline/result/columns.hpp"
#include "pipeline/result/result.hpp"

namespace pipeline {

/// What the elements of a dataset are. Numbers are little-endian.
enum class Type { f64, i64, u64, u32, u8, text };

/// Bytes of one element; 0 for text.
std::size_t size_of(Type type);

template <typename T>
constexpr Type type_of() {
  if constexpr (std::same_as<T, double>) return Type::f64;
  if constexpr (std::same_as<T, std::int64_t>) return Type::i64;
  if constexpr (std::same_as<T, std::uint64_t>) return Type::u64;
  if constexpr (std::same_as<T, std::uint32_t>) return Type::u32;
  if constexpr (std::same_as<T, std::uint8_t>) return Type::u8;
}

/// A named scalar of a group or dataset.
struct Attribute {
  std::string name;
  std::variant<std::string, std::int64_t, double, std::uint8_t> value;
};

/// What a dataset is to the dimensions of others.
enum class Scale {
  none,
  values,  // a scale with values: step numbers, names
  bare     // gives a dimension its name and size only; no values are stored (netCDF's "dimension without a variable")
};

/// One array. Moves only: `bytes` may point into `owned`, or into the Result it was made from.
struct Dataset {
  std::string path;  // absolute
  Type type = Type::f64;
  std::vector<std::uint64_t> shape;  // empty: a scalar
  std::vector<std::string> dims;     // for every dimension the path of its scale; a scale names itself
  std::string units, long_name;
  std::span<const std::byte> bytes;  // row-major; empty for text and bare scales
  std::vector<std::string> text;     // row-major; of text only
  Scale scale = Scale::none;
  bool grows = false;  // of scales: the dimension is unlimited
  std::vector<Attribute> attributes;
  std::vector<std::byte> owned;

  Dataset() = default;
  Dataset(Dataset&&) = default;
  Dataset& operator=(Dataset&&) = default;

  std::uint64_t elements() const;
};

/// One group, its attributes and the datasets directly in it.
struct Group {
  std::string path;
  std::vector<Attribute> attributes;
  std::vector<Dataset> datasets;
  bool digested = false;  // it carries a digest of its own
};

/// Everything that the file holds but the digests, the root first. Points into `result`, which must outlive it.
std::vector<Group> layout(const Result& result);

/// The last name of a path.
std::string_view base_name(std::string_view path);

inline constexpr Column<GapLists, std::vector<double>> kGapReals[] = {
    {"gap_lower", &GapLists::lower, "m", "the distance of the pair's surfaces is at least this, certified"},
    {"gap_upper", &GapLists::upper, "m", "the distance of the pair's surfaces is at most this, certified"}};

inline constexpr Column<ExtremeCase, std::string> kCaseTexts[] = {
    {"pair", &ExtremeCase::pair, "1", "the two shapes"},
    {"gap_class", &ExtremeCase::gap_class, "1",
     "the gap as it was asked for: ulps, or a part of the scale; negative: beyond touching"}};
inline constexpr Column<ExtremeCase, double> kCaseReals[] = {
    {"gap", &ExtremeCase::gap, "m", "displacement along the approach from exact touching; positive: apart"},
    {"ulp", &ExtremeCase::ulp, "m", "spacing of doubles at the greatest coordinate, offset + 8 scale"},
    {"scale", &ExtremeCase::scale, "m", "size of the bodies: about half their extent"},
    {"offset", &ExtremeCase::offset, "m", "each coordinate at which the first body stands"}};
inline constexpr Column<ExtremeCase, std::int64_t> kCaseIntegers[] = {
    {"gap_ulps", &ExtremeCase::gap_ulps, "1", "gap in units of ulp"}};
inline constexpr Column<ExtremeCase, std::uint64_t> kCaseCounts[] = {
    {"orientation_stream", &ExtremeCase::orientation, "1", "stream of the seed that turned the two and chose the way"}};
inline constexpr Column<ExtremeCase, std::uint8_t> kCaseFlags[] = {
    {"truth", &ExtremeCase::truth, "1", "1 when the pair meets, by which answers are scored"},
    {"truth_moved", &ExtremeCase::truth_moved, "1",
     "1 when the pair meets with both bodies moved by an exactly representable step, by the same truth"},
    {"near_touching", &ExtremeCase::near_touching, "1",
     "1 within 1000 ulps of touching, or where the truth changes within 1000 ulps: to be counted apart"}};
inline constexpr Column<ExtremeAnswers, std::vector<std::uint8_t>> kCaseAnswerFlags[] = {
    {"reported", &ExtremeAnswers::reported, "1", "1 when the algorithm reported the pair"},
    {"swapped", &ExtremeAnswers::swapped, "1", "its answer with the two bodies in the other order"},
    {"moved", &ExtremeAnswers::moved, "1", "its answer with both bodies moved by an exactly representable step"},
    {"failed", &ExtremeAnswers::failed, "1", "1: it refused the bodies, 2: it threw; then its other flags are 0"}};
inline constexpr Column<ExtremeAnswers, std::string> kCaseReason{
    "failure", &ExtremeAnswers::reason, "1", "what the algorithm said when it first failed; empty: it never did"};

inline constexpr Column<PhysicsSample, double> kPhysicsReals[] = {
    {"energy", &PhysicsSample::energy, "J", "kinetic, gravity and elastic energy; gravity counted from y = 0"},
    {"kinetic_energy", &PhysicsSample::kinetic_energy, "J", "kinetic energy"},
    {"greatest_penetration", &PhysicsSample::greatest_penetration, "m", "greatest depth of a contact; 0 without one"}};
inline constexpr Column<PhysicsSample, std::int64_t, std::uint64_t> kPhysicsCounts[] = {
    {"contacts", &PhysicsSample::contacts, "1", "contacts at the sample"},
    {"integrator_steps", &PhysicsSample::integrator_steps, "1", "internal steps since the sample before"},
    {"rejected_steps", &PhysicsSample::rejected_steps, "1", "internal steps rejected since the sample before"},
    {"force_evaluations", &PhysicsSample::force_evaluations, "1", "evaluations of forces since the sample before"}};
inline constexpr Column<PhysicsSample, std::int64_t> kPhysicsTimes[] = {
    {"time_ns", &PhysicsSample::time_ns, "ns", "wall time of the integration since the sample before"},
    {"contact_time_ns", &PhysicsSample::contact_time_ns, "ns", "part of time_ns spent on contacts and their forces"}};

inline constexpr Column<PassRow, std::string> kPassTexts[] = {
    {"target", &PassRow::target, "1", "body that the hero passes through"},
    {"path", &PassRow::path, "1", "name of the path: x, y and z are straight along that axis"},
    {"orientation", &PassRow::orientation, "1",
     "the hero's own y axis lies along the path, or across: along the second axis after the path's; or as given"}};
inline constexpr Column<PassRow, double> kPassReals[] = {
    {"offset", &PassRow::offset, "m", "distance of the path from the target's position"},
    {"truth_first", &PassRow::truth_first, "m", "way from the path's start to the exact first contact; NaN: none"},
    {"truth_last", &PassRow::truth_last, "m", "way from the path's start to the exact last contact; NaN: none"}};
inline constexpr Column<PassRow, std::uint64_t> kPassCounts[] = {
    {"first_step", &PassRow::first_step, "1", "step of the first sample of the pass"},
    {"samples", &PassRow::samples, "1", "samples of the pass, one a step, at equal distances"},
    {"truth_hits", &PassRow::truth_hits, "1", "samples that truly meet"}};
inline constexpr Column<PassAnswers, std::vector<double>> kPassAnswerReals[] = {
    {"first", &PassAnswers::first, "m",
     "how far before (positive) or after (negative) the exact first contact it first reports; NaN: one of them is "
     "none"},
    {"last", &PassAnswers::last, "m",
     "how far before (positive) or after (negative) the exact last contact it last reports; NaN: one of them is none"}};
inline constexpr Column<PassAnswers, std::vector<std::uint64_t>> kPassAnswerCounts[] = {
    {"flicker", &PassAnswers::flicker, "1", "changes of its answer between neighbouring samples that both truly meet"},
    {"hits", &PassAnswers::hits, "1", "samples reported, whether they truly meet or not"}};

inline constexpr Column<StudyRow, std::string> kStudyTexts[] = {
    {"sweep", &StudyRow::sweep, "1", "name of the [[sweep]] of the configuration"},
    {"problem", &StudyRow::problem, "1", "what is integrated (pipeline list problems)"},
    {"integrator", &StudyRow::integrator, "1", "name of the integrator"},
    {"units", &StudyRow::units, "1", "SI, or scaled: integrated in units of the problem's own length, mass and time"},
    {"status", &StudyRow::status, "1",
     "finished, exception, not_finite, energy, evaluations, time, tunnelled or aborted"},
    {"reason", &StudyRow::reason, "1", "why it did not finish, or why its error is not known"}};
/// What a case is made of; NaN where its problem has no such parameter.
inline constexpr Column<StudyRow, double> kStudyParameters[] = {
    {"accuracy", &StudyRow::accuracy, "1", "accuracy asked of the integrator; NaN: the step is fixed"},
    {"fixed_step", &StudyRow::fixed_step, "s", "length of every step; NaN: chosen by the accuracy"},
    {"nominal_order", &StudyRow::nominal_order, "1", "order of the integrator by its documentation; NaN: it varies"},
    {"duration", &StudyRow::duration, "s", "simulated time"},
    {"greatest_step", &StudyRow::greatest_step, "s", "steps are at most of this length, unless fixed"},
    {"radius", &StudyRow::radius, "m", "radius of the ball"},
    {"thickness", &StudyRow::thickness, "m", "thickness of the plate"},
    {"offset", &StudyRow::offset, "m", "everything is moved that far along x, y and z"},
    {"mass", &StudyRow::mass, "kg", "mass of the ball"},
    {"inertia", &StudyRow::inertia, "kg m^2", "moment of inertia of the ball"},
    {"balls", &StudyRow::balls, "1", "balls in the stack"},
    {"mass_ratio", &StudyRow::mass_ratio, "1", "mass of the topmost ball over that of each other"},
    {"speed", &StudyRow::speed, "m/s", "speed of approach or of the throw"},
    {"transition_velocity", &StudyRow::transition_velocity, "m/s", "slip at which friction is greatest"},
    {"stiffness", &StudyRow::stiffness, "Pa", "plane-strain modulus of the surfaces"},
    {"dissipation", &StudyRow::dissipation, "s/m", "Hunt and Crossley's"}};
inline constexpr Column<StudyRow, double> kStudyReals[] = {
    {"reached", &StudyRow::reached, "s", "simulated time reached"},
    {"error", &StudyRow::error, "1",
     "greatest over the bodies at the end: position error over the problem's length, or orientation error in rad; NaN: "
     "no reference"},
    {"position_error", &StudyRow::position_error, "m", "greatest error of a position at the end"},
    {"orientation_error", &StudyRow::orientation_error, "rad", "greatest error of an orientation at the end"},
    {"energy_error", &StudyRow::energy_error, "1",
     "energy gained (positive) or lost against its balance, over the problem's energy: the worst of 256 looks"},
    {"momentum_drift", &StudyRow::momentum_drift, "1",
     "worst deviation of linear or angular momentum from its balance, over the problem's; NaN: no balance is known"},
    {"greatest_penetration", &StudyRow::greatest_penetration, "m", "greatest depth of a contact after a step"},
    {"smallest_step", &StudyRow::smallest_step, "s", "shortest step but the last"},
    {"preventing_step", &StudyRow::preventing_step, "s",
     "where the ball tunnelled: the greatest step (to 2 %) that stops it from each of 64 phases; NaN: none was found"}};
inline constexpr Column<StudyRow, std::uint64_t> kStudyCounts[] = {
    {"steps", &StudyRow::steps, "1", "internal steps"},
    {"rejected_steps", &StudyRow::rejected_steps, "1", "internal steps tried and rejected"},
    {"force_evaluations", &StudyRow::force_evaluations, "1", "evaluations of forces"}};
inline constexpr Column<StudyRow, bool, std::uint8_t> kStudyFinished{"finished", &StudyRow::finished, "1",
                                                                     "1 when the end was reached"};
inline constexpr Column<StudyRow, std::int64_t> kStudyTime{
    "time_ns", &StudyRow::time_ns, "ns", "processor time of the integration; the fastest of up to five"};

/// Tells `each` every column of what an algorithm said about the cases of /extremes.
template <typename Each>
void each_case_answer_column(const Each& each) {
  for (const auto& column : kCaseAnswerFlags) each(column);
}

/// Tells `each` every column of /study, in the file's order.
template <typename Each>
void each_study_column(const Each& each) {
  for (const auto& column : kStudyTexts) each(column);
  for (const auto& column : kStudyParameters) each(column);
  for (const auto& column : kStudyReals) each(column);
  for (const auto& column : kStudyCounts) each(column);
  each(kStudyFinished);
  each(kStudyTime);
}

}  // namespace pipeline
