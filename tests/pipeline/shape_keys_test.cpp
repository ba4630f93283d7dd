#include "pipeline/scene/shape_keys.hpp"

#include <gtest/gtest.h>

#include "pipeline/terminal/error.hpp"
#include "tests/support/refusal.hpp"

using namespace pipeline;

namespace {

Shape shape_of(const std::string& keys, const std::vector<std::string>& others = {}) {
  const Document document("[s]\n" + keys, "t.toml");
  return read_shape(Section(document).section("s"), others);
}

std::string refusal(const std::string& keys) {
  return tests::refusal_of([&] { shape_of(keys); });
}

std::string written(const Shape& shape) {
  TomlText out;
  write_shape(shape, out);
  return out.text;
}

const char* const kOneOfEach[] = {
    "shape = 'box'\nsize = [1, 2.5, 3]\n",
    "shape = 'sphere'\nradius = 2\n",
    "shape = 'sphere'\nradius = 2\nsegments = 5\n",
    "shape = 'capsule'\nheight = 3\nradius = 0.6\n",
    "shape = 'capsule'\nheight = 5\nradius_bottom = 0.7\nradius_top = 1.4\nsegments = 7\n",
    "shape = 'torus'\ndiameter = 6\nthickness = 1\n",
    "shape = 'torus'\ndiameter = 6\nthickness = 1\nsegments = 3\n",
    "shape = 'torus_knot'\nradius = 3\ntube = 0.5\n",
    "shape = 'torus_knot'\nradius = 3\ntube = 0.5\nradial_segments = 9\ntubular_segments = 4\np = 3\nq = 5\n",
};

}  // namespace

TEST(ShapeKeys, MakeTheShapesTheyName) {
  EXPECT_EQ(make_mesh(shape_of(kOneOfEach[0]), "b").shape, R"({"kind":"box","size":[1,2.5,3]})");
  EXPECT_EQ(make_mesh(shape_of(kOneOfEach[1]), "s").shape, R"({"kind":"sphere","radius":2,"segments":32})");
  EXPECT_EQ(make_mesh(shape_of(kOneOfEach[3]), "c").shape,
            R"({"kind":"capsule","height":3,"radius_bottom":0.6,"radius_top":0.6,"segments":8})");
  EXPECT_EQ(make_mesh(shape_of(kOneOfEach[5]), "t").shape,
            R"({"kind":"torus","diameter":6,"thickness":1,"segments":16})");
  const geometry::Mesh knot = make_mesh(shape_of(kOneOfEach[7]), "k");
  EXPECT_EQ(knot.shape,
            R"({"kind":"torus_knot","radius":3,"tube":0.5,"radial_segments":32,"tubular_segments":32,"p":2,"q":3})");
  EXPECT_EQ(knot.name, "k");
}

TEST(ShapeKeys, WrittenAndReadAgainAreTheSame) {
  for (const char* keys : kOneOfEach) {
    const Shape shape = shape_of(keys);
    EXPECT_EQ(written(shape_of(written(shape))), written(shape)) << keys;
    EXPECT_EQ(make_mesh(shape_of(written(shape)), "m").shape, make_mesh(shape, "m").shape);
  }
}

TEST(ShapeKeys, SizeIsKnownWithoutMakingTheMesh) {
  for (const char* keys : kOneOfEach) {
    const Shape shape = shape_of(keys);
    const geometry::Mesh mesh = make_mesh(shape, "m");
    EXPECT_EQ(mesh_size(shape).vertices, mesh.vertices.size()) << keys;
    EXPECT_EQ(mesh_size(shape).triangles, mesh.triangles.size()) << keys;
  }
}

TEST(ShapeKeys, OtherKeysOfTheSectionAreAllowedByName) {
  EXPECT_NO_THROW(shape_of("shape = 'sphere'\nradius = 1\nname = 'x'\n", {"name"}));
  EXPECT_EQ(refusal("shape = 'sphere'\nradius = 1\nname = 'x'\n").substr(0, 31), "t.toml:4:1: unknown key 's.name");
}

TEST(ShapeKeys, BadOnesAreRefusedWithPlaceAndRule) {
  const auto refused = [](const std::string& keys, const std::string& place, const std::string& words) {
    const std::string message = refusal(keys);
    EXPECT_EQ(message.substr(0, place.size()), place) << keys;
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  refused("", "t.toml:1:1: ", "missing key 's.shape'; known: box, sphere");
  refused("shape = 'boxx'\n", "t.toml:2:9: ", "did you mean 'box'?");
  refused("shape = 'box'\n", "t.toml:1:1: ", "missing key 's.size'");
  refused("shape = 'box'\nsize = [1, 0, 1]\n", "t.toml:3:12: ", "'s.size.1' must be a number of at least 1e-6");
  refused("shape = 'box'\nsize = [1, 1]\n", "t.toml:3:8: ", "an array of 3 numbers");
  refused("shape = 'box'\nsize = [1, 1, nan]\n", "t.toml:3:15: ", "'s.size.2' must be a number");
  refused("shape = 'sphere'\n", "t.toml:1:1: ", "missing key 's.radius'");
  refused("shape = 'sphere'\nradius = 0\n", "t.toml:3:10: ", "'s.radius' must be a number of at least 1e-6");
  refused("shape = 'sphere'\nradius = 1\nsegments = 0\n", "t.toml:4:12: ", "an integer between 1 and");
  refused("shape = 'capsule'\nheight = 3\n", "t.toml:1:1: ", "missing key 's.radius', or radius_bottom");
  refused("shape = 'capsule'\nheight = 3\nradius_top = 1\n", "t.toml:1:1: ", "missing key 's.radius_bottom'");
  refused("shape = 'capsule'\nheight = 3\nradius = 1\nradius_top = 1\n", "t.toml:5:14: ", "be absent where 'radius'");
  refused("shape = 'capsule'\nheight = 2\nradius = 1\n", "t.toml:3:10: ", "be more than twice the greater radius");
  refused("shape = 'capsule'\nheight = 4\nradius_bottom = 0.5\nradius_top = 2\n", "t.toml:3:10: ", "twice");
  refused("shape = 'torus'\ndiameter = 1\nthickness = 1\n", "t.toml:4:13: ", "be below the diameter 1.0");
  refused("shape = 'torus'\ndiameter = 2\nthickness = 1\nsegments = 2\n", "t.toml:5:12: ", "between 3 and");
  refused("shape = 'torus_knot'\nradius = 3\ntube = 1\nq = 4\n", "t.toml:5:5: ", "no common factor with p = 2");
  refused("shape = 'torus_knot'\nradius = 3\ntube = 1\np = 3\n", "t.toml:5:5: ", "no common factor with q = 3");
}
