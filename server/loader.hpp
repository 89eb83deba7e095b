// Brings clouds into the catalog, one after the other, while the server already answers: cloud files are
// opened, scans are read and built, in memory or, when they would not fit or are to be kept, as a cloud file.
//
// Owned by `serve`. Its thread reads; the octree builder uses all cores by itself. *Thread safety*: its
// functions may be called from any thread.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/import/open_scan.hpp"
#include "renderer/residency/block_cache.hpp"
#include "server/catalog.hpp"

namespace scancast {

struct LoadedCloud {
    std::string id;
    const Cloud& cloud;
    double seconds = 0;
};

struct LoaderOptions {
    int threads = 0;  ///< 0 = all cores
    ImportOptions import;
    Shape shape{};
    std::shared_ptr<BlockCache> cache;  ///< that cloud files live in; its limit is the memory limit
    /// Keeps scans as cloud files, named by a digest of what they are made of; empty = nothing is kept, and
    /// what does not fit into memory goes through a file in the system's temporary folder.
    std::filesystem::path cacheDir;
    std::string version;  ///< of the program: another one builds anew
    std::chrono::milliseconds firstPreview{1000};
    /// Called on the loader's threads.
    std::function<void(const std::string& note)> onNote;
    std::function<void(const std::string& id, const Progress&)> onProgress;
    std::function<void(const LoadedCloud&)> onLoaded;
    std::function<void(const Error&)> onFailed;
};

class Loader {
  public:
    /// The entries are in the catalog when this returns; loading has begun. The catalog outlives the loader.
    Loader(std::vector<std::filesystem::path> files, Catalog& catalog, LoaderOptions options);
    /// requestStop(), then waits. A tree that is being built is finished first.
    ~Loader();
    Loader(const Loader&) = delete;
    Loader& operator=(const Loader&) = delete;

    void requestStop() { stop_.request_stop(); }
    bool finished() const { return finished_; }
    std::size_t failed() const { return failed_; }

  private:
    void run();
    using Result = Expected<std::shared_ptr<const Cloud>>;
    void loadOne(std::size_t index);
    void settle(std::size_t index, Result cloud, double seconds);
    Result load(const std::filesystem::path& file, const std::string& id);
    Result build(const std::filesystem::path& file, const std::string& id);
    Result ingestTo(const std::filesystem::path& output, const std::filesystem::path& file,
                    const std::string& id);
    Expected<std::unique_ptr<PointSource>> open(const std::filesystem::path& file,
                                                const std::string& id) const;
    ProgressSink progressOf(const std::string& id) const;
    void note(const std::string& text) const;

    const std::vector<std::filesystem::path> files_;
    Catalog& catalog_;
    const LoaderOptions options_;
    std::vector<std::string> ids_;
    std::stop_source stop_;
    std::atomic<bool> finished_{false};
    std::atomic<std::size_t> failed_{0};
    std::thread thread_;
};

}  // namespace scancast
