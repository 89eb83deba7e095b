// Loads scans into the catalog, one after the other, while the server already answers.
//
// Owned by `serve`. Its thread reads; the octree builder uses all cores by itself. *Thread safety*: its
// functions may be called from any thread.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/import/open_scan.hpp"
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
    /// Called on the loader's threads.
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

    void requestStop() { stop_ = true; }
    bool finished() const { return finished_; }
    std::size_t failed() const { return failed_; }

  private:
    void run();
    void loadOne(const std::filesystem::path& file, const std::string& id);

    const std::vector<std::filesystem::path> files_;
    Catalog& catalog_;
    const LoaderOptions options_;
    std::vector<std::string> ids_;
    std::atomic<bool> stop_{false}, finished_{false};
    std::atomic<std::size_t> failed_{0};
    std::thread thread_;
};

}  // namespace scancast
