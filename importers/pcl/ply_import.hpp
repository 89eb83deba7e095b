// PLY to point stream, by PCL's PLY parser, vertex by vertex: the file is never in memory as a whole.
#pragma once

#include <string>

#include "protocol/error.hpp"
#include "renderer/cloud/import/stream/point_stream_writer.hpp"

namespace scancast::import_pcl {

/// Writes the whole stream but a failure record. Errors without the file's name.
Expected<void> importPly(const std::string& file, PointStreamWriter& writer);

}  // namespace scancast::import_pcl
