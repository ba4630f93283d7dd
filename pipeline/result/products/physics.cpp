#include "pipeline/result/products/physics.hpp"

#include <cassert>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pipeline/result/dataset.hpp"
#include "pipeline/result/hdf5/reader.hpp"
#include "pipeline/result/products/all.hpp"

namespace pipeline {
namespace {

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

template <typename Each>
void each_column(const Each& each) {
  for (const auto& column : kPhysicsReals) each(column);
  for (const auto& column : kPhysicsCounts) each(column);
  for (const auto& column : kPhysicsTimes) each(column);
}

void lay(const Result& result, const Sizes& n, std::vector<Group>& groups) {
  const PhysicsRows& physics = *result.products.find<PhysicsRows>();
  Group group{"/physics", {{"status", physics.status}}, {}};
  if (!std::isnan(physics.quaternion_drift)) group.attributes.push_back({"quaternion_drift", physics.quaternion_drift});
  assert(physics.rows.size() == n.step.size && "a row for every step");
  each_column([&](const auto& column) { group.datasets.push_back(of_rows(group.path, column, physics.rows, n.step)); });
  groups.push_back(std::move(group));
}

void read(const Reader& from, Result& result) {
  PhysicsRows physics;
  physics.status = from.attribute<std::string>("/physics", "status");
  if (from.has_attribute("/physics", "quaternion_drift"))
    physics.quaternion_drift = from.attribute<double>("/physics", "quaternion_drift");
  physics.rows.resize(result.steps());
  each_column([&](const auto& column) { from.rows("/physics", column, physics.rows); });
  result.products.put(std::move(physics));
}

std::string failure(const Result& result) {
  const std::string& status = result.products.find<PhysicsRows>()->status;
  return status == "complete" ? "" : "the integration " + status;
}

void json(const Result& result, OrderedJson& out) {
  const PhysicsRows* physics = result.products.find<PhysicsRows>();
  out["integration"] = physics ? OrderedJson(physics->status) : OrderedJson(nullptr);
}

Cost cost(const OrderedJson& asked, const Extent& run) {
  constexpr double kStep = 32;  // bytes of a step's row
  return asked.contains("physics") ? Cost{.objects = 10, .bytes = kStep * run.steps} : Cost{};
}

}  // namespace

Product physics_product() {
  return {
      .name = "physics",
      .place = Product::Place::after_motion,
      .sign = "/physics",
      .has = [](const Result& result) { return result.products.find<PhysicsRows>() != nullptr; },
      .lay = lay,
      .read = read,
      .when = "the scene is integrated",
      .sample = [](Result& result) { result.products.put(PhysicsRows{}).rows.resize(2); },

      .failure = failure,
      .line = [](const Result& result) { return "integration " + result.products.find<PhysicsRows>()->status + "\n"; },
      .json = json,
      .cost = cost};
}

}  // namespace pipeline
