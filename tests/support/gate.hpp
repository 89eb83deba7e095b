// Where a test stops somebody else's thread, and lets it go on. *Thread safety*: any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace scancast::test {

class Gate {
  public:
    void close() { set(false); }
    void open() { set(true); }
    /// Waits while it is closed; not for ever, so that a test that fails ends.
    void pass() {
        std::unique_lock lock(mutex_);
        ++waiting_;
        changed_.notify_all();
        changed_.wait_for(lock, patience, [this] { return open_; });
        --waiting_;
    }
    /// Waits until somebody stands before it; false = it took too long.
    bool waitForSomebody() {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, patience, [this] { return waiting_ > 0 && !open_; });
    }

  private:
    static constexpr std::chrono::seconds patience{20};

    void set(bool open) {
        const std::lock_guard lock(mutex_);
        open_ = open;
        changed_.notify_all();
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    bool open_ = true;
    int waiting_ = 0;
};

}  // namespace scancast::test
