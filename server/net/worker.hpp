// One thread for work that may wait for a disk, so that neither network nor render threads do. A task that
// throws ends there, and the log says so; the thread goes on.
//
// Owned by the API. *Thread safety*: any thread, except destruction.
#pragma once

#include <deque>
#include <functional>
#include <stop_token>
#include <thread>

#include "threads/monitor.hpp"

namespace scancast {

class Worker {
  public:
    using Task = std::function<void(std::stop_token)>;

    /// Keeps at most `room` tasks waiting.
    explicit Worker(std::size_t room);
    /// stop().
    ~Worker();
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    /// First come, first served. False when there is no room, or after stop(): then the task is never run.
    bool post(Task task);
    /// Stops the running task, forgets those that wait, and ends the thread. Not from two threads at once.
    void stop();

  private:
    bool isDue() const { return stop_.stop_requested() || !tasks_.empty(); }
    void run();
    bool step();

    const std::size_t room_;
    Monitor monitor_;  // guards tasks_, and requests of a stop
    std::stop_source stop_;
    std::deque<Task> tasks_;
    std::thread thread_;
};

}  // namespace scancast
