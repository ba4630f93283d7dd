// The frames by which the pipeline and a method of others in a process of its own speak; algorithms/README.md, "A
// program", is their definition. Pure functions from values to bytes and back: whatever comes from others is judged
// here, before anything is made of it.
//
// A frame is a kind of four letters, the number of the question that is asked or answered (32 bits, counted from 0),
// the number of bytes of its content (32 bits), and the content. Numbers are little-endian.
#pragma once
#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/bodies.hpp"

namespace pipeline {

static_assert(std::endian::native == std::endian::little, "frames are little-endian");

/// What a method of others did wrong, in words: its answers are data, and so is this.
struct Fault : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// It took longer than it may.
struct TooLate : Fault {
  using Fault::Fault;
};

constexpr std::int64_t kProtocol = 1;
constexpr std::size_t kFrameHead = 12;                  // bytes: kind, number, length
constexpr std::uint32_t kMostHelloAnswer = 64 << 10;    // bytes of what a method says of itself
constexpr std::uint32_t kMostFailure = 64 << 10;        // bytes of why it gives up
constexpr std::uint64_t kMostContent = 0xffff'ffffull;  // bytes that a frame's length can tell

struct Frame {
  std::string_view kind;     // four letters
  std::string_view content;  // within the bytes it was read from
};

/// The bytes of a frame. Throws Fault when the content is longer than a frame can be.
std::string frame(std::string_view kind, std::uint32_t number, std::string_view content);

/// Which kind of answer is waited for, how long it may be, and to which question. "FAIL" may come instead of any.
struct Expected {
  std::string_view kind;
  std::uint64_t most = 0;    // bytes of content
  std::uint32_t number = 0;  // of the question
};

/// The frame at the beginning of `bytes`; nothing when more bytes are needed for it, which is known to be right so far.
/// Throws Fault at the first byte that cannot belong to what is expected, however little is there.
std::optional<Frame> first_frame(std::string_view bytes, const Expected& expected);

/// A question about one step: the content of STEP and OPER.
struct QuestionFrame {
  std::uint32_t step = 0;
  double enlarge = 0;  // boxes and radii grow by this times (size + |t|)
  std::vector<geometry::Pose> poses;
  std::vector<geometry::PairRun> runs;
};

/// The content of a question: u32 step, u32 runs, f64 enlarge; by body f64 px py pz qw qx qy qz; by run u32 a first
/// last.
std::string content_of(std::uint32_t step, double enlarge, std::span<const geometry::Pose> poses,
                       std::span<const geometry::PairRun> runs);

/// The counterpart, for `bodies` bodies. Throws Fault.
QuestionFrame question_in(std::string_view content, std::size_t bodies);

/// What is answered: the content of HITS.
struct Reply {
  double time_ns = 0, prepare_ns = 0;  // of the method's own clock; prepare_ns is a part of time_ns
  double operations = 0;               // of OPER, else 0
  std::vector<geometry::Pair> hits;
};

constexpr std::size_t kReplyHead = 24;  // bytes before the pairs

/// The content of a reply: f64 time_ns, f64 prepare_ns, f64 operations; by pair u32 a, u32 b.
std::string content_of(const Reply& reply);

/// The counterpart. Throws Fault for what is no whole number of pairs, a time that is negative, NaN or infinite, a
/// preparation longer than the time, operations that are no whole number.
Reply reply_in(std::string_view content);

/// What is wrong with reported pairs, given what was asked; empty when nothing is. Sorts `hits`.
std::string flaw_of(std::vector<geometry::Pair>& hits, std::span<const geometry::PairRun> runs,
                    std::span<const geometry::Pose> poses);

}  // namespace pipeline
