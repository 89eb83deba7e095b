// A running importer program, as a source of bytes: its standard output.
// Pipeline: file → **importer process** → point stream → points. Owned and used by one thread.
//
// The process has its own group, limits on memory and processor time that hold before it starts, no core
// dumps, no descriptors but its three and that of the scan, a small environment, and it is shut in: what starts it
// (importer_launch.hpp) sees to that. It is killed and waited for when this object goes, and killed when this process ends.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "renderer/cloud/import/byte_source.hpp"
#include "renderer/cloud/import/open_scan.hpp"

namespace scancast {

/// A program that reads scans, and how it is limited.
struct ImporterProgram {
    std::string name;                  ///< such as "scancast-import-pcl"
    bool knowsKeepAttributes = false;  ///< takes --keep-attributes before the file
    bool knowsRecover = false;         ///< takes --recover before the file
};

struct LaunchedProgram;

class ImporterProcess final : public ByteSource {
  public:
    /// Starts `PROGRAM [--keep-attributes] [--recover] FILE`. FILE leads to what is open, not to what has its name by
    /// now: /proc/self/fd/3, or a description in there for the folder of an octree. Errors: Importer when
    /// there is no such program; one that the system refuses to run shows in badEnd().
    static Expected<std::unique_ptr<ImporterProcess>> start(const ImporterProgram& importer,
                                                            const ScanInput& input,
                                                            const ImportOptions& options);
    /// Of a program that runs already.
    ImporterProcess(LaunchedProgram program, std::chrono::seconds silence, std::stop_token stop = {});
    ~ImporterProcess() override;
    ImporterProcess(const ImporterProcess&) = delete;
    ImporterProcess& operator=(const ImporterProcess&) = delete;

    /// Errors: Importer when it hangs: it has sent nothing for too long, and read nothing of its file; Cancelled when it
    /// was asked to stop.
    Expected<std::size_t> read(std::span<std::byte> into) override;

    /// After read() came to the end: how the program ended when that was not well - "crashed (signal 11,
    /// Segmentation fault)", "ended with exit status 3: out of paper", "cannot be started: …". nullopt for
    /// exit status 0. Waits a moment for its end.
    std::optional<std::string> badEnd();

    pid_t pid() const { return pid_; }

  private:
    using Clock = std::chrono::steady_clock;

    bool hasReadMore();
    bool waitForBytes(Clock::time_point deadline, bool& outputReady);
    void readErrors();
    bool reap(Clock::time_point deadline);
    void kill();

    pid_t pid_;
    UniqueFd output_, errors_;
    std::chrono::seconds silence_;
    std::stop_token stop_;
    std::uint64_t taken_ = 0;  ///< bytes that it had read when it was last looked at
    bool ended_ = false;       ///< standard output is closed
    bool reaped_ = false;
    int status_ = 0;         ///< as waitpid gives it, once reaped
    std::string errorText_;  ///< the end of what it said on standard error; bounded
};

/// Where a program is: options.importerDirectory if set, otherwise beside the running program, then on PATH.
/// Error: Importer, with the places that were looked at.
Expected<std::filesystem::path> findImporter(const std::string& program, const ImportOptions& options);

}  // namespace scancast
