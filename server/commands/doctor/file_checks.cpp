#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "files/unique_fd.hpp"
#include "renderer/cloud/import/stream/importer_process.hpp"
#include "server/commands/doctor/checks.hpp"
#include "server/commands/file_info.hpp"
#include "server/commands/scans/found_scans.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t littleSpace = std::uintmax_t(1) << 30;

/// Writes a file there that has no name and is gone at once. An errno; 0 = it can.
int whyNotWritable(const fs::path& folder) {
    const UniqueFd unnamed(::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600));
    if (unnamed) return 0;
    if (errno != EOPNOTSUPP && errno != EISDIR) return errno;  // those: a file system without such files
    std::string name = (folder / ".scancast-doctor-XXXXXX").string();
    const UniqueFd named(::mkostemp(name.data(), O_CLOEXEC));
    if (!named) return errno;
    ::unlink(name.c_str());
    return 0;
}

bool isThere(const std::string& topic, const fs::path& folder, Findings& findings) {
    std::error_code error;
    if (fs::is_directory(folder, error)) return true;
    findings.fault(topic, "there is no folder " + folder.string(), "mkdir -p " + folder.string());
    return false;
}

void lookAtWritten(const std::string& topic, const fs::path& folder, Findings& findings) {
    if (!isThere(topic, folder, findings)) return;
    if (const int why = whyNotWritable(folder); why != 0)
        return findings.fault(topic,
                              fmt::format("{} cannot be written to: {}", folder.string(), std::strerror(why)),
                              fmt::format("another folder, or one that user {} may write to", ::geteuid()));
    std::error_code error;
    const fs::perms others = fs::status(folder, error).permissions();
    const bool isOpen = (others & fs::perms::others_write) != fs::perms::none &&
                        (others & fs::perms::sticky_bit) == fs::perms::none;
    if (!error && isOpen)
        return findings.warning(
            topic, folder.string() + " may be written to by everybody: what is kept there can be replaced",
            "chmod o-w " + folder.string());
    const fs::space_info space = fs::space(folder, error);
    const std::string text = fmt::format("{} can be written to, {:.1f} GiB are left", folder.string(),
                                         error ? 0.0 : double(space.available) / double(littleSpace));
    if (!error && space.available >= littleSpace) return findings.ok(topic, text);
    findings.warning(topic, text,
                     "make room, or name another folder: a scan takes about as much as its file");
}

void lookAtFolders(const ServeOptions& options, Findings& findings) {
    if (!options.server.dataRoot.empty() && isThere("data root", options.server.dataRoot, findings)) {
        const std::string root = options.server.dataRoot.string();
        if (::access(root.c_str(), R_OK | X_OK) == 0)
            findings.ok("data root", root + " can be read");
        else
            findings.fault("data root", fmt::format("{} cannot be read: {}", root, std::strerror(errno)),
                           fmt::format("one that user {} may read", ::geteuid()));
    }
    if (!options.cacheDir.empty()) return lookAtWritten("cache", options.cacheDir, findings);
    // Scans that do not fit into memory are built there.
    std::error_code error;
    const fs::path folder = fs::temp_directory_path(error);
    if (!error) return lookAtWritten("temporary", folder, findings);
    const char* const named = std::getenv("TMPDIR");
    findings.fault(
        "temporary",
        fmt::format("there is no folder for temporary files ({})", named != nullptr ? named : "/tmp"),
        "TMPDIR=/tmp, or --cache-dir FOLDER");
}

void lookAtImporters(const ServeOptions& options, Findings& findings) {
    const auto import = importOptions(options.importer);
    if (!import) return;  // the flags' line says it
    struct Program {
        const char* name;
        const char* reads;
    };
    constexpr std::array programs{Program{"scancast-import-pcl", "PLY and PCD"},
                                  Program{"scancast-import-e57", "E57"},
                                  Program{"scancast-import-laz", "LAZ and COPC"},
                                  Program{"scancast-import-octree", "EPT and Potree"}};
    for (const auto& [name, reads] : programs) {
        const auto program = findImporter(name, *import);
        if (!program) {
            findings.warning(
                "importers", fmt::format("{} is not there, so that {} cannot be read", name, reads),
                "install it beside this program (deploy/README.md); LAS, text and cloud files need none");
            continue;
        }
        findings.ok("importers", fmt::format("{} reads {}", program->string(), reads));
    }
    const SandboxLine sandbox = sandboxLine(*import);
    if (sandbox.sound) return findings.ok("sandbox", sandbox.text);
    findings.warning(
        "sandbox", sandbox.text,
        "a kernel with Landlock (Linux 5.13) or namespaces; or ingest scans of strangers on another "
        "machine and serve the cloud files");
}

std::string describe(const FileInfo& info) {
    const std::string points =
        info.points ? fmt::format("{} points", *info.points) : "points, not counted yet";
    if (!info.octree) return fmt::format("a scan of {}", points);
    return fmt::format("a cloud file of {} in {} nodes, written by {}", points, info.octree->nodes,
                       info.writtenBy);
}

void lookAtClouds(const ServeOptions& options, Findings& findings) {
    if (options.files.empty()) findings.ok("clouds", "none was named; those that are will be looked at");
    FoundScans found;
    for (const fs::path& named : options.files)
        if (auto ok = found.add(named.string()); !ok)
            findings.fault("clouds", ok.error().message, "name a folder with scans in it, or leave it out");
    if (!found.leftOut().empty()) findings.ok("clouds", found.leftOutText());
    for (const fs::path file : found.files()) {
        const auto info = fileInfo(file, false);
        if (info) {
            findings.ok("clouds", fmt::format("{}: {}", file.string(), describe(*info)));
            continue;
        }
        const bool isDamaged =
            info.error().code == ErrorCode::Malformed || info.error().code == ErrorCode::Truncated;
        findings.fault(
            "clouds", info.error().message,
            isDamaged ? fmt::format("fetch it again, or ingest it anew; scancast info --check {} says more",
                                    file.string())
                      : "name one that is there and may be read, or leave it out");
    }
}

}  // namespace

void lookAtFiles(const ServeOptions& options, Findings& findings) {
    lookAtFolders(options, findings);
    lookAtImporters(options, findings);
    lookAtClouds(options, findings);
}

}  // namespace scancast
