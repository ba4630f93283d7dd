#include "pipeline/system/child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <vector>

#include "pipeline/system/file_bytes.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/progress.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostSaid = 300;  // bytes of a child's stderr that are kept: the last
constexpr char kWhole = '\n';           // the last byte of a child that came to its end
constexpr int kRound_ms = 100;          // of waiting; also how soon a wish to stop is seen
constexpr double kMostRound = 0.2;      // s; what is beyond it was no waiting: Ctrl-Z had stopped all of us

[[noreturn]] void cannot(const char* action) {
  throw Error(kFile,
              std::string("a child process: cannot ") + action + " (" + std::strerror(errno) +
                  "); what was finished is kept: give fewer --threads, or raise the limits of this shell (ulimit)");
}

struct Pipe {
  Descriptor out, in;

  Pipe() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) cannot("have a pipe");
    out = Descriptor(ends[0]);
    in = Descriptor(ends[1]);
  }
};

struct Child {
  std::size_t job = 0;
  pid_t pid = -1;
  Descriptor answer, said;  // ends of pipes; closed when the child has closed its own
  std::string bytes, words;
  double waited = 0;  // s
  bool late = false;
};

[[noreturn]] void be_child(pid_t parent, int answer, int said, const ChildLimits& limits,
                           const std::function<std::string(std::size_t)>& work, std::size_t job) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it died before
  // Both may reach the whole group: the parent decides, or the end of a job would be taken for its own.
  signal(SIGINT, SIG_IGN);
  signal(SIGTERM, SIG_IGN);
  const auto seconds = static_cast<rlim_t>(std::ceil(limits.processor_seconds));
  const rlimit processor{seconds, seconds + 1}, core{0, 0};
  setrlimit(RLIMIT_CPU, &processor);
  setrlimit(RLIMIT_CORE, &core);
  // 0 to 2 are open in the parent, so that none of these is one of them.
  dup2(said, STDERR_FILENO);
  dup2(answer, STDERR_FILENO + 1);
  answer = STDERR_FILENO + 1;
  // The rest is the parent's, its lock on the result among it: it must be free as soon as the parent is dead.
  close_range(static_cast<unsigned>(answer) + 1, ~0u, 0);
  Descriptor nothing(open("/dev/null", O_RDWR));
  if (dup2(nothing.number(), STDIN_FILENO) < 0 || dup2(nothing.number(), STDOUT_FILENO) < 0) _exit(1);
  nothing.close();
  try {
    if (!write_all(answer, work(job) + kWhole)) _exit(1);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    std::fflush(stderr);
    _exit(1);
  }
  _exit(0);  // neither the parent's buffers nor its destructors are the child's
}

Child start(std::size_t job, const ChildLimits& limits, const std::function<std::string(std::size_t)>& work) {
  Pipe answer, said;
  Child child;
  child.job = job;
  const pid_t self = getpid();
  child.pid = fork();
  if (child.pid < 0) cannot("start");
  if (child.pid == 0) be_child(self, answer.in.number(), said.in.number(), limits, work, job);
  child.answer = std::move(answer.out);
  child.said = std::move(said.out);
  return child;
}

/// Takes what is there, keeps the last `most` bytes of all; closes `file` at its end.
void take(Descriptor& file, std::string& into, std::size_t most) {
  char block[1 << 14];
  const ssize_t got = read(file.number(), block, sizeof block);
  if (got < 0 && (errno == EINTR || errno == EAGAIN)) return;
  if (got <= 0) return file.close();
  into.append(block, static_cast<std::size_t>(got));
  if (into.size() > most) into.erase(0, into.size() - most);
}

std::string failure_of(const Child& child, int status, const rusage& used, const ChildLimits& limits) {
  std::string said = child.words;
  while (!said.empty() && said.back() == '\n') said.pop_back();
  said = one_line(said, kMostSaid);
  if (child.late) return "more than " + real_text(limits.wall_seconds) + " s of wall time";
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) {
    // What it had, as it may have given itself less.
    const auto seconds = [](const timeval& time) { return double(time.tv_sec) + double(time.tv_usec) * 1e-6; };
    return "more than " + real_text(std::round(seconds(used.ru_utime) + seconds(used.ru_stime))) +
           " s of processor time";
  }
  return ended_text(status) + (said.empty() ? "" : ": " + said);
}

/// The children of one call; whoever leaves it leaves none behind.
struct Children {
  std::vector<Child> running;

  ~Children() {
    for (Child& child : running) kill(child.pid, SIGKILL);
    for (Child& child : running) waitpid(child.pid, nullptr, 0);
  }
};

}  // namespace

std::string ended_text(int status) {
  if (!WIFSIGNALED(status)) return "ended with code " + std::to_string(WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  if (signal == SIGABRT) return "aborted";
  if (signal == SIGKILL) return "was killed by signal 9, by hand or for want of memory";
  return "crashed by signal " + std::to_string(signal);
}

void in_children(std::size_t count, int processes, const ChildLimits& limits,
                 const std::function<std::string(std::size_t)>& work,
                 const std::function<void(std::size_t, const std::string&, const std::string&)>& done) {
  std::fflush(nullptr);
  Children children;
  auto& running = children.running;
  std::size_t next = 0;
  Clock::time_point before = Clock::now();
  while (next < count || !running.empty()) {
    stop_if_wanted();
    while (next < count && running.size() < static_cast<std::size_t>(std::max(1, processes)))
      running.push_back(start(next++, limits, work));

    std::vector<pollfd> files;
    for (const Child& child : running) {
      files.push_back({child.answer.number(), POLLIN, 0});
      files.push_back({child.said.number(), POLLIN, 0});
    }
    poll(files.data(), files.size(), kRound_ms);
    const Clock::time_point now = Clock::now();
    const double passed = std::min(kMostRound, std::chrono::duration<double>(now - before).count());
    before = now;
    for (std::size_t i = 0; i < running.size(); ++i) {
      Child& child = running[i];
      if (files[2 * i].revents) take(child.answer, child.bytes, ~std::size_t{0});
      if (files[2 * i + 1].revents) take(child.said, child.words, kMostSaid);
      child.waited += passed;
      if (!child.late && child.waited > limits.wall_seconds) {
        child.late = true;
        kill(child.pid, SIGKILL);
      }
    }
    for (std::size_t i = running.size(); i-- > 0;) {
      if (running[i].answer || running[i].said) continue;
      Child child = std::move(running[i]);
      running.erase(running.begin() + static_cast<std::ptrdiff_t>(i));
      int status = 0;
      rusage used = {};
      while (wait4(child.pid, &status, 0, &used) < 0 && errno == EINTR) continue;
      const bool whole = WIFEXITED(status) && WEXITSTATUS(status) == 0 && child.bytes.ends_with(kWhole);
      if (whole) child.bytes.pop_back();
      done(child.job, whole ? child.bytes : "", whole ? "" : failure_of(child, status, used, limits));
    }
  }
}

}  // namespace pipeline
