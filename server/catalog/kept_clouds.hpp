// The folder in which scans are kept as cloud files (--cache-dir), with an end (--cache-size): before another one is built,
// those that have not been used for longest make room. What somebody has open - this server, or another one that shares the
// folder - has a lock on it and stays. Only files that are named as the loader names them are ever removed; what else
// lies there is left alone, and compiled programs (its folder "programs") have a limit of their own, which counts here.
//
// When a file was last used is its time of access, which is set by hand when it is opened: file systems need not count it.
//
// Owned by `serve`, the loader and the API together. *Thread safety*: every function may be called from any thread. Place:
// loader → **kept clouds** → cloud file.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "files/input_file.hpp"

namespace scancast {

struct KeptCloudsOptions {
    std::filesystem::path folder;
    std::uint64_t limit = 0;  ///< bytes; 0 = a tenth of the disk that the folder is on
    /// What was removed, for the log.
    std::function<void(const std::string& note)> onNote{};
};

struct KeptCloudsStats {
    std::uint64_t limit = 0, bytes = 0;  ///< as of when something was last opened or built
    std::uint64_t evicted = 0;           ///< files, since the start
};

class KeptClouds {
  public:
    /// Removes what servers that have ended left unfinished.
    explicit KeptClouds(KeptCloudsOptions options);
    KeptClouds(const KeptClouds&) = delete;
    KeptClouds& operator=(const KeptClouds&) = delete;

    /// Where a cloud file of this name is, or will be.
    std::filesystem::path pathOf(std::string_view stem, std::uint64_t digest) const;
    /// It has been used now, and stays as long as it is open. Errors: InputFile::open()'s; NotFound, too, where it is being
    /// removed.
    Expected<InputFile> open(const std::filesystem::path& path);

    /// Bytes that a file about to be built may take, as long as this lives.
    class Room {
      public:
        Room(KeptClouds& kept, std::uint64_t bytes) : kept_(kept), bytes_(bytes) {}
        /// What was built may have become larger than it was thought to: others make room for that, too.
        ~Room();
        Room(const Room&) = delete;
        Room& operator=(const Room&) = delete;

      private:
        KeptClouds& kept_;
        const std::uint64_t bytes_;
    };
    /// Removes others until there is room. ResourceLimit, with a sentence, where it would be larger than all may be, or than
    /// what others leave that are open.
    Expected<std::unique_ptr<Room>> makeRoom(std::uint64_t bytes);

    KeptCloudsStats stats() const;
    const std::filesystem::path& folder() const { return options_.folder; }

  private:
    struct Kept;
    /// How much is there after as much as can be was removed of what is beyond the limit with `more`.
    std::uint64_t evict(std::uint64_t more);
    bool remove(const Kept& kept);
    std::uint64_t programBytes() const;
    void note(const std::string& text) const;

    const KeptCloudsOptions options_;
    std::uint64_t limit_ = 0;
    std::mutex mutex_;            // guards what follows, and is held while files are removed
    std::uint64_t reserved_ = 0;  // by Rooms
    std::atomic<std::uint64_t> bytes_{0}, evicted_{0};
};

/// Bytes; what is kept there where nobody says how much may be.
std::uint64_t tenthOfTheDisk(const std::filesystem::path& folder);

/// Whether that is the name of a cloud file that is kept, finished: "town-0123456789abcdef.scan".
bool isKeptName(std::string_view name);

}  // namespace scancast
