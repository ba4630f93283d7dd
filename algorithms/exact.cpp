#include "algorithms/exact.hpp"

#include "algorithms/parts/deciding.hpp"

namespace algorithms {

Algorithm exact() {
  return {.name = "exact",
          .what = "exact predicates behind hierarchies; starts from what the step before taught",
          .operations_unit = std::string(kDecidingUnit),
          .promise = Promise::exact,
          .scope = Scope::scene,
          .knobs = {containment_knob()},
          .make = [](const Bodies& bodies, const Knobs& knobs) { return make_deciding(bodies, knobs, true); },
          .memory = deciding_memory};
}

}  // namespace algorithms
