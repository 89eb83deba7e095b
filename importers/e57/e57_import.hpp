// E57 to point stream: all scans of a file, one after the other, each put where its pose says; the file is never in memory
// as a whole. Pipeline: file → **importer** → point stream.
#pragma once

#include <memory>

#include "protocol/error.hpp"
#include "renderer/cloud/import/byte_source.hpp"
#include "renderer/cloud/import/stream/point_stream_writer.hpp"

namespace scancast::import_e57 {

struct Choices {
    bool keepAttributes = false;
    /// Of a file that is damaged or cut, what is whole; notes say how much that is.
    bool recover = false;
};

/// Writes the whole stream but a failure record. Errors without the file's name.
Expected<void> importE57(std::unique_ptr<ByteSource> file, const Choices& choices, PointStreamWriter& writer);

}  // namespace scancast::import_e57
