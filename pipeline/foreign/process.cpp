#include "pipeline/foreign/process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <thread>

#include "pipeline/system/child.hpp"
#include "pipeline/system/heap.hpp"
#include "pipeline/terminal/error.hpp"
#include "pipeline/terminal/progress.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostSaid = 600;   // bytes of its stderr that are kept: the last
constexpr std::size_t kBlock = 1 << 16;  // bytes read at a time
constexpr int kPipe = 1 << 20;           // bytes that a pipe should hold, where the system allows
constexpr int kRound_ms = 100;           // of waiting; also how soon a wish to stop is seen
constexpr double kMostRound = 0.2;       // s; what is beyond it was no waiting: Ctrl-Z had stopped all of us
constexpr auto kToEnd = std::chrono::milliseconds(500);  // for a process whose stdin was closed
constexpr const char* kThreads[] = {"OMP_NUM_THREADS",     "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS",
                                    "NUMBA_NUM_THREADS",   "RAYON_NUM_THREADS",    "VECLIB_MAXIMUM_THREADS",
                                    "NUMEXPR_NUM_THREADS", "JULIA_NUM_THREADS",    "GOMAXPROCS"};

[[noreturn]] void cannot(const char* action) {
  throw Error(kFile, std::string("a method of others: cannot ") + action + " (" + std::strerror(errno) +
                         "); raise the limits of this shell (ulimit)");
}

struct Pipe {
  Descriptor out, in;

  Pipe() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) cannot("have a pipe");
    out = Descriptor(ends[0]);
    in = Descriptor(ends[1]);
    fcntl(ends[1], F_SETPIPE_SZ, kPipe);  // no harm where it is refused
  }
};

/// The three pipes of a child.
struct Pipes {
  Pipe in, out, said;
};

void refuse_to_wait(int file) { fcntl(file, F_SETFL, fcntl(file, F_GETFL) | O_NONBLOCK); }

/// Writing to a process that has ended is told by write, for as long as this lives.
class NoPipeSignal {
 public:
  NoPipeSignal() {
    struct sigaction ignore = {};
    ignore.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &ignore, &before_);
  }
  ~NoPipeSignal() { sigaction(SIGPIPE, &before_, nullptr); }

 private:
  struct sigaction before_;
};

/// Bytes of data that this process has.
std::uint64_t own_data() {
  std::ifstream file("/proc/self/statm");
  std::uint64_t pages = 0;
  for (int i = 0; i < 6; ++i) file >> pages;  // size resident shared text lib data
  return file ? pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) : 0;
}

void limit_memory(std::uint64_t bytes) {
  if (!counts_heap()) return;  // a sanitizer's shadow is data
  // Not RLIMIT_AS: engines reserve many times what they use.
  const rlimit data{bytes, bytes};
  setrlimit(RLIMIT_DATA, &data);
}

/// What every child does first; the pipes become its 0, 1 and 2.
void become_child(pid_t parent, const Pipes& pipes) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it died before
  setpgid(0, 0);
  for (const int signal : {SIGINT, SIGTERM, SIGXFSZ, SIGPIPE}) ::signal(signal, SIG_DFL);
  const rlimit core{0, 0};
  setrlimit(RLIMIT_CORE, &core);
  // 0 to 2 are open in the parent, so that none of the pipes is one of them.
  dup2(pipes.in.out.number(), STDIN_FILENO);
  dup2(pipes.out.in.number(), STDOUT_FILENO);
  dup2(pipes.said.in.number(), STDERR_FILENO);
}

/// The place of a name along PATH that can be executed.
fs::path along_path(const std::string& name, const fs::path& folder) {
  const char* variable = std::getenv("PATH");
  std::string path = variable ? variable : "/usr/local/bin:/usr/bin:/bin";
  path += ':';
  for (std::size_t begin = 0, end; (end = path.find(':', begin)) != std::string::npos; begin = end + 1) {
    const fs::path found = folder / path.substr(begin, end - begin) / name;
    std::error_code none;
    if (fs::is_regular_file(found, none) && access(found.c_str(), X_OK) == 0) return found;
  }
  return {};
}

/// The last lines of what a process said, as one.
std::string lines_of(std::string said) {
  while (!said.empty() && (said.back() == '\n' || said.back() == '\r')) said.pop_back();
  std::string out;
  for (const char c : said) {
    if (c == '\r') continue;
    if (c != '\n') {
      out += c;
    } else if (!out.empty() && !out.ends_with(" | ")) {
      out += " | ";
    }
  }
  return one_line(out, kMostSaid);
}

}  // namespace

fs::path program_of(const Command& command) {
  const std::string& name = command.words.front();
  const fs::path folder = command.folder.empty() ? fs::path(".") : command.folder;
  if (name.find('/') == std::string::npos) return along_path(name, folder);
  const fs::path file = folder / name;
  std::error_code none;
  return fs::is_regular_file(file, none) && access(file.c_str(), X_OK) == 0 ? file : fs::path();
}

void Process::adopt(pid_t pid) {
  if (pid < 0) cannot("be started");
  pid_ = pid;
  setpgid(pid, pid);  // here too: whoever comes first
  for (const Descriptor* file : {&in_, &out_, &said_}) refuse_to_wait(file->number());
}

Process::Process(const Command& command, std::uint64_t memory) {
  const fs::path program = program_of(command);
  if (program.empty())
    throw Fault("there is no program '" + command.words.front() + "'" +
                (command.words.front().find('/') == std::string::npos
                     ? " along PATH"
                     : " that can be executed in " + (command.folder.empty() ? "." : command.folder.string())));
  const fs::path file = fs::absolute(program);
  std::vector<char*> words;
  for (const std::string& word : command.words) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  Pipes pipes;
  Pipe trouble;  // closed by a program that starts
  std::fflush(nullptr);
  const pid_t self = getpid(), pid = fork();
  if (pid == 0) {
    become_child(self, pipes);
    for (const char* variable : kThreads) setenv(variable, "1", /*overwrite=*/0);
    limit_memory(memory);
    close_range(STDERR_FILENO + 1, ~0u, CLOSE_RANGE_CLOEXEC);  // our locks and files are not its own
    if (command.folder.empty() || chdir(command.folder.c_str()) == 0) execv(file.c_str(), words.data());
    const int error = errno;
    write_all(trouble.in.number(), {reinterpret_cast<const char*>(&error), sizeof error});
    _exit(127);
  }
  in_ = std::move(pipes.in.in);
  out_ = std::move(pipes.out.out);
  said_ = std::move(pipes.said.out);
  adopt(pid);
  trouble.in.close();
  int error = 0;
  ssize_t got;
  while ((got = read(trouble.out.number(), &error, sizeof error)) < 0 && errno == EINTR) continue;
  if (got == sizeof error) {
    waitpid(pid_, nullptr, 0);
    throw Fault("'" + program.string() + "' cannot be started (" + std::strerror(error) + ")");
  }
}

Process::Process(const std::function<void(int in, int out)>& work, std::uint64_t memory) {
  Pipes pipes;
  std::fflush(nullptr);
  const pid_t self = getpid(), pid = fork();
  if (pid == 0) {
    become_child(self, pipes);
    constexpr int kIn = 3, kOut = 4;
    // Duplicates above both, as one of the two may have the other's number.
    const int in = fcntl(STDIN_FILENO, F_DUPFD, kOut + 1), out = fcntl(STDOUT_FILENO, F_DUPFD, kOut + 1);
    dup2(in, kIn);
    dup2(out, kOut);
    // The rest is the parent's, its lock on the result among it: it must be free as soon as the parent is dead.
    close_range(kOut + 1, ~0u, 0);
    const int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, STDIN_FILENO);
    close(nothing);
    dup2(STDERR_FILENO, STDOUT_FILENO);
    limit_memory(own_data() + memory);
    try {
      work(kIn, kOut);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
      std::fflush(nullptr);
      _exit(1);
    } catch (...) {
      std::fprintf(stderr, "it threw what is no std::exception\n");
      std::fflush(nullptr);
      _exit(1);
    }
    _exit(0);  // neither the parent's buffers nor its destructors are the child's
  }
  in_ = std::move(pipes.in.in);
  out_ = std::move(pipes.out.out);
  said_ = std::move(pipes.said.out);
  adopt(pid);
}

Process::~Process() {
  if (pid_ < 0) return;
  in_.close();
  const auto until = Clock::now() + kToEnd;
  bool ended = false;
  while (!(ended = waitpid(pid_, nullptr, WNOHANG) != 0) && Clock::now() < until && !stop_wanted)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  kill(-pid_, SIGKILL);  // what it started, too
  if (!ended) waitpid(pid_, nullptr, 0);
}

void Process::hear() {
  char block[1 << 12];
  for (ssize_t got; said_ && (got = read(said_.number(), block, sizeof block)) != 0;) {
    if (got < 0) {
      if (errno == EINTR) continue;
      if (errno != EAGAIN) said_.close();
      return;
    }
    words_.append(block, static_cast<std::size_t>(got));
    if (words_.size() > kMostSaid) words_.erase(0, words_.size() - kMostSaid);
    if (got < static_cast<ssize_t>(sizeof block)) return;
  }
  said_.close();
}

std::string Process::with_last_words(const std::string& why) {
  hear();
  const std::string said = lines_of(words_);
  return why + (said.empty() ? "" : "; it said: " + said);
}

void Process::fail(const std::string& why) {
  const std::string all = with_last_words(why);
  if (pid_ > 0) kill(-pid_, SIGKILL);
  throw Fault(all);
}

std::string Process::ending() {
  int status = 0;
  const auto until = Clock::now() + kToEnd;
  while (waitpid(pid_, &status, WNOHANG) == 0) {
    if (Clock::now() > until) return "it closed its stdout";
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  kill(-pid_, SIGKILL);
  pid_ = -1;
  return "it " + ended_text(status);
}

Process::Answer Process::ask(std::string_view kind, std::string_view content, Expected expected, double seconds) {
  expected.number = asked_++;
  const std::string frame_sent = frame(kind, expected.number, content);
  std::string_view question = frame_sent;  // what of it is still to be written
  const auto throw_fault = [&](const std::string& why) { fail(why); };
  bytes_.erase(0, used_);
  used_ = 0;
  // What comes unasked was sent before the question.
  char early = 0;
  if (bytes_.empty() && read(out_.number(), &early, 1) == 1) bytes_ += early;
  if (!bytes_.empty()) throw_fault("it sent more than it was asked for, beginning with '" + one_line(bytes_, 20) + "'");

  const NoPipeSignal none;
  double waited = 0;
  const Clock::time_point start = Clock::now();
  Clock::time_point before = start;
  bool deaf = false;
  for (;;) {
    if (!question.empty() && !deaf) {
      const ssize_t put = write(in_.number(), question.data(), question.size());
      if (put > 0) question.remove_prefix(static_cast<std::size_t>(put));
      if (put < 0 && errno != EAGAIN && errno != EINTR) deaf = true;  // what it said last comes before its end
    }
    pollfd files[] = {{out_.number(), POLLIN, 0},
                      {said_ ? said_.number() : -1, POLLIN, 0},
                      {question.empty() || deaf ? -1 : in_.number(), POLLOUT, 0}};
    poll(files, 3, std::clamp(int((seconds - waited) * 1000) + 1, 1, kRound_ms));
    const Clock::time_point now = Clock::now();
    const double round = std::chrono::duration<double>(now - before).count();
    before = now;
    waited += std::min(kMostRound, round);
    stop_if_wanted();
    if (files[1].revents) hear();
    if (files[0].revents) {
      const std::size_t size = bytes_.size();
      bytes_.resize(size + kBlock);
      const ssize_t got = read(out_.number(), bytes_.data() + size, kBlock);
      const int error = errno;
      bytes_.resize(size + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
      if (got == 0) {
        const std::string half = bytes_.empty() ? "" : " after " + std::to_string(bytes_.size()) + " bytes of a frame";
        throw_fault(ending() + half);
      }
      if (got < 0 && error != EAGAIN && error != EINTR) throw_fault("its stdout cannot be read");
      if (got > 0) {
        std::optional<Frame> answer;
        try {
          answer = first_frame(bytes_, expected);
        } catch (const Fault& fault) {
          throw_fault(fault.what());
        }
        if (answer) {
          waited_ += waited;
          used_ = kFrameHead + answer->content.size();
          if (answer->kind == "FAIL") throw_fault("it gives up: " + lines_of(std::string(answer->content)));
          if (!question.empty()) throw_fault("it answers before it has read the question");
          return {answer->content, std::chrono::nanoseconds(Clock::now() - start).count()};
        }
      }
    }
    if (waited > seconds) {
      const std::string half = bytes_.empty() ? "" : ", only " + std::to_string(bytes_.size()) + " bytes of one";
      waited_ += waited;
      const std::string why = with_last_words("no answer within " + real_text(seconds) + " s" + half);
      kill(-pid_, SIGKILL);
      throw TooLate(why);
    }
  }
}

}  // namespace pipeline
