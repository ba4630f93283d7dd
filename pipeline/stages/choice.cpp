#include "pipeline/stages/choice.hpp"

#include "pipeline/terminal/words.hpp"

namespace pipeline {

std::string knobs_json(const algorithms::Knobs& knobs) {
  std::string out = "{";
  for (const auto& [knob, value] : knobs) {
    if (out.size() > 1) out += ',';
    out += in_quotes(knob) + ':' + value_text(value);
  }
  return out + '}';
}

}  // namespace pipeline
