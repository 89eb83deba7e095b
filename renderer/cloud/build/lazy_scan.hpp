// A scan that is open only while it is read: hundreds of files in one cloud need neither hundreds of importer
// processes nor descriptors. Pipeline: import → **lazy scan** → many scans. Owned and used by one thread.
#pragma once

#include <functional>
#include <memory>

#include "renderer/cloud/point_batch.hpp"

namespace scancast {

using OpenScan = std::function<Expected<std::unique_ptr<PointSource>>()>;

/// Opens the scan for its header, and again when its first point is wanted. Errors: those of opening.
Expected<std::unique_ptr<PointSource>> lazyScan(OpenScan open);

}  // namespace scancast
