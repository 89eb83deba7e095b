// Brings clouds into the catalog while the server already answers: cloud files are opened, scans are read and built, in
// memory or, when they would not fit or are to be kept, as a cloud file. Those that this program reads itself come one after the
// other; beside them some at once that importers read, so that nothing waits for a program of others.
//
// A cloud whose loading throws has failed, and the next one is loaded. What comes from a cloud file is watched
// from then on (cloud_watch.hpp); the kept file of a scan that turns out to be damaged is built anew, once.
//
// Owned by `serve`. Its threads read, one for its own and one for each importer; the octree builder uses all cores by itself.
// *Thread safety*: its functions may be called from any thread.
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "renderer/cloud/build/octree_shape.hpp"
#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/import/open_scan.hpp"
#include "renderer/residency/block_cache.hpp"
#include "server/base/native_cloud.hpp"
#include "server/catalog/catalog.hpp"
#include "server/catalog/cloud_watch.hpp"
#include "server/catalog/damage_reports.hpp"
#include "server/catalog/kept_clouds.hpp"
#include "threads/monitor.hpp"

namespace scancast {

struct LoadedCloud {
    std::string id;
    const Cloud& cloud;
    double seconds = 0;
};

struct LoaderOptions {
    int threads = 0;    ///< 0 = all cores
    int importers = 2;  ///< scans at once that importers read
    ImportOptions import;
    OctreeShape shape{};
    std::shared_ptr<BlockCache> cache;  ///< that cloud files live in; its limit is the memory limit
    /// Keeps scans as cloud files, named by a digest of what they are made of. Empty = nothing is kept; that, and what there
    /// is no room for, goes through a file in the system's temporary folder where it does not fit into memory.
    std::shared_ptr<KeptClouds> kept;
    bool native = false;                            ///< scans that can be shown as they are are not ingested
    std::string version;                            ///< of the program: another one builds anew
    std::shared_ptr<DamageReports> damage;          ///< of the cache's files; may be empty
    std::shared_ptr<RemoteFiles> remote{};          ///< opens cloud files behind URLs; empty = none is
    std::chrono::milliseconds remoteRetry{5000};    ///< before one that could not be reached is opened again
    std::chrono::milliseconds watchInterval{2000};  ///< between looks whether files have changed
    /// Called on the loader's threads.
    std::function<void(const std::string& note)> onNote;
    std::function<void(const std::string& id, const Progress&)> onProgress;
    std::function<void(const LoadedCloud&)> onLoaded;
    std::function<void(const Error&)> onFailed;
    std::function<void(const CloudFile&, const Error&)> onDamaged;  ///< a block of it
    std::function<void()> onChanged;  ///< an entry that was Ready shows another cloud, or none
};

class Loader {
  public:
    static constexpr std::size_t mostAdded = 64;  ///< by load(), waiting

    /// The entries are in the catalog when this returns; loading has begun, what opens in milliseconds first.
    /// The catalog outlives the loader.
    Loader(std::vector<std::filesystem::path> files, Catalog& catalog, LoaderOptions options);
    /// requestStop(), then waits. A tree that is being built is finished first.
    ~Loader();
    Loader(const Loader&) = delete;
    Loader& operator=(const Loader&) = delete;

    /// Loads one more, opened already, into an entry that is in the catalog, after those that wait; false
    /// when too many do, or after requestStop().
    bool load(ScanInput input, std::string id);
    struct Changes {
        std::size_t added = 0, removed = 0, tried = 0;  ///< tried: again, because they had failed
    };
    /// What becomes of files that have failed, or were removed by others, and are still named.
    enum class Again : std::uint8_t { Try, TryFailed, Leave };
    /// From now on these files are served in place of those of the constructor, or of the last call: new ones are added,
    /// those that are not named any more are removed (what is being read first when it has been), what has failed, or was
    /// removed by others, is tried again (or only the former), or left as it is; and whether a file has changed is looked at at once. What load()
    /// brought stays. A URL that names the same object with another signature is the same file.
    Changes serve(std::vector<std::filesystem::path> files, Again again = Again::Try);
    void requestStop();
    /// Nothing is being loaded, and nothing waits; after requestStop(): nothing is being loaded.
    bool finished() const;
    /// There are files that were to be served, and not one of them could be loaded.
    bool allFailed() const;

  private:
    using Result = Expected<std::shared_ptr<const Cloud>>;
    struct Job {
        ScanPlace place;
        std::string id;
        std::optional<ScanInput> opened{};  ///< empty: when it is its turn
        std::uint64_t number = 0;           ///< in the order in which they came
        /// Of a cloud whose kept file is damaged, or whose object has been replaced: that cloud, which the new one is to take the
        /// place of.
        std::optional<std::weak_ptr<const Cloud>> instead{};
        std::optional<WatchedFile> watched{};         ///< the cloud file that it is in, once that is open
        std::chrono::steady_clock::time_point due{};  ///< not before; of one that waits in later_
        bool waitsForRemote = false;                  ///< which has been told

        std::filesystem::path file() const {
            return place.root.empty() ? place.name : place.root / place.name;
        }
    };
    using Jobs = std::deque<Job>;
    /// A file that is to be served.
    struct Named {
        std::filesystem::path file;
        std::string id;
        bool leaves = false;  ///< when it has been read: a thread is at it
    };
    /// Those that this program reads, those behind URLs, whose servers may take their time, or those that importers read: each
    /// has threads of its own.
    enum class Lane : std::uint8_t { Own, Remote, Importers };
    static constexpr std::size_t remoteOpeners = 4;
    using Clock = std::chrono::steady_clock;
    Jobs& jobsOf(Lane lane) {
        return lane == Lane::Own ? own_ : lane == Lane::Remote ? remote_ : forImporters_;
    }
    std::size_t ingesters() const { return std::size_t(1 + std::max(1, options_.importers)); }
    Jobs::iterator nextOf(Lane lane);
    void disownLocked(const std::string& id);
    void addLocked(std::vector<std::filesystem::path> files);
    bool removeLocked(Named& named);
    bool tryAgainLocked(Named& named, Again again);
    bool dismissLocked(const std::string& id);
    bool leaveLocked(const std::string& id);
    std::size_t waiting() const {
        return unsorted_.size() + own_.size() + remote_.size() + forImporters_.size() + later_.size();
    }
    std::size_t added() const;
    ScanPlace currentPlace(const ScanPlace& place, const std::string& id) const;
    void signAnewLocked(Named& named, std::filesystem::path file);
    Clock::time_point nextLater() const;
    void takeLater();
    bool tryLater(Job& job, const Error& error);
    Result openRemote(Job& job);
    void run(Lane lane);
    bool step(Lane lane);
    void sort(Job& job);
    void loadOne(Job& job);
    class IngestMemory;
    void settle(const Job& job, Result cloud, double seconds);
    void settleFailed(const Job& job, Error error);
    void settleRebuilt(const Job& job, Result cloud);
    void settleReopened(const Job& job, Result cloud);
    /// With a look, so that nobody sees it without.
    Result shownCloudOf(const ScanInput& input, Job& job);
    Result cloudOf(const ScanInput& input, Job& job);
    /// As a cloud file that is kept, or why not.
    Result keep(const std::filesystem::path& path, const ScanInput& input, Job& job);
    /// Through a file without a name.
    Result buildOnDisk(const ScanInput& input, const std::string& id);
    /// `kept`: it is a file that a scan is kept in.
    Result openAsItIs(const ScanInput& input, Job& job);
    Result openIn(Expected<InputFile> file, Job& job, bool kept);
    /// `room`: what is reserved for it already.
    Result build(const ScanInput& input, const std::string& id, std::shared_ptr<const void> room = nullptr);
    Expected<void> ingestTo(const std::filesystem::path& output, const ScanInput& input,
                            const std::string& id);
    bool rebuild(const WatchedFile& file, const std::shared_ptr<const Cloud>& instead);
    CloudWatchOptions watchOptions();
    Expected<std::unique_ptr<PointSource>> open(const ScanInput& input, const std::string& id) const;
    ProgressSink progressOf(const std::string& id) const;
    void note(const std::string& text) const;

    Catalog& catalog_;
    std::stop_source stop_;
    const LoaderOptions options_;
    const NativeOpening native_;
    std::mutex room_;          // held while it is decided whether a scan fits into memory
    mutable Monitor monitor_;  // guards what follows, and requests of a stop
    Jobs unsorted_, own_, remote_, forImporters_;
    Jobs later_;  // behind URLs that cannot be reached at present
    std::vector<Named> named_;
    std::vector<const Job*> loading_;  // room for one of each thread
    std::size_t sorting_ = 0;
    std::uint64_t numbers_ = 0, ingestMemory_ = 0;
    CloudWatch watch_;  // calls back, and is called by the threads
    std::vector<std::thread> threads_;
};

}  // namespace scancast
