// Any bytes as what a method of others sends: its frames, what it says of itself, its answers, and what a child process
// of ours is asked. Refused in one line, or what can be an answer.
#include "pipeline/foreign/frames.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "fuzz.hpp"
#include "pipeline/foreign/hello.hpp"

namespace {

using namespace pipeline;
using fuzz::require;

constexpr std::size_t kBodies = 4;
const std::vector<geometry::PairRun> kRuns = {{0, 1, 4}, {1, 3, 4}};
const std::vector<geometry::Pose> kPoses(kBodies, geometry::Pose{{1, 0, 0, 0}});

void take_hello(std::string_view content) {
  const About about = about_in(content);
  fuzz::require_one_line("name: " + about.name + about.version + about.language);
  require(about.threads >= 1 && about.setup_ns >= 0 && about.memory_bytes >= -1, "what is counted is not negative");
  require(text_of(about_in(text_of(about))) == text_of(about), "what it says of itself is written and read back");
}

void take_reply(std::string_view content) {
  Reply reply = reply_in(content);
  require(reply.time_ns >= 0 && std::isfinite(reply.time_ns), "a time is a number");
  require(reply.prepare_ns >= 0 && reply.prepare_ns <= reply.time_ns, "a preparation is a part of it");
  require(content_of(reply_in(content_of(reply))) == content_of(reply), "a reply is written and read back");
  if (!flaw_of(reply.hits, kRuns, kPoses).empty()) return;
  for (std::size_t i = 0; i < reply.hits.size(); ++i) {
    const geometry::Pair& pair = reply.hits[i];
    require(pair.a < pair.b && pair.b < kBodies, "a pair is one of the bodies'");
    require((pair.a == 0 || (pair.a == 1 && pair.b == 3)) && (i == 0 || reply.hits[i - 1] < pair), "asked, and once");
  }
}

void take_question(std::string_view content) {
  const auto question = question_in(content, kBodies);
  require(question.poses.size() == kBodies, "a pose per body");
  for (const geometry::PairRun& run : question.runs)
    require(run.a < run.first && run.first < run.last && run.last <= kBodies, "a run is one of the bodies'");
}

template <class Take>
void judged(const Take& take) {
  try {
    take();
  } catch (const Fault& fault) {
    fuzz::require_one_line(fault.what());
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  for (const auto& [kind, most] : {std::pair("HELO", kMostHelloAnswer), std::pair("HITS", 1u << 20)})
    judged([&] {
      const Expected expected{kind, most};
      const auto whole = first_frame(bytes, expected);
      // What comes byte by byte is judged as what comes at once.
      for (const std::size_t part : {size / 3, size - size / 3})
        if (const auto early = first_frame(bytes.substr(0, part), expected))
          require(whole && early->content == whole->content, "more bytes change no frame");
      if (!whole || whole->kind != kind) return;
      require(frame(whole->kind, 0, whole->content) == bytes.substr(0, kFrameHead + whole->content.size()),
              "read back");
      if (whole->kind == "HELO") take_hello(whole->content);
      if (whole->kind == "HITS") take_reply(whole->content);
    });
  judged([&] { take_hello(bytes); });
  judged([&] { take_reply(bytes); });
  judged([&] { take_question(bytes); });
  return 0;
}
