#include "importers/in_order.hpp"

#include <algorithm>
#include <deque>
#include <optional>
#include <thread>

#include "threads/guarded.hpp"
#include "threads/monitor.hpp"

namespace scancast {

namespace {

constexpr std::size_t mostThreads = 16;

/// A job that has been handed out.
struct Running {
    std::size_t job = 0;
    std::deque<Piece> pieces;
    bool ended = false;
    std::optional<Error> failure;
};

class InOrder {
  public:
    InOrder(std::size_t first, std::size_t end, InOrderLimits limits)
        : limits_(limits), next_(first), end_(end) {}

    void work(const std::function<JobWorker()>& makeWorker) {
        const auto worked = guarded("decoding it", [&]() -> Expected<void> {
            const JobWorker worker = makeWorker();
            while (const auto running = nextJob()) runJob(*running, worker);
            return {};
        });
        if (worked) return;
        // No worker, and perhaps no memory for one.
        const Monitor::Lock lock(monitor_);
        failure_ = worked.error();
    }

    Expected<void> takeAll(const TakePiece& take) {
        for (;;) {
            auto piece = nextPiece();
            if (!piece) return passOn(piece);
            if (!*piece) return {};
            const auto wantsMore = take((*piece)->job, std::move((*piece)->piece));
            if (!wantsMore) return passOn(wantsMore);
            if (!*wantsMore) return {};
        }
    }

    /// Nobody takes any more.
    void stop() {
        const Monitor::Lock lock(monitor_);
        stopped_ = true;
    }

  private:
    struct Taken {
        std::size_t job;
        Piece piece;
    };

    void runJob(Running& running, const JobWorker& worker) {
        const auto done = guarded("decoding it", [&] {
            return worker(running.job, [&](Piece piece) { return give(running, std::move(piece)); });
        });
        const Monitor::Lock lock(monitor_);
        if (!done) running.failure = done.error();
        running.ended = true;
    }

    /// Waits while those who are ahead are far enough.
    std::shared_ptr<Running> nextJob() {
        Monitor::Lock lock(monitor_);
        monitor_.wait(lock,
                      [this] { return stopped_ || next_ == end_ || running_.size() < 2 * limits_.threads; });
        if (stopped_ || next_ == end_) return nullptr;
        auto running = std::make_shared<Running>();
        running->job = next_;
        running_.push_back(running);
        ++next_;
        return running;
    }

    bool give(Running& running, Piece piece) {
        Monitor::Lock lock(monitor_);
        monitor_.wait(lock, [&] { return stopped_ || running.pieces.size() < limits_.waiting; });
        if (stopped_) return false;
        running.pieces.push_back(std::move(piece));
        return true;
    }

    /// Nothing: all jobs have ended.
    Expected<std::optional<Taken>> nextPiece() {
        Monitor::Lock lock(monitor_);
        for (;;) {
            monitor_.wait(lock, [this] {
                if (failure_ || (running_.empty() && next_ == end_)) return true;
                return !running_.empty() && (!running_.front()->pieces.empty() || running_.front()->ended);
            });
            if (failure_) return tl::unexpected<Error>(*failure_);
            if (running_.empty()) return std::optional<Taken>{};
            Running& due = *running_.front();
            if (!due.pieces.empty()) {
                Taken taken{due.job, std::move(due.pieces.front())};
                due.pieces.pop_front();
                return std::optional(std::move(taken));
            }
            if (due.failure) return tl::unexpected<Error>(*due.failure);
            running_.pop_front();
        }
    }

    const InOrderLimits limits_;
    Monitor monitor_;  // guards all below, and what is running
    std::deque<std::shared_ptr<Running>> running_;
    std::size_t next_;
    const std::size_t end_;
    bool stopped_ = false;
    std::optional<Error> failure_;
};

}  // namespace

Expected<void> runInOrder(std::size_t first, std::size_t end, InOrderLimits limits,
                          const std::function<JobWorker()>& makeWorker, const TakePiece& take) {
    InOrder order(first, end, limits);
    // Its end stops the workers, whatever ends it, before the threads are joined.
    struct Workers {
        InOrder& order;
        std::vector<std::jthread> threads;
        ~Workers() { order.stop(); }
    } workers{order, {}};
    return guarded("decoding it", [&]() -> Expected<void> {
        for (std::size_t i = 0; i < limits.threads; ++i)
            workers.threads.emplace_back([&] { order.work(makeWorker); });
        return order.takeAll(take);
    });
}

std::size_t importerThreads(std::size_t jobs, std::size_t cores) {
    return std::clamp<std::size_t>(std::min(jobs, cores), 1, mostThreads);
}

}  // namespace scancast
