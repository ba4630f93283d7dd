// The keys that configurations can have, as `pipeline list keys` tells them.
#pragma once
#include <string>
#include <vector>

#include "pipeline/scene/document.hpp"

namespace pipeline {

struct KeyFacts {
  AskedKey key;            // as its reader asks for it; an entry of an array of tables is N, of a shape "SHAPE."
  std::string unit, what;  // "1" where it has none; one line
  std::vector<std::string> where;  // kinds of scenes, of shapes, problems of studies that have it
};

/// All of them, those of the whole first. Type, preset and rule are what the readers ask for when they read one example
/// of every kind; unit and what come from a table here. `what` is empty of a key that the table does not have.
std::vector<KeyFacts> key_facts();

/// Keys of that table which no reader asks for: there should be none.
std::vector<std::string> unasked_keys();

}  // namespace pipeline
