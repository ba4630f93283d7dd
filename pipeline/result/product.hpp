// Products: what some results hold besides bodies, motion, truth and answers, as passes and cases of extremes.
//
// A product is a row of products() and a file of its own under products/: its values in memory (Result::products has
// them by type), its place in the file, its columns with units and long names, how it is read, and what the commands
// say of it. layout, reader, checkpoint, show, check and score loop over the rows and know no product. To add one,
// write products/<name>.cpp and its line in products/all.cpp; where its values follow from the rest of the result,
// `make` is all of it, else a stage puts them into the result.
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "pipeline/result/result.hpp"

namespace pipeline {

struct Group;
struct Sizes;
class Reader;

using OrderedJson = nlohmann::ordered_json;

/// How large a run is that is only foreseen.
struct Extent {
  double steps = 0, labels = 0;
  double moving = 0;  // poses of bodies that move, over all steps
};

/// What a product adds to the file, about.
struct Cost {
  double objects = 0;  // groups and datasets
  double bytes = 0;
};

/// One product, as data. What is null is not for it. Unless it says otherwise a function is called where `has` holds.
struct Product {
  enum class Place {
    alone,         // there is no scene: of studies
    after_motion,  // a group of its own, at these places
    in_truth,      // within /truth, part of its digest
    at_end
  };

  std::string name;
  Place place;
  std::string sign;  // the group or dataset by which a file has it
  bool (*has)(const Result&);

  // ---- The file ----
  void (*lay)(const Result&, const Sizes&, std::vector<Group>&);  // adds its group, or its datasets to the last one
  void (*read)(const Reader&, Result&);                           // all that is no product has been read
  /// Chunks of FILE.part that it alone has, one a case: their name. Others are part of motion, truth or answers.
  const char* chunks = nullptr;

  // ---- list datasets ----
  const char* when;         // what it takes that a result has it
  void (*sample)(Result&);  // puts the least of it into a result of two steps and one algorithm; alone: into none

  // ---- run and detect ----
  /// Puts what follows from the rest of the result; called of every result that is not alone.
  void (*make)(Result&) = nullptr;
  /// Moves what algorithm i of `from` said to place `at`, at most one behind the last.
  void (*take)(Products& from, std::size_t i, Products& to, std::size_t at) = nullptr;
  /// Why a run that holds it is not good; empty: it is.
  std::string (*failure)(const Result&) = nullptr;

  // ---- show and score ----
  const char* what = nullptr;                           // of one that is alone: "a study of the integrators"
  std::string (*line)(const Result&) = nullptr;         // among the first lines of `show`
  std::string (*text)(const Result&) = nullptr;         // behind the table of algorithms; alone: all of it
  void (*json)(const Result&, OrderedJson&) = nullptr;  // also called where there is none of it
  void (*figures)(const Result&,
                  nlohmann::json& truth) = nullptr;  // of a baseline; texts are keys that end in "digest"
  void (*label_figures)(const Result&, std::size_t algorithm, nlohmann::json&) = nullptr;

  // ---- check: `asked` is what configuration and scene ask of all products, as `check --json` prints it ----
  std::string (*plan)(const OrderedJson& asked) = nullptr;  // whole lines; alone: all that it says of cases
  Cost (*cost)(const OrderedJson& asked, const Extent&) = nullptr;
};

/// In the file's order.
const std::vector<Product>& products();

/// The product that a result is instead of a scene; null: it is one.
const Product* stands_alone(const Result& result);

}  // namespace pipeline
