#include "pipeline/stages/choice.hpp"

#include "pipeline/terminal/words.hpp"

namespace pipeline {

const algorithms::Algorithm& row_of(const AlgorithmChoice& choice) {
  if (choice.foreign) return choice.foreign->row;
  return choice.bound ? *choice.bound : *algorithms::find(choice.name);
}

std::string whose(const AlgorithmChoice& choice) {
  return (choice.place.empty() ? "" : choice.place + ": ") + "algorithm '" + choice.label + "': ";
}

std::unique_ptr<algorithms::Method> make_method(const AlgorithmChoice& choice, const geometry::Bodies& bodies) {
  if (choice.foreign) return choice.foreign->start(bodies, choice.label, knobs_json(choice.knobs));
  return row_of(choice).make(bodies, choice.knobs);
}

std::string knobs_json(const algorithms::Knobs& knobs) {
  std::string out = "{";
  for (const auto& [knob, value] : knobs) {
    if (out.size() > 1) out += ',';
    out += in_quotes(knob) + ':' + value_text(value);
  }
  return out + '}';
}

}  // namespace pipeline
