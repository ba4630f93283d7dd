#include "pipeline/result/products/all.hpp"

#include <algorithm>

namespace pipeline {

const std::vector<Product>& products() {
  static const std::vector<Product> rows = {
      study_product(),  physics_product(),  gaps_product(),     noise_product(),
      passes_product(), extremes_product(), machines_product(), proxies_product(),
  };
  return rows;
}

const Product* stands_alone(const Result& result) {
  const auto found = std::ranges::find_if(products(), [&](const Product& product) {
    return product.place == Product::Place::alone && product.has(result);
  });
  return found == products().end() ? nullptr : &*found;
}

}  // namespace pipeline
