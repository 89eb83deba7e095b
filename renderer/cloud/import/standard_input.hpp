// A LAS file on standard input. Pipeline: pipe → **import** → staging.
#pragma once

#include "renderer/cloud/import/open_scan.hpp"

namespace scancast {

/// Errors: those of the LAS reader; InvalidArgument where standard input is a terminal.
Expected<std::unique_ptr<PointSource>> openStandardInput(const ImportOptions& options);

}  // namespace scancast
