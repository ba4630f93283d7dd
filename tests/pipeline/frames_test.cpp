// Frames: there and back, and every way in which bytes of others are no frame.
#include "pipeline/foreign/frames.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>

#include "pipeline/foreign/hello.hpp"

namespace pipeline {
namespace {

using geometry::Pair;
using geometry::PairRun;
using geometry::Pose;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class Act>
std::string fault_of(Act act) {
  try {
    act();
  } catch (const Fault& fault) {
    return fault.what();
  }
  return "no fault";
}

std::string little(std::uint32_t value) { return {reinterpret_cast<const char*>(&value), sizeof value}; }
std::string little(double value) { return {reinterpret_cast<const char*>(&value), sizeof value}; }

TEST(Frames, AreAKindANumberALengthAndAContent) {
  EXPECT_EQ(frame("DONE", 0x102, "abc"), std::string("DONE\x02\x01\0\0\x03\0\0\0abc", 15));
}

TEST(Frames, ComeWholeOrNotYet) {
  const std::string bytes = frame("HITS", 7, "0123456789") + "next";
  for (std::size_t size = 0; size < 22; ++size)
    EXPECT_FALSE(first_frame(bytes.substr(0, size), {"HITS", 10, 7})) << size << " bytes are no whole frame";
  const auto found = first_frame(bytes, {"HITS", 10, 7});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->kind, "HITS");
  EXPECT_EQ(found->content, "0123456789");
  EXPECT_EQ(first_frame(frame("FAIL", 0, "why"), {"HITS", 10})->content, "why") << "FAIL may come instead of any";
}

// A program that answers twice: the second answer comes before, with or after the next question, and is known by
// itself.
TEST(Frames, AnAnswerToAnotherQuestionIsKnown) {
  EXPECT_EQ(fault_of([] {
              first_frame(frame("HITS", 4, ""), {"HITS", 99, 5});
            }),
            "it sent more than it was asked for: a frame HITS that answers question 4 where 5 was asked");
}

// A banner on stdout is the most usual mistake of a new program: known at its first letter, and shown.
TEST(Frames, NoiseIsKnownAtOnce) {
  EXPECT_EQ(fault_of([] {
              first_frame("Babylon.js v6.49.0 - WebGL2\nmore", {"HELO", 99});
            }),
            "its stdout holds \"Babylon.js v6.49.0 - WebGL2\" where a frame HELO must begin; only frames belong there, "
            "print on stderr");
  EXPECT_NE(fault_of([] { first_frame("\n", {"HITS", 99}); }), "no fault");
  EXPECT_NE(fault_of([] { first_frame("HI!", {"HITS", 99}); }), "no fault");
  EXPECT_NE(fault_of([] { first_frame(frame("DONE", 0, ""), {"HITS", 99}); }), "no fault") << "a right frame, not now";
  EXPECT_NE(fault_of([] { first_frame(std::string(4, '\0'), {"HITS", 99}); }), "no fault");
}

TEST(Frames, FourGibibytesAreRefusedByTheirHead) {
  EXPECT_EQ(fault_of([] {
              first_frame(std::string("HITS\0\0\0\0\xff\xff\xff\xff", 12), {"HITS", 24});
            }),
            "its frame HITS says that it has 4294967295 bytes; at most 24 are possible here");
  EXPECT_NE(fault_of([] { first_frame(std::string("FAIL\0\0\0\0\xff\xff\xff\xff", 12), {"HITS", 24}); }), "no fault");
}

TEST(Frames, AQuestionHasTheWrittenLayout) {
  const std::vector<Pose> poses = {{{0.5, -0.5, 0.25, 1}, {1, 2, -0.0}}, geometry::unborn()};
  const std::vector<PairRun> runs = {{0, 1, 2}};
  const std::string content = content_of(7, 0x1p-40, poses, runs);
  std::string expected = little(7u) + little(1u) + little(0x1p-40);
  for (const double x : {1.0, 2.0, -0.0, 0.5, -0.5, 0.25, 1.0}) expected += little(x);
  EXPECT_EQ(content.substr(0, expected.size()), expected);
  EXPECT_EQ(content.size(), 16u + 2 * 56 + 12);
  EXPECT_EQ(content.substr(content.size() - 12), little(0u) + little(1u) + little(2u));

  const QuestionFrame back = question_in(content, 2);
  EXPECT_EQ(back.step, 7u);
  EXPECT_EQ(back.enlarge, 0x1p-40);
  EXPECT_TRUE(std::signbit(back.poses[0].t.z())) << "bit for bit";
  EXPECT_EQ(back.poses[0].q.y, 0.25);
  EXPECT_FALSE(geometry::is_born(back.poses[1]));
  ASSERT_EQ(back.runs.size(), 1u);
  EXPECT_EQ(back.runs[0].last, 2u);
}

TEST(Frames, AQuestionOfAnotherSizeIsNone) {
  const std::string content = content_of(0, 0, std::vector<Pose>(2), std::vector<PairRun>{{0, 1, 2}});
  EXPECT_NE(fault_of([&] { question_in(content, 1); }), "no fault");
  EXPECT_NE(fault_of([&] { question_in(content, 3); }), "no fault");
  EXPECT_NE(fault_of([&] { question_in(content, std::numeric_limits<std::size_t>::max()); }), "no fault");
  for (std::size_t size = 0; size < content.size(); ++size)
    EXPECT_NE(fault_of([&] { question_in(content.substr(0, size), 2); }), "no fault") << size;
  std::string many = content;
  many.replace(4, 4, little(0xffff'ffffu));
  EXPECT_NE(fault_of([&] { question_in(many, 2); }), "no fault") << "runs that are not there";
}

// Found by fuzzing: the runs were handed to a library as they came.
TEST(Frames, AQuestionAsksOfItsBodiesOnly) {
  const auto asked = [](const PairRun& run) {
    return fault_of([&] { question_in(content_of(0, 0, std::vector<Pose>(3), std::vector<PairRun>{run}), 3); });
  };
  EXPECT_EQ(asked({0, 1, 3}), "no fault");
  for (const PairRun& run : {PairRun{0, 1, 4}, PairRun{1, 1, 3}, PairRun{2, 1, 3}, PairRun{0, 2, 2}, PairRun{0, 3, 2},
                             PairRun{0xffffffff, 1, 3}})
    EXPECT_NE(asked(run), "no fault") << run.a << ' ' << run.first << ' ' << run.last;
}

TEST(Frames, AReplyHasTheWrittenLayout) {
  const Reply reply{1500.5, 500, 12, {{0, 1}, {3, 4}}};
  const std::string content = content_of(reply);
  EXPECT_EQ(content, little(1500.5) + little(500.0) + little(12.0) + little(0u) + little(1u) + little(3u) + little(4u));
  const Reply back = reply_in(content);
  EXPECT_EQ(back.time_ns, 1500.5);
  EXPECT_EQ(back.prepare_ns, 500);
  EXPECT_EQ(back.operations, 12);
  EXPECT_EQ(back.hits, reply.hits);
}

TEST(Frames, TimesAndOperationsThatAreNoneAreRefused) {
  const auto fault = [](double time, double prepare, double operations) {
    return fault_of([&] { reply_in(content_of(Reply{time, prepare, operations, {}})); });
  };
  EXPECT_EQ(fault(0, 0, 0), "no fault");
  EXPECT_EQ(fault(kNaN, 0, 0), "its time is nan ns; it must be 0 or more");
  EXPECT_EQ(fault(-1, 0, 0), "its time is -1.0 ns; it must be 0 or more");
  EXPECT_EQ(fault(kInfinity, 0, 0), "its time is inf ns; it must be 0 or more");
  EXPECT_EQ(fault(10, 11, 0), "its time for preparation is 11.0 ns; it must be a part of its time, 10.0 ns");
  EXPECT_NE(fault(10, kNaN, 0), "no fault");
  EXPECT_NE(fault(10, -1, 0), "no fault");
  EXPECT_NE(fault(1, 0, 0.5), "no fault");
  EXPECT_NE(fault(1, 0, -1), "no fault");
  EXPECT_NE(fault(1, 0, kNaN), "no fault");
  EXPECT_NE(fault(1, 0, 0x1p54), "no fault");
  EXPECT_EQ(fault_of([] { reply_in(std::string(31, '\0')); }),
            "its frame HITS has 31 bytes, not 24 and 8 for every pair");
  EXPECT_NE(fault_of([] { reply_in(std::string(23, '\0')); }), "no fault");
}

// 0 fixed, 1 and 2 there, 3 not born, 4 fixed: asked are 0-1, 0-2, 1-2, 1-4, 2-4.
TEST(Frames, EveryWrongPairIsNamed) {
  std::vector<Pose> poses(5);
  poses[3] = geometry::unborn();
  const std::vector<PairRun> runs = {{0, 1, 3}, {1, 2, 3}, {1, 4, 5}, {2, 4, 5}};
  const auto flaw = [&](std::vector<Pair> hits) { return flaw_of(hits, runs, poses); };
  EXPECT_EQ(flaw({{2, 4}, {0, 1}, {1, 4}, {1, 2}, {0, 2}}), "") << "in any order";
  EXPECT_EQ(flaw({{0, 1}, {1, 5}}), "it reports the pair 1, 5: there is no body 5, only 0 to 4");
  EXPECT_EQ(flaw({{0xffff'ffff, 1}}), "it reports the pair 4294967295, 1: there is no body 4294967295, only 0 to 4");
  EXPECT_EQ(flaw({{2, 1}}), "it reports the pair 2, 1: the smaller number must come first");
  EXPECT_EQ(flaw({{2, 2}}), "it reports the pair 2, 2: a body with itself");
  EXPECT_EQ(flaw({{1, 3}}), "it reports the pair 1, 3: body 3 is not there yet");
  EXPECT_EQ(flaw({{1, 2}, {0, 1}, {1, 2}}), "it reports the pair 1, 2 twice");
  EXPECT_EQ(flaw({{0, 4}}), "it reports the pair 0, 4, which was not asked about");
}

// Whatever the bytes, the parsers give a value or a Fault; a value written again gives the same bytes.
TEST(Frames, AnyBytesGiveAValueOrAFault) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < 20000; ++round) {
    std::string bytes(random() % 80, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random() % 4 ? 0 : random());
    try {
      const std::string all = "HITS" + bytes;
      if (const auto found = first_frame(all, {"HITS", 60})) {
        EXPECT_EQ(frame(found->kind, 0, found->content), all.substr(0, kFrameHead + found->content.size()));
        const Reply reply = reply_in(found->content);
        EXPECT_EQ(content_of(reply), found->content);
      }
    } catch (const Fault&) {
    }
    try {
      const std::size_t bodies = random() % 3;
      const QuestionFrame question = question_in(bytes, bodies);
      EXPECT_EQ(question.poses.size(), bodies);
      const std::string again = content_of(question.step, question.enlarge, question.poses, question.runs);
      EXPECT_EQ(again, bytes);
    } catch (const Fault&) {
    }
    try {
      about_in(bytes);
      ADD_FAILURE() << "no hello is made of zeros";
    } catch (const Fault&) {
    }
  }
}

TEST(Hello, SaysAllAndIsReadBack) {
  About about{.name = "mine",
              .version = "1.2",
              .language = "C++",
              .tests = "hulls",
              .licence = "MIT",
              .precision = "single",
              .promise = algorithms::Promise::conservative,
              .scope = algorithms::Scope::scene,
              .operations_unit = "boxes",
              .remembers = true,
              .threads = 2,
              .setup_ns = 123456789,
              .memory_bytes = 4096,
              .refuses = "mesh 'a' is open"};
  const About back = about_in(text_of(about));
  EXPECT_EQ(back.name, "mine");
  EXPECT_EQ(back.version, "1.2");
  EXPECT_EQ(back.language, "C++");
  EXPECT_EQ(back.tests, "hulls");
  EXPECT_EQ(back.licence, "MIT");
  EXPECT_EQ(back.precision, "single");
  EXPECT_EQ(back.promise, algorithms::Promise::conservative);
  EXPECT_EQ(back.scope, algorithms::Scope::scene);
  EXPECT_EQ(back.operations_unit, "boxes");
  EXPECT_TRUE(back.remembers);
  EXPECT_EQ(back.threads, 2);
  EXPECT_EQ(back.setup_ns, 123456789);
  EXPECT_EQ(back.memory_bytes, 4096);
  EXPECT_EQ(fault_of([&] { back.takes_them(); }), "it cannot take these bodies: mesh 'a' is open");

  const About least = about_in(R"({"protocol": 1, "name": "m"})");
  EXPECT_EQ(least.promise, algorithms::Promise::none);
  EXPECT_EQ(least.memory_bytes, -1);
  least.takes_them();
  EXPECT_EQ(least.operations_unit + least.tests + least.licence, "");
}

TEST(Hello, IsRefusedWithItsKeyAndRule) {
  const auto fault = [](const std::string& more) {
    return fault_of([&] { about_in(R"({"protocol": 1, "name": "m")" + more + "}"); });
  };
  EXPECT_EQ(fault_of([] { about_in("no JSON"); }), "its hello is no JSON object");
  EXPECT_EQ(fault_of([] { about_in(std::string(1000, '[')); }), "its hello is no JSON object");
  EXPECT_EQ(fault_of([] { about_in(R"({"name": "m"})"); }), "its hello: 'protocol' must be 1, the version spoken here");
  EXPECT_EQ(fault_of([] { about_in(R"({"protocol": 2, "name": "m"})"); }),
            "its hello: 'protocol' must be 1, the version spoken here");
  EXPECT_EQ(
      fault_of([] { about_in(R"({"protocol": 1})"); }),
      "its hello: 'name' must be there and be 1 to 64 characters of A-Z a-z 0-9 _ . + - and neither '.' nor '..'");
  EXPECT_EQ(fault(R"(, "promis": "none")"), "its hello: unknown key 'promis'; did you mean 'promise'?");
  EXPECT_EQ(fault(R"(, "promise": "always")"), "its hello: 'promise' must be \"none\", \"conservative\" or \"exact\"");
  EXPECT_EQ(fault(R"(, "setup_ns": -1)"), "its hello: 'setup_ns' must be a number from 0 to 9007199254740992");
  EXPECT_EQ(fault(R"(, "setup_ns": "fast")"), "its hello: 'setup_ns' must be a number from 0 to 9007199254740992");
  EXPECT_EQ(fault(R"(, "version": "1\n2")"), "its hello: 'version' must be one line of at most 200 characters");
  EXPECT_EQ(fault(R"(, "remembers": 1)"), "its hello: 'remembers' must be true or false");
  EXPECT_EQ(fault(R"(, "threads": 0)"), "its hello: 'threads' must be a number from 1 to 4096");
}

// ---- algorithms/program/conversation.txt, the test vector of the protocol

struct Said {
  char way;
  std::string bytes;
};

std::vector<Said> conversation() {
  const std::filesystem::path root = TREE;
  std::ifstream file(root / "algorithms/program/conversation.txt");
  std::vector<Said> out;
  for (std::string line; std::getline(file, line);) {
    line = line.substr(0, line.find('#'));
    if (line.starts_with('>') || line.starts_with('<')) out.push_back({line[0], ""});
    std::erase_if(line, [](char c) { return !std::isxdigit(static_cast<unsigned char>(c)); });
    for (std::size_t i = 0; i < line.size(); i += 2)
      out.back().bytes += static_cast<char>(std::stoi(line.substr(i, 2), nullptr, 16));
  }
  return out;
}

TEST(Conversation, IsWhatThePipelineSendsAndUnderstands) {
  geometry::Bodies bodies;
  bodies.name = {"plate", "one", "two"};
  bodies.mesh = {0, 1, 1};
  bodies.fixed = {1, 0, 0};
  bodies.meshes.resize(2);
  bodies.meshes[0].name = "plate";
  bodies.meshes[0].vertices = {{-1, 0, -1}, {1, 0, -1}, {0, -0.0, 1}};
  bodies.meshes[0].triangles = {{0, 2, 1}};
  bodies.meshes[1].name = "tetra";
  bodies.meshes[1].vertices = {{0, 0, 0}, {0.1, 0, 0}, {0, 1e-5, 0}, {0, 0, 1}};
  bodies.meshes[1].triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const Pose plate, one{{0.6, 0.8, 0, 0}, {0.5, 1, 0}}, two{{}, {0, 2.5, -0.25}};
  const std::vector<Pose> before = {plate, one, geometry::unborn()}, after = {plate, one, two};
  const std::vector<PairRun> first = {{0, 1, 2}}, second = {{0, 1, 3}, {1, 2, 3}}, missed = {{0, 2, 3}};

  const std::vector<Said> said = conversation();
  ASSERT_EQ(said.size(), 16u);
  std::vector<std::string> down, up;
  for (const Said& one : said) (one.way == '>' ? down : up).push_back(one.bytes);
  EXPECT_EQ(down, (std::vector<std::string>{frame("HELO", 0, hello_text("near", bodies, "{\"reach\":2.0}")),
                                            frame("STEP", 1, content_of(0, 0, before, first)),
                                            frame("OPER", 2, content_of(0, 0, before, first)), frame("KEEP", 3, ""),
                                            frame("STEP", 4, content_of(1, 0, after, second)),
                                            frame("STEP", 5, content_of(1, 0x1p-40, after, missed)),
                                            frame("WIPE", 6, ""), frame("STEP", 7, content_of(9, 0, after, second))}));

  const auto content = [&](std::size_t i, const char* kind) {
    const auto found = first_frame(up[i], {kind, 1000, static_cast<std::uint32_t>(i)});
    EXPECT_TRUE(found && found->content.size() + kFrameHead == up[i].size()) << i;
    return std::string(found ? found->content : "");
  };
  const About about = about_in(content(0, "HELO"));
  EXPECT_EQ(about.name, "near");
  EXPECT_EQ(about.operations_unit, "distances");
  EXPECT_TRUE(about.remembers);
  EXPECT_EQ(about.setup_ns, 9876);
  EXPECT_EQ(about.memory_bytes, 48);
  EXPECT_EQ(reply_in(content(1, "HITS")).hits, (std::vector<Pair>{{0, 1}}));
  EXPECT_EQ(reply_in(content(1, "HITS")).time_ns, 2500);
  EXPECT_EQ(reply_in(content(2, "HITS")).operations, 1);
  EXPECT_EQ(content(3, "DONE"), "");
  EXPECT_EQ(reply_in(content(4, "HITS")).hits, (std::vector<Pair>{{0, 1}, {1, 2}}));
  EXPECT_TRUE(reply_in(content(5, "HITS")).hits.empty());
  EXPECT_EQ(content(6, "DONE"), "");
  EXPECT_EQ(first_frame(up[7], {"HITS", 24, 7})->kind, "FAIL");
}

}  // namespace
}  // namespace pipeline
