// The points behind a PCD header, slice by slice: only compressed files are in memory as a whole. Text and what is compressed
// is decoded by PCL's reader; binary bodies are rows of numbers (raw_rows.hpp). Used on one thread.
#pragma once

#include <string>

#include "importers/pcl/pcd_header.hpp"
#include "importers/pcl/raw_rows.hpp"
#include "protocol/error.hpp"

namespace scancast::import_pcl {

/// Calls `sink` for every point of the file, in order. Errors without the file's name; the sink's own.
Expected<void> readPcdPoints(const std::string& file, std::uint64_t fileBytes, const PcdHeader& header,
                             const RawPointSink& sink);

/// How many points are whole before the file ends, at most as many as promised. Compressed ones come value by value of all
/// points: there it is all of them or, as Truncated, none.
Expected<std::uint64_t> wholePcdPoints(const std::string& file, std::uint64_t fileBytes,
                                       const PcdHeader& header);

}  // namespace scancast::import_pcl
