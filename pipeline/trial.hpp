// How long a run would take: a trial of its stages before it begins.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "pipeline/config.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/terminal/forecast.hpp"

namespace pipeline {

/// The stages of a run of the scene, from a trial of its motion, truth and methods that takes about `seconds`.
/// The trial is of the beginning and of a state in which all that is foreseen has happened (SceneKind::hurry); a step
/// between is taken as such a mixture as there are bodies to which it happened. Methods whose set-up would be large
/// are not made: recorded rates stand for them. Rates of cores that are busy with something else are not known.
std::vector<Stage> foreseen_stages(const Config& config, const Scene& scene, const Plan& plan, int threads,
                                   double seconds);

/// Of `detect` on an existing motion.
std::vector<Stage> foreseen_stages(const geometry::Bodies& bodies,
                                   const std::vector<std::vector<geometry::Pose>>& poses,
                                   const std::vector<AlgorithmChoice>& choices, std::int64_t repeats,
                                   std::uint64_t passes, const Plan& plan, double seconds);

/// Asks methods about a motion while it is made: what detection will take is known better the more of it is there.
class Looks {
 public:
  /// `detect` as foreseen_stages has it; everything else must outlive this object.
  Looks(const geometry::Bodies& bodies, const std::vector<AlgorithmChoice>& choices, std::int64_t repeats,
        const Plan& plan, Stage detect);
  ~Looks();

  /// Asks about the last of the poses so far. Returns the stage as it is foreseen now: what was asked about as it was
  /// found, the rest as before, times how far the last two looks were from what was foreseen for them.
  Stage look(const std::vector<std::vector<geometry::Pose>>& poses);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Of extremes and of studies, which have recorded rates.
std::vector<Stage> foreseen_stages(const Config& config, const Plan& plan, int threads);

/// From `least` to `most`: what was foreseen and its spread.
struct Seconds {
  double least = 0, most = 0;
};
Seconds range(const std::vector<Stage>& stages, const Config& config);

/// "about 50 s to 3 min".
std::string duration_text(double seconds);

}  // namespace pipeline
