// PLY to point stream, vertex by vertex: the file is never in memory as a whole. Binary vertices without lists are rows of
// numbers (raw_rows.hpp); everything else is read by PCL's PLY parser.
#pragma once

#include <string>

#include "protocol/error.hpp"
#include "renderer/cloud/import/stream/point_stream_writer.hpp"

namespace scancast::import_pcl {

/// Writes the whole stream but a failure record. With `recover`, of a file that ends too early what is whole, and a note on
/// what is lost. Errors without the file's name.
Expected<void> importPly(const std::string& file, PointStreamWriter& writer, bool recover);

}  // namespace scancast::import_pcl
