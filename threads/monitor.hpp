// A lock whose waiting threads cannot be forgotten. Who waits names a condition of the guarded state; whoever
// lets go of the lock wakes every thread whose condition has come true. No change of state has to know who
// may be waiting for it, so none can miss a wake-up.
//
//     Monitor monitor_;                       // guards tasks_, stopping_
//     bool isDue() const { return stopping_ || !tasks_.empty(); }
//     ...
//     Monitor::Lock lock(monitor_);           // a producer: changes the state, and that is all
//     tasks_.push_back(task);
//     ...
//     Monitor::Lock lock(monitor_);           // a consumer
//     monitor_.wait(lock, [this] { return isDue(); });
//
// Conditions are functions of what the monitor guards (and of what never changes), cheap, and throw nothing:
// each is looked at whenever a lock is let go. That suits a handful of waiting threads; waiting allocates
// nothing.
//
// Owned by the object whose state it guards, which no thread may still wait in when it ends. *Thread safety*:
// any thread. Any room's queues stand on it: scheduler, loader, block cache, worker.
#pragma once

#include <cassert>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>

namespace scancast {

/// `Monitor` below is what programs use; tests put in a mutex and a condition variable that they can step
/// through.
template <class Mutex, class Condition>
class BasicMonitor {
  public:
    using Clock = std::chrono::steady_clock;

    /// For whoever changes the state: holds the monitor, and wakes who can go on when it lets go.
    class Lock {
      public:
        explicit Lock(BasicMonitor& monitor) : monitor_(monitor), held_(monitor.mutex_) {}
        ~Lock() {
            if (held_.owns_lock()) unlock();
        }
        Lock(const Lock&) = delete;
        Lock& operator=(const Lock&) = delete;
        void lock() { held_.lock(); }
        void unlock() {
            monitor_.wakeReady();
            held_.unlock();
        }

      private:
        friend class BasicMonitor;
        BasicMonitor& monitor_;
        std::unique_lock<Mutex> held_;
    };

    /// For whoever only looks at it: wakes nobody.
    class Look {
      public:
        explicit Look(const BasicMonitor& monitor) : held_(monitor.mutex_) {}
        Look(const Look&) = delete;
        Look& operator=(const Look&) = delete;

      private:
        std::unique_lock<Mutex> held_;
    };

    BasicMonitor() = default;
    ~BasicMonitor() { assert(first_ == nullptr && "a thread waits in a monitor that ends"); }
    BasicMonitor(const BasicMonitor&) = delete;
    BasicMonitor& operator=(const BasicMonitor&) = delete;

    /// Lets go of the lock until ready() holds, and returns with the lock.
    template <class Ready>
    void wait(Lock& lock, const Ready& ready) {
        waitUntil(lock, Clock::time_point::max(), ready);
    }

    /// The same until `deadline` (max() = for ever); returns whether ready() holds.
    template <class Ready>
    bool waitUntil(Lock& lock, Clock::time_point deadline, const Ready& ready) {
        assert(&lock.monitor_ == this && lock.held_.owns_lock());
        if (ready()) return true;
        wakeReady();  // waiting lets go of the lock
        Waiter self(*this, &ready,
                    [](const void* condition) { return (*static_cast<const Ready*>(condition))(); });
        while (!ready()) {
            self.woken = false;
            if (deadline == Clock::time_point::max())
                self.wakeUp.wait(lock.held_);
            else if (self.wakeUp.wait_until(lock.held_, deadline) == std::cv_status::timeout)
                return ready();
        }
        return true;
    }

    /// The same until a stop is requested; whoever requests it must not hold this monitor.
    template <class Ready>
    bool wait(Lock& lock, const std::stop_token& stop, const Ready& ready) {
        const auto over = [&] { return ready() || stop.stop_requested(); };
        while (!over()) {
            lock.unlock();  // the request takes it, and the end of its callback waits for a request under way
            {
                const std::stop_callback request(stop, [this] { const Lock letGoAtOnce(*this); });
                lock.lock();
                wait(lock, over);
                lock.unlock();
            }
            lock.lock();
        }
        return ready();
    }

  private:
    /// A thread that waits, in the list of those that do; lives on its stack.
    struct Waiter {
        Waiter(BasicMonitor& in, const void* ready, bool (*holds)(const void*))
            : monitor(in), condition(ready), isReady(holds), next(in.first_) {
            if (next != nullptr) next->previous = this;
            monitor.first_ = this;
        }
        ~Waiter() {
            (previous != nullptr ? previous->next : monitor.first_) = next;
            if (next != nullptr) next->previous = previous;
        }
        Waiter(const Waiter&) = delete;
        Waiter& operator=(const Waiter&) = delete;

        BasicMonitor& monitor;
        const void* condition;
        bool (*isReady)(const void*);
        Waiter* previous = nullptr;
        Waiter* next;
        Condition wakeUp;
        bool woken = false;  ///< and will look for itself
    };

    // Under the lock, because a waiter that goes on takes what it waited with from its stack.
    void wakeReady() {
        for (Waiter* waiter = first_; waiter != nullptr; waiter = waiter->next) {
            if (waiter->woken || !waiter->isReady(waiter->condition)) continue;
            waiter->woken = true;
            waiter->wakeUp.notify_one();
        }
    }

    mutable Mutex mutex_;
    Waiter* first_ = nullptr;
};

extern template class BasicMonitor<std::mutex, std::condition_variable>;
using Monitor = BasicMonitor<std::mutex, std::condition_variable>;

}  // namespace scancast
