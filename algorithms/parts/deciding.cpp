#include "algorithms/parts/deciding.hpp"

#include <algorithm>
#include <optional>

#include "geometry/decision/contain.hpp"
#include "geometry/decision/meet.hpp"

namespace algorithms {
namespace {

constexpr char kContainment[] = "containment";

std::vector<geometry::Solid> solids_of(const Bodies& bodies) {
  std::vector<geometry::Solid> solids;
  for (const geometry::Mesh& mesh : bodies.meshes) solids.push_back(geometry::solid_of(mesh, bodies.closed_within));
  if (std::ranges::none_of(solids, &geometry::Solid::closed))
    throw std::invalid_argument("no mesh is closed, so nothing can be inside another: mesh '" + bodies.meshes[0].name +
                                "' is open, " + geometry::open_text(solids[0]) +
                                "; close it, or set containment = false");
  return solids;
}

class Deciding final : public Method {
 public:
  Deciding(const Bodies& bodies, bool containment, bool remembers)
      : bodies_(bodies),
        bvhs_(geometry::build_bvhs(bodies)),
        solids_(containment ? solids_of(bodies) : std::vector<geometry::Solid>{}),
        containment_(containment),
        remembers_(remembers) {
    Deciding::forget();
  }

  void prepare(std::span<const Pose> poses, double /*enlarge*/) override { decision_->prepare(poses); }

  void answer(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    contained_.clear();
    decision_->hits(runs, hits, containment_ ? &contained_ : nullptr);
    for (const geometry::Contained& one : contained_) hits.push_back(one.pair);
  }

  std::uint64_t count(std::span<const PairRun> runs, std::vector<Pair>& hits) override {
    answer(runs, hits);
    return decision_->operations();
  }

  void remember() override {
    if (remembers_) decision_->remember();
  }

  /// All of it, also in what order the sweep left the bodies: that shows in the number of its comparisons.
  void forget() override { decision_.emplace(bodies_, bvhs_, solids_); }

 private:
  const Bodies& bodies_;
  std::vector<geometry::Bvh> bvhs_;             // one per distinct mesh
  std::vector<geometry::Solid> solids_;         // likewise, or none
  std::optional<geometry::Decision> decision_;  // refers to both
  bool containment_, remembers_;
  std::vector<geometry::Contained> contained_;
};

}  // namespace

Knob containment_knob() {
  return {.name = kContainment,
          .preset = false,
          .unit = "1",
          .what = "bodies wholly inside others are hits too; follows truth.containment unless given",
          .role = Role::containment};
}

Memory deciding_memory(const Bodies& bodies, const Knobs&) {
  const geometry::BvhsBytes hierarchies = geometry::bvhs_bytes(bodies);
  const std::uint64_t held = hierarchies.held + geometry::broad_phase_bytes(bodies);
  return {held, std::max(held, hierarchies.greatest)};
}

std::unique_ptr<Method> make_deciding(const Bodies& bodies, const Knobs& knobs, bool remembers) {
  return std::make_unique<Deciding>(bodies, value_of<bool>(knobs, kContainment), remembers);
}

}  // namespace algorithms
