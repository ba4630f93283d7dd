// What the pipeline and a method of others say of themselves before the first step: JSON in frames HELO.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "algorithms/contract/algorithm.hpp"

namespace pipeline {

/// What a method of others says of itself.
struct About {
  std::string name = {}, version = {}, language = {};
  std::string tests = {};            // what it tests: "meshes", "hulls", "boxes", ...; empty: it does not say
  std::string licence = {};          // of what answers
  std::string precision = "double";  // in which it computes
  algorithms::Promise promise = algorithms::Promise::none;
  algorithms::Scope scope = algorithms::Scope::pair;
  std::string operations_unit = {};  // empty: it does not count
  bool remembers = false;            // it has a memory between steps
  std::int64_t threads = 1;          // that it uses
  std::int64_t setup_ns = 0;         // of its construction for the bodies of the run
  std::int64_t memory_bytes = -1;    // that it holds; -1: it does not say
  std::string refuses = {};          // why it cannot take these bodies; empty: it can

  /// Throws Fault where it cannot.
  void takes_them() const;
};

/// What a method is told of the run: protocol, label, bodies (name, mesh, fixed), meshes (name, vertices, triangles)
/// and knobs. `knobs` is a JSON object. Throws Error(kInput) when it is longer than a frame can be.
std::string hello_text(const std::string& label, const geometry::Bodies& bodies, const std::string& knobs);

/// The answer to it, and back. about_in throws Fault with the key and its rule.
std::string text_of(const About& about);
About about_in(std::string_view json);

}  // namespace pipeline
