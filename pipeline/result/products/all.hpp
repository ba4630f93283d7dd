// The rows, each from its own file.
#pragma once
#include "pipeline/result/product.hpp"

namespace pipeline {

Product study_product();
Product physics_product();
Product gaps_product();
Product noise_product();
Product passes_product();
Product extremes_product();
Product proxies_product();
Product machines_product();

}  // namespace pipeline
