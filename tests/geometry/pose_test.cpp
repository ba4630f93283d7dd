// Poses: the roundings that truth is defined by, and Babylon.js's angles.
#include "geometry/pose.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace geometry {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool same_bits(const Quaternion& p, const Quaternion& q) { return std::memcmp(&p, &q, sizeof p) == 0; }

double squared_norm(const Quaternion& q) { return ((q.w * q.w + q.x * q.x) + q.y * q.y) + q.z * q.z; }

/// Random directions in quaternion space: components of a normal distribution.
class RandomQuaternions {
 public:
  explicit RandomQuaternions(unsigned seed) : random_(seed) {}
  Quaternion any() { return {normal_(random_), normal_(random_), normal_(random_), normal_(random_)}; }
  Quaternion unit() { return normalised(any()); }
  double number() { return normal_(random_); }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

TEST(Pose, UnbornIsNotBornAndOneNanIsEnough) {
  EXPECT_TRUE(is_born(Pose{}));
  EXPECT_FALSE(is_born(unborn()));
  double Quaternion::*const parts[] = {&Quaternion::w, &Quaternion::x, &Quaternion::y, &Quaternion::z};
  for (const auto part : parts) {
    Pose pose;
    pose.q.*part = std::nan("");
    EXPECT_FALSE(is_born(pose));
  }
  for (int axis = 0; axis < 3; ++axis) {
    Pose pose;
    pose.t[axis] = std::nan("");
    EXPECT_FALSE(is_born(pose));
  }
}

TEST(Normalised, LeavesWhatIsWithinItsToleranceBitForBit) {
  const Quaternion nearly_unit[] = {{1, 0, 0, 0},
                                    {0, 0, -1, 0},
                                    {1 + 0x1p-52, 0, 0, 0},           // squared norm 1 + 4.4e-16
                                    {1 - 0x1p-52, 1e-200, -0.0, 0}};  // squared norm 1 - 4.4e-16
  for (const Quaternion& q : nearly_unit) EXPECT_TRUE(same_bits(normalised(q), q)) << q.w;
  const Quaternion beyond{1 + 3 * 0x1p-52, 0, 0, 0};  // squared norm 1 + 1.3e-15
  EXPECT_EQ(normalised(beyond).w, 1.0);
}

TEST(Normalised, DividesByTheLength) {
  const Quaternion q = normalised({0, 3, 0, -4});
  EXPECT_TRUE(same_bits(q, {0, 0.6, 0, -0.8}));
  EXPECT_TRUE(same_bits(normalised({-2, 2, -2, 2}), {-0.5, 0.5, -0.5, 0.5}));
}

TEST(Normalised, SurvivesHugeAndTinyLengths) {
  for (const double scale : {1e-320, 1e-200, 1e-160, 1e-100, 1e100, 1e160, 1e300}) {
    const Quaternion q = normalised({scale, scale, -scale, scale});
    EXPECT_TRUE(same_bits(q, {0.5, 0.5, -0.5, 0.5})) << scale;
  }
}

TEST(Normalised, GivesNanWithoutADirection) {
  EXPECT_FALSE(is_born({normalised({0, 0, 0, 0}), Vec3::Zero()}));
  EXPECT_FALSE(is_born({normalised({kInfinity, 0, 0, 0}), Vec3::Zero()}));
  EXPECT_FALSE(is_born({normalised({1, std::nan(""), 0, 0}), Vec3::Zero()}));
}

// A pose is written, read and normalised again by whoever replays it: that must change nothing. The rule leaves room
// for 9 units of 2^-53 in the squared norm; a search for the worst case found 7.
TEST(Normalised, ChangesNothingTheSecondTime) {
  constexpr unsigned kSeed = 31;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  RandomQuaternions random(kSeed);
  std::uint64_t changed = 0;
  double worst = 0;
  for (int i = 0; i < 1000000; ++i) {
    const Quaternion once = random.unit();
    worst = std::fmax(worst, std::abs(squared_norm(once) - 1));
    changed += !same_bits(normalised(once), once);
  }
  EXPECT_EQ(changed, 0u);
  EXPECT_LE(worst, 7 * 0x1p-53);
}

TEST(Rotation, IsExactForQuarterAndHalfTurns) {
  EXPECT_EQ(rotation({1, 0, 0, 0}), Mat3::Identity());
  Mat3 half_about_z, third_about_diagonal;
  half_about_z << -1, 0, 0, 0, -1, 0, 0, 0, 1;
  third_about_diagonal << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // x to y to z to x
  EXPECT_EQ(rotation({0, 0, 0, 1}), half_about_z);
  EXPECT_EQ(rotation({0.5, 0.5, 0.5, 0.5}), third_about_diagonal);
}

TEST(Rotation, HasTheBitsOfEigensToRotationMatrix) {
  constexpr unsigned kSeed = 32;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  RandomQuaternions random(kSeed);
  for (int i = 0; i < 100000; ++i) {
    const Quaternion q = random.unit();
    const Mat3 ours = rotation(q), eigens = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
    ASSERT_EQ(std::memcmp(ours.data(), eigens.data(), 9 * sizeof(double)), 0) << "quaternion " << i;
  }
}

TEST(Quaternion, MultipliesAsHamiltonDoes) {
  const Quaternion one{1, 0, 0, 0}, i{0, 1, 0, 0}, j{0, 0, 1, 0}, k{0, 0, 0, 1};
  EXPECT_EQ((i * j).z, 1);
  EXPECT_EQ((j * k).x, 1);
  EXPECT_EQ((k * i).y, 1);
  EXPECT_EQ((j * i).z, -1);
  EXPECT_EQ((i * i).w, -1);
  EXPECT_EQ((one * k).z, 1);
}

TEST(Quaternion, ProductTurnsFirstByTheRightFactor) {
  constexpr unsigned kSeed = 33;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  RandomQuaternions random(kSeed);
  for (int i = 0; i < 1000; ++i) {
    const Quaternion p = random.unit(), q = random.unit();
    ASSERT_LT((rotation(p * q) - rotation(p) * rotation(q)).cwiseAbs().maxCoeff(), 1e-14);
  }
}

TEST(TurnAbout, TurnsCounterClockwise) {
  const Mat3 quarter_about_z = rotation(turn_about(Vec3::UnitZ(), kPi / 2));
  EXPECT_LT((quarter_about_z * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);
  const Mat3 quarter_about_x = rotation(turn_about(Vec3::UnitX(), kPi / 2));
  EXPECT_LT((quarter_about_x * Vec3::UnitY() - Vec3::UnitZ()).norm(), 1e-15);
  EXPECT_TRUE(same_bits(turn_about(Vec3::UnitY(), 0), {1, 0, 0, 0}));
}

// (1 + e)(1 - e) = 1 - e^2 rounds to 1: a fused multiply-add would keep the e^2.
TEST(ToWorld, RoundsEveryProductAndAddsFromLeftToRight) {
  const double e = 0x1p-30;
  Mat3 r = Mat3::Zero();
  r(0, 0) = 1 + e, r(0, 1) = -1;
  EXPECT_EQ(to_world(r, Vec3::Zero(), {1 - e, 1, 0}).x(), 0);
  r(1, 0) = 1, r(1, 1) = 1, r(1, 2) = 1;  // ((2^53 + 1) - 2^53) + 1: the first sum loses its 1
  EXPECT_EQ(to_world(r, Vec3(0, 1, 0), {0x1p53, 1, -0x1p53}).y(), 1);
  EXPECT_EQ(to_world(Mat3::Identity(), Vec3(1, 2, 3), {10, 20, 30}), Vec3(11, 22, 33));
}

TEST(ToWorld, GivesTheSameBitsForManyAsForOne) {
  constexpr unsigned kSeed = 34;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  RandomQuaternions random(kSeed);
  for (const std::size_t count : {0u, 1u, 2u, 3u, 5u, 1000u}) {
    const Pose pose{random.unit(), Vec3(random.number(), random.number(), random.number())};
    std::vector<Vec3> local, world(count);
    for (std::size_t i = 0; i < count; ++i) local.emplace_back(random.number(), random.number(), random.number());
    to_world(pose, local, world);
    const Mat3 r = rotation(pose.q);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 one = to_world(r, pose.t, local[i]);
      ASSERT_EQ(std::memcmp(one.data(), world[i].data(), 3 * sizeof(double)), 0) << "vertex " << i << " of " << count;
    }
  }
}

/// Ry Rx Rz, from the C library's functions.
Mat3 recomposed(const EulerAngles& e) {
  return (Eigen::AngleAxisd(e.y, Vec3::UnitY()) * Eigen::AngleAxisd(e.x, Vec3::UnitX()) *
          Eigen::AngleAxisd(e.z, Vec3::UnitZ()))
      .toRotationMatrix();
}

TEST(EulerAngles, AreTheAngleOfATurnAboutOneAxis) {
  for (const double angle : {-1.5, -0.3, 0.2, 1.0, 1.5}) {
    EXPECT_NEAR(euler_angles(turn_about(Vec3::UnitX(), angle)).x, angle, 1e-14);
    EXPECT_NEAR(euler_angles(turn_about(Vec3::UnitY(), angle)).y, angle, 1e-15);
    EXPECT_NEAR(euler_angles(turn_about(Vec3::UnitZ(), angle)).z, angle, 1e-15);
  }
  const EulerAngles none = euler_angles({1, 0, 0, 0});
  EXPECT_EQ(none.x, 0);
  EXPECT_EQ(none.y, 0);
  EXPECT_EQ(none.z, 0);
}

TEST(EulerAngles, RecomposeToTheRotation) {
  constexpr unsigned kSeed = 35;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  RandomQuaternions random(kSeed);
  for (int i = 0; i < 20000; ++i) {
    const Quaternion q = random.unit();
    if (std::abs(q.y * q.z - q.x * q.w) > 0.4999999) continue;  // see below
    // asin near 1 loses digits: 1e-16 / sqrt(1 - 0.9999998^2) = 2e-13.
    ASSERT_LT((recomposed(euler_angles(q)) - rotation(q)).cwiseAbs().maxCoeff(), 1e-12) << "quaternion " << i;
  }
}

TEST(EulerAngles, AtTheGimbalPutTheWholeTurnIntoYExactly) {
  for (const double sign : {1.0, -1.0})
    for (const double turn : {-2.5, -1.0, 0.0, 0.7, 3.0}) {
      const Quaternion q = turn_about(Vec3::UnitY(), turn) * turn_about(Vec3::UnitX(), sign * kPi / 2);
      const EulerAngles e = euler_angles(q);
      EXPECT_EQ(e.x, sign * kPi / 2);
      EXPECT_EQ(e.z, 0);
      EXPECT_LT((recomposed(e) - rotation(q)).cwiseAbs().maxCoeff(), 1e-14) << "turn " << turn;
    }
}

// Inside Babylon.js's limit |s| > 0.4999999 the tilt is taken for a right angle, from which it may be asin(0.9999998) =
// 6.3e-4 rad away: the angles are wrong by that, as published.
TEST(EulerAngles, NearTheGimbalErrByLessThanOneThousandth) {
  constexpr unsigned kSeed = 36;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  RandomQuaternions random(kSeed);
  double worst = 0;
  int near = 0;
  for (int i = 0; i < 2000; ++i) {
    const double tilt = (i % 2 ? 1 : -1) * (kPi / 2) + 5e-4 * random.number();
    const Quaternion q = normalised(turn_about(Vec3::UnitY(), 3 * random.number()) * turn_about(Vec3::UnitX(), tilt) *
                                    turn_about(Vec3::UnitZ(), 3 * random.number()));
    if (!(std::abs(q.y * q.z - q.x * q.w) > 0.4999999)) continue;
    ++near;
    worst = std::fmax(worst, (recomposed(euler_angles(q)) - rotation(q)).cwiseAbs().maxCoeff());
  }
  EXPECT_GT(near, 1000);
  EXPECT_LT(worst, 1e-3);
  EXPECT_GT(worst, 1e-4);
}

}  // namespace
}  // namespace geometry
