#include "pipeline/foreign/host.hpp"

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <new>

#include "pipeline/system/file_bytes.hpp"
#include "pipeline/system/heap.hpp"

namespace pipeline {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::nanoseconds;

/// Reads so many bytes; false at the end of the file.
bool read_all(int file, char* to, std::size_t size) {
  while (size > 0) {
    const ssize_t got = read(file, to, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    to += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

/// The method between two questions.
class Host {
 public:
  Host(const std::function<Hosted()>& make, std::size_t bodies, HeapCount& heap)
      : make_(make), bodies_(bodies), heap_(heap) {}

  std::string answer(std::string_view kind, std::uint32_t number, std::string_view content) {
    if (kind == "HELO") {
      {
        const CountingHeap counting(heap_);
        const auto start = Clock::now();
        hosted_ = make_();
        hosted_.about.setup_ns = nanoseconds(Clock::now() - start).count();
      }
      if (counts_heap()) hosted_.about.memory_bytes = heap_.held;
      return frame("HELO", number, text_of(hosted_.about));
    }
    if (!hosted_.method) throw Fault("asked before the hello");
    if (kind == "STEP" || kind == "OPER") return frame("HITS", number, content_of(hits(kind == "OPER", content)));
    const CountingHeap counting(heap_);
    if (kind == "KEEP") {
      hosted_.method->remember();
    } else if (kind == "WIPE") {
      hosted_.method->forget();
    } else {
      throw Fault("asked with an unknown frame " + std::string(kind));
    }
    return frame("DONE", number, "");
  }

 private:
  Reply hits(bool counts, std::string_view content) {
    const QuestionFrame question = question_in(content, bodies_);
    Reply out;
    out.hits.reserve(most_hits_);
    const std::size_t reserved = heap_bytes(out.hits.data());
    const std::int64_t greatest = heap_.greatest;
    {
      const CountingHeap counting(heap_);
      answer(counts, question, out);
    }
    most_hits_ = std::max(most_hits_, out.hits.size());
    if (const std::size_t grown = heap_bytes(out.hits.data()) - reserved; grown > 0) {
      heap_.held -= static_cast<std::int64_t>(grown);
      heap_.greatest = std::max(greatest, heap_.held);  // the list was there twice for a moment: that is not counted
    }
    return out;
  }

  void answer(bool counts, const QuestionFrame& question, Reply& out) {
    if (counts) {
      hosted_.method->prepare(question.poses, question.enlarge);
      out.operations = static_cast<double>(hosted_.method->count(question.runs, out.hits));
    } else {
      const auto start = Clock::now();
      hosted_.method->prepare(question.poses, question.enlarge);
      const auto prepared = Clock::now();
      hosted_.method->answer(question.runs, out.hits);
      const auto answered = Clock::now();
      out.time_ns = static_cast<double>(nanoseconds(answered - start).count());
      out.prepare_ns = static_cast<double>(nanoseconds(prepared - start).count());
    }
  }

  const std::function<Hosted()>& make_;
  std::size_t bodies_, most_hits_ = 0;
  HeapCount& heap_;
  Hosted hosted_;
};

}  // namespace

void serve(const std::function<Hosted()>& make, std::size_t bodies, int in, int out, HeapCount& heap) {
  Host host(make, bodies, heap);
  std::string head(kFrameHead, '\0'), content;
  while (read_all(in, head.data(), head.size())) {
    std::uint32_t number = 0, length = 0;
    head.copy(reinterpret_cast<char*>(&number), sizeof number, 4);
    head.copy(reinterpret_cast<char*>(&length), sizeof length, 8);
    content.resize(length);
    if (!read_all(in, content.data(), length)) return;
    std::string answer, failure;
    try {
      answer = host.answer(std::string_view(head).substr(0, 4), number, content);
    } catch (const std::bad_alloc&) {
      failure = "out of memory";
    } catch (const std::exception& error) {
      failure = error.what();
    } catch (...) {
      failure = "it threw what is no std::exception";
    }
    if (!failure.empty()) answer = frame("FAIL", number, std::string_view(failure).substr(0, kMostFailure));
    if (!write_all(out, answer) || !failure.empty()) return;
  }
}

}  // namespace pipeline
