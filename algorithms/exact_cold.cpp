#include "algorithms/exact_cold.hpp"

#include "algorithms/parts/deciding.hpp"

namespace algorithms {

Algorithm exact_cold() {
  return {.name = "exact_cold",
          .what = "exact predicates behind hierarchies; every step as if it were the first",
          .operations_unit = std::string(kDecidingUnit),
          .promise = Promise::exact,
          .scope = Scope::scene,
          .knobs = {containment_knob()},
          .make = [](const Bodies& bodies, const Knobs& knobs) { return make_deciding(bodies, knobs, false); },
          .memory = deciding_memory};
}

}  // namespace algorithms
