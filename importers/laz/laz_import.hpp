// A LAZ file to the point stream: its head, points to look at first, how bright its colours are, then all records, decoded by
// many threads and sent in their order. What records mean is for who reads the stream. Pipeline: LAZ file → **records** → point stream.
#pragma once

#include <cstddef>
#include <memory>

#include "importers/laz/decoder/laz_file.hpp"
#include "renderer/cloud/import/stream/point_stream_writer.hpp"

namespace scancast::import_laz {

struct ImportLimits {
    std::size_t threads = 1;
    /// Bytes of records that may be kept while the scan's colours are looked through, so that they need not be decoded twice.
    std::size_t kept = std::size_t(128) << 20;
    /// Bytes of records that are decoded at once, or one record.
    std::size_t piece = std::size_t(1) << 20;
    /// Points from which on a scan has some to look at first; smaller ones are there at once.
    std::uint64_t fewestToGlanceAt = 1'000'000;
    /// Of a file that ends too early, what is whole; a note says how much that is.
    bool recover = false;
};

/// Everything but the end of a stream that fails, which is the caller's. Errors: LazFile's, LazDecoder's, the writer's; without the file's name.
Expected<void> importLaz(std::shared_ptr<const laz::RandomAccess> bytes, const ImportLimits& limits,
                         PointStreamWriter& writer);

}  // namespace scancast::import_laz
