#include "pipeline/result/result.hpp"

#include <algorithm>
#include <iterator>

namespace pipeline {
namespace {

constexpr std::string_view kContainment[] = {"ignore", "record", "meet"};  // in the order of the enumerators

}  // namespace

std::vector<Pair> Truth::scoring(std::size_t step) const {
  const std::span<const Pair> surface = hits.at(step);
  std::vector<Pair> out(surface.begin(), surface.end());
  if (containment == Containment::meet) {
    const std::span<const Pair> inside = contained.at(step);
    out.insert(out.end(), inside.begin(), inside.end());
    std::inplace_merge(out.begin(), out.begin() + std::ptrdiff_t(surface.size()), out.end());
  }
  return out;
}

Truth Truth::some(std::size_t first, std::size_t last) const {
  Truth out;
  out.containment = containment;
  for (std::size_t step = first; step < last; ++step) {
    out.hits.append(hits.at(step));
    if (lists_contained()) out.contained.append(contained.at(step));
  }
  return out;
}

std::vector<std::string> processors(const Answers& answers) {
  std::vector<std::string> all;
  for (const Machine& machine : answers.timed_on)
    if (std::ranges::find(all, machine.processor) == all.end()) all.push_back(machine.processor);
  if (all.empty()) all.push_back(answers.machine.processor);
  return all;
}

bool sound(const PairLists& lists, std::uint64_t steps, std::uint64_t bodies) {
  bool sound = lists.offset.size() == steps + 1 && lists.offset.front() == 0 &&
               lists.offset.back() == lists.pair.size() && std::ranges::is_sorted(lists.offset) &&
               std::ranges::all_of(lists.pair, [&](const Pair& pair) { return pair.a < pair.b && pair.b < bodies; });
  for (std::uint64_t s = 0; sound && s < steps; ++s)
    sound = std::ranges::adjacent_find(lists.at(s), std::ranges::greater_equal()) == lists.at(s).end();
  return sound;
}

std::vector<Pair> without(std::span<const Pair> from, std::span<const Pair> these) {
  std::vector<Pair> rest;
  std::set_difference(from.begin(), from.end(), these.begin(), these.end(), std::back_inserter(rest));
  return rest;
}

std::string_view text_of(Containment containment) { return kContainment[std::size_t(containment)]; }

std::optional<Containment> containment_of(std::string_view text) {
  for (std::size_t i = 0; i < std::size(kContainment); ++i)
    if (kContainment[i] == text) return Containment(i);
  return std::nullopt;
}

}  // namespace pipeline
