// The end of an ingest: what the options say goes into the facts, and the file gets its indices and its name. Pipeline: octree →
// **facts, indices** → cloud file.
#pragma once

#include <stop_token>

#include "renderer/cloud/build/cloud_builder.hpp"
#include "renderer/cloud/build/ingest.hpp"

namespace scancast {

/// All blocks are in the file. The report lacks scratchBytes and seconds. Reports the stage "columns", where there are some. Errors: the file's; Cancelled.
Expected<IngestReport> finishFile(BuiltCloud built, const IngestOptions& options, CloudFileWriter& file,
                                  const ProgressSink& progress, const std::stop_token& stop);

}  // namespace scancast
