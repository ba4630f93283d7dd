#include "pipeline/scene/urdf.hpp"

#include <gtest/gtest.h>

#include "pipeline/scene/robot.hpp"
#include "pipeline/terminal/error.hpp"
#include "tests/support/refusal.hpp"

using namespace pipeline;

namespace {

std::string link(const std::string& name) { return "<link name=\"" + name + "\"/>\n"; }
std::string joint(const std::string& name, const std::string& above, const std::string& below,
                  const std::string& more = "", const std::string& type = "revolute") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + above + "\"/><child link=\"" + below +
         "\"/>" + more + "</joint>\n";
}
Urdf robot(const std::string& inside) { return parse_urdf("<robot name=\"r\">\n" + inside + "</robot>", "r.urdf"); }

}  // namespace

TEST(Urdf, LinksAreOrderedFromTheRootWhereverTheyStand) {
  const Urdf r = robot(joint("b", "middle", "tip") + link("tip") + link("middle") + link("root") +
                       joint("a", "root", "middle", "<origin xyz=\"1 2 3\"/><limit lower=\"-1\" upper=\"2\"/>"));
  ASSERT_EQ(r.order.size(), 3u);
  EXPECT_EQ(r.links[r.order[0]].name, "root");
  EXPECT_EQ(r.links[r.order[1]].name, "middle");
  EXPECT_EQ(r.links[r.order[2]].name, "tip");
  EXPECT_EQ(r.joints[1].origin.t, geometry::Vec3(1, 2, 3));
  EXPECT_EQ(r.joints[1].limits->at(0), -1);
  EXPECT_FALSE(r.joints[0].limits);
}

// rpy is about fixed axes, x first: with roll and yaw a quarter turn each, y goes to z, which yaw leaves alone.
TEST(Urdf, OriginsTurnAboutFixedAxes) {
  const Urdf r =
      robot(link("a") + link("b") + joint("j", "a", "b", "<origin rpy=\"1.5707963267948966 0 1.5707963267948966\"/>"));
  const geometry::Vec3 y = geometry::rotation(r.joints[0].origin.q) * geometry::Vec3::UnitY();
  EXPECT_LT((y - geometry::Vec3::UnitZ()).norm(), 1e-15);
}

TEST(Urdf, NamesTheLineOfWhatIsWrong) {
  const auto said = [](const std::string& inside) { return tests::refusal_of([&] { robot(inside); }); };
  EXPECT_EQ(said(link("a") + link("b") + joint("j", "a", "b") + joint("k", "b", "a")),
            "r.urdf:5: link \"a\" hangs on itself: the joints make a circle");
  EXPECT_EQ(said(link("a") + link("b") + joint("j", "a", "b") + joint("k", "a", "b")),
            "r.urdf:5: link \"b\" hangs on two joints, \"j\" and \"k\"; a robot is a tree");
  EXPECT_EQ(said(link("a") + joint("j", "a", "b")), "r.urdf:3: there is no link \"b\"");
  EXPECT_EQ(said(""), "r.urdf:1: has no link");
  EXPECT_EQ(said(link("a") + link("b") + joint("j", "a", "b", "<mimic joint=\"j\"/>")),
            "r.urdf:4: joint \"j\" follows one that has no value of its own");
  EXPECT_EQ(tests::refusal_of([] { parse_urdf("<robot>\n<link name=\"a\">\n</robot>", "r.urdf"); }).substr(0, 7),
            "r.urdf:");
  EXPECT_EQ(tests::refusal_of([] { parse_urdf("", "r.urdf"); }).substr(0, 9), "r.urdf:1:");
}

TEST(Urdf, JointsAreKnownByTheirNames) {
  const Urdf r = robot(link("a") + link("b") + link("c") + link("d") + joint("one", "a", "b") +
                       joint("two_m", "b", "c", "", "prismatic") + joint("stuck", "c", "d", "", "fixed"));
  const JointValues v = parse_joints("step,two_m [cm],one [deg],speed\n0,50,180,9\n1,-1,0,9\n", "j.csv", r);
  ASSERT_EQ(v.values.size(), 2u);
  EXPECT_DOUBLE_EQ(v.values[0][0], 3.14159265358979323846);
  EXPECT_DOUBLE_EQ(v.values[0][1], 0.5);
  EXPECT_EQ(v.values[0][2], 0);
  EXPECT_EQ(v.understood, "joints one [deg], two_m [cm]; left out: speed");
  const auto said = [&](const std::string& text) { return tests::refusal_of([&] { parse_joints(text, "j.csv", r); }); };
  EXPECT_EQ(said("step,one,two_n\n0,1,2\n"), "j.csv:1: joint \"two_m\" has no column; did you mean 'two_n'?");
  EXPECT_EQ(said("step,one,two_m,stuck\n"), "j.csv:1: joint \"stuck\" is fixed; leave its column out");
  EXPECT_EQ(said("one,two_m\n1,2\n"), "j.csv:1: has neither a column 'step' nor 'time'");
  EXPECT_EQ(said("step,one,two_m\n"), "j.csv:1: there is no row below the header");
  EXPECT_EQ(said("step,one [m],two_m\n0,1,2\n"), "j.csv:1: the unit of \"one [m]\" must be rad or deg");
}
