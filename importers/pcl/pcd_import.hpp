// PCD to point stream: header checked here, points decoded by pcd_body.
#pragma once

#include <string>

#include "protocol/error.hpp"
#include "renderer/cloud/import/stream/point_stream_writer.hpp"

namespace scancast::import_pcl {

/// Writes the whole stream but a failure record. With `recover`, of a file that ends too early what is whole, and a note on
/// what is lost. Errors without the file's name.
Expected<void> importPcd(const std::string& file, PointStreamWriter& writer, bool recover);

}  // namespace scancast::import_pcl
