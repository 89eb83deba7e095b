// Out again: a cloud file, or a scan, as a file that other programs read. `scancast export` without the command line.
// Pipeline: cloud file → points → region → **writer** → LAS, PLY, text. Called on any thread.
//
// Streamed: memory is that of a few batches, whatever the size. The points' order, and with it every byte, is the cloud
// file's own: neither threads nor memory show. The file is there when it is whole, or not at all.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/cloud/export/cloud_points.hpp"
#include "renderer/cloud/export/export_writer.hpp"
#include "renderer/cloud/export/region.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/progress.hpp"

namespace scancast {

/// By the end of a file's name, in upper or lower case. Unsupported, with the way out, for formats that nobody here writes;
/// InvalidArgument for names that tell none.
Expected<ExportFormat> exportFormatOf(const std::string& name);

struct ExportOptions {
    std::string output;  ///< a file, a device, or "-": standard output
    ExportFormat format = ExportFormat::Las;
    PointsRegion region{};
    bool estimatedNormals = false;  ///< of cloud files: those too that ingest estimated
    /// Of cloud files: only what lies in it, with stations and offsets.
    std::shared_ptr<const Corridor> corridor{};
};

struct ExportReport {
    std::uint64_t points = 0, bytes = 0;
    double seconds = 0;
    std::vector<std::string> losses;  ///< against the scan as it was, one sentence each without an end
};

/// What is read of a cloud file for these options.
CloudPointsOptions cloudPointsOptions(const ExportOptions& options, std::stop_token stop = {});

/// Errors: CloudFile's, where a block is damaged; Empty where no point is in the region; InvalidArgument; Io;
/// ResourceLimit (a full disk); Cancelled. Nothing is left by any of them, but for what devices and pipes have got.
Expected<ExportReport> exportCloud(std::shared_ptr<const CloudFile> file, const ExportOptions& options,
                                   const ProgressSink& progress = {}, std::stop_token stop = {});

/// Opens the scan from its beginning: once, or twice where heads of files want to know what is only known at the end.
using OpenPoints = std::function<Expected<std::unique_ptr<PointSource>>()>;
/// Errors: the same, and the source's.
Expected<ExportReport> exportScan(const OpenPoints& open, const ExportOptions& options,
                                  const ProgressSink& progress = {}, std::stop_token stop = {});

}  // namespace scancast
