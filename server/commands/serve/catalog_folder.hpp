// The folder of --catalog: which of its files are clouds to serve, now. Looked at again and again, because files come and go: by a
// listing, so that it may be on any file system, and any number of servers may look at it.
//
// A file is served from when it is a whole cloud file until its name is gone, so nobody sees one that is half written. What becomes
// of its content meanwhile is the watch's (server/catalog/cloud_watch.hpp). What is there decides, in byte order of the names, and not
// what was there before: servers that look at the same folder serve the same clouds under the same ids.
//
// Owned by `serve`'s cloud sources, on the main thread.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "files/input_file.hpp"

namespace scancast {

class CatalogFolder {
  public:
    using Time = std::chrono::steady_clock::time_point;
    static constexpr std::chrono::seconds interval{2};
    static constexpr std::size_t mostNames = 100'000;  ///< of files of any kind

    /// Serves `most` at the same time. Notes are sentences for the log: what is left out and why, once for each file as it is.
    CatalogFolder(std::filesystem::path path, std::size_t most,
                  std::function<void(const std::string&)> onNote);

    /// Looks, unless it did so less than an interval ago; whether files() are others than before. A folder that cannot be
    /// read changes nothing, and is told of once.
    bool look(Time now);
    /// Whole cloud files, in byte order; no two of them have the same id.
    const std::vector<std::filesystem::path>& files() const { return files_; }
    const std::filesystem::path& path() const { return path_; }

  private:
    struct Known {
        std::optional<FileIdentity>
            judged{};          ///< as it was when it was judged; empty: it could not be opened
        bool isWhole = false;  ///< it was, once: it is served as long as the name is there
    };
    std::optional<std::vector<std::string>> names();
    bool isServed(const std::string& name, Known& known);
    void judge(const std::string& name, const InputFile& file, Known& known);
    std::vector<std::filesystem::path> choose();
    void note(const std::string& text);

    std::filesystem::path path_;
    std::size_t most_;
    std::function<void(const std::string&)> onNote_;
    std::optional<Time> looked_;
    bool isUnreadable_ = false, isFull_ = false;
    std::map<std::string, Known> known_;  ///< by name; those that are there
    std::vector<std::string> namesakes_;  ///< that were left out, and told
    std::vector<std::filesystem::path> files_;
};

}  // namespace scancast
