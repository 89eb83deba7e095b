// A cloud from whatever file the user names: a cloud file, or a scan that is read into memory.
#pragma once

#include <memory>
#include <string>

#include "renderer/cloud/cloud.hpp"

namespace scancast {

struct OpenOptions {
    int threads = 0;            ///< 0 = all cores
    bool surfels = true;        ///< of scans
    std::string assumeCrs{};    ///< of scans, as written; empty = they are believed
    std::string memoryLimit{};  ///< of cloud files, like "2G"; empty = half of the machine's
};

/// Shows progress and tells what is remarkable on standard error. Errors: those of opening and reading.
Expected<std::shared_ptr<const Cloud>> openAny(const std::string& file, const OpenOptions& options);

}  // namespace scancast
