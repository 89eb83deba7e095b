// The folder of --catalog: which of its files are clouds to serve, now. Looked at again and again, because files come and go: by a
// listing, so that it may be on any file system, and any number of servers may look at it.
//
// A file is served from when it is a whole cloud file until its name is gone, so nobody sees one that is half written; it is opened
// no more than until then. What becomes of its content meanwhile is the watch's (server/catalog/cloud_watch.hpp). What is there
// decides, in byte order of the names, and not what was there before: servers that look at the same folder, and serve nothing beside
// it, serve the same clouds under the same ids. (Where another cloud has the id already - a file beside the folder, one that an
// administrator added -, the catalog puts "-2" behind it, as ever.)
//
// Owned by the lookout (catalog_lookout.hpp), and used on its thread: a folder of a network may not answer for minutes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "files/input_file.hpp"
#include "server/commands/serve/catalog_place.hpp"

namespace scancast {

class CatalogFolder final : public CatalogPlace {
  public:
    static constexpr std::size_t mostNames = 100'000;  ///< of files of any kind

    /// Notes are sentences for the log: what is left out and why, each reason once for each name until it is whole.
    CatalogFolder(std::filesystem::path path, std::function<void(const std::string&)> onNote);

    bool look(std::size_t most) override;
    /// Whole cloud files.
    const std::vector<std::filesystem::path>& files() const override { return files_; }

  private:
    enum class Reason : std::uint8_t { Unreadable = 1, NoCloudFile = 2, NotWhole = 4 };
    struct Known {
        std::optional<FileIdentity> judged{};  ///< as it was when its content was; empty: it has not been yet
        bool isWhole = false;                  ///< it was, once: it is served as long as the name is there
        unsigned told = 0;                     ///< reasons
    };
    std::optional<std::vector<std::string>> names();
    bool isServed(const std::string& name, Known& known);
    void judge(const std::string& name, const InputFile& file, Known& known);
    void leaveOut(const std::string& name, Known& known, Reason reason, const std::string& why);
    void note(const std::string& text);

    std::filesystem::path path_;
    std::function<void(const std::string&)> onNote_;
    CatalogChoice choice_;
    bool isUnreadable_ = false;
    std::map<std::string, Known> known_;  ///< by name; those that are there
    std::vector<std::filesystem::path> files_;
};

}  // namespace scancast
