// Links that joints hold together, placed by the values of the joints: Simbody's forward kinematics. Nothing moves by
// itself and nothing has a mass that counts.
#pragma once
#include <array>
#include <memory>
#include <vector>

namespace pipeline {

/// One link and the joint by which it hangs on another, or on the ground.
struct LinkJoint {
  enum Kind { fixed, turning, sliding };

  int above = -1;                                 // the link that it hangs on, before it in the list; -1: the ground
  std::array<double, 3> position{};               // of the joint's frame in that link, m
  std::array<double, 4> orientation{1, 0, 0, 0};  // w x y z
  Kind kind = fixed;
  std::array<double, 3> axis{1, 0, 0};  // in the joint's frame, of any length but 0
};

struct LinkPlace {
  std::array<double, 3> position{};               // of the link's frame on the ground, m
  std::array<double, 4> orientation{1, 0, 0, 0};  // w x y z
};

class Linkage {
 public:
  explicit Linkage(const std::vector<LinkJoint>& joints);
  ~Linkage();
  Linkage(const Linkage&) = delete;
  Linkage& operator=(const Linkage&) = delete;

  /// Where each link is; `values` are one a link, rad or m, and nothing for fixed ones.
  std::vector<LinkPlace> places(const std::vector<double>& values);

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace pipeline
