#include "pipeline/foreign/frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

using geometry::Pair;
using geometry::PairRun;
using geometry::Pose;

constexpr std::size_t kQuestionHead = 16, kPose = 7 * sizeof(double), kRun = 3 * sizeof(std::uint32_t);
constexpr double kMostOperations = 9007199254740992;  // 2^53: every whole number up to it is a double

/// Values one after another.
class Writer {
 public:
  template <class T>
  Writer& operator<<(T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  std::string bytes;
};

/// The counterpart; the caller has made sure that they are there.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : at_(bytes.data()) {}

  template <class T>
  T get() {
    T value;
    std::memcpy(&value, at_, sizeof value);
    at_ += sizeof value;
    return value;
  }

 private:
  const char* at_;
};

std::string whole(std::uint64_t number) { return std::to_string(number); }

std::string pair_text(const Pair& pair) { return "the pair " + whole(pair.a) + ", " + whole(pair.b); }

}  // namespace

std::string frame(std::string_view kind, std::uint32_t number, std::string_view content) {
  if (content.size() > kMostContent)
    throw Fault("a frame " + std::string(kind) + " of " + whole(content.size()) + " bytes is more than 4 GiB");
  Writer out;
  out.bytes.reserve(kFrameHead + content.size());
  out.bytes += kind;
  out << number << static_cast<std::uint32_t>(content.size());
  out.bytes += content;
  return out.bytes;
}

std::optional<Frame> first_frame(std::string_view bytes, const Expected& expected) {
  constexpr std::size_t kLetters = 4;
  const std::string_view kind = bytes.substr(0, kLetters);
  const bool fails = !kind.empty() && std::string_view("FAIL").starts_with(kind);
  if (!fails && !expected.kind.starts_with(kind)) {
    const std::string_view there = bytes.substr(0, bytes.find('\n'));
    throw Fault("its stdout holds \"" + one_line(there, 40) + "\" where a frame " + std::string(expected.kind) +
                " must begin; only frames belong there, print on stderr");
  }
  if (bytes.size() < kFrameHead) return std::nullopt;
  Reader head(bytes.substr(kLetters));
  const auto number = head.get<std::uint32_t>(), length = head.get<std::uint32_t>();
  // An answer too many would be taken for that to the next question, whenever it happens to come.
  if (number != expected.number)
    throw Fault("it sent more than it was asked for: a frame " + std::string(kind) + " that answers question " +
                whole(number) + " where " + whole(expected.number) + " was asked");
  const std::uint64_t most = fails ? kMostFailure : expected.most;
  if (length > most)
    throw Fault("its frame " + std::string(kind) + " says that it has " + whole(length) + " bytes; at most " +
                whole(most) + " are possible here");
  if (bytes.size() - kFrameHead < length) return std::nullopt;
  return Frame{kind, bytes.substr(kFrameHead, length)};
}

std::string content_of(std::uint32_t step, double enlarge, std::span<const Pose> poses, std::span<const PairRun> runs) {
  Writer out;
  out.bytes.reserve(kQuestionHead + poses.size() * kPose + runs.size() * kRun);
  out << step << static_cast<std::uint32_t>(runs.size()) << enlarge;
  for (const Pose& pose : poses)
    out << pose.t.x() << pose.t.y() << pose.t.z() << pose.q.w << pose.q.x << pose.q.y << pose.q.z;
  for (const PairRun& run : runs) out << run.a << run.first << run.last;
  return out.bytes;
}

QuestionFrame question_in(std::string_view content, std::size_t bodies) {
  if (content.size() < kQuestionHead) throw Fault("a question of " + whole(content.size()) + " bytes has no head");
  Reader in(content);
  QuestionFrame out;
  out.step = in.get<std::uint32_t>();
  const std::size_t runs = in.get<std::uint32_t>();
  out.enlarge = in.get<double>();
  // Divided, as products of what others say may overflow.
  const std::size_t rest = content.size() - kQuestionHead;
  if (bodies > rest / kPose || runs != (rest - bodies * kPose) / kRun || (rest - bodies * kPose) % kRun != 0)
    throw Fault("a question of " + whole(content.size()) + " bytes does not hold " + whole(bodies) + " poses and " +
                whole(runs) + " runs of pairs");
  out.poses.resize(bodies);
  for (Pose& pose : out.poses) {
    for (int axis = 0; axis < 3; ++axis) pose.t[axis] = in.get<double>();
    for (double* part : {&pose.q.w, &pose.q.x, &pose.q.y, &pose.q.z}) *part = in.get<double>();
  }
  out.runs.resize(runs);
  for (PairRun& run : out.runs) {
    run.a = in.get<std::uint32_t>();
    run.first = in.get<std::uint32_t>();
    run.last = in.get<std::uint32_t>();
    if (run.a >= run.first || run.first >= run.last || run.last > bodies)
      throw Fault("a question asks of pairs (" + whole(run.a) + ", b), b from " + whole(run.first) + " to below " +
                  whole(run.last) + ", of " + whole(bodies) + " bodies");
  }
  return out;
}

std::string content_of(const Reply& reply) {
  Writer out;
  out.bytes.reserve(kReplyHead + reply.hits.size() * sizeof(Pair));
  out << reply.time_ns << reply.prepare_ns << reply.operations;
  for (const Pair& pair : reply.hits) out << pair.a << pair.b;
  return out.bytes;
}

Reply reply_in(std::string_view content) {
  if (content.size() < kReplyHead || (content.size() - kReplyHead) % sizeof(Pair) != 0)
    throw Fault("its frame HITS has " + whole(content.size()) + " bytes, not 24 and 8 for every pair");
  Reader in(content);
  Reply out;
  out.time_ns = in.get<double>();
  out.prepare_ns = in.get<double>();
  out.operations = in.get<double>();
  if (!(out.time_ns >= 0) || std::isinf(out.time_ns))
    throw Fault("its time is " + real_text(out.time_ns) + " ns; it must be 0 or more");
  if (!(out.prepare_ns >= 0 && out.prepare_ns <= out.time_ns))
    throw Fault("its time for preparation is " + real_text(out.prepare_ns) + " ns; it must be a part of its time, " +
                real_text(out.time_ns) + " ns");
  if (!(out.operations >= 0 && out.operations <= kMostOperations) || out.operations != std::floor(out.operations))
    throw Fault("its operations are " + real_text(out.operations) + "; they must be a whole number up to 2^53");
  out.hits.resize((content.size() - kReplyHead) / sizeof(Pair));
  for (Pair& pair : out.hits) {
    pair.a = in.get<std::uint32_t>();
    pair.b = in.get<std::uint32_t>();
  }
  return out;
}

std::string flaw_of(std::vector<Pair>& hits, std::span<const PairRun> runs, std::span<const Pose> poses) {
  for (const Pair& pair : hits) {
    const std::uint32_t body = std::max(pair.a, pair.b);
    if (body >= poses.size())
      return "it reports " + pair_text(pair) + ": there is no body " + whole(body) + ", only 0 to " +
             whole(poses.empty() ? 0 : poses.size() - 1);
    if (pair.a == pair.b) return "it reports " + pair_text(pair) + ": a body with itself";
    if (pair.a > pair.b) return "it reports " + pair_text(pair) + ": the smaller number must come first";
    for (const std::uint32_t one : {pair.a, pair.b})
      if (!geometry::is_born(poses[one]))
        return "it reports " + pair_text(pair) + ": body " + whole(one) + " is not there yet";
  }
  std::sort(hits.begin(), hits.end());
  auto run = runs.begin();
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (i > 0 && hits[i] == hits[i - 1]) return "it reports " + pair_text(hits[i]) + " twice";
    const auto [a, b] = hits[i];
    while (run != runs.end() && (run->a < a || (run->a == a && run->last <= b))) ++run;
    if (run == runs.end() || run->a != a || b < run->first)
      return "it reports " + pair_text(hits[i]) + ", which was not asked about";
  }
  return {};
}

}  // namespace pipeline
