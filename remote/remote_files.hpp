// Opens objects in object storage, and has what they share: the requests' thread, the pieces on disk, the memory for pieces.
// Nothing is started before the first one is opened.
//
// Owned by a command, for the process. *Thread safety*: every function may be called from any thread. Place: commands, loader →
// **remote files** → cloud files.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>

#include "remote/access.hpp"
#include "remote/remote_file.hpp"
#include "remote/remote_folder.hpp"
#include "remote/remote_url.hpp"

namespace scancast {

struct RemoteOptions {
    RemoteEnvironment environment = RemoteEnvironment::ofProcess();
    std::uint64_t memory = 32 << 20;  ///< bytes, for pieces
    std::filesystem::path folder{};   ///< that pieces are kept in; empty = nowhere
    std::uint64_t folderLimit = 0;    ///< bytes
    PaceLimits pace{};                ///< of one object
    int tries = 3;
    TransfersOptions transfers{};
    std::chrono::milliseconds firstProbe{500}, lastProbe{10000};
    std::function<void(const std::string& note)> onNote{};
    /// Counts the memory for pieces, for as long as the result lives.
    std::function<std::shared_ptr<const void>(std::uint64_t bytes)> reserve{};
    bool stopsWithOwner = true;  ///< else files that are open go on
};

/// All of something small.
struct RemoteDocument {
    std::string text, etag;
    bool isUnchanged = false;  ///< it has the ETag that was given; without text
};

struct RemoteStats {
    TransfersStats transfers;
    std::uint64_t memoryHits = 0, diskHits = 0, misses = 0;  ///< pieces
    std::uint64_t brokenPieces = 0;                          ///< on disk
    std::uint64_t folderBytes = 0, folderLimit = 0;
    std::size_t files = 0, away = 0;  ///< open; of which cannot be fetched now
};

class RemoteFiles {
  public:
    explicit RemoteFiles(RemoteOptions options);
    ~RemoteFiles();
    RemoteFiles(const RemoteFiles&) = delete;
    RemoteFiles& operator=(const RemoteFiles&) = delete;

    /// Waits for its first bytes, and no longer than some tries take. Errors, which name it without its query:
    /// InvalidArgument for credentials; NotFound; Unavailable for what may pass; Unsupported for a server that sends no parts;
    /// Io for one that refuses, and for the folder.
    Expected<std::shared_ptr<RemoteFile>> open(const RemoteUrl& url);
    /// What lies beside an object that was opened by this URL, and describes them. InvalidArgument for a URL that is signed for it alone.
    Expected<std::shared_ptr<RemoteFolder>> around(const RemoteUrl& url,
                                                   std::shared_ptr<RemoteFile> description);
    /// What is open of the object that it names goes on with this signature: an old one ends some time.
    void signAnew(const RemoteUrl& url);
    /// All of what is there, `most` bytes at most, unless it still has the ETag `unless`; nothing is kept of it, and nothing is tried
    /// again. Waits, and no longer than a request takes. Errors: as open().
    Expected<RemoteDocument> fetch(const RemoteUrl& url, std::uint64_t most, const std::string& unless = {});
    /// A page of what a bucket holds; `shown`: what errors call it.
    Expected<RemoteDocument> fetch(const ListAsk& ask, const std::string& shown, std::uint64_t most);
    /// Called when one that is open turns out to be another now; replaces what was to be called before.
    void onChanged(std::function<void()> tell);
    /// Whoever waits gets Unavailable, now and later.
    void stop();
    RemoteStats stats() const;

  private:
    Expected<std::shared_ptr<RemoteCommons>> commons();
    Expected<RemoteDocument> fetch(ObjectAccess access, const std::string& shown, std::uint64_t most,
                                   const std::string& unless);

    const RemoteOptions options_;
    mutable std::mutex mutex_;                                         // guards what follows
    std::multimap<std::string, std::weak_ptr<RemoteFile>> open_;       // by what their URLs name
    std::multimap<std::string, std::weak_ptr<RemoteFolder>> folders_;  // by their descriptions' URLs
    std::shared_ptr<RemoteCommons> commons_;
    bool stopping_ = false;
    struct Changes;
    const std::shared_ptr<Changes> changes_;
};

/// The same object for who wants to own a reader alone.
std::unique_ptr<RandomReader> readerOf(std::shared_ptr<const RemoteFile> file);

}  // namespace scancast
