// The job behind a front: the program that starts ranks, usually mpirun, as a child process. Owned by the front's keeper, on its
// thread. Place: keeper → **process** → mpirun → ranks.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

/// Words as a shell would make them of a line, with '…' and "…" around what has spaces; nothing else means anything.
/// InvalidArgument: no word, or a quotation that does not end.
Expected<std::vector<std::string>> wordsOfLine(const std::string& line);

class JobProcess {
  public:
    /// In a process group of its own, so that Ctrl-C at a terminal is for the front alone; with nothing to read, and what it
    /// prints among the front's errors. Io: it cannot be started.
    static Expected<JobProcess> start(std::vector<std::string> words);
    JobProcess(JobProcess&& other) noexcept;
    JobProcess& operator=(JobProcess&&) = delete;
    /// end()
    ~JobProcess();

    /// Never waits.
    bool hasEnded();
    /// Asks it to end (SIGTERM), which mpirun passes on. Any thread, while this is alive.
    void ask() const;
    /// Waits so long for it to end by itself: an mpirun that is ending already does not bear to be asked. Then asks, and after a
    /// while ends it.
    void end(std::chrono::milliseconds byItself = {});
    /// "it ended with exit code 1"; of one that has ended.
    std::string howItEnded() const;

  private:
    explicit JobProcess(pid_t pid) : pid_(pid) {}

    pid_t pid_;
    std::optional<int> status_;
};

}  // namespace scancast
