// The datasets that a result can hold, as `pipeline list datasets` tells them.
#pragma once
#include <string>
#include <vector>

namespace pipeline {

struct DatasetFacts {
  std::string path;   // <mesh> and <label> stand for names
  std::string shape;  // "S, B, 3": S steps, B bodies, A algorithms, V vertices, T triangles, E entries, P passes, C
                      // cases, K contact spheres
  std::string type;   // of numpy: "float64", ...; "text"
  std::string unit, long_name;
  std::string when;  // "always", or what it takes
};

/// All of them, in the file's order: the layout of small results, of which each has one thing more than the first.
std::vector<DatasetFacts> dataset_facts();

}  // namespace pipeline
