// `pipeline list WHAT`: what configurations can name. WHAT is algorithms, scenes, shapes, integrators,
// problems, keys (of a configuration) or datasets (of a result).
#pragma once
#include <string>

namespace pipeline {

std::string list_text(const std::string& what);
std::string list_json(const std::string& what);

}  // namespace pipeline
