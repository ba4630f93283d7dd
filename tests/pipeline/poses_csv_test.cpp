#include "pipeline/scene/poses_csv.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "pipeline/terminal/error.hpp"
#include "tests/support/refusal.hpp"

using namespace pipeline;
using geometry::Vec3;

namespace {

const std::string kHeader = "step,body,px,py,pz,qw,qx,qy,qz\n";
const std::vector<CsvBody> kBodies{
    {"hero", CsvBody::every_step}, {"wall", CsvBody::first_step}, {"floor", CsvBody::none}};

std::string row(int step, const std::string& body, const std::string& rest = "1,2,3,1,0,0,0") {
  return std::to_string(step) + "," + body + "," + rest + "\n";
}

std::vector<std::vector<geometry::Pose>> read(const std::string& text, const std::vector<CsvBody>& bodies) {
  const CsvMotion motion = parse_poses(text, "p.csv", bodies);
  return poses_of(motion, motion.steps);
}

std::string error_of(const std::string& text, const std::vector<CsvBody>& bodies = kBodies) {
  return tests::refusal_of([&] { parse_poses(text, "p.csv", bodies); });
}

}  // namespace

TEST(PosesCsv, GivesEveryBodysPoseAtEveryStep) {
  const std::string text = kHeader + row(0, "wall", "5,0,0,0,1,0,0") + row(0, "hero") + row(1, "hero", "4,5,6,0,0,0,1");
  const auto poses = read(text, kBodies);
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0][0].t, Vec3(1, 2, 3));
  EXPECT_EQ(poses[1][0].t, Vec3(4, 5, 6));
  EXPECT_EQ(poses[1][0].q.z, 1);
  // A fixed body keeps its one row's pose; one with its pose in the configuration is left to its reader.
  EXPECT_EQ(poses[1][1].t, Vec3(5, 0, 0));
  EXPECT_EQ(poses[1][1].q.x, 1);
  EXPECT_FALSE(geometry::is_born(poses[0][2]));
}

TEST(PosesCsv, ABodyIsBornAtItsFirstRow) {
  const std::vector<CsvBody> two{{"a"}, {"b"}};
  const auto poses = read(kHeader + row(0, "a") + row(1, "b") + row(1, "a") + row(2, "a") + row(2, "b"), two);
  EXPECT_FALSE(geometry::is_born(poses[0][1]));
  EXPECT_TRUE(geometry::is_born(poses[1][1]));
  EXPECT_TRUE(geometry::is_born(poses[2][1]));
}

TEST(PosesCsv, NormalisesQuaternionsByTheRuleOfTheTruth) {
  const std::vector<CsvBody> one{{"a"}};
  // Off by less than 1e-6: divided by its length. Off by nothing that counts: kept bit for bit.
  const auto poses =
      read(kHeader + row(0, "a", "0,0,0,0.6000003,0.8000004,0,0") + row(1, "a", "0,0,0,0.6,0,0.8,0"), one);
  const geometry::Quaternion expected = geometry::normalised({0.6000003, 0.8000004, 0, 0});
  EXPECT_EQ(poses[0][0].q.w, expected.w);
  EXPECT_EQ(poses[0][0].q.x, expected.x);
  EXPECT_NE(poses[0][0].q.w, 0.6000003);
  EXPECT_EQ(poses[1][0].q.w, 0.6);
  EXPECT_EQ(poses[1][0].q.y, 0.8);
}

TEST(PosesCsv, AcceptsByteOrderMarkCrLfQuotesBlanksAndBlankLines) {
  const std::vector<CsvBody> one{{"a"}};
  const std::string text =
      "\xEF\xBB\xBF\"step\",\"body\",px,py,pz,qw,qx,qy,qz\r\n0,\"a\", 1 "
      ",+2,3e0,1,0,0,0\r\n\r\n1,a,1,2,3,1,0,0,0\r\n\r\n";
  const auto poses = read(text, one);
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0][0].t, Vec3(1, 2, 3));
}

TEST(PosesCsv, RefusesWithFileAndLine) {
  const std::string start = kHeader + row(0, "wall") + row(0, "hero");
  const std::pair<std::string, std::string> cases[] = {
      {"", "p.csv:1: is empty; it must begin with a header"},
      {kHeader, "p.csv:1: there is no row below the header"},
      {row(0, "hero"), "p.csv:1: has neither a column 'step' nor 'time'; its columns are \"0,hero"},
      {start + "1,hero,1,2,3,1,0,0\n", "p.csv:4: must have 9 columns, not 8"},
      {start + "1,hero,1,2,3,1,0,0,0,\n", "p.csv:4: must have 9 columns, not 10"},
      {start + row(2, "hero"), "p.csv:4: step 2 comes after step 0; no step may be left out"},
      {start + row(1, "hero") + row(0, "hero"), "p.csv:5: step 0 comes after step 1; steps do not go back"},
      {kHeader + row(1, "hero"), "p.csv:2: steps must begin with 0, not 1"},
      {start + row(0, "hero"), "p.csv:4: a second row of body \"hero\" at step 0"},
      {start + row(1, "wall"), "p.csv:4: body \"wall\" is fixed: it has one row, at step 0"},
      {start + row(1, "floor"), "p.csv:4: body \"floor\" is fixed and has its pose in the configuration"},
      {start + row(1, "herro"), "p.csv:4: there is no body \"herro\" in the configuration; did you mean \"hero\"?"},
      {kHeader + row(0, "hero"), "p.csv:2: body \"wall\" has no row; a fixed body has one row at step 0"},
      {kHeader + row(0, "wall"), "p.csv:2: body \"hero\" has no row"},
      {start + row(1, "hero", "1,2,x,1,0,0,0"), "p.csv:4: pz must be a number between -1e15 and 1e15, not \"x\""},
      {start + row(1, "hero", "1,,3,1,0,0,0"), "p.csv:4: py must be a number between -1e15 and 1e15, not \"\""},
      {start + row(1, "hero", "1,nan,3,1,0,0,0"), "p.csv:4: py must be a number"},
      {start + row(1, "hero", "1e16,2,3,1,0,0,0"), "p.csv:4: px must be a number"},
      {start + row(1, "hero", "1,2,3,inf,0,0,0"), "p.csv:4: qw must be a number"},
      {start + row(1, "hero", "1,2,3,1.000002,0,0,0"),
       "p.csv:4: the quaternion must be of length 1 within 1e-6, not 1.000002"},
      {start + row(1, "hero", "1,2,3,0,0,0,0"), "p.csv:4: the quaternion must be of length 1 within 1e-6, not 0.0"},
      {start + "-1,hero,1,2,3,1,0,0,0\n", "p.csv:4: step must be an integer of at least 0, not \"-1\""},
      {start + "1.0,hero,1,2,3,1,0,0,0\n", "p.csv:4: step must be an integer of at least 0, not \"1.0\""},
  };
  for (const auto& [text, message] : cases) {
    const std::string got = error_of(text);
    EXPECT_EQ(got.substr(0, message.size()), message);
    EXPECT_EQ(got.find('\n'), std::string::npos);
  }
}

TEST(PosesCsv, ABodyThatDisappearsIsAGap) {
  const std::vector<CsvBody> two{{"a"}, {"b"}};
  const std::string both = kHeader + row(0, "a") + row(0, "b");
  const std::string gap = "body \"b\" has no row at step 1; it was born at step 0 and must have one at every step";
  // Said where the step ends: at the next one's first row, or at the end.
  EXPECT_EQ(error_of(both + row(1, "a") + row(2, "a") + row(2, "b"), two).find("p.csv:5: " + gap), 0u);
  EXPECT_EQ(error_of(both + row(1, "a"), two).find("p.csv:4: " + gap), 0u);
  EXPECT_EQ(error_of(both + row(1, "a") + row(1, "b"), two), "");
}

TEST(PosesCsv, LinesMayEndWithCarriageReturnsAlone) {
  const auto poses = read("step,body,px,py,pz,qw,qx,qy,qz\r0,a,1,2,3,1,0,0,0\r1,a,4,5,6,1,0,0,0\r", {{"a"}});
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[1][0].t, Vec3(4, 5, 6));
  EXPECT_EQ(error_of("step,body,px,py,pz,qw,qx,qy,qz\r0,hero,1,2,x,1,0,0,0\r").substr(0, 8), "p.csv:2:");
}

TEST(PosesCsv, NumbersNearZeroAreTheirNearestDoubles) {
  const auto poses = read(kHeader + row(0, "a", "1E-330,-3e-324,4e-320,1,-1e-400,0,0"), {{"a"}});
  const double least = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(poses[0][0].t, Vec3(0, -least, 4e-320));
  EXPECT_EQ(poses[0][0].q.x, 0);
  EXPECT_NE(error_of(kHeader + row(0, "hero", "1E330,0,0,1,0,0,0")).find("px must be a number between"),
            std::string::npos);
}

TEST(PosesCsv, TheHeaderSaysTheOrderOfTheColumns) {
  const auto poses = read("body,step,qx,qy,qz,qw,pz,py,px\na,0,0,0.6,0,0.8,3,2,1\n", {{"a"}});
  EXPECT_EQ(poses[0][0].t, Vec3(1, 2, 3));
  EXPECT_EQ(poses[0][0].q.w, 0.8);
  EXPECT_EQ(poses[0][0].q.y, 0.6);
  EXPECT_NE(error_of("step,body,px,py,pz,qw,qx,qy,qy\n").find("\"qy\" and \"qy\" can be the same"), std::string::npos);
}

// The identity in the order x, y, z, w is a legal half turn about z in ours.
TEST(PosesCsv, SaysWhenEveryBodyBeginsWithAHalfTurn) {
  const std::vector<CsvBody> two{{"a"}, {"b"}};
  const auto asked = [&](const std::string& a, const std::string& b) {
    const std::string rows = row(0, "a", "1,2,3," + a) + row(0, "b", "1,2,3," + b);
    // What comes later does not matter.
    return parse_poses(kHeader + rows + row(1, "a") + row(1, "b"), "p.csv", two).begins_with_half_turns;
  };
  EXPECT_TRUE(asked("0,0,0,1", "0,0.6,0,0.8"));
  EXPECT_TRUE(asked("-0.0,1,0,0", "0,0,0,1"));
  EXPECT_FALSE(asked("0,0,0,1", "1,0,0,0"));
  EXPECT_FALSE(asked("0,0,0,1", "1e-9,0,0,1"));  // no longer exactly
}

TEST(PosesCsv, TakesMemoryByTheRow) {
  std::vector<CsvBody> bodies{{"a"}};
  std::string text = kHeader;
  for (int i = 0; i < 2000; ++i) {
    bodies.push_back({"w" + std::to_string(i), CsvBody::first_step});
    text += row(0, bodies.back().name);
  }
  for (int step = 0; step < 2000; ++step) text += row(step, "a");
  const CsvMotion motion = parse_poses(text, "p.csv", bodies);
  std::size_t poses = 0;
  for (const CsvTrack& track : motion.tracks) poses += track.poses.size();
  EXPECT_EQ(poses, 4000u);  // not 2000 x 2001
  EXPECT_EQ(poses_of(motion, 3).size(), 3u);
  EXPECT_EQ(poses_of(motion, 3)[2][7].t, Vec3(1, 2, 3));
}

namespace {

const std::vector<CsvBody> kOne{{"a"}};

/// The pose of the one row of a table.
geometry::Pose only_pose(const std::string& text, const CsvRules& rules = {}) {
  const CsvMotion motion = parse_poses(text, "p.csv", kOne, rules);
  return motion.tracks.at(0).poses.at(0);
}

std::string refusal(const std::string& text, const CsvRules& rules = {}, const std::vector<CsvBody>& bodies = kOne) {
  return tests::refusal_of([&] { parse_poses(text, "p.csv", bodies, rules); });
}

}  // namespace

// One row in the words of other programs; all say (1, 2, 3) and the rotation that takes x to y, y to z and z to x,
// whose quaternion is (1/2, 1/2, 1/2, 1/2).
TEST(PosesCsv, TheSamePoseIsReadWhateverTheColumnsAreCalled) {
  const std::string texts[] = {
      "step,body,px,py,pz,qw,qx,qy,qz\n0,a,1,2,3,.5,.5,.5,.5\n",
      "qx;qy;qz;qw;x;y;z;body;frame\n.5;.5;.5;.5;1;2;3;a;0\n",
      "step\tbody\ttx\tty\ttz\tqw\tqx\tqy\tqz\n0\ta\t1\t2\t3\t.5\t.5\t.5\t.5\n",
      "step body  pos_x pos_y   pos_z quat_w quat_x quat_y quat_z\n0  a 1 2\t3 .5 .5 .5 .5\n",
      "Time,Body,Position.X,Position.Y,Position.Z,Rotation.X,Rotation.Y,Rotation.Z,Rotation.W\n7,a,1,2,3,.5,.5,.5,.5\n",
      "time_ns,body,px_mm,py_mm,pz_mm,qw,qx,qy,qz\n7,a,1000,2000,3000,.5,.5,.5,.5\n",
      "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z "
      "[]\n7,1,2,3,.5,.5,.5,.5\n",
      "# a comment\n# time tx ty tz qx qy qz qw\n7 1 2 3 .5 .5 .5 .5\n",
      "# ground truth trajectory\n7.25 1 2 3 .5 .5 .5 .5\n",
      "step,body,m00,m01,m02,m03,m10,m11,m12,m13,m20,m21,m22,m23\n0,a,0,0,1,1,1,0,0,2,0,1,0,3\n",
      "step,body,m11,m12,m13,m14,m21,m22,m23,m24,m31,m32,m33,m34\n0,a,0,0,1,1,1,0,0,2,0,1,0,3\n",
      "step,body,m00,m10,m20,m30,m01,m11,m21,m31,m02,m12,m22,m32,m03,m13,m23,m33\n0,a,0,1,0,0,0,0,1,0,1,0,0,0,1,2,3,"
      "1\n",
      "step,body,px,py,pz,r00,r01,r02,r10,r11,r12,r20,r21,r22\n0,a,1,2,3,0,0,1,1,0,0,0,1,0\n",
  };
  for (const std::string& text : texts) {
    SCOPED_TRACE(text);
    const geometry::Pose pose = only_pose(text);
    EXPECT_LT((pose.t - Vec3(1, 2, 3)).norm(), 1e-15);
    const double sign = pose.q.w < 0 ? -1 : 1;  // q and -q are one rotation
    for (const double c : {pose.q.w, pose.q.x, pose.q.y, pose.q.z}) EXPECT_NEAR(sign * c, 0.5, 1e-15);
  }
}

// Turns of 90 degrees about x and about z by hand: "xz" about fixed axes takes y to z and leaves it there; about the
// body's own it ends at -x ... R = Rz Rx and R = Rx Rz.
TEST(PosesCsv, AnglesAreTurnedInTheStatedOrder) {
  const std::string text = "step,body,px,py,pz,rx_deg,ry_deg,rz_deg\n0,a,0,0,0,90,0,90\n";
  const auto turned = [&](const std::string& order) {
    return Vec3(geometry::rotation(only_pose(text, {.tolerance = 1e-6, .euler = order}).q) * Vec3::UnitY());
  };
  EXPECT_LT((turned("xyz") - Vec3(0, 0, 1)).norm(), 1e-15);   // Rz (Rx y) = Rz z = z
  EXPECT_LT((turned("zyx") - Vec3(-1, 0, 0)).norm(), 1e-15);  // Rx (Rz y) = Rx (-x) = -x
  EXPECT_LT((turned("ZYX") - Vec3(0, 0, 1)).norm(), 1e-15);   // own axes, z first: Rz Rx again
  EXPECT_LT((turned("XYZ") - Vec3(-1, 0, 0)).norm(), 1e-15);
  const std::string rad = "step,body,px,py,pz,rx_rad,ry_rad,rz_rad\n0,a,0,0,0,0,0,1.5707963267948966\n";
  EXPECT_LT((geometry::rotation(only_pose(rad, {.tolerance = 1e-6, .euler = "xyz"}).q) * Vec3::UnitX() - Vec3::UnitY())
                .norm(),
            1e-15);
  EXPECT_NE(refusal(text).find("p.csv:1: has angles: state their order"), std::string::npos);
}

TEST(PosesCsv, TimesMakeStepsAndARate) {
  const std::string text = "time,body,px,py,pz,qw,qx,qy,qz\n";
  const std::vector<CsvBody> two{{"a"}, {"b"}};
  const std::string pose = ",1,2,3,1,0,0,0\n";
  const CsvMotion motion = parse_poses(
      text + "5,a" + pose + "5,b" + pose + "5.1,b" + pose + "5.1,a" + pose + "5.25,a" + pose + "5.25,b" + pose, "p.csv",
      two);
  EXPECT_EQ(motion.steps, 3);
  EXPECT_EQ(motion.times, (std::vector<double>{5, 5.1, 5.25}));
  EXPECT_DOUBLE_EQ(*rate_of(motion), 8);
  EXPECT_FALSE(rate_of(parse_poses(kHeader + row(0, "a") + row(1, "a"), "p.csv", kOne)).has_value());
  EXPECT_NE(refusal(text + "5,a" + pose + "4,a" + pose).find("p.csv:3: time 4.0 comes after 5.0; times must increase"),
            std::string::npos);
  EXPECT_NE(refusal(text + "0,a" + pose + "5e6,a" + pose).find("name the column time_ns, or time_s"),
            std::string::npos);
  EXPECT_EQ(refusal("time_s,body,px,py,pz,qw,qx,qy,qz\n0,a" + pose + "5e6,a" + pose), "");
  EXPECT_NE(refusal("step," + text + "0,5,a" + pose + "1,5,a" + pose).find("time 5.0 comes after 5.0"),
            std::string::npos);
  EXPECT_NE(refusal("step," + text + "0,5,a" + pose + "0,6,b" + pose, {}, two)
                .find("time 6.0 within a step whose time is 5.0"),
            std::string::npos);
  EXPECT_NE(refusal(text + "5,a" + pose + "6,b" + pose, {}, two).find("body \"a\" has no row at step 1"),
            std::string::npos);
}

TEST(PosesCsv, WhatCanBeMeantInTwoWaysIsRefused) {
  const std::string matrix = "m00,m01,m02,m03,m10,m11,m12,m13,m20,m21,m22,m23";
  const std::string tail = ",0,0,0,1\n";
  const std::string whole = "m00,m01,m02,m03,m10,m11,m12,m13,m20,m21,m22,m23,m30,m31,m32,m33";
  const std::pair<std::string, std::string> cases[] = {
      {"body,px,py,pz,qw,qx,qy,qz\na,1,2,3,1,0,0,0\n",
       "p.csv:1: has neither a column 'step' nor 'time'; its columns are"},
      {"step,body,px,py,qw,qx,qy,qz\n", "p.csv:1: the position has no column for z; its columns are"},
      {"step,body,qw,qx,qy,qz\n", "p.csv:1: has no position: columns px, py, pz"},
      {"step,body,px,py,pz\n", "p.csv:1: has no orientation: columns qw, qx, qy, qz, or m00"},
      {"step,body,px,py,pz,qw,qx,qy\n", "p.csv:1: the quaternion has no column for z"},
      {"step,body,px,py,pz,q0,q1,q2,q3\n", "p.csv:1: \"q0\" does not say whether the scalar is first or last"},
      {"step,body,px,py,pz,roll,pitch,yaw\n", "p.csv:1: \"roll\" does not say about which axis it turns"},
      {"step,body,px,py,pz,rx,ry,rz\n", "p.csv:1: \"rx\" does not say its unit; write rx_deg or rx_rad"},
      {"step,body,px,py,pz,rx_deg,ry_rad,rz_deg\n", "p.csv:1: \"ry_rad\" has another unit than the columns beside it"},
      {"step,body,px_mm,py_mm,pz,qw,qx,qy,qz\n", "p.csv:1: \"pz\" has another unit than the columns beside it"},
      {"step,body,px [ft],py [ft],pz [ft],qw,qx,qy,qz\n", "p.csv:1: the unit of \"px [ft]\" must be one of cm, m, mm"},
      {"step,body,px,x,py,pz,qw,qx,qy,qz\n", "p.csv:1: \"px\" and \"x\" can be the same; leave one out"},
      {"step,body,px,py,pz," + matrix + "\n", "p.csv:1: has the position in more than one way (matrix and \"px\")"},
      {"step,body,qw,qx,qy,qz," + matrix + "\n", "p.csv:1: has the orientation in more than one way"},
      {"step,body,px,py,pz,m00,m01,m10,m11\n", "p.csv:1: the matrix must be 3x3, 3x4 or 4x4, whole"},
      {"step,body;px,py\n", "p.csv:1: both ',' and ';' stand in"},
      {"step;body;px;py;pz;qw;qx;qy;qz\n0;a;1,5;2;3;1;0;0;0\n",
       "p.csv:2: px must be a number between -1e15 and 1e15, not "
       "\"1,5\"; write decimals with a point"},
      {"0,1,2,3\n", "p.csv:1: has no header; its first line must name the columns"},
      {"7 1 2 3 1 0 0 0\n", "p.csv:1: the first quaternion has qw = 0, a half turn: lines without a header are time"},
      {"step,body," + matrix + "\n0,a,2,0,0,1,0,1,0,2,0,0,1,3\n",
       "p.csv:2: column 0 of the matrix must be of length 1 within 1e-6, not 2.0; a scale belongs to the body: scale"},
      {"step,body," + matrix + "\n0,a,1,0.6,0,1,0,0.8,0,2,0,0,1,3\n",
       "p.csv:2: columns 0 and 1 of the matrix must be at right angles within 1e-6, not 0.6 off"},
      {"step,body," + matrix + "\n0,a,-1,0,0,1,0,1,0,2,0,0,1,3\n", "p.csv:2: the matrix mirrors"},
      {"step,body," + whole + "\n0,a,1,0,0,0,0,1,0,0,0,0,1,0,5,6,7,1\n",
       "p.csv:2: the last row of the matrix must be 0 0 0 1; where it holds the position, the matrix is transposed"},
  };
  for (const auto& [text, message] : cases) EXPECT_EQ(refusal(text).substr(0, message.size()), message) << text;
}

TEST(PosesCsv, TheToleranceIsThatOfTheRules) {
  const std::string text = kHeader + row(0, "a", "0,0,0,0.6004,0.8,0,0");
  EXPECT_NE(refusal(text).find("of length 1 within 1e-6"), std::string::npos);
  const geometry::Quaternion q = only_pose(text, {.tolerance = 1e-3, .euler = {}}).q,
                             expected = geometry::normalised({0.6004, 0.8, 0, 0});
  EXPECT_EQ(q.w, expected.w);
  EXPECT_EQ(q.x, expected.x);
}

TEST(PosesCsv, SaysWhichColumnIsWhat) {
  const CsvMotion plain = parse_poses(kHeader + row(0, "a"), "p.csv", kOne);
  EXPECT_TRUE(plain.plain);
  const CsvMotion other = parse_poses("time body x y z qx qy qz qw speed\n0 a 1 2 3 0 0 0 1 9\n", "p.csv", kOne);
  EXPECT_FALSE(other.plain);
  EXPECT_EQ(other.understood,
            "time in s, body, position in m (x, y, z), quaternion w x y z (qw, qx, qy, qz); left out: speed");
}

TEST(PosesCsv, WithoutAColumnOfBodiesAllRowsAreOfTheOnlyOne) {
  const std::string text = "step,px,py,pz,qw,qx,qy,qz\n0,1,2,3,1,0,0,0\n";
  const std::vector<CsvBody> bodies{{"floor", CsvBody::none}, {"a"}, {"b", CsvBody::elsewhere}};
  EXPECT_EQ(parse_poses(text, "p.csv", bodies).tracks[1].poses.size(), 1u);
  EXPECT_NE(refusal(text, {}, {{"a"}, {"b"}}).find("has no column 'body', though it is of 2 bodies"),
            std::string::npos);
}

TEST(PosesCsv, FilesOfOneSceneAreSampledTogether) {
  const auto file = [](const std::string& rows) { return parse_poses(rows, "p.txt", kOne); };
  const std::string pose = " 1 2 3 0 0 0 1\n";
  const auto joined = [&](const std::string& rows) -> std::string {
    CsvMotion motion = file("0" + pose + "0.1" + pose + "0.2" + pose), other = file(rows);
    other.tracks.insert(other.tracks.begin(), CsvTrack{});
    const std::string line = tests::refusal_of([&] { join(motion, std::move(other), "q.txt"); });
    if (!line.empty()) return line;
    EXPECT_EQ(motion.tracks.size(), 2u);
    EXPECT_EQ(motion.tracks[1].poses.size(), 3u);
    return "";
  };
  EXPECT_EQ(joined("0" + pose + "0.1" + pose + "0.2" + pose), "");
  EXPECT_EQ(joined("0.004" + pose + "0.097" + pose + "0.21" + pose), "");
  EXPECT_EQ(joined("0" + pose + "0.1" + pose),
            "q.txt: has 2 steps, the poses before it 3; files of one scene have the same");
  EXPECT_EQ(joined("0" + pose + "0.16" + pose + "0.2" + pose),
            "q.txt: step 1 is at 0.16 s, in the poses before it at 0.1 s; files of one scene are sampled together");
}
