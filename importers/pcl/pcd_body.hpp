// The points behind a PCD header, decoded by PCL's reader slice by slice: only compressed files are in memory
// as a whole. Used on one thread.
#pragma once

#include <functional>
#include <string>

#include "importers/pcl/pcd_header.hpp"
#include "protocol/error.hpp"

namespace scancast::import_pcl {

using RawPointSink = std::function<Expected<void>(const RawPoint&)>;

/// Calls `sink` for every point of the file, in order. Errors without the file's name; the sink's own.
Expected<void> readPcdPoints(const std::string& file, std::uint64_t fileBytes, const PcdHeader& header,
                             const RawPointSink& sink);

/// How many points are whole before the file ends, at most as many as promised. Compressed ones come value by value of all
/// points: there it is all of them or, as Truncated, none.
Expected<std::uint64_t> wholePcdPoints(const std::string& file, std::uint64_t fileBytes,
                                       const PcdHeader& header);

}  // namespace scancast::import_pcl
