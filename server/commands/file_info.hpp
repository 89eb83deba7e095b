// What there is to know of a cloud file or a scan without drawing it: gathered here, printed by info_print.
// Used on one thread. Pipeline: file → **what is known of it** → text or JSON.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/progress.hpp"
#include "server/base/remote_cloud.hpp"

namespace scancast {

struct OctreeInfo {
    std::uint64_t nodes = 0, leaves = 0, samples = 0;
    int levels = 0;
};

/// A block that cannot be read, as its error says.
struct DamagedBlock {
    std::optional<std::uint32_t> node{};   ///< whose samples or values it holds
    std::optional<std::uint32_t> photo{};  ///< or which photo it is
    std::uint64_t offset = 0;
    std::string message;
};

struct FileInfo {
    std::filesystem::path file;
    std::uint64_t bytes = 0;
    /// Of a scan: what its header tells, completed by what was read where it was read through.
    CloudFacts facts;
    std::optional<std::uint64_t> points;  ///< of a scan as declared; nullopt = not known until it is read
    bool boundsKnown = false;

    std::optional<OctreeInfo> octree;  ///< a cloud file has one, a scan does not
    std::string writtenBy;             ///< cloud file: by which program

    glm::dvec3 gridStep{0};                   ///< the steps of the scan's coordinates; 0 = none, or not known
    std::optional<glm::dvec3> scannerOrigin;  ///< scan: where the scanner stood

    bool checked = false;  ///< every block was read, or the scan to its end
    std::vector<DamagedBlock> damaged;
};

/// Whether it is a cloud file, or else a scan, goes by its content. With `check`, every block of a cloud file
/// is read and verified, and a scan is read through. Errors: those of CloudFile::open(), openScan() and
/// PointSource::read(); a damaged block is none.
Expected<FileInfo> fileInfo(const std::filesystem::path& file, bool check, const ProgressSink& progress = {});

/// The same of a cloud file behind a URL. Errors: those of openRemoteCloud().
Expected<FileInfo> remoteInfo(RemoteFiles& remote, const std::string& url, bool check,
                              const ProgressSink& progress = {});

}  // namespace scancast
