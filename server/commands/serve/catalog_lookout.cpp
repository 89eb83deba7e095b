#include "server/commands/serve/catalog_lookout.hpp"

#include <tuple>
#include <utility>

#include "server/base/faults.hpp"

namespace scancast {

CatalogLookout::CatalogLookout(LookoutOptions options)
    : options_(std::move(options)),
      place_(catalogPlace(options_.place, options_.remote, options_.onNote)),
      most_(options_.most),
      thread_([this] { run(); }) {}

CatalogLookout::~CatalogLookout() {
    requestStop();
    thread_.join();
}

void CatalogLookout::run() {
    Monitor::Lock lock(monitor_);
    while (!stops_) {
        const std::size_t most = most_;
        lock.unlock();
        std::optional<News> news;
        std::ignore = contained("Looking for clouds", [&] {
            if (place_ && place_->look(most)) news = News{place_->files(), place_->isAnew()};
        });
        lock.lock();
        hasLooked_ = true;
        if (news) news->isAnew = news->isAnew || (news_ && news_->isAnew);
        if (news) news_ = std::move(news);
        std::ignore =
            monitor_.waitUntil(lock, Monitor::Clock::now() + options_.interval, [this] { return stops_; });
    }
    finished_ = true;
}

bool CatalogLookout::waitForFirst(std::chrono::milliseconds patience) {
    Monitor::Lock lock(monitor_);
    return monitor_.waitUntil(lock, Monitor::Clock::now() + patience, [this] { return hasLooked_; });
}

std::optional<CatalogLookout::News> CatalogLookout::takeNews() {
    const Monitor::Lock lock(monitor_);
    return std::exchange(news_, std::nullopt);
}

void CatalogLookout::setMost(std::size_t most) {
    const Monitor::Lock lock(monitor_);
    most_ = most;
}

void CatalogLookout::requestStop() {
    const Monitor::Lock lock(monitor_);
    stops_ = true;
}

bool CatalogLookout::finished() const {
    const Monitor::Look look(monitor_);
    return finished_;
}

}  // namespace scancast
