// Keeps what is served true to the cloud files that it comes from: every few seconds it looks whether a name
// still leads to what was opened (device, inode, size, time of change), and at once when a block cannot be
// read. A file that was replaced is served anew, with what was replaced still drawn by pictures that have
// begun; one that was changed in place and is whole, too; new facts of the same blocks (`look --set`) cost no
// block. One that is not whole when it has stopped changing is refused: what was opened before goes on where
// it still can be read, and ends where it was overwritten. A damaged file that a scan is kept in is built anew,
// once. What is behind a URL is asked for less often - reading it tells, too -, and served anew when it is another.
//
// No picture is ever mixed of two files: the index in memory has the checksum of every block, and a block of
// another file is one that cannot be read.
//
// Owned by the loader; has a thread of its own, on which it opens files and calls back. *Thread safety*: opened(),
// shown() and hurry() may be called from any thread. Place: loader, damage reports → **cloud watch** → catalog, loader.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/import/scan_input.hpp"
#include "renderer/residency/block_cache.hpp"
#include "server/base/remote_cloud.hpp"
#include "server/catalog/catalog.hpp"
#include "server/catalog/damage_reports.hpp"
#include "threads/monitor.hpp"

namespace scancast {

/// A cloud file as it was opened for an entry of the catalog.
struct WatchedFile {
    std::string id;
    ScanPlace place;                              ///< of what was asked for: the file itself, or a scan
    std::optional<std::filesystem::path> kept{};  ///< the file, where that is what a scan is kept in
    FileIdentity identity{};                      ///< of the file, before it was read
    std::shared_ptr<const CloudFile> file{};
    std::shared_ptr<RemoteFile> remote{};  ///< what it is read from, where that is no file of this machine
    bool rebuilt = false;  ///< it has been built anew in this process: it is not a second time
};

struct CloudWatchOptions {
    std::chrono::milliseconds interval{2000};
    std::shared_ptr<BlockCache> cache;
    std::shared_ptr<DamageReports> damage;  ///< may be empty: then only names are looked at
    NativeOpening native{};                 ///< opens scans that are shown as they are
    /// Between questions whether something behind a URL is what it was; whatever is read of it tells, too.
    std::chrono::milliseconds remoteInterval{60000};
    /// What happened, for the log.
    std::function<void(const std::string& note)> onNote;
    /// A file that cannot be served any more, or not in the place of the one before.
    std::function<void(const Error&)> onRefused;
    /// A block of a file that is what it was.
    std::function<void(const CloudFile&, const Error&)> onDamaged;
    /// The catalog has another cloud.
    std::function<void()> onChanged;
    /// Builds a kept file anew, or opens what is behind a URL again, later, in the place of this cloud; false = not now.
    std::function<bool(const WatchedFile&, const std::shared_ptr<const Cloud>&)> rebuild;
};

class CloudWatch {
  public:
    /// The catalog outlives it.
    CloudWatch(Catalog& catalog, CloudWatchOptions options);
    /// requestStop(), then waits for the file that is being opened.
    ~CloudWatch();
    CloudWatch(const CloudWatch&) = delete;
    CloudWatch& operator=(const CloudWatch&) = delete;

    /// Before its blocks are read and the entry shows it; it takes the place of what was known of that entry.
    void opened(WatchedFile file);
    /// Now it does; or it still shows that one, because building it anew came to nothing.
    void shown(const std::string& id, std::shared_ptr<const Cloud> cloud);
    /// It came to nothing: what is behind the URL could not be opened again, and what was opened before is shown.
    void notOpened(const std::string& id, const Error& error);
    /// Looks at every name at once instead of within the interval.
    void hurry();
    void requestStop();

  private:
    struct Watched;
    struct News {
        std::vector<WatchedFile> opened;
        std::vector<std::pair<std::string, std::shared_ptr<const Cloud>>> shown;
        std::vector<std::pair<std::string, Error>> notOpened;
        std::vector<DamageReport> damage;
        std::uint64_t damageLeftOut = 0;
        bool empty() const { return opened.empty() && shown.empty() && notOpened.empty() && damage.empty(); }
    };
    using Clock = std::chrono::steady_clock;

    void run();
    bool step();
    void take(News news);
    void takeDamage(const DamageReport& report);
    void lookAtAll();
    void lookAt(Watched& one);
    void lookAtRemote(Watched& one);
    /// `scan`: what it describes, where that can be shown as it is.
    void changed(Watched& one, InputFile file, const ScanInput* scan);
    void notWhole(Watched& one, const FileIdentity& identity, const Error& error);
    void serveAgain(Watched& one, const FileIdentity& identity, std::shared_ptr<const CloudFile> file);
    bool showInstead(Watched& one, std::shared_ptr<const Cloud> cloud);
    void damaged(Watched& one, const Error& error);
    void buildAnew(Watched& one);
    void note(const std::string& text) const;

    Catalog& catalog_;
    const CloudWatchOptions options_;
    std::vector<std::unique_ptr<Watched>> watched_;  // the thread's own
    Clock::time_point next_;
    Monitor monitor_;  // guards what follows
    News news_;
    bool stopping_ = false, hurrying_ = false;
    std::thread thread_;
};

}  // namespace scancast
