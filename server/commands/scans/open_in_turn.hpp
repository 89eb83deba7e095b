// Many scans as one: opened for their headers now, and again when their turn comes, so that thousands do not wait open. Used on
// one thread. Place: files → **sources** → octree.
#pragma once

#include <memory>

#include "renderer/cloud/import/open_scan.hpp"

namespace scancast {

/// One of many. It has to be the file then that it is now. Errors: those of opening; when it is read, also Io for a file that
/// has changed since.
Expected<std::unique_ptr<PointSource>> openInTurn(const ScanInput& input, const ImportOptions& import);

}  // namespace scancast
