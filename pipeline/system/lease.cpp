#include "pipeline/system/lease.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <stop_token>
#include <system_error>
#include <thread>
#include <utility>

#include "pipeline/system/file_bytes.hpp"
#include "pipeline/terminal/words.hpp"

namespace pipeline {
namespace {

using Seconds = Lease::Seconds;

constexpr std::uint64_t kMostBytes = 4096;  // ours have less than 400
constexpr int kRenewals = 4;                // in the time of a lease
constexpr double kLongest = 1e6;            // s; a longer lease is nonsense that somebody wrote

/// Who holds a lease. A process is told by its number only within one boot of one host and one space of numbers
/// (containers have their own), and only with the time at which it started: numbers are given again.
struct Holder {
  std::string host, boot, numbers, started;
  std::int64_t process = 0;
  double lease = 0;  // s
};

std::string text_of_file(const char* path) {
  try {
    return read_regular(AT_FDCWD, path, true, kMostBytes);
  } catch (const FileFailure&) {
    return "";
  }
}

/// State and start (in ticks since the boot) of a process; nothing where that cannot be known.
std::optional<std::pair<char, std::string>> process_of(std::int64_t number) {
  const std::string stat = text_of_file(("/proc/" + std::to_string(number) + "/stat").c_str());
  std::size_t at = stat.rfind(") ");  // the name before it may hold anything
  if (at == std::string::npos) return std::nullopt;
  at += 2;
  const char state = at < stat.size() ? stat[at] : '?';
  constexpr int kFieldsToStart = 19;
  for (int field = 0; field < kFieldsToStart && at != std::string::npos; ++field) {
    at = stat.find(' ', at);
    if (at != std::string::npos) ++at;
  }
  if (at == std::string::npos) return std::nullopt;
  return std::pair(state, stat.substr(at, stat.find(' ', at) - at));
}

Holder myself(Seconds length) {
  char name[256] = {}, numbers[64] = {};
  Holder me;
  if (gethostname(name, sizeof name - 1) == 0) me.host = name;
  me.boot = text_of_file("/proc/sys/kernel/random/boot_id");
  me.boot.erase(std::min(me.boot.find('\n'), me.boot.size()));
  if (readlink("/proc/self/ns/pid", numbers, sizeof numbers - 1) > 0) me.numbers = numbers;
  me.process = getpid();
  if (const auto found = process_of(me.process)) me.started = found->second;
  me.lease = length.count();
  return me;
}

std::string text_of(const Holder& holder) {
  return nlohmann::json{{"host", holder.host},       {"boot", holder.boot},       {"numbers", holder.numbers},
                        {"process", holder.process}, {"started", holder.started}, {"lease_s", holder.lease}}
             .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) +
         "\n";
}

Holder holder_of(const std::string& text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  Holder out;
  if (!json.is_object()) return out;
  const auto word = [&](const char* key) {
    return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
  };
  out.host = word("host");
  out.boot = word("boot");
  out.numbers = word("numbers");
  out.started = word("started");
  if (json.contains("process") && json["process"].is_number_integer()) out.process = json["process"];
  if (json.contains("lease_s") && json["lease_s"].is_number()) out.lease = json["lease_s"];
  return out;
}

bool known_dead(const Holder& holder) {
  const Holder me = myself(Seconds(0));
  const bool here = holder.host == me.host && holder.boot == me.boot && holder.numbers == me.numbers;
  if (!here || me.boot.empty() || holder.process <= 0) return false;
  if (kill(pid_t(holder.process), 0) != 0 && errno == ESRCH) return true;
  const auto found = process_of(holder.process);
  return found && (found->second != holder.started || found->first == 'Z' || found->first == 'X');
}

bool same_file(const struct stat& a, const struct stat& b) { return a.st_dev == b.st_dev && a.st_ino == b.st_ino; }

double seconds(const timespec& time) { return double(time.tv_sec) + 1e-9 * double(time.tv_nsec); }

/// What stands at a name. It is opened, for then NFS asks its server instead of remembering.
struct Seen {
  struct stat status;
  Holder holder;
};
std::optional<Seen> look(int folder, const std::string& name) {
  try {
    Seen seen;
    seen.holder = holder_of(read_regular(folder, name, /*follow_links=*/false, kMostBytes));
    open_regular(folder, name, /*follow_links=*/false, seen.status);
    return seen;
  } catch (const FileFailure& failure) {
    if (failure.error() == ENOENT || failure.error() == ESTALE) return std::nullopt;
    throw;
  }
}

/// A file of one's own beside the name, that says who made it and, by its time, when. It is kept open: while it is, no
/// other file gets its number.
class Own {
 public:
  Own(int folder, const std::string& name, Seconds length) : folder_(folder) {
    Descriptor made;
    do {
      path_ = new_file_name(name);
      made = Descriptor(openat(folder, path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
    } while (!made && errno == EEXIST);
    if (!made) throw FileFailure("cannot be written", errno);
    const bool written = write_all(made.number(), text_of(myself(length)));
    const int error = errno;
    made.close();  // NFS shows others what was closed
    file_ = Descriptor(openat(folder, path_.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC));
    if (written && file_ && futimens(file_.number(), nullptr) == 0 && fstat(file_.number(), &status_) == 0) return;
    const FileFailure failure("cannot be written", written ? errno : error);
    unlinkat(folder, path_.c_str(), 0);
    throw failure;
  }
  ~Own() { unlinkat(folder_, path_.c_str(), 0); }
  Own(const Own&) = delete;
  Own& operator=(const Own&) = delete;

  Descriptor file() { return std::move(file_); }
  const struct stat& status() const { return status_; }

  /// Links it to the name; false where another stands.
  bool link_to(const std::string& name) const {
    if (linkat(folder_, path_.c_str(), folder_, name.c_str(), 0) == 0) return true;
    const int error = errno;
    struct stat there;  // an answer of NFS that was lost is asked for again, and the link is in its own way then
    if (fstatat(folder_, name.c_str(), &there, AT_SYMLINK_NOFOLLOW) == 0 && same_file(there, status_)) return true;
    if (error == EEXIST) return false;
    throw FileFailure("cannot be linked", error);
  }

 private:
  int folder_;
  std::string path_;
  Descriptor file_;
  struct stat status_;
};

bool is_stale(const Seen& seen, const Own& own, Seconds length) {
  if (known_dead(seen.holder)) return true;
  const bool said = seen.holder.lease > 0 && seen.holder.lease < kLongest;
  const double lease = said ? seen.holder.lease : length.count();
  return seconds(own.status().st_mtim) - seconds(seen.status.st_mtim) > lease;
}

/// Removes what was seen, but nothing that came in its place meanwhile, nor what was renewed.
bool remove_seen(int folder, const std::string& name, const Seen& seen) {
  const std::string aside = new_file_name(name);
  if (renameat(folder, name.c_str(), folder, aside.c_str()) != 0) return errno == ENOENT;
  const auto moved = look(folder, aside);
  const bool same =
      moved && same_file(moved->status, seen.status) && seconds(moved->status.st_mtim) == seconds(seen.status.st_mtim);
  if (!same) linkat(folder, aside.c_str(), folder, name.c_str(), 0);
  unlinkat(folder, aside.c_str(), 0);
  return same;
}

/// Touches the name while it is that file; false when it is another's.
bool renew(int folder, const std::string& name, const struct stat& mine) {
  const Descriptor file(openat(folder, name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat there;
  if (!file) return errno != ENOENT && errno != ESTALE;  // what cannot be reached now may be later
  if (fstat(file.number(), &there) != 0) return true;
  return same_file(there, mine) && (futimens(file.number(), nullptr) == 0 || errno != ESTALE);
}

}  // namespace

struct Lease::Held {
  int folder;
  std::string name;
  struct stat mine;
  Descriptor file;
  std::mutex mutex = {};
  std::condition_variable_any ended = {};
  std::jthread renewing = {};  // last: ends first

  void keep(const std::stop_token& stop, Seconds length) {
    std::unique_lock lock(mutex);
    while (!ended.wait_for(lock, stop, length / kRenewals, [] { return false; }) && !stop.stop_requested())
      if (!renew(folder, name, mine)) return;
  }
};

Lease::Lease(std::unique_ptr<Held> held) : held_(std::move(held)) {}

Lease::~Lease() {
  held_->renewing = {};  // stops and joins
  struct stat there;
  if (fstatat(held_->folder, held_->name.c_str(), &there, AT_SYMLINK_NOFOLLOW) == 0 && same_file(there, held_->mine))
    unlinkat(held_->folder, held_->name.c_str(), 0);
}

std::unique_ptr<Lease> take_lease(int folder, const std::string& name, Seconds length) {
  Own own(folder, name, length);
  if (!own.link_to(name)) {
    const auto seen = look(folder, name);
    if (seen && (!is_stale(*seen, own, length) || !remove_seen(folder, name, *seen))) return nullptr;
    if (!own.link_to(name)) return nullptr;
  }
  std::unique_ptr<Lease::Held> held(new Lease::Held{folder, name, own.status(), own.file()});
  try {
    held->renewing = std::jthread([&held = *held, length](const std::stop_token& stop) { held.keep(stop, length); });
  } catch (const std::system_error&) {  // no thread to be had: the lease is as long as it is
  }
  return std::unique_ptr<Lease>(new Lease(std::move(held)));
}

bool is_leased(int folder, const std::string& name, Seconds length) {
  const auto seen = look(folder, name);
  return seen && !is_stale(*seen, Own(folder, name, length), length);
}

std::string holder_text(int folder, const std::string& name) {
  try {
    const auto seen = look(folder, name);
    if (!seen || known_dead(seen->holder)) return "";
    if (seen->holder.host.empty()) return "somebody";
    return "process " + std::to_string(seen->holder.process) + " on " + one_line(seen->holder.host, 256);
  } catch (const FileFailure&) {
    return "somebody";
  }
}

}  // namespace pipeline
