// Runs a small program of a few threads in every order in which their critical sections can follow each
// other, and tells when in one of them everybody waits for ever. The threads are real, but only one runs at a
// time: whoever locks a SteppedMutex hands over to the explorer, which chooses who goes on. Time is virtual:
// it passes only when nobody can do anything else, and then the first deadline comes.
//
// *Thread safety*: none; one exploration at a time, from one thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <semaphore>
#include <string>
#include <thread>
#include <vector>

namespace scancast::test {

class SteppedMutex;
class SteppedCondition;

class Interleavings {
  public:
    using Program = std::vector<std::function<void()>>;  ///< a function for each thread

    struct Found {
        std::size_t orders = 0;  ///< that were run
        std::string
            stuck{};  ///< the first in which everybody waited: who went on, step by step; empty = none
    };

    /// Runs make()'s program, anew and with its own state, in every order, but stops at the first that gets
    /// stuck.
    static Found explore(const std::function<Program()>& make, std::size_t mostOrders = 200'000) {
        Interleavings all(make().size());
        Found found;
        do {
            ++found.orders;
            if (!all.runOnce(make())) found.stuck = all.told_.empty() ? "at the start" : all.told_;
        } while (found.stuck.empty() && found.orders < mostOrders && all.nextOrder());
        return found;
    }

  private:
    friend class SteppedMutex;
    friend class SteppedCondition;
    using Time = std::chrono::steady_clock::time_point;
    struct Abandoned {};  // thrown in the threads of a program that is stuck

    struct Thread {
        enum class State { Begins, WantsLock, Waits, Done };
        State state = State::Begins;
        SteppedMutex* mutex = nullptr;  // that it wants, now or after its wait
        const SteppedCondition* condition = nullptr;
        Time deadline = Time::max();
        bool timedOut = false;
        std::function<void()> work;
        std::binary_semaphore go{0};
        std::thread thread;
    };
    struct Choice {
        std::size_t taken, of;
    };

    explicit Interleavings(std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) threads_.push_back(std::make_unique<Thread>());
        for (auto& one : threads_) one->thread = std::thread([this, &one = *one] { live(one); });
    }
    ~Interleavings() {
        ending_ = true;
        for (auto& one : threads_) one->go.release();
        for (auto& one : threads_) one->thread.join();
    }

    void live(Thread& self) {
        here() = {this, &self};
        while (true) {
            self.go.acquire();
            if (ending_) return;
            try {
                self.work();
            } catch (const Abandoned&) {
            }
            self.state = Thread::State::Done;
            back_.release();
        }
    }

    bool runOnce(Program program) {
        told_.clear();
        depth_ = 0;
        abandoned_ = false;
        for (std::size_t i = 0; i < threads_.size(); ++i) {
            threads_[i]->state = Thread::State::Begins;
            threads_[i]->work = program[i];
        }
        while (true) {
            const auto able = canGoOn();
            if (!able.empty()) {
                step(able[choose(able.size())]);
            } else if (allDone()) {
                return true;
            } else if (!letTimePass()) {
                abandonAll();
                return false;
            }
        }
    }

    std::vector<std::size_t> canGoOn() const;
    bool allDone() const {
        for (const auto& one : threads_)
            if (one->state != Thread::State::Done) return false;
        return true;
    }
    bool letTimePass() {
        Thread* first = nullptr;
        for (const auto& one : threads_) {
            const bool timed = one->state == Thread::State::Waits && one->deadline != Time::max();
            if (timed && (first == nullptr || one->deadline < first->deadline)) first = one.get();
        }
        if (first == nullptr) return false;
        first->timedOut = true;
        first->state = Thread::State::WantsLock;
        return true;
    }
    void step(std::size_t which);
    void abandonAll() {
        abandoned_ = true;
        for (const auto& one : threads_) {
            if (one->state == Thread::State::Done) continue;
            one->go.release();
            back_.acquire();
        }
    }

    std::size_t choose(std::size_t of) {
        if (of == 1) return 0;
        if (depth_ == choices_.size()) choices_.push_back({0, of});
        return choices_[depth_++].taken;
    }
    bool nextOrder() {
        while (!choices_.empty() && choices_.back().taken + 1 == choices_.back().of) choices_.pop_back();
        if (choices_.empty()) return false;
        ++choices_.back().taken;
        return true;
    }

    // Of a thread of the program: lets the explorer choose, and returns when it is its turn.
    void yield(Thread& self) {
        back_.release();
        self.go.acquire();
        if (abandoned_) throw Abandoned();
    }

    struct Here {
        Interleavings* all = nullptr;
        Thread* self = nullptr;
    };
    static Here& here() {
        thread_local Here here;
        return here;
    }

    std::vector<std::unique_ptr<Thread>> threads_;
    std::binary_semaphore back_{0};
    std::vector<Choice> choices_;
    std::size_t depth_ = 0;
    std::string told_;
    bool abandoned_ = false, ending_ = false;
};

class SteppedMutex {
  public:
    void lock() {
        const auto [all, self] = Interleavings::here();
        self->state = Interleavings::Thread::State::WantsLock;
        self->mutex = this;
        all->yield(*self);
    }
    void unlock() { taken_ = false; }

  private:
    friend class Interleavings;
    friend class SteppedCondition;
    bool taken_ = false;
};

class SteppedCondition {
  public:
    void wait(std::unique_lock<SteppedMutex>& lock) { wait_until(lock, Interleavings::Time::max()); }
    std::cv_status wait_until(std::unique_lock<SteppedMutex>& lock, Interleavings::Time deadline) {
        const auto [all, self] = Interleavings::here();
        self->state = Interleavings::Thread::State::Waits;
        self->mutex = lock.mutex();
        self->condition = this;
        self->deadline = deadline;
        self->timedOut = false;
        lock.mutex()->taken_ = false;
        all->yield(*self);
        return self->timedOut ? std::cv_status::timeout : std::cv_status::no_timeout;
    }
    void notify_one() const {
        for (const auto& one : Interleavings::here().all->threads_) {
            if (one->state != Interleavings::Thread::State::Waits || one->condition != this) continue;
            one->state = Interleavings::Thread::State::WantsLock;
            return;
        }
    }
};

inline std::vector<std::size_t> Interleavings::canGoOn() const {
    std::vector<std::size_t> able;
    for (std::size_t i = 0; i < threads_.size(); ++i) {
        const Thread& one = *threads_[i];
        const bool begins = one.state == Thread::State::Begins;
        if (begins || (one.state == Thread::State::WantsLock && !one.mutex->taken_)) able.push_back(i);
    }
    return able;
}

inline void Interleavings::step(std::size_t which) {
    Thread& one = *threads_[which];
    told_ += std::to_string(which) + " ";
    if (one.state == Thread::State::WantsLock) one.mutex->taken_ = true;
    one.go.release();
    back_.acquire();
}

}  // namespace scancast::test
