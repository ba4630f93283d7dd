#include "pipeline/result/checkpoint.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <fstream>
#include <map>
#include <set>

#include "geometry/meshes/shapes.hpp"
#include "pipeline/config.hpp"
#include "pipeline/result/answer_chunk.hpp"
#include "pipeline/scene/scene.hpp"
#include "pipeline/stages/motion.hpp"
#include "pipeline/stages/truth.hpp"
#include "pipeline/terminal/error.hpp"
#include "tests/support/files.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"

using namespace pipeline;
namespace fs = std::filesystem;
using tests::bytes_of, tests::names_in;

namespace {

const CheckpointKey kKey{.config_sha256 = "c1", .program_sha256 = "p1"};

std::string refusal(const fs::path& folder, const CheckpointKey& key, bool force = false) {
  return tests::refusal_of([&] { Checkpoint part(folder, key, "title", 100, force); }, kFile);
}

void overwrite(const fs::path& file, std::streamoff at, char with) {
  std::fstream io(file, std::ios::binary | std::ios::in | std::ios::out);
  io.seekp(at);
  io.put(with);
}

}  // namespace

TEST(Checkpoint, GivesBackWhatWasSaved) {
  const TemporaryFolder folder;
  Checkpoint part(folder / "x.h5.part", kKey, "title", 100, false);
  EXPECT_FALSE(part.resumed());
  EXPECT_FALSE(part.load("motion-0000000"));
  const std::string content("a\0b\xff", 4);
  part.save("motion-0000000", content);
  EXPECT_EQ(part.load("motion-0000000"), content);
  part.save("truth-0000000", "");
  EXPECT_EQ(part.load("truth-0000000"), "");
}

TEST(Checkpoint, IsResumedByTheSameKeyOnly) {
  const TemporaryFolder folder;
  const fs::path path = folder / "x.h5.part";
  { Checkpoint(path, kKey, "title", 100, false).save(chunk_name("motion", 0), "1"); }
  {
    Checkpoint again(path, kKey, "title", 100, false);
    EXPECT_TRUE(again.resumed());
    EXPECT_EQ(again.load(chunk_name("motion", 0)), "1");
  }
  EXPECT_NE(refusal(path, {.config_sha256 = "c2", .program_sha256 = "p1"}).find("another configuration"),
            std::string::npos);
  EXPECT_NE(refusal(path, {.config_sha256 = "c1", .program_sha256 = "p2"}).find("another build"), std::string::npos);
  // What was refused is still whole; --force empties it.
  EXPECT_EQ(Checkpoint(path, kKey, "title", 100, false).load(chunk_name("motion", 0)), "1");
  Checkpoint forced(path, {.config_sha256 = "c2", .program_sha256 = "p1"}, "title", 100, true);
  EXPECT_FALSE(forced.resumed());
  EXPECT_FALSE(forced.load(chunk_name("motion", 0)));
}

TEST(Checkpoint, RefusesASecondWriterEvenWithForce) {
  const TemporaryFolder folder;
  Checkpoint first(folder / "x.h5.part", kKey, "title", 100, false);
  EXPECT_NE(refusal(folder / "x.h5.part", kKey).find("another run"), std::string::npos);
  EXPECT_NE(refusal(folder / "x.h5.part", kKey, true).find("another run"), std::string::npos);
}

TEST(Checkpoint, NeverEmptiesAFolderThatIsNotItsOwn) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "x.h5.part");
  std::ofstream(folder / "x.h5.part/diary.txt") << "dear diary";
  EXPECT_NE(refusal(folder / "x.h5.part", kKey, true), "");
  EXPECT_TRUE(fs::exists(folder / "x.h5.part/diary.txt"));
}

// A torn or damaged chunk counts as absent, so its steps are computed again.
TEST(Checkpoint, TakesNoDamagedChunk) {
  const TemporaryFolder folder;
  Checkpoint part(folder / "p", kKey, "title", 100, false);
  part.save("truth-0000000", std::string(1000, 'x'));
  for (const std::streamoff at : {0, 8, 23, 24, 700, 1023}) {
    part.save("truth-0000050", std::string(1000, 'x'));
    overwrite(folder / "p/truth-0000050", at, '!');
    EXPECT_FALSE(part.load("truth-0000050")) << "byte " << at;
  }
  for (const std::uintmax_t size : {0, 7, 24, 500, 1023}) {
    part.save("truth-0000100", std::string(1000, 'x'));
    fs::resize_file(folder / "p/truth-0000100", size);
    EXPECT_FALSE(part.load("truth-0000100")) << "size " << size;
  }
  EXPECT_TRUE(part.load("truth-0000000"));
}

// ---- Workers

TEST(Checkpoint, IsJoinedByWorkersBesideTheRun) {
  const TemporaryFolder folder;
  const fs::path path = folder / "p";
  Checkpoint run(path, kKey, "title", 100, false);
  run.save("motion-0000000", "1");
  run.describe("steps = 100\n", "/somewhere/x.toml");
  const Checkpoint worker(path);
  EXPECT_EQ(worker.load("motion-0000000"), "1");
  EXPECT_EQ(worker.steps(), 100);
  ASSERT_TRUE(worker.description());
  EXPECT_EQ(worker.description()->configuration, "steps = 100\n");
  EXPECT_EQ(worker.description()->from, "/somewhere/x.toml");
  EXPECT_FALSE(worker.moved());
  run.mark_moved();
  EXPECT_TRUE(worker.moved());
  EXPECT_EQ(worker.state(), Checkpoint::State::open);

  auto mine = worker.claim("truth-0000000");
  ASSERT_TRUE(mine);
  EXPECT_FALSE(run.claim("truth-0000000"));
  EXPECT_TRUE(run.claimed("truth-0000000"));
  EXPECT_EQ(checkpoint_status(path).held.size(), 1u);
  worker.save("truth-0000000", "2");
  mine.reset();
  EXPECT_EQ(run.load("truth-0000000"), "2");
  EXPECT_TRUE(checkpoint_status(path).held.empty());

  run.mark_complete();
  EXPECT_EQ(worker.state(), Checkpoint::State::complete);
  run.remove();
  EXPECT_EQ(worker.state(), Checkpoint::State::complete);
  EXPECT_FALSE(fs::exists(path));
}

// The stopped worker's chunk, made again by another meanwhile, is dropped; a damaged one is replaced.
TEST(Checkpoint, KeepsTheFirstWholeChunk) {
  const TemporaryFolder folder;
  Checkpoint part(folder / "p", kKey, "title", 100, false);
  part.save("truth-0000000", "first");
  part.save("truth-0000000", "second");
  EXPECT_EQ(part.load("truth-0000000"), "first");
  overwrite(folder / "p/truth-0000000", 3, '!');
  part.save("truth-0000000", "third");
  EXPECT_EQ(part.load("truth-0000000"), "third");
}

TEST(Checkpoint, WorkersOfAnotherRunAreTold) {
  const TemporaryFolder folder;
  const fs::path path = folder / "p";
  const CheckpointKey other{.config_sha256 = "c2", .program_sha256 = "p1"};
  { Checkpoint(path, kKey, "title", 100, false).save("motion-0000000", "1"); }
  const Checkpoint worker(path);
  EXPECT_NO_THROW(worker.require(kKey, "x.toml"));
  CheckpointKey elsewhere = kKey;
  elsewhere.machine_sha256 = "m2";
  EXPECT_NO_THROW(worker.require(elsewhere, "x.toml")) << "truth and answers depend on no machine";
  for (const auto& [key, what] : std::vector<std::pair<CheckpointKey, std::string>>{
           {other, "another configuration than x.toml"},
           {{.config_sha256 = "c1", .program_sha256 = "p2"}, "another build"},
           {{.config_sha256 = "c1", .program_sha256 = "p1", .inputs_sha256 = "i"}, "other input files"}}) {
    const std::string line = tests::refusal_of([&] { worker.require(key, "x.toml"); }, kFile);
    EXPECT_NE(line.find(what), std::string::npos) << line;
  }
  Checkpoint forced(path, other, "title", 100, true);
  EXPECT_EQ(worker.state(), Checkpoint::State::another);
  worker.save("truth-0000000", "theirs");  // too late: it has their seal
  EXPECT_FALSE(forced.load("truth-0000000"));
}

// The motion alone depends on the machine: once it is made, any may go on.
TEST(Checkpoint, IsResumedOnAnotherMachineOnceTheMotionIsMade) {
  const TemporaryFolder folder;
  const fs::path path = folder / "p";
  CheckpointKey elsewhere = kKey;
  elsewhere.machine_sha256 = "m2";
  { Checkpoint(path, kKey, "title", 100, false).save("motion-0000000", "1"); }
  EXPECT_NE(refusal(path, elsewhere).find("another build or machine"), std::string::npos);
  { Checkpoint(path, kKey, "title", 100, false).mark_moved(); }
  Checkpoint there(path, elsewhere, "title", 100, false);
  EXPECT_TRUE(there.resumed());
  EXPECT_EQ(there.load("motion-0000000"), "1") << "by the seal that it was made with";
  there.save("truth-0000000", "2");
  there.mark_complete();
  EXPECT_TRUE(checkpoint_status(path).moved);
}

// A run that begins leaves alone what workers are writing, and clears away what the dead left.
TEST(Checkpoint, SweepsClaimsOfTheDeadOnly) {
  const TemporaryFolder folder;
  const fs::path path = folder / "p";
  { Checkpoint(path, kKey, "title", 100, false).save("motion-0000000", "1"); }
  const Checkpoint worker(path);
  const auto mine = worker.claim("truth-0000000");
  for (const char* name : {".truth-0000000.01234567.new", ".truth-0000050.01234567.new",
                           ".answers-0000000.claim.01234567.new", "answers-0000050.claim"})
    std::ofstream(path / name) << R"({"host":"elsewhere","lease_s":1})";
  fs::last_write_time(path / "answers-0000050.claim", fs::file_time_type::clock::now() - std::chrono::seconds(10));
  const Checkpoint run(path, kKey, "title", 100, false);
  EXPECT_EQ(names_in(path), (std::set<std::string>{"lock", "manifest.json", "motion-0000000", "truth-0000000.claim",
                                                   ".truth-0000000.01234567.new"}));
}

// A run that fails before it has anything takes away its folder, but not what workers have put there meanwhile.
TEST(Checkpoint, LeavesWhatWorkersMade) {
  const TemporaryFolder folder;
  const fs::path path = folder / "p";
  {
    Checkpoint run(path, kKey, "title", 100, false);
    run.describe("", "x.toml");
  }
  EXPECT_FALSE(fs::exists(path));
  {
    Checkpoint run(path, kKey, "title", 100, false);
    run.describe("", "x.toml");
    Checkpoint(path).save("truth-0000000", "1");
  }
  EXPECT_TRUE(fs::exists(path / "truth-0000000"));
}

// A chunk is of its run: one of another configuration is never taken even where one is found.
TEST(Checkpoint, NeverTakesTheChunksOfAnotherRun) {
  const TemporaryFolder folder;
  const fs::path path = folder / "p";
  const CheckpointKey other{.config_sha256 = "c2", .program_sha256 = "p1"};
  { Checkpoint(path, kKey, "title", 100, false).save("motion-0000000", "theirs"); }
  fs::copy_file(path / "motion-0000000", folder / "kept");
  Checkpoint mine(path, other, "title", 100, true);
  EXPECT_FALSE(mine.resumed());
  EXPECT_FALSE(fs::exists(path / "motion-0000000"));
  fs::copy_file(folder / "kept", path / "motion-0000000");
  EXPECT_FALSE(mine.load("motion-0000000"));
}

// ... and of its step: until 29 November 2026 a chunk copied under the name of another was taken, and the run ended
// with another digest and code 0.
TEST(Checkpoint, NeverTakesAChunkUnderAnotherName) {
  const TemporaryFolder folder;
  Checkpoint part(folder / "p", kKey, "title", 100, false);
  part.save("answers-0000000", "of step 0");
  fs::copy_file(folder / "p/answers-0000000", folder / "p/answers-0000050");
  EXPECT_FALSE(part.load("answers-0000050"));
  EXPECT_EQ(part.load("answers-0000000"), "of step 0");
}

// A folder that looks like ours, by a lock or by some manifest, was emptied without --force, and with it.
TEST(Checkpoint, ErasesNothingInAFolderThatIsNotKnownAsItsOwn) {
  const char* const kForeign[] = {
      R"({"name":"my web page"})", "{", "[]", R"({"kind":7,"steps":3})",
      R"({"config_sha256":"c1","inputs_sha256":"","program_sha256":"p1","title":"title","steps":100})"};
  for (const bool force : {false, true}) {
    for (const char* manifest : kForeign) {
      const TemporaryFolder folder;
      const fs::path path = folder / "p";
      fs::create_directory(path);
      std::ofstream(path / "manifest.json") << manifest;
      std::ofstream(path / "motion-0000000") << "a film";
      EXPECT_NE(refusal(path, kKey, force).find("in the way"), std::string::npos) << manifest;
      EXPECT_EQ(names_in(path), (std::set<std::string>{"manifest.json", "motion-0000000"})) << manifest;
    }
    const TemporaryFolder folder;
    const fs::path path = folder / "p";
    fs::create_directory(path);
    std::ofstream(path / "lock") << "";
    std::ofstream(path / "truth-0000000") << "mine";
    EXPECT_NE(refusal(path, kKey, force).find("in the way"), std::string::npos);
    EXPECT_EQ(names_in(path), (std::set<std::string>{"lock", "truth-0000000"}));
  }
}

TEST(Checkpoint, LeavesWhatOthersPutIntoItsFolder) {
  const TemporaryFolder folder;
  const fs::path path = folder / "p";
  const CheckpointKey other{.config_sha256 = "c2", .program_sha256 = "p1"};
  { Checkpoint(path, kKey, "title", 100, false).save("motion-0000000", "1"); }
  std::ofstream(path / "notes.txt") << "mine";
  fs::create_directory(path / "truth-0000050");
  fs::create_symlink(folder / "elsewhere", path / "truth-0000100");
  const std::set<std::string> foreign{"notes.txt", "truth-0000050", "truth-0000100"};
  {
    Checkpoint part(path, other, "title", 100, true);
    EXPECT_FALSE(fs::exists(path / "motion-0000000"));
    part.save("motion-0000000", "2");
    testing::internal::CaptureStderr();
    part.remove();
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find(" is in it); it is of no more use"), std::string::npos) << said;
  }
  EXPECT_EQ(names_in(path), foreign);
}

TEST(Checkpoint, IsNoLink) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "elsewhere");
  fs::create_directory_symlink(folder / "elsewhere", folder / "p");
  EXPECT_NE(refusal(folder / "p", kKey).find("not a folder"), std::string::npos);
  EXPECT_TRUE(fs::is_empty(folder / "elsewhere"));
}

// Chunks were written through whatever link stood at their name with ".new".
TEST(Checkpoint, WritesThroughNoLink) {
  const TemporaryFolder folder;
  std::ofstream(folder / "precious") << "precious";
  Checkpoint part(folder / "p", kKey, "title", 100, false);
  for (const char* name : {"p/motion-0000000", "p/motion-0000000.new", "p/.motion-0000000.new"})
    fs::create_symlink(folder / "precious", folder / name);
  part.save("motion-0000000", "chunk");
  EXPECT_EQ(part.load("motion-0000000"), "chunk");
  EXPECT_EQ(bytes_of(folder / "precious"), "precious");
}

TEST(Checkpoint, ReadsThroughNoLinkAndTellsWhatItCannotRead) {
  const TemporaryFolder folder;
  Checkpoint part(folder / "p", kKey, "title", 100, false);
  part.save("truth-0000000", "chunk");
  fs::create_symlink("truth-0000000", folder / "p/motion-0000000");
  fs::create_directory(folder / "p/motion-0000050");
  mkfifo((folder / "p/answers-0000000").c_str(), 0600);
  for (const auto& [name, what] : std::map<std::string, std::string>{{"motion-0000000", "is a symbolic link"},
                                                                     {"motion-0000050", "is a folder"},
                                                                     {"answers-0000000", "is a pipe"}}) {
    const std::string line = tests::refusal_of([&] { part.load(name); }, kFile);
    EXPECT_NE(line.find(name + ": " + what), std::string::npos) << line;
  }
}

TEST(Checkpoint, SweepsWhatAKillLeftWhileAChunkWasWritten) {
  const TemporaryFolder folder;
  const fs::path path = folder / "p";
  { Checkpoint(path, kKey, "title", 100, false).save("motion-0000000", "1"); }
  for (const char* name : {".motion-0000050.0123abcd.new", ".manifest.json.89abcdef.new", ".notes.0123abcd.new"})
    std::ofstream(path / name) << "half";
  Checkpoint again(path, kKey, "title", 100, false);
  EXPECT_TRUE(again.resumed());
  EXPECT_EQ(names_in(path), (std::set<std::string>{".notes.0123abcd.new", "lock", "manifest.json", "motion-0000000"}));
}

// A kill before the first manifest leaves a folder with nothing but its lock, or with half a manifest.
TEST(Checkpoint, TakesOverWhatAKillLeftAtTheVeryBeginning) {
  for (const char* name : {"lock", ".manifest.json.0123abcd.new"}) {
    const TemporaryFolder folder;
    fs::create_directory(folder / "p");
    std::ofstream(folder / "p" / name) << "";
    EXPECT_EQ(refusal(folder / "p", kKey), "") << name;
  }
}

// A run that failed before it had anything leaves no folders, at any level.
TEST(Checkpoint, LeavesNothingWhenNothingWasSaved) {
  const TemporaryFolder folder;
  { Checkpoint part(folder / "a/b/p", kKey, "title", 100, false); }
  EXPECT_FALSE(fs::exists(folder / "a"));
  { Checkpoint(folder / "a/b/p", kKey, "title", 100, false).save("truth-0000000", "1"); }
  EXPECT_TRUE(fs::exists(folder / "a/b/p/truth-0000000"));
}

// Killed between the result's rename and the folder's removal: the next run clears it away.
TEST(Checkpoint, ACompleteFolderIsRemovedOnlyWhenItIsCompleteAndFree) {
  const TemporaryFolder folder;
  const fs::path path = folder / "p";
  {
    Checkpoint part(path, kKey, "title", 100, false);
    part.save("truth-0000000", "1");
    Checkpoint::remove_complete(path);
    EXPECT_TRUE(fs::exists(path / "truth-0000000")) << "not complete";
    part.mark_complete();
    Checkpoint::remove_complete(path);
    EXPECT_TRUE(fs::exists(path / "manifest.json")) << "another run holds it";
  }
  EXPECT_TRUE(Checkpoint(path, kKey, "title", 100, false).resumed()) << "complete is still the same run";
  EXPECT_TRUE(fs::exists(path / "truth-0000000"));
  Checkpoint::remove_complete(path);
  EXPECT_FALSE(fs::exists(path));
}

TEST(Checkpoint, RefusesManifestsOfNonsense) {
  const TemporaryFolder folder;
  for (const char* text : {"", "{", "[]", "{\"steps\":\"x\"}", "{\"steps\":-1}", "{\"steps\":4000000000000000000}"}) {
    fs::create_directories(folder / "p");
    std::ofstream(folder / "p/manifest.json") << text;
    EXPECT_THROW(checkpoint_status(folder / "p"), Error) << text;
    EXPECT_NE(refusal(folder / "p", kKey), "") << text;
  }
}

TEST(Checkpoint, SaysHowFarItIs) {
  const TemporaryFolder folder;
  Checkpoint part(folder / "p", kKey, "A title", 120, false);
  part.save(chunk_name("motion", 0), "");
  part.save(chunk_name("motion", 50), "");
  part.save(chunk_name("motion", 100), "");
  part.save(chunk_name("truth", 50), "");
  const CheckpointStatus status = checkpoint_status(folder / "p");
  EXPECT_EQ(status.title, "A title");
  EXPECT_EQ(status.steps, 120);
  EXPECT_EQ(status.motion_steps, 120);
  EXPECT_EQ(status.truth_steps, 50);
  EXPECT_EQ(status.answered_steps, 0);
  EXPECT_THROW(checkpoint_status(folder / "elsewhere"), Error);
}

TEST(Chunk, ReadsWhatWasWritten) {
  ChunkWriter out;
  out.put(std::vector<double>{1, -0.0, 2});
  out.put(std::string("text"));
  out.put(std::vector<std::uint64_t>{});
  ChunkReader in(out.bytes);
  EXPECT_EQ(in.get<double>(), (std::vector<double>{1, -0.0, 2}));
  EXPECT_EQ(in.text(), "text");
  EXPECT_TRUE(in.get<std::uint64_t>().empty());
  EXPECT_THROW(in.get<char>(), std::logic_error);
}

// It asked the disk for every step that the manifest spoke of: 10^7 cases stalled `show`.
TEST(Checkpoint, CountsWhatIsThere) {
  const TemporaryFolder folder;
  std::ofstream(folder / "manifest.json")
      << R"({"kind":"collision benchmark checkpoint","title":"t","steps":10000000,"study":true})";
  for (const char* name : {"case-0000003", "case-9999999", "case-10000000", "case-3", "case-0000004.new", "lock"})
    std::ofstream(folder / name) << "x";
  EXPECT_EQ(checkpoint_status(folder / "").cases, 2);
  std::ofstream(folder / "manifest.json") << R"({"kind":"collision benchmark checkpoint","title":"t","steps":130})";
  for (const char* name : {"motion-0000000", "motion-0000050", "truth-0000100", "answers-0000007", "truth-0000150"})
    std::ofstream(folder / name) << "x";
  const CheckpointStatus status = checkpoint_status(folder / "");
  EXPECT_EQ(status.motion_steps, 100);
  EXPECT_EQ(status.truth_steps, 30);
  EXPECT_EQ(status.answered_steps, 0);
}

TEST(Checkpoint, RefusesAManifestThatIsNone) {
  const TemporaryFolder folder;
  const auto code = [&] {
    try {
      checkpoint_status(folder / "");
    } catch (const Error& error) {
      return error.code();
    }
    return kDone;
  };
  for (const std::string& text : {std::string("{\"steps\": 1"), std::string(10'000, '['), std::string(1 << 20, ' ')}) {
    std::ofstream(folder / "manifest.json") << text;
    EXPECT_EQ(code(), kFile);
  }
  fs::remove(folder / "manifest.json");
  ASSERT_EQ(mkfifo((folder / "manifest.json").c_str(), 0600), 0);
  EXPECT_EQ(code(), kFile);
}

// The count of a list is believed only as far as there are bytes.
TEST(ChunkReader, AllocatesNothingForWhatIsNotThere) {
  const std::uint64_t count = std::uint64_t{1} << 60;
  const std::string bytes(reinterpret_cast<const char*>(&count), sizeof count);
  ChunkReader reader(bytes);
  EXPECT_THROW(reader.get<double>(), std::logic_error);
}

// Chunks whose checksum holds although no run wrote them: the lists would be read beyond their ends.
TEST(Checkpoint, TakesNoChunkOfAnotherSize) {
  geometry::Bodies bodies;
  bodies.meshes = {geometry::box("box", {1, 1, 1})};
  bodies.name = {"a", "b"};
  bodies.mesh = {0, 0};
  bodies.fixed = {0, 0};
  const std::vector<std::vector<geometry::Pose>> poses(3, std::vector<geometry::Pose>(2, geometry::Pose{{1, 0, 0, 0}}));
  const auto truth_of = [&](const PairLists& hits, std::size_t times) {
    ChunkWriter out;
    out.put(hits.offset);
    out.put(hits.pair);
    out.put(std::vector<std::uint64_t>{0});
    out.put(std::vector<Pair>{});
    out.put(std::vector<std::uint32_t>{});
    out.put(std::vector<std::int64_t>(times));
    put_machine({}, out);
    const TemporaryFolder folder;
    Checkpoint part(folder / "p", kKey, "title", 3, true);
    part.save(chunk_name("truth", 0), out.bytes);
    Progress progress("", 0, true);
    return decide(bodies, poses, 1, part, progress);
  };
  EXPECT_EQ(truth_of({{0, 1, 1, 1}, {{0, 1}}}, 3).hits.pair.size(), 1u);
  EXPECT_THROW(truth_of({{}, {}}, 3), std::logic_error);                           // no offset at all
  EXPECT_THROW(truth_of({{0, 1, 1}, {{0, 1}}}, 3), std::logic_error);              // a step is missing
  EXPECT_THROW(truth_of({{0, 1ull << 60, 1, 1}, {{0, 1}}}, 3), std::logic_error);  // beyond the pairs
  EXPECT_THROW(truth_of({{0, 0, 0, 2}, {{0, 1}}}, 3), std::logic_error);           // more than there are
  EXPECT_THROW(truth_of({{0, 1, 1, 1}, {{0, 2}}}, 3), std::logic_error);           // no such body
  EXPECT_THROW(truth_of({{0, 2, 2, 2}, {{0, 1}, {0, 1}}}, 3), std::logic_error);   // twice
  EXPECT_THROW(truth_of({{0, 1, 1, 1}, {{0, 1}}}, 4), std::logic_error);           // more times than steps
}

TEST(Checkpoint, TakesNoMotionOfAnotherSize) {
  const Config config = parse_config("steps = 3\n[scene]\nkind = \"box\"\n[scene.births]\ncount = 2\n", "a.toml");
  const Scene scene = make_scene(config);
  const auto motion_of = [&](std::size_t samples, std::size_t rows, const std::string& failure) {
    ChunkWriter out;
    out.put(std::vector<BodyState>(samples));
    out.put(std::vector<PhysicsSample>(rows));
    out.put(failure);
    out.put(std::vector<double>{0});
    const TemporaryFolder folder;
    Checkpoint part(folder / "p", kKey, "title", 3, true);
    part.save(chunk_name("motion", 0), out.bytes);
    Progress progress("", 0, true);
    return integrate(config, scene, part, progress);
  };
  const std::size_t bodies = scene.bodies.size();
  EXPECT_EQ(motion_of(3 * bodies, 3, "").poses.size(), 3u);
  EXPECT_EQ(motion_of(bodies, 1, "failed at step 1: energy").poses.size(), 3u);
  EXPECT_THROW(motion_of(3 * bodies - 1, 3, ""), std::logic_error);
  EXPECT_THROW(motion_of(0, 0, ""), std::logic_error);
  EXPECT_THROW(motion_of(0, 3, ""), std::logic_error);
  EXPECT_THROW(motion_of(4 * bodies, 4, ""), std::logic_error);
  EXPECT_THROW(motion_of(3 * bodies, 3, "failed at step 3: energy"), std::logic_error);
}
