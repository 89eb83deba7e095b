// What shuts importers in on this machine, as scancast-sandbox finds by doing it. Used by commands, once, before scans are read.
#pragma once

#include <string>

#include "renderer/cloud/import/open_scan.hpp"

namespace scancast {

struct SandboxReport {
    bool complete = false;
    /// What holds, and after "without:" what does not; for people.
    std::string text;
};

/// Waits for it, some milliseconds. Errors: Importer when scancast-sandbox is not there or says nothing.
Expected<SandboxReport> askSandbox(const ImportOptions& options = {});

}  // namespace scancast
