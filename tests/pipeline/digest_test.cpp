#include "pipeline/result/digest.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "pipeline/result/layout.hpp"
#include "tests/support/synthetic_result.hpp"

namespace pipeline {
namespace {

/// The stream that the header describes, put together here byte by byte.
class Stream {
 public:
  Stream& integer(std::uint64_t value) {
    for (int byte = 0; byte < 8; ++byte) bytes_.push_back(static_cast<std::byte>(value >> (8 * byte)));
    return *this;
  }
  Stream& text(std::string_view value) {
    integer(value.size());
    for (const char c : value) bytes_.push_back(static_cast<std::byte>(c));
    return *this;
  }
  std::string hex() const {
    Digest digest;
    digest.add(bytes_);
    return digest.hex();
  }

 private:
  std::vector<std::byte> bytes_;
};

Dataset doubles(const std::string& path, std::vector<std::uint64_t> shape, const std::vector<double>& values) {
  Dataset dataset;
  dataset.path = path;
  dataset.type = Type::f64;
  dataset.shape = std::move(shape);
  const auto bytes = std::as_bytes(std::span(values));
  dataset.owned.assign(bytes.begin(), bytes.end());
  dataset.bytes = dataset.owned;
  return dataset;
}

std::string digest_of(const Dataset& dataset) {
  Digest digest;
  digest.add(dataset);
  return digest.hex();
}

// The published values of XXH3-128 with seed 0, as `xxhsum -H2` prints them.
TEST(Digest, IsXxh3WithTheHighHalfFirst) {
  EXPECT_EQ(Digest().hex(), "99aa06d3014798d86001c324468d497f");
  Digest digest;
  const std::string text = "abc";
  digest.add(std::as_bytes(std::span(text)));
  EXPECT_EQ(digest.hex(), "06b05ab6733a618578af5f94892f3950");
}

TEST(Digest, TakesPathTypeRankShapeAndValues) {
  const Dataset dataset = doubles("/a/b", {2, 1}, {1.0, -0.0});
  const std::string expected = Stream()
                                   .text("/a/b")
                                   .text("f8")
                                   .integer(2)
                                   .integer(2)
                                   .integer(1)
                                   .integer(0x3ff0000000000000)
                                   .integer(1ull << 63)
                                   .hex();
  EXPECT_EQ(digest_of(dataset), expected);
}

TEST(Digest, TakesTextsWithTheirLengths) {
  Dataset dataset;
  dataset.path = "/body";
  dataset.type = Type::text;
  dataset.shape = {3};
  dataset.text = {"koule", "", "kůň"};
  const std::string expected =
      Stream().text("/body").text("text").integer(1).integer(3).text("koule").text("").text("k\xc5\xaf\xc5\x88").hex();
  EXPECT_EQ(digest_of(dataset), expected);
}

TEST(Digest, EveryNaNIsTheSame) {
  const double quiet = std::bit_cast<double>(std::uint64_t{0x7ff8000000000000});
  const double negative = std::bit_cast<double>(std::uint64_t{0xfff8000000000001});
  const double payload = std::bit_cast<double>(std::uint64_t{0x7ff800000000beef});
  ASSERT_TRUE(std::isnan(negative) && std::isnan(payload));
  const std::string digest = digest_of(doubles("/a", {2}, {quiet, quiet}));
  EXPECT_EQ(digest, digest_of(doubles("/a", {2}, {negative, payload})));
  EXPECT_NE(digest, digest_of(doubles("/a", {2}, {quiet, std::numeric_limits<double>::infinity()})));
}

// The canonical form is made block by block; a dataset over several blocks must not notice.
TEST(Digest, IsTheSameOverManyBlocks) {
  std::vector<double> values(10'000);
  Stream stream;
  stream.text("/a").text("f8").integer(1).integer(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = i % 3 == 0 ? std::nan("5") : static_cast<double>(i);
    stream.integer(i % 3 == 0 ? 0x7ff8000000000000 : std::bit_cast<std::uint64_t>(values[i]));
  }
  EXPECT_EQ(digest_of(doubles("/a", {values.size()}, values)), stream.hex());
}

// What is too large to be laid out is told in parts of whole chunks.
TEST(Digest, IsTheSameInParts) {
  constexpr std::uint64_t kRows = 5000, kColumns = 70, kMultiple = 7;
  std::vector<double> values(kRows * kColumns);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = i % 5 == 0 ? std::nan("5") : static_cast<double>(i);
  const Dataset whole = doubles("/a", {kRows, kColumns}, values);
  Dataset parts = doubles("/a", {kRows, kColumns}, {});
  parts.rows = [&](std::uint64_t first, std::uint64_t last) {
    const auto bytes = std::as_bytes(std::span(values).subspan(first * kColumns, (last - first) * kColumns));
    return std::vector<std::byte>(bytes.begin(), bytes.end());
  };
  EXPECT_EQ(digest_of(parts), digest_of(whole));

  std::vector<std::byte> told;
  std::uint64_t count = 0;
  each_part(parts, kMultiple, [&](std::uint64_t first, std::span<const std::byte> bytes) {
    EXPECT_EQ(first * kColumns * sizeof(double), told.size());
    EXPECT_EQ(first % kMultiple, 0u);
    EXPECT_LE(bytes.size(), 1u << 20);
    told.insert(told.end(), bytes.begin(), bytes.end());
    ++count;
  });
  EXPECT_GE(count, 3u);
  EXPECT_TRUE(told == whole.owned);
}

TEST(Digests, AreOfMotionTruthAnswersAndRoot) {
  const Result result = synthetic_result();
  std::vector<std::string> paths;
  for (const auto& [path, digest] : digests(layout(result))) {
    paths.push_back(path);
    EXPECT_EQ(digest.size(), 32u) << path;
  }
  EXPECT_EQ(paths, (std::vector<std::string>{"/", "/answers/method_1", "/answers/method_2", "/answers/method_3",
                                             "/motion", "/truth"}));
}

/// Which digests change with `change`, of a result that was made by `first`.
template <typename First, typename Change>
std::vector<std::string> changed(First first, Change change) {
  Result result = synthetic_result();
  first(result);
  const auto before = digests(layout(result));
  change(result);
  const auto after = digests(layout(result));
  std::vector<std::string> out;
  for (const auto& [path, digest] : after)
    if (!before.contains(path) || before.at(path) != digest) out.push_back(path);
  return out;
}
template <typename Change>
std::vector<std::string> changed(Change change) {
  return changed([](Result&) {}, change);
}
using Paths = std::vector<std::string>;

TEST(Digests, DoNotSeeTheClockNorTheMachine) {
  EXPECT_EQ(changed([](Result& r) {
              r.truth.time_ns[0] = 1;
              r.answers[0].time_ns[0] = r.answers[0].time_median_ns[0] = r.answers[0].prepare_ns[0] = 1;
              r.summary[0].time_mean_ns = r.summary[0].time_median_ns = r.summary[0].time_p95_ns = 1;
              r.products.find<PhysicsRows>()->rows[0].time_ns =
                  r.products.find<PhysicsRows>()->rows[0].contact_time_ns = 1;
              r.answers[0].machine.host = r.provenance.host = r.provenance.compiler = "another";
              r.provenance.wall_time_s = 1;
              r.config_text += "# a comment";
              r.title = "another";
            }),
            Paths{});
}

TEST(Digests, SeeEveryAnswer) {
  EXPECT_EQ(changed([](Result& r) { r.motion[3][1].t.x() += 0x1p-52; }), (Paths{"/", "/motion"}));
  const auto one_hit = [](std::size_t at) {  // the same pair, and only the step tells
    return [at](Result& r) {
      const std::size_t steps = r.truth.hits.steps();
      r.truth.hits = {};
      for (std::size_t s = 0; s < steps; ++s) r.truth.hits.append(std::vector<Pair>(s == at ? 1 : 0, {0, 1}));
    };
  };
  EXPECT_EQ(changed(one_hit(2)), (Paths{"/", "/truth"}));
  EXPECT_EQ(changed(one_hit(2), one_hit(3)), (Paths{"/", "/truth"}));
  EXPECT_EQ(changed([](Result& r) { r.answers[1].hits.pair[0].b += 1; }), (Paths{"/", "/answers/method_2"}));
  EXPECT_EQ(changed([](Result& r) { r.answers[1].operations[2] += 1; }), (Paths{"/"}));
  EXPECT_EQ(changed([](Result& r) { r.summary[1].promise_kept = true; }), (Paths{"/"}));
  EXPECT_EQ(changed([](Result& r) { r.products.find<PhysicsRows>()->rows[2].energy += 1; }), (Paths{"/"}));
  EXPECT_EQ(changed([](Result& r) { r.products.drop<PhysicsRows>(); }), (Paths{"/"}));
  EXPECT_EQ(changed([](Result& r) { r.bodies.name[1] = "another"; }), (Paths{"/"}));
  EXPECT_EQ(changed([](Result& r) { r.bodies.meshes[0].vertices[0].x() = 0.5; }), (Paths{"/"}));
  EXPECT_EQ(changed([](Result& r) { std::swap(r.bodies.meshes[0].triangles[0], r.bodies.meshes[0].triangles[1]); }),
            (Paths{"/"}));
  EXPECT_EQ(changed([](Result& r) { r.rate = 50; }), (Paths{"/"}));
}

TEST(Digests, DoNotSeeTheOrderOfMeshes) {
  EXPECT_EQ(changed([](Result& r) {
              std::swap(r.bodies.meshes[0], r.bodies.meshes[1]);
              for (auto& mesh : r.bodies.mesh) mesh = 1 - mesh;
            }),
            Paths{});
}

}  // namespace
}  // namespace pipeline
