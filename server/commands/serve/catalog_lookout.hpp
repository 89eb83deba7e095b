// Looks at the place of --catalog again and again on a thread of its own, because a folder of a network, or a server, may not answer for
// minutes, and hands over what is there now. Who asks for that never waits for a disk: the main thread has signals to serve meanwhile.
//
// Owned by `serve`'s cloud sources. Place: folder, URL → **lookout** → cloud sources → loader. *Thread safety*: any thread; notes come on
// the lookout's own.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/commands/serve/catalog_place.hpp"
#include "threads/monitor.hpp"

namespace scancast {

struct LookoutOptions {
    std::filesystem::path place;  ///< a folder, or a URL
    std::shared_ptr<RemoteFiles>
        remote{};          ///< asks for the latter; is stopped before the lookout is waited for
    std::size_t most = 0;  ///< clouds of it at the same time
    std::chrono::milliseconds interval{2000};  ///< between two looks
    std::function<void(const std::string&)> onNote{};
};

class CatalogLookout {
  public:
    using Files = std::vector<std::filesystem::path>;
    struct News {
        Files files;          ///< CatalogPlace::files()
        bool isAnew = false;  ///< CatalogPlace::isAnew(), of any look since the last news
    };

    /// It has begun to look.
    explicit CatalogLookout(LookoutOptions options);
    /// Waits until the look that is under way is over.
    ~CatalogLookout();
    CatalogLookout(const CatalogLookout&) = delete;
    CatalogLookout& operator=(const CatalogLookout&) = delete;

    /// Waits until it has looked once; false when that takes longer.
    bool waitForFirst(std::chrono::milliseconds patience);
    /// What is there, when that is other than what was taken last.
    std::optional<News> takeNews();
    /// From the next look on.
    void setMost(std::size_t most);
    void requestStop();
    /// It looks no more.
    bool finished() const;
    /// As it may be told.
    std::string shown() const { return shownArgument(options_.place.native()); }

  private:
    void run();

    const LookoutOptions options_;
    const std::unique_ptr<CatalogPlace> place_;  // the thread's own
    mutable Monitor monitor_;
    std::size_t most_;
    bool hasLooked_ = false, stops_ = false, finished_ = false;
    std::optional<News> news_;
    std::thread thread_;  // last: it uses all of the above
};

}  // namespace scancast
