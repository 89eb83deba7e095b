// One thread for work that may wait for a disk, so that neither network nor render threads do.
//
// Owned by the API. *Thread safety*: any thread, except destruction.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

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
    void run(const std::stop_token& token);

    const std::size_t room_;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::deque<Task> tasks_;
    std::jthread thread_;
};

}  // namespace scancast
