#include "remote/transfers.hpp"

#include <algorithm>
#include <list>
#include <mutex>
#include <random>
#include <system_error>
#include <thread>

#include "threads/guarded.hpp"

namespace scancast {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
constexpr milliseconds longestNap{1000};
constexpr std::size_t mostSpareHandles = 32;

RequestFault stopped() {
    return {RequestFault::Kind::Stopped, "this program is ending"};
}

/// What the thread and its owner have together: the thread may be the last to let go.
class CurlTransfers {
  public:
    explicit CurlTransfers(const TransfersOptions& options)
        : options_(options),
          multi_(curl_multi_init(), &curl_multi_cleanup),
          random_(options.seed != 0 ? options.seed : std::random_device()()) {
        if (!multi_) throw std::bad_alloc();
        curl_multi_setopt(multi_.get(), CURLMOPT_MAX_HOST_CONNECTIONS, options.connectionsToHost);
        curl_multi_setopt(multi_.get(), CURLMOPT_PIPELINING, long(CURLPIPE_MULTIPLEX));
    }

    void start(PartAsk ask, PartDone done) {
        auto one = std::make_unique<Waiting>();
        one->due = Clock::now() + ask.delay;
        one->transfer = std::make_unique<Transfer>(std::move(ask), std::move(done));
        {
            const std::lock_guard lock(mutex_);
            if (!stopping_) new_.push_back(std::move(one));
        }
        if (one) return one->transfer->finish(tl::unexpected(stopped()));
        curl_multi_wakeup(multi_.get());
    }

    void stop() {
        {
            const std::lock_guard lock(mutex_);
            stopping_ = true;
        }
        curl_multi_wakeup(multi_.get());
    }

    TransfersStats stats() const { return {requests_, retries_, bytes_}; }

    void run() {
        while (takeNew()) {
            (void)guarded("Fetching", [&] { step(); });
        }
        end();
    }

  private:
    struct Waiting {
        std::unique_ptr<Transfer> transfer;
        Clock::time_point due, begun{};
        int tried = 0;
    };
    using One = std::unique_ptr<Waiting>;

    bool takeNew() {
        const std::lock_guard lock(mutex_);
        waiting_.splice(waiting_.end(), new_);
        return !stopping_;
    }

    void step() {
        const auto now = Clock::now();
        for (auto at = waiting_.begin(); at != waiting_.end();) {
            const auto one = at++;
            if ((*one)->due <= now) begin(one);
        }
        int running = 0;
        curl_multi_perform(multi_.get(), &running);
        takeEnded();
        auto next = Clock::now() + longestNap;
        for (const One& one : waiting_) next = std::min(next, one->due);
        const auto nap = std::chrono::ceil<milliseconds>(next - Clock::now());
        curl_multi_poll(multi_.get(), nullptr, 0, int(std::clamp(nap, milliseconds(0), longestNap).count()),
                        nullptr);
    }

    Transfer::Handle handle() {
        if (spare_.empty()) return {curl_easy_init(), &curl_easy_cleanup};
        Transfer::Handle one = std::move(spare_.back());
        spare_.pop_back();
        return one;
    }

    void begin(std::list<One>::iterator at) {
        underWay_.splice(underWay_.end(), waiting_, at);
        Waiting& one = **at;
        auto ready = handle();
        ++requests_;
        retries_ += one.tried > 0 ? 1 : 0;
        ++one.tried;
        one.begun = Clock::now();
        if (!ready || !one.transfer->begin(std::move(ready), options_.limits) ||
            curl_multi_add_handle(multi_.get(), one.transfer->handle()) != CURLM_OK)
            settle(at, tl::unexpected(RequestFault{RequestFault::Kind::Unreachable,
                                                   "there is not enough memory for a request"}));
    }

    void takeEnded() {
        int left = 0;
        while (const CURLMsg* message = curl_multi_info_read(multi_.get(), &left)) {
            if (message->msg != CURLMSG_DONE) continue;
            CURL* const easy = message->easy_handle;
            const CURLcode result = message->data.result;
            curl_multi_remove_handle(multi_.get(), easy);
            const auto at = std::ranges::find_if(
                underWay_, [&](const One& one) { return one->transfer->handle() == easy; });
            if (at == underWay_.end()) continue;
            auto came = (*at)->transfer->end(result);
            if (spare_.size() < mostSpareHandles) spare_.push_back((*at)->transfer->takeHandle());
            settle(at, std::move(came));
        }
    }

    void settle(std::list<One>::iterator at, PartOrFault result) {
        Waiting& one = **at;
        // What a slow line did not bring in that long it does not bring the next time: its owner asks for less.
        const bool wasSlow = Clock::now() - one.begun >= options_.limits.grace / 2;
        if (!result && result.error().kind == RequestFault::Kind::Unreachable && !wasSlow &&
            one.tried < one.transfer->ask().tries) {
            one.due = Clock::now() + delayAfter(one.tried, result.error());
            return waiting_.splice(waiting_.end(), underWay_, at);
        }
        if (result) bytes_ += result->bytes.size();
        const One ended = std::move(*at);
        underWay_.erase(at);
        (void)guarded("Fetching", [&] { ended->transfer->finish(std::move(result)); });
    }

    /// Between half and all of what is due, so that those who failed together do not come back together.
    milliseconds delayAfter(int tries, const RequestFault& fault) {
        auto delay = options_.firstDelay;
        for (int i = 1; i < tries && delay < options_.longestDelay; ++i) delay *= 2;
        delay = std::min(delay, options_.longestDelay);
        std::uniform_int_distribution<milliseconds::rep> share(delay.count() / 2, delay.count());
        const milliseconds wanted = fault.after ? milliseconds(*fault.after) : milliseconds(0);
        return std::max(milliseconds(share(random_)), std::min(wanted, options_.longestDelay));
    }

    void end() {
        for (const One& one : underWay_)
            if (one->transfer->handle()) curl_multi_remove_handle(multi_.get(), one->transfer->handle());
        for (auto* list : {&underWay_, &waiting_}) {
            for (const One& one : *list)
                (void)guarded("Fetching", [&] { one->transfer->finish(tl::unexpected(stopped())); });
            list->clear();
        }
        spare_.clear();
    }

    const TransfersOptions options_;
    const std::unique_ptr<CURLM, decltype(&curl_multi_cleanup)> multi_;
    std::atomic<std::uint64_t> requests_{0}, retries_{0}, bytes_{0};

    std::mutex mutex_;  // guards what follows
    std::list<One> new_;
    bool stopping_ = false;

    // The thread's own.
    std::minstd_rand random_;
    std::list<One> waiting_, underWay_;
    std::vector<Transfer::Handle> spare_;
};

class TransfersThread final : public Transfers {
  public:
    explicit TransfersThread(const TransfersOptions& options)
        : core_(std::make_shared<CurlTransfers>(options)) {
        thread_ = std::thread([core = core_] { core->run(); });
    }
    ~TransfersThread() override {
        core_->stop();
        // The last one who has a file may be who is told of it.
        if (thread_.get_id() == std::this_thread::get_id())
            thread_.detach();
        else
            thread_.join();
    }
    void start(PartAsk ask, PartDone done) override { core_->start(std::move(ask), std::move(done)); }
    void stop() override { core_->stop(); }
    TransfersStats stats() const override { return core_->stats(); }

  private:
    const std::shared_ptr<CurlTransfers> core_;
    std::thread thread_;
};

}  // namespace

Expected<std::shared_ptr<Transfers>> Transfers::create(const TransfersOptions& options) {
    // Counted by the library; what it sets up stays for the process.
    if (curl_global_init(CURL_GLOBAL_DEFAULT) != CURLE_OK)
        return fail(ErrorCode::ResourceLimit, "The library that fetches from the network cannot be set up.");
    return guarded("Fetching", [&]() -> Expected<std::shared_ptr<Transfers>> {
        return std::make_shared<TransfersThread>(options);
    });
}

}  // namespace scancast
