#include "pipeline/terminal/forecast.hpp"

#include <algorithm>
#include <cmath>

namespace pipeline {

double Forecast::foreseen(std::uint64_t item) const {
  if (!known_) return double(item);
  const std::vector<double>& until = stages_[present_].until;
  return until[std::min<std::uint64_t>(item, until.size() - 1)];
}

void Forecast::begin(const std::string& stage, std::uint64_t items) {
  const auto found = std::ranges::find(stages_, stage, &Stage::name);
  known_ = found != stages_.end() && found->seconds() > 0 && found->until.size() == items + 1;
  if (found != stages_.end()) present_ = std::size_t(found - stages_.begin());
  items_ = items;
  done_ = 0;
  expected_ = actual_ = 0;
}

void Forecast::done(std::uint64_t items, double seconds, bool fresh, double busy) {
  const double before = foreseen(done_);
  done_ = std::min(done_ + items, items_);
  if (!fresh) return;
  if (busy > 0) busy_ = std::max(1.0, busy);
  const double expected = foreseen(done_) - before, whole = foreseen(items_);
  const double fade = whole > 0 ? std::exp(-expected / (0.3 * whole)) : 1;
  expected_ = fade * expected_ + expected;
  actual_ = fade * actual_ + seconds;
}

const Stage* Forecast::find(const std::string& stage) const {
  const auto found = std::ranges::find(stages_, stage, &Stage::name);
  return found == stages_.end() ? nullptr : &*found;
}

void Forecast::improve(const Stage& stage) {
  for (Stage& known : stages_)
    if (known.name == stage.name && known.until.size() == stage.until.size()) known = stage;
}

std::optional<double> Forecast::left() const {
  const double rest = foreseen(items_) - foreseen(done_);
  if (!known_) {
    if (expected_ <= 0) return std::nullopt;
    return rest * actual_ / expected_;
  }
  const double prior = 0.03 * foreseen(items_);
  double left = rest * (actual_ + prior * busy_) / (expected_ + prior);
  for (std::size_t i = present_ + 1; i < stages_.size(); ++i) left += busy_ * stages_[i].seconds();
  return left;
}

}  // namespace pipeline
