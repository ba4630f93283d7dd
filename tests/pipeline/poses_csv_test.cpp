#include "pipeline/scene/poses_csv.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "pipeline/terminal/error.hpp"

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
  try {
    parse_poses(text, "p.csv", bodies);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), kInput);
    return error.what();
  }
  return "";
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
      {"", "p.csv:1: is empty; it must begin with step,body,px,py,pz,qw,qx,qy,qz"},
      {kHeader, "p.csv:1: there is no row below the header"},
      {"step,body,x,y,z,qw,qx,qy,qz\n", "p.csv:1: must be step,body,px,py,pz,qw,qx,qy,qz, not \"step,body,x"},
      {row(0, "hero"), "p.csv:1: must be step,body,px,py,pz,qw,qx,qy,qz, not \"0,hero"},
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
  EXPECT_NE(error_of("step,body,px,py,pz,qw,qx,qy,qy\n").find("must be step,body"), std::string::npos);
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
