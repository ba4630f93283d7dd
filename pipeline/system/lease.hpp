// A name in a folder that one process at a time holds, while it lives: also on NFS, and by processes of several hosts.
//
// Which lock, and why: a small file NAME that says who holds it (host, its boot, process, when that started), made
// beside under a name of its own and brought to its place by link(2), which fails where NAME stands. Every version of
// NFS does that in one step at the server; flock(2) is emulated there, is none on some mounts, and a host that is gone
// or a process that is stopped keeps it. So a holder renews its lease: it touches the file. Another may take NAME over
// when the holder is known dead (the same boot of the same host: by process and start time) or has not touched it for
// its lease. Both times are the file server's, of this file and of one made just now: clocks of hosts need not agree.
//
// A stopped holder goes on when its lease is long over, so two may think that they hold NAME: what is done under a
// lease must do no harm when it is done twice.
#pragma once
#include <chrono>
#include <memory>
#include <string>

namespace pipeline {

class Lease {
 public:
  using Seconds = std::chrono::duration<double>;

  ~Lease();  // gives the name back, unless another has taken it over
  Lease(const Lease&) = delete;
  Lease& operator=(const Lease&) = delete;

 private:
  friend std::unique_ptr<Lease> take_lease(int folder, const std::string& name, Seconds length);
  struct Held;
  explicit Lease(std::unique_ptr<Held> held);
  std::unique_ptr<Held> held_;
};

/// Takes `name` in an open folder, which must stay open, and renews it in a thread of its own; null when a live one has
/// it. Throws FileFailure when it cannot be written, or is no regular file.
std::unique_ptr<Lease> take_lease(int folder, const std::string& name, Lease::Seconds length);

/// Whether somebody who may be alive holds it, by now.
bool is_leased(int folder, const std::string& name, Lease::Seconds length);

/// "process 4711 on n2"; empty where nobody holds it, or one who is known dead. Writes nothing.
std::string holder_text(int folder, const std::string& name);

}  // namespace pipeline
