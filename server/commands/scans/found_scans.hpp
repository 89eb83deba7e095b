// The files that a command's arguments mean: scans and cloud files, folders of them, patterns. Used on one thread, before
// anything is opened for good. Place: command line, configuration → **files** → whoever reads them.
//
//   FILE      itself, whatever it is
//   URL       of a cloud file, where the command reads those (remote/remote_url.hpp); nothing is asked for yet
//   FOLDER    all scans in it and beneath it, hidden ones aside; an octree of another program's is one scan
//   PATTERN   `flight/*.laz`, where there is no file of that name (glob.hpp): the files, and the folders, that it stands for
//
// Arguments keep their order; what one of them stands for is in byte order. A file that is found twice is read once. What lies
// in a folder and is no scan is counted by kind, and told.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "protocol/error.hpp"

namespace scancast {

struct FindScansOptions {
    bool cloudFiles = true;      ///< those in folders, too; one that is named is always taken
    bool urls = false;           ///< of cloud files in object storage
    std::size_t most = 100'000;  ///< names that are looked at for one argument
};

class FoundScans {
  public:
    /// Deeper folders are not looked into, and counted.
    static constexpr int deepest = 64;

    explicit FoundScans(FindScansOptions options = {}) : options_(options) {}

    /// Adds what one argument stands for. A file that is not there is added as it is: whoever reads it says so. Errors:
    /// InvalidArgument for a folder without scans and for a pattern that nothing matches; Io for a folder that cannot be
    /// read; ResourceLimit.
    Expected<void> add(const std::string& argument);

    const std::vector<std::string>& files() const { return files_; }
    /// "3 files are no scans: 2 .jpg, 1 .txt"; empty = all were.
    std::string leftOutText() const;
    /// Each of them: "flight/notes.txt (.txt)".
    const std::vector<std::string>& leftOut() const { return leftOut_; }

  private:
    using Identity = std::pair<std::uint64_t, std::uint64_t>;  ///< device, inode
    struct Found {
        std::string path;
        Identity identity;
    };
    /// What one argument stands for, while it is looked for.
    struct Search {
        std::string argument{};
        std::vector<Found> found{};
        std::set<Identity> folders{};  ///< that were gone into: no loop of links is gone round
        std::size_t looked = 0;
        std::map<std::string, std::size_t> kinds{};  ///< that were left out
    };

    Expected<void> addUrl(const std::string& argument);
    void addNamed(const std::string& file);
    Expected<void> addPattern(const std::string& pattern);
    Expected<void> settle(Search& search, bool pattern);
    Expected<void> lookIn(const std::string& folder, int depth, Search& search);
    Expected<void> lookAt(const std::string& path, int depth, Search& search);
    void leaveOut(const std::string& path, const std::string& kind, Search& search);

    FindScansOptions options_;
    std::vector<std::string> files_, leftOut_;
    std::set<std::string> named_;   ///< in files_, by their paths without detours
    std::set<Identity> inFolders_;  ///< in files_, those that were found
    std::set<Identity> all_;        ///< in files_, that are there
    std::map<std::string, std::size_t> kinds_;
};

/// All of them. Errors: those of add().
Expected<FoundScans> findScans(std::span<const std::string> arguments, FindScansOptions options = {});

/// Says on standard error what was left out: a line, and with `byName` each of them.
void tellLeftOut(const FoundScans& found, bool byName);

}  // namespace scancast
