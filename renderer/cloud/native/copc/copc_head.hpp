// The part of a COPC file that LAS and LAZ share with it: the header, the coordinate reference system, how records are packed. Read and held
// against what can be shown. Waits for the reader. Pipeline: COPC file → **head** → chunks, facts.
#pragma once

#include "files/random_reader.hpp"
#include "renderer/cloud/import/las/las_reader.hpp"
#include "renderer/cloud/native/chunk_decoders.hpp"
#include "renderer/cloud/native/copc/copc_layout.hpp"

namespace scancast {

struct CopcHead {
    CopcInfo info;
    LasReader las;  ///< understood
    ChunkShape shape;
    std::uint64_t digest = 0;  ///< XXH3, 64 bits, of all that stands before the points
};

/// Errors without the file's name: Unsupported (no COPC), Malformed, Truncated, Empty; the reader's.
Expected<CopcHead> readCopcHead(const RandomReader& reader);

}  // namespace scancast
