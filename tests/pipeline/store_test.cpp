#include "pipeline/result/store.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <set>

#include "pipeline/result/hdf5/h5.hpp"
#include "pipeline/result/products/extremes.hpp"
#include "pipeline/result/products/physics.hpp"
#include "pipeline/result/seal.hpp"
#include "pipeline/terminal/error.hpp"
#include "tests/support/files.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/synthetic_result.hpp"
#include "tests/support/temporary_folder.hpp"

namespace pipeline {
namespace {

namespace fs = std::filesystem;
using tests::bytes_of;

/// A folder of its own for every test, removed afterwards.
class Store : public testing::Test {
 protected:
  fs::path file(const std::string& name = "result.h5") const { return folder_ / name; }

  std::set<std::string> files() const { return tests::names_in(folder_ / ""); }

 private:
  TemporaryFolder folder_;
};

void put(const fs::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

/// Seals what HDF5 has changed, as somebody may.
void seal(const fs::path& path) {
  const std::string bytes = bytes_of(path);
  put(path, bytes + seal_of(std::as_bytes(std::span(bytes))));
}

/// Changes a result by HDF5 and seals it again.
void change(const fs::path& path, const std::function<void(hid_t)>& how) {
  {
    const h5::File opened(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "open");
    how(opened.id());
  }
  seal(path);
}

/// The line of the Error that reading ends with; also checks its code and that it is one line about this file.
std::string reading_fails(const fs::path& path) {
  const std::string line = tests::refusal_of([&] { read_result(path); }, kFile);
  EXPECT_EQ(line.rfind(path.string() + ": ", 0), 0u) << line;
  EXPECT_NE(line.find("; "), std::string::npos) << "no remedy: " << line;
  return line;
}

std::string writing_fails(const fs::path& path) {
  Result result = synthetic_result();
  const std::string line = tests::refusal_of([&] { write_result(result, path); }, kFile);
  EXPECT_NE(line, "") << path << " was written";
  return line;
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

void expect_same(const PairLists& a, const PairLists& b) {
  EXPECT_EQ(a.offset, b.offset);
  EXPECT_EQ(a.pair, b.pair);
}

void expect_same(const Result& a, const Result& b) {
  EXPECT_EQ(a.title, b.title);
  EXPECT_EQ(a.config_text, b.config_text);
  EXPECT_EQ(a.config_effective, b.config_effective);
  EXPECT_EQ(a.rate, b.rate);
  EXPECT_EQ(a.digest, b.digest);

  ASSERT_EQ(a.bodies.meshes.size(), b.bodies.meshes.size());
  for (std::size_t m = 0; m < a.bodies.meshes.size(); ++m) {
    const geometry::Mesh &x = a.bodies.meshes[m], &y = b.bodies.meshes[m];
    EXPECT_EQ(x.name, y.name);
    EXPECT_EQ(x.vertices, y.vertices);
    EXPECT_EQ(x.triangles, y.triangles);
    EXPECT_EQ(x.shape, y.shape);
    EXPECT_TRUE(same_bits(x.surface_deviation, y.surface_deviation)) << x.name;
    EXPECT_EQ(x.sphere_radius, y.sphere_radius);
  }
  EXPECT_EQ(a.bodies.name, b.bodies.name);
  EXPECT_EQ(a.bodies.mesh, b.bodies.mesh);
  EXPECT_EQ(a.bodies.fixed, b.bodies.fixed);
  EXPECT_EQ(a.bodies.chosen, b.bodies.chosen);
  EXPECT_EQ(a.first_step, b.first_step);

  ASSERT_EQ(a.steps(), b.steps());
  for (std::size_t s = 0; s < a.steps(); ++s) {
    ASSERT_EQ(a.motion[s].size(), b.motion[s].size());
    for (std::size_t body = 0; body < a.motion[s].size(); ++body) {
      const geometry::Pose &p = a.motion[s][body], &q = b.motion[s][body];
      EXPECT_TRUE(same_bits(p.q.w, q.q.w) && same_bits(p.q.x, q.q.x) && same_bits(p.q.y, q.q.y) &&
                  same_bits(p.q.z, q.q.z) && same_bits(p.t.x(), q.t.x()) && same_bits(p.t.y(), q.t.y()) &&
                  same_bits(p.t.z(), q.t.z()))
          << "step " << s << ", body " << body;
    }
  }
  ASSERT_EQ((a.products.find<PhysicsRows>() != nullptr), (b.products.find<PhysicsRows>() != nullptr));
  if (a.products.find<PhysicsRows>()) {
    EXPECT_EQ(a.products.find<PhysicsRows>()->status, b.products.find<PhysicsRows>()->status);
    ASSERT_EQ(a.products.find<PhysicsRows>()->rows.size(), b.products.find<PhysicsRows>()->rows.size());
    for (std::size_t s = 0; s < a.products.find<PhysicsRows>()->rows.size(); ++s) {
      const PhysicsSample &x = a.products.find<PhysicsRows>()->rows[s], &y = b.products.find<PhysicsRows>()->rows[s];
      EXPECT_TRUE(same_bits(x.energy, y.energy) && same_bits(x.kinetic_energy, y.kinetic_energy) &&
                  same_bits(x.greatest_penetration, y.greatest_penetration))
          << "step " << s;
      EXPECT_EQ(x.contacts, y.contacts);
      EXPECT_EQ(x.integrator_steps, y.integrator_steps);
      EXPECT_EQ(x.rejected_steps, y.rejected_steps);
      EXPECT_EQ(x.force_evaluations, y.force_evaluations);
      EXPECT_EQ(x.time_ns, y.time_ns);
      EXPECT_EQ(x.contact_time_ns, y.contact_time_ns);
    }
  }
  expect_same(a.truth.hits, b.truth.hits);
  EXPECT_EQ(a.truth.containment, b.truth.containment);
  expect_same(a.truth.contained, b.truth.contained);
  EXPECT_EQ(a.truth.contained_inside, b.truth.contained_inside);
  ASSERT_EQ(a.truth.closed_within.size(), b.truth.closed_within.size());
  for (std::size_t i = 0; i < a.truth.closed_within.size(); ++i)
    EXPECT_TRUE(same_bits(a.truth.closed_within[i], b.truth.closed_within[i]));
  EXPECT_EQ(a.bodies.closed_within, b.bodies.closed_within);
  ASSERT_EQ(a.truth.gaps.has_value(), b.truth.gaps.has_value());
  if (a.truth.gaps) {
    EXPECT_EQ(a.truth.gaps->margin, b.truth.gaps->margin);
    expect_same(a.truth.gaps->pairs, b.truth.gaps->pairs);
    EXPECT_EQ(a.truth.gaps->lower, b.truth.gaps->lower);
    EXPECT_EQ(a.truth.gaps->upper, b.truth.gaps->upper);
  }
  EXPECT_EQ(a.truth.time_ns, b.truth.time_ns);

  ASSERT_EQ(a.answers.size(), b.answers.size());
  for (std::size_t i = 0; i < a.answers.size(); ++i) {
    const Answers &x = a.answers[i], &y = b.answers[i];
    const auto texts = [](const Answers& one) {
      return std::vector{one.label,           one.name,  one.knobs,        one.promise,      one.thesis_key,
                         one.operations_unit, one.scope, one.machine.host, one.machine.date, one.machine.processor,
                         one.machine.build};
    };
    EXPECT_EQ(texts(x), texts(y));
    expect_same(x.hits, y.hits);
    EXPECT_EQ(x.time_ns, y.time_ns);
    EXPECT_EQ(x.time_median_ns, y.time_median_ns);
    EXPECT_EQ(x.prepare_ns, y.prepare_ns);
    EXPECT_EQ(x.operations, y.operations);
    EXPECT_EQ(x.true_positive, y.true_positive);
    EXPECT_EQ(x.false_positive, y.false_positive);
    EXPECT_EQ(x.false_negative, y.false_negative);
    EXPECT_EQ(x.rounding_miss, y.rounding_miss);
    EXPECT_EQ(x.contained_hit, y.contained_hit);
  }
  ASSERT_EQ(a.summary.size(), b.summary.size());
  for (std::size_t i = 0; i < a.summary.size(); ++i) {
    const Summary &x = a.summary[i], &y = b.summary[i];
    const auto counts = [](const Summary& s) {
      return std::vector{s.hits, s.true_positive, s.false_positive, s.false_negative, s.operations};
    };
    EXPECT_EQ(counts(x), counts(y));
    EXPECT_TRUE(same_bits(x.error, y.error) && same_bits(x.precision, y.precision) && same_bits(x.recall, y.recall) &&
                same_bits(x.matthews, y.matthews) && same_bits(x.time_mean_ns, y.time_mean_ns) &&
                same_bits(x.time_median_ns, y.time_median_ns) && same_bits(x.time_p95_ns, y.time_p95_ns))
        << x.error;
    EXPECT_EQ(x.promise_kept, y.promise_kept);
    EXPECT_EQ(x.contained_hit, y.contained_hit);
  }
  const auto texts = [](const Provenance& p) {
    return std::vector{p.creator,       p.git_commit,    p.build_type, p.compiler, p.flags,    p.library_versions,
                       p.config_sha256, p.inputs_sha256, p.date,       p.host,     p.processor};
  };
  EXPECT_EQ(texts(a.provenance), texts(b.provenance));
  EXPECT_EQ(a.provenance.wall_time_s, b.provenance.wall_time_s);
}

/// Writes, reads, compares, writes again and compares the bytes.
void round_trip(Result result, const fs::path& first, const fs::path& second) {
  write_result(result, first);
  Result read = read_result(first);
  expect_same(result, read);
  write_result(read, second);
  EXPECT_TRUE(bytes_of(first) == bytes_of(second)) << "the second file differs";
}

TEST_F(Store, ReadsBackEverythingAndWritesItTheSame) { round_trip(synthetic_result(), file("a.h5"), file("b.h5")); }

TEST_F(Store, WritesTheSameBytesForTheSameResult) {
  Result a = synthetic_result(120, 40, 4, 60), b = synthetic_result(120, 40, 4, 60);
  write_result(a, file("a.h5"));
  write_result(b, file("b.h5"));
  EXPECT_GT(fs::file_size(file("a.h5")), 10'000u);
  EXPECT_TRUE(bytes_of(file("a.h5")) == bytes_of(file("b.h5")));
}

TEST_F(Store, KeepsWhatHasManyChunks) { round_trip(synthetic_result(700, 60, 2, 300), file("a.h5"), file("b.h5")); }

// Neither chunks nor parts of the motion end together, and one step of many bodies is more than a chunk.
TEST_F(Store, KeepsAMotionWrittenInParts) {
  round_trip(synthetic_result(101, 500, 1, 50), file("a.h5"), file("b.h5"));
  round_trip(synthetic_result(2, 22'000, 1, 50), file("c.h5"), file("d.h5"));
}

TEST_F(Store, KeepsOneStep) { round_trip(synthetic_result(1, 3, 1, 1), file("a.h5"), file("b.h5")); }

TEST_F(Store, KeepsContainedPairsAndTheHitsOnThem) {
  for (const Containment containment : {Containment::record, Containment::meet}) {
    Result result = synthetic_result(3, 5, 2, 0);
    result.truth.containment = containment;
    for (std::uint32_t s = 0; s < 3; ++s) result.truth.contained.append(std::vector<Pair>{{0, s + 1}});
    if (containment == Containment::record)
      for (std::size_t a = 0; a < 2; ++a) {
        result.answers[a].contained_hit = {a, 1, 0};
        result.summary[a].contained_hit = a + 1;
      }
    round_trip(result, file("a.h5"), file("b.h5"));  // as files are that do not say which one is inside
    result.bodies.closed_within = 0x1p-30;
    result.truth.contained_inside = {0, 2, 3};
    result.truth.closed_within = {2.5e-16, std::numeric_limits<double>::quiet_NaN()};
    round_trip(result, file("a.h5"), file("b.h5"));
    // They are part of the truth's digest.
    const std::string before = digests(result).at("/truth");
    result.truth.contained_inside->at(1) = 0;
    EXPECT_NE(digests(result).at("/truth"), before);
    result.truth.contained_inside->at(1) = 3;  // not of the pair
    write_result(result, file("c.h5"));
    EXPECT_THROW(read_result(file("c.h5")), Error);
    result.truth.contained_inside->at(1) = 2;
    EXPECT_EQ(digests(result).at("/truth"), before);
    result.truth.contained.pair[1].b = 3;
    EXPECT_NE(digests(result).at("/truth"), before);
  }
}

TEST_F(Store, KeepsGaps) {
  Result result = synthetic_result(3, 5, 2, 1);
  const std::string without = digests(result).at("/truth");
  GapLists& gaps = result.truth.gaps.emplace();
  gaps.margin = 0.25;
  gaps.pairs.append(std::vector<Pair>{{0, 1}, {2, 4}});
  gaps.pairs.append(std::vector<Pair>{});
  gaps.pairs.append(std::vector<Pair>{{1, 3}});
  gaps.lower = {0, 0.125, 0.25};
  gaps.upper = {1e-300, 0.1251, 0.3};
  round_trip(result, file("a.h5"), file("b.h5"));
  const std::string before = digests(result).at("/truth");
  EXPECT_NE(before, without);
  result.truth.gaps->upper[2] = 0.31;
  EXPECT_NE(digests(result).at("/truth"), before);
  *result.truth.gaps = GapLists{.margin = 1, .pairs = {{0, 0, 0, 0}, {}}, .lower = {}, .upper = {}};
  round_trip(result, file("c.h5"), file("d.h5"));
}

TEST_F(Store, KeepsExtremes) {
  Result result = synthetic_result(3, 5, 2, 1);
  Extremes& extremes = result.products.put<Extremes>({});
  for (std::uint8_t s = 0; s < 3; ++s)
    extremes.rows.push_back({.pair = "box-box",
                             .gap_class = "-10 ulp",
                             .gap = -1e-15 * s,
                             .gap_ulps = -10 * s,
                             .ulp = 1e-16,
                             .scale = 1e-9,
                             .offset = 1e3,
                             .orientation = 7u + s,
                             .truth = std::uint8_t(s == 1),
                             .truth_moved = std::uint8_t(s == 2),
                             .near_touching = 1});
  for (std::uint8_t a = 0; a < 2; ++a)
    extremes.answers.push_back({.reported = {a, 0, 1},
                                .swapped = {0, a, 1},
                                .moved = {1, 0, a},
                                .failed = {0, 1, 2},
                                .reason = a ? "too dense; scale it down" : ""});
  round_trip(result, file("a.h5"), file("b.h5"));
  const Result read = read_result(file("a.h5"));
  ASSERT_TRUE(read.products.find<Extremes>());
  for (std::size_t s = 0; s < 3; ++s) {
    const ExtremeCase &x = extremes.rows[s], &y = read.products.find<Extremes>()->rows[s];
    EXPECT_EQ(std::tie(x.pair, x.gap_class, x.gap, x.gap_ulps, x.ulp, x.scale, x.offset, x.orientation),
              std::tie(y.pair, y.gap_class, y.gap, y.gap_ulps, y.ulp, y.scale, y.offset, y.orientation));
    EXPECT_EQ(std::tie(x.truth, x.truth_moved, x.near_touching), std::tie(y.truth, y.truth_moved, y.near_touching));
  }
  for (std::size_t a = 0; a < 2; ++a) {
    const ExtremeAnswers &x = extremes.answers[a], &y = read.products.find<Extremes>()->answers[a];
    EXPECT_EQ(std::tie(x.reported, x.swapped, x.moved, x.failed, x.reason),
              std::tie(y.reported, y.swapped, y.moved, y.failed, y.reason));
  }
}

TEST_F(Store, KeepsListsWithoutPairs) {
  const Result result = synthetic_result(5, 4, 2, 0);
  ASSERT_TRUE(result.truth.hits.pair.empty());
  round_trip(result, file("a.h5"), file("b.h5"));
}

TEST_F(Store, KeepsWhichBodiesWereChosen) {
  Result result = synthetic_result();
  result.bodies.chosen = {0, 1, 0, 0, 1};
  round_trip(result, file("a.h5"), file("b.h5"));
}

TEST_F(Store, KeepsAFailedIntegration) {
  Result result = synthetic_result();
  result.products.find<PhysicsRows>()->status = "failed at step 4: energy grew tenfold";
  for (std::size_t s = 4; s < result.steps(); ++s) {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    result.products.find<PhysicsRows>()->rows[s] = {kNaN, kNaN, kNaN, 0, 0, 0, 0, 0, 0};
    for (std::size_t body = 1; body < result.bodies.size(); ++body) result.motion[s][body] = geometry::unborn();
  }
  round_trip(result, file("a.h5"), file("b.h5"));
}

TEST_F(Store, KeepsTextsOfAnyLength) {
  Result result = synthetic_result();
  result.config_text = "";
  // More than the 64 KiB that an attribute of fixed length could hold.
  result.config_effective = std::string(200'000, 'x');
  result.answers[0].knobs = "{\"x\":\"" + std::string(100'000, 'x') + "\"}";
  result.title = "";
  round_trip(result, file("a.h5"), file("b.h5"));
}

TEST_F(Store, KeepsAMeshFileWithoutARadius) {
  Result result = synthetic_result();
  geometry::Mesh& mesh = result.bodies.meshes[1];
  mesh.shape = "{\"file\":\"hero.obj\",\"radius\":5}";
  mesh.surface_deviation = std::numeric_limits<double>::quiet_NaN();
  mesh.triangles.pop_back();  // open
  round_trip(result, file("a.h5"), file("b.h5"));
  EXPECT_EQ(
      h5::read_attribute<std::uint8_t>(
          h5::File(H5Fopen(file("a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open").id(), "/meshes/plate", "closed"),
      0);
}

TEST_F(Store, LeavesOutWhatTheSceneDoesNotNeed) {
  Result result = synthetic_result();
  result.products.drop<PhysicsRows>();
  result.answers.clear();
  result.summary.clear();
  round_trip(result, file("a.h5"), file("b.h5"));
  const h5::File opened(H5Fopen(file("a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open");
  for (const char* absent : {"/physics", "/algorithm", "/results", "/answers", "/summary", "/bodies/chosen"})
    EXPECT_FALSE(h5::exists(opened.id(), absent)) << absent;
  for (const char* present : {"/bodies", "/motion", "/truth", "/run", "/config"})
    EXPECT_TRUE(h5::exists(opened.id(), present)) << present;
}

TEST_F(Store, DigestsAreThoseInTheFile) {
  Result result = synthetic_result();
  write_result(result, file());
  const h5::File opened(H5Fopen(file().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open");
  const auto all = digests(result);
  EXPECT_EQ(all.size(), 6u);
  for (const auto& [group, digest] : all)
    EXPECT_EQ(h5::read_attribute<std::string>(opened.id(), group, "digest"), digest) << group;
  EXPECT_EQ(result.digest, all.at("/"));
}

TEST_F(Store, ReplacesAnExistingFileAndLeavesNothingBeside) {
  put(file(), "an older file");
  Result result = synthetic_result();
  write_result(result, file());
  EXPECT_EQ(read_result(file()).digest, result.digest);
  EXPECT_EQ(files(), std::set<std::string>{"result.h5"});
}

TEST_F(Store, SaysThatAFileIsMissing) { EXPECT_NE(reading_fails(file()).find("No such file"), std::string::npos); }

TEST_F(Store, SaysThatAFolderIsNoFile) {
  fs::create_directory(file());
  EXPECT_NE(reading_fails(file()).find("is a folder"), std::string::npos);
}

TEST_F(Store, SaysThatAFileIsNotHdf5) {
  put(file("text.h5"), "title = \"a configuration\"\n");
  put(file("empty.h5"), "");
  EXPECT_NE(reading_fails(file("text.h5")).find("is not an HDF5 file"), std::string::npos);
  EXPECT_NE(reading_fails(file("empty.h5")).find("is not an HDF5 file"), std::string::npos);
}

TEST_F(Store, SaysThatAFileIsOfAnotherProgram) {
  { const h5::File made(H5Fcreate(file().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), "make"); }
  EXPECT_NE(reading_fails(file()).find("of another program"), std::string::npos);
}

/// Gives the file another schema version.
void set_schema(const fs::path& path, std::int64_t version) {
  const h5::File opened(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "open");
  h5::check(H5Adelete(opened.id(), "schema_version"), "delete");
  h5::write_attribute(opened.id(), "schema_version", version);
}

TEST_F(Store, RefusesANewerSchemaAndNamesBoth) {
  Result result = synthetic_result();
  write_result(result, file());
  set_schema(file(), 17);
  const std::string line = reading_fails(file());
  EXPECT_NE(line.find("schema version 17"), std::string::npos) << line;
  EXPECT_NE(line.find("up to " + std::to_string(kSchemaVersion)), std::string::npos) << line;
  EXPECT_NE(line.find("newer program"), std::string::npos) << line;
  set_schema(file(), 0);
  EXPECT_NE(reading_fails(file()).find("schema version 0"), std::string::npos);
}

TEST_F(Store, SaysThatAFileIsTruncated) {
  Result result = synthetic_result();
  write_result(result, file());
  const std::string bytes = bytes_of(file());
  const std::size_t end = bytes.rfind("\ncollision benchmark result, seal ");
  for (const std::size_t size : {bytes.size() / 100, bytes.size() * 3 / 10, end * 9 / 10, end - 1}) {
    SCOPED_TRACE(size);
    put(file("part.h5"), bytes.substr(0, size));
    EXPECT_NE(reading_fails(file("part.h5")).find("is truncated"), std::string::npos);
  }
  for (const std::size_t size : {end, end + 1, bytes.size() - 1}) {
    SCOPED_TRACE(size);
    put(file("part.h5"), bytes.substr(0, size));
    EXPECT_NE(reading_fails(file("part.h5")).find("its seal is missing"), std::string::npos);
  }
}

// Wherever a byte is changed, reading gives either what was written or an error: never another result, never a crash.
TEST_F(Store, NeverReadsADamagedFileAsSomethingElse) {
  Result result = synthetic_result(3, 3, 1, 1);
  write_result(result, file());
  const std::string bytes = bytes_of(file());
  std::mt19937_64 random(5);
  int refused = 0, read = 0;
  for (int i = 0; i < 50; ++i) {
    std::string damaged = bytes;
    const std::size_t at = random() % damaged.size();
    damaged[at] = static_cast<char>(damaged[at] ^ static_cast<char>(1 << random() % 8));
    put(file("damaged.h5"), damaged);
    SCOPED_TRACE("byte " + std::to_string(at));
    try {
      EXPECT_EQ(digests(read_result(file("damaged.h5"))), digests(result));
      ++read;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), kFile);
      ++refused;
    }
  }
  EXPECT_GT(refused, 0) << "of " << refused + read;
}

TEST_F(Store, RefusesChangedAnswers) {
  Result result = synthetic_result();
  write_result(result, file());
  {
    const h5::File opened(H5Fopen(file().c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "open");
    const h5::Dataset dataset(H5Dopen2(opened.id(), "/summary/error", H5P_DEFAULT), "open");
    const std::vector<double> better(result.answers.size(), 0.0);
    h5::check(H5Dwrite(dataset.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, better.data()), "write");
  }
  EXPECT_NE(reading_fails(file()).find("its seal is missing"), std::string::npos);
  seal(file());
  EXPECT_NE(reading_fails(file()).find("its content does not have its digest"), std::string::npos);
}

// What follows is crafted: whoever makes such files seals them too.

TEST_F(Store, ComparesTheDigestOfEveryGroup) {
  for (const std::string group : {"/motion", "/truth", "/answers/method_1", "/"}) {
    SCOPED_TRACE(group);
    Result result = synthetic_result();
    write_result(result, file());
    change(file(), [&](hid_t opened) {
      const h5::Handle<H5Oclose> object(H5Oopen(opened, group.c_str(), H5P_DEFAULT), "open");
      h5::check(H5Adelete(object.id(), "digest"), "delete");
      h5::write_attribute(object.id(), "digest", std::string(32, '0'));
    });
    const std::string line = reading_fails(file());
    EXPECT_NE(line.find((group == "/" ? "its content" : group) + " does not have its digest"), std::string::npos)
        << line;
  }
}

TEST_F(Store, RefusesCountsThatContradictTheLists) {
  Result result = synthetic_result();
  write_result(result, file());
  change(file(), [&](hid_t opened) {  // it follows from the pairs, so it is not read otherwise
    const h5::Dataset dataset(H5Dopen2(opened, "/truth/hits", H5P_DEFAULT), "open");
    const std::vector<std::uint64_t> more(result.steps(), 77);
    h5::check(H5Dwrite(dataset.id(), H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, more.data()), "write");
  });
  EXPECT_NE(reading_fails(file()).find("/truth/hits: contradicts the rest"), std::string::npos);
}

TEST_F(Store, NamesAnAttributeOfAnotherKind) {
  const struct {
    const char *object, *name;
    h5::Scalar value;
    const char* said;
  } kCases[] = {
      {"/answers/method_1", "knobs", "{broken", "attribute knobs of /answers/method_1: is no JSON object"},
      {"/answers/method_1", "knobs", std::string(100'000, '['), "is no JSON object"},
      {"/answers/method_1", "promise", std::int64_t{1}, "attribute promise of /answers/method_1: it has another type"},
      {"/answers/method_1", "promise", "always", "'always' is not known"},
      {"/", "library_versions", "[1]", "attribute library_versions of /: is no JSON object"},
      {"/", "title", 1.5, "attribute title of /: it has another type"},
      {"/meshes/plate", "shape", "{\"kind\":", "attribute shape of /meshes/plate: is no JSON object"},
      {"/run", "wall_time_s", "long", "attribute wall_time_s of /run: it has another type"}};
  for (const auto& one : kCases) {
    Result result = synthetic_result();
    write_result(result, file());
    change(file(), [&](hid_t opened) {
      const h5::Handle<H5Oclose> object(H5Oopen(opened, one.object, H5P_DEFAULT), "open");
      h5::check(H5Adelete(object.id(), one.name), "delete");
      h5::write_attribute(object.id(), one.name, one.value);
    });
    const std::string line = reading_fails(file());
    EXPECT_NE(line.find(one.said), std::string::npos) << line;
  }
}

// A sphere's radius is read from its shape: of another kind it is none, and no exception of the JSON library.
TEST_F(Store, ReadsAShapeWithOddParameters) {
  Result result = synthetic_result();
  result.bodies.meshes[0].shape = "{\"kind\":\"sphere\",\"radius\":\"big\"}";
  write_result(result, file());
  EXPECT_EQ(read_result(file()).bodies.meshes[0].sphere_radius, 0);
}

TEST_F(Store, FollowsNoLinkOutOfTheFileOrInCircles) {
  ASSERT_EQ(mkfifo(file("fifo").c_str(), 0600), 0);  // opening it would wait for ever
  const auto refused = [&](const std::function<void(hid_t)>& make, const std::string& said) {
    Result result = synthetic_result();
    write_result(result, file());
    change(file(), [&](hid_t opened) {
      h5::check(H5Ldelete(opened, "/motion", H5P_DEFAULT), "delete");
      make(opened);
    });
    const std::string line = reading_fails(file());
    EXPECT_NE(line.find(said), std::string::npos) << line;
  };
  const auto fifo = file("fifo").string();
  refused([&](hid_t to) { H5Lcreate_external(fifo.c_str(), "/motion", to, "/motion", H5P_DEFAULT, H5P_DEFAULT); },
          "/motion: is a link to another file");
  refused([](hid_t to) { H5Lcreate_soft("/motion", to, "/motion", H5P_DEFAULT, H5P_DEFAULT); },
          "/motion: is a soft link");
  refused(
      [](hid_t to) {
        std::string path;
        for (int i = 0; i < 100; ++i) {
          path += "/d";
          h5::Group(H5Gcreate2(to, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), "make");
        }
      },
      "is nested too deep");
}

TEST_F(Store, ReadsNoValuesFromElsewhere) {
  Result result = synthetic_result();
  write_result(result, file());
  change(file(), [&](hid_t opened) {
    h5::check(H5Ldelete(opened, "/truth/time_ns", H5P_DEFAULT), "delete");
    const h5::Properties made(H5Pcreate(H5P_DATASET_CREATE), "make");
    h5::check(H5Pset_external(made.id(), "/etc/passwd", 0, 56), "lie elsewhere");
    const hsize_t size = result.steps();
    const h5::Space space(H5Screate_simple(1, &size, nullptr), "shape");
    h5::Dataset(H5Dcreate2(opened, "/truth/time_ns", H5T_STD_I64LE, space.id(), H5P_DEFAULT, made.id(), H5P_DEFAULT),
                "make");
  });
  EXPECT_NE(reading_fails(file()).find("/truth/time_ns: its values are in another file"), std::string::npos);
}

// 4.1 GB were taken for a file of 235 KB: nothing of the dataset is stored, all of it would be the fill value.
TEST_F(Store, TakesNoMemoryForWhatIsNotStored) {
  Result result = synthetic_result();
  write_result(result, file());
  change(file(), [](hid_t opened) {
    const h5::Dataset pair(H5Dopen2(opened, "/answers/method_1/pair", H5P_DEFAULT), "open");
    const hsize_t size[] = {hsize_t{1} << 29, 2};
    h5::check(H5Dset_extent(pair.id(), size), "grow");
  });
  const std::string line = reading_fails(file());
  EXPECT_NE(line.find("/answers/method_1/pair: of 1073741824 values only "), std::string::npos) << line;
}

TEST_F(Store, RefusesMoreStepsThanAConfigurationMayAskFor) {
  Result result = synthetic_result();
  write_result(result, file());
  change(file(), [](hid_t opened) {
    const h5::Dataset step(H5Dopen2(opened, "/step", H5P_DEFAULT), "open");
    const hsize_t size = hsize_t{1} << 29;
    h5::check(H5Dset_extent(step.id(), &size), "grow");
  });
  const std::string line = reading_fails(file());
  EXPECT_NE(line.find("/step: has 536870912 entries, at most 10000000 make sense"), std::string::npos) << line;
}

TEST_F(Store, RefusesMoreMeshesThanBodies) {
  Result result = synthetic_result();
  write_result(result, file());
  change(file(), [&](hid_t opened) {
    for (int i = 0; i < 1000; ++i)
      h5::Group(H5Gcreate2(opened, ("/meshes/m" + std::to_string(i)).c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                "make");
  });
  EXPECT_NE(reading_fails(file()).find("/meshes: has 1002 entries, at most 5 make sense"), std::string::npos);
}

TEST_F(Store, ReadsWithoutASealOnlyWhenAskedTo) {
  Result result = synthetic_result();
  write_result(result, file());
  {
    const h5::File opened(H5Fopen(file().c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "open");
    h5::Group(H5Gcreate2(opened.id(), "/my", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), "make");
  }
  EXPECT_NE(reading_fails(file()).find("--unsealed"), std::string::npos);
  testing::internal::CaptureStderr();
  EXPECT_EQ(read_result(file(), true).digest, result.digest);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("times and attributes are vouched for by nobody"), std::string::npos) << said;
}

// Results from before there were seals lack the attribute too.
TEST_F(Store, ReadsAnOlderFileAndSaysSo) {
  Result result = synthetic_result();
  write_result(result, file());
  {
    const h5::File opened(H5Fopen(file().c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "open");
    h5::check(H5Adelete(opened.id(), kSealed), "delete");
  }
  testing::internal::CaptureStderr();
  EXPECT_EQ(read_result(file()).digest, result.digest);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("is not sealed, as results of older programs"), std::string::npos) << said;
}

TEST_F(Store, WaitsForNoFifoAndReadsNoDevice) {
  ASSERT_EQ(mkfifo(file("fifo").c_str(), 0600), 0);
  EXPECT_NE(reading_fails(file("fifo")).find("not a regular file"), std::string::npos);
  EXPECT_NE(reading_fails("/dev/zero").find("not a regular file"), std::string::npos);
}

TEST_F(Store, SaysWhyAFileCannotBeWritten) {
  std::ofstream(file("plain"));
  const fs::path nowhere = file("plain") / "result.h5";
  const std::string line = writing_fails(nowhere);
  EXPECT_EQ(line.rfind(nowhere.string() + ": the folder cannot be opened (Not a directory)", 0), 0u) << line;
  fs::create_directory(file("folder.h5"));
  EXPECT_NE(writing_fails(file("folder.h5")).find("not a regular file"), std::string::npos);
  EXPECT_NE(writing_fails("/dev/full").find("not a regular file"), std::string::npos);
}

// A limit on the size of files stands for a full disk: the write fails in the middle in the same way.
TEST_F(Store, KeepsTheOldFileWhenThereIsNoRoom) {
  Result result = synthetic_result();
  write_result(result, file());
  const std::string before = bytes_of(file());

  struct rlimit old;
  getrlimit(RLIMIT_FSIZE, &old);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const struct rlimit small { 4096, old.rlim_max };
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string line = writing_fails(file());
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);

  EXPECT_NE(line.find("cannot be written (File too large)"), std::string::npos) << line;
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  EXPECT_TRUE(bytes_of(file()) == before);
  EXPECT_EQ(files(), std::set<std::string>{"result.h5"});
}

// For the tests in Python: writes the made-up result where RESULT_FILE says, when it says so.
TEST(SyntheticResult, CanBeLeftForOthers) {
  Result result = synthetic_result(50, 12, 3, 20);
  const char* place = std::getenv("SYNTHETIC_RESULT");
  const fs::path path = place ? fs::path(place) : fs::temp_directory_path() / ("synthetic_" + std::to_string(getpid()));
  write_result(result, path);
  EXPECT_EQ(read_result(path).digest, result.digest);
  if (!place) fs::remove(path);
}

}  // namespace
}  // namespace pipeline
