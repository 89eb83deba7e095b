// A cloud from whatever the user names: a cloud file, or scans - files, folders, patterns - that are read into memory as one.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "renderer/residency/block_cache.hpp"

namespace scancast {

struct OpenOptions {
    int threads = 0;            ///< 0 = all cores
    bool surfels = true;        ///< of scans
    std::string assumeCrs{};    ///< of scans, as written; empty = they are believed
    std::string memoryLimit{};  ///< of cloud files, like "2G"; empty = half of the machine's
    bool native = false;        ///< scans that can be are shown as they are
    bool verbose = false;       ///< name each file of a folder that is no scan
    std::shared_ptr<BlockCache> cache{};  ///< of cloud files; empty = each has one of its own, of that limit
};

/// Memory for cloud files, as the options limit it. InvalidArgument where that is no size.
Expected<std::shared_ptr<BlockCache>> cacheFor(const OpenOptions& options);

/// Shows progress and tells what is remarkable on standard error. Errors: those of findScans(), of opening and reading;
/// InvalidArgument for a cloud file among others.
Expected<std::shared_ptr<const Cloud>> openAny(const std::vector<std::string>& arguments,
                                               const OpenOptions& options);

}  // namespace scancast
