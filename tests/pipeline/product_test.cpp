// What every row of the table of products promises, whatever it is.
#include "pipeline/result/product.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "pipeline/commands/show.hpp"
#include "pipeline/result/store.hpp"
#include "tests/support/synthetic_result.hpp"
#include "tests/support/temporary_folder.hpp"

namespace pipeline {
namespace {

/// A result that has this product and no other.
Result with(const Product& product) {
  const Result full = synthetic_result(2, 3, 1, 1);
  Result result;
  if (product.place == Product::Place::alone) {
    result.title = full.title;
    result.provenance = full.provenance;
  } else {
    result = full;
    result.products = {};
    result.config_effective = "[scene]\nkind = \"falling\"\n";
  }
  product.sample(result);
  return result;
}

std::set<std::string> names_in(const Result& result) {
  std::set<std::string> names;
  for (const Product& product : products())
    if (product.has(result)) names.insert(product.name);
  return names;
}

TEST(Product, HasANameOfItsOwn) {
  std::set<std::string> names, signs;
  for (const Product& product : products()) {
    EXPECT_TRUE(names.insert(product.name).second) << product.name;
    EXPECT_TRUE(signs.insert(product.sign).second) << product.name;
    EXPECT_EQ(product.place == Product::Place::alone, product.what != nullptr) << product.name;
  }
}

TEST(Product, IsWrittenAndReadBackAlone) {
  const TemporaryFolder folder;
  for (const Product& product : products()) {
    SCOPED_TRACE(product.name);
    Result result = with(product);
    ASSERT_EQ(names_in(result), std::set<std::string>{product.name});
    write_result(result, folder / product.name);
    const Result again = read_result(folder / product.name);
    EXPECT_EQ(names_in(again), std::set<std::string>{product.name});
    EXPECT_EQ(again.digest, result.digest);
    EXPECT_EQ(digests(again), digests(result));
  }
}

TEST(Product, IsShown) {
  for (const Product& product : products()) {
    SCOPED_TRACE(product.name);
    const Result result = with(product);
    EXPECT_NE(result_text(result), "");
    const auto json = nlohmann::json::parse(result_json(result, "x.h5"));
    EXPECT_EQ(json["title"], result.title);
  }
}

}  // namespace
}  // namespace pipeline
