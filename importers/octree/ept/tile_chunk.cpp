#include "importers/octree/ept/tile_chunk.hpp"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

#include "importers/laz/decoder/laz_file.hpp"
#include "protocol/text/grouped.hpp"

namespace scancast::import_octree {

namespace {

using namespace chunk_messages;

Expected<std::vector<std::byte>> decodeLaz(const RequestHead& head, std::span<const std::byte> tile) {
    const auto file = laz::LazFile::open(std::make_shared<laz::MemoryAccess>(tile));
    if (!file) return passOn(file);
    const laz::LasShape& shape = file->shape();
    if (shape.points != head.points)
        return fail(ErrorCode::Malformed, fmt::format("it holds {} points; its hierarchy says {}",
                                                      grouped(shape.points), grouped(head.points)));
    if (std::uint32_t(shape.pointFormat) != head.pointFormat || shape.recordBytes != head.recordBytes)
        return fail(ErrorCode::Malformed, "its records are others than the tiles' before it");
    std::vector<std::byte> records(std::size_t(head.points) * head.recordBytes);
    for (const laz::Chunk& chunk : file->chunks()) {
        const auto into = std::span(records).subspan(std::size_t(chunk.first) * head.recordBytes,
                                                     std::size_t(chunk.points) * head.recordBytes);
        if (auto ok = laz::decodeChunk(*file, chunk, into); !ok) return passOn(ok);
    }
    return records;
}

Expected<std::vector<std::byte>> decodeZstd(const RequestHead& head, std::span<const std::byte> tile) {
    // Room for exactly the records: a frame that has more ends with an error.
    std::vector<std::byte> records(std::size_t(head.points) * head.recordBytes);
    const std::size_t got = ZSTD_decompress(records.data(), records.size(), tile.data(), tile.size());
    if (ZSTD_isError(got) != 0)
        return fail(ErrorCode::Malformed,
                    fmt::format("it cannot be decompressed: {}", ZSTD_getErrorName(got)));
    if (got != records.size())
        return fail(ErrorCode::Malformed,
                    fmt::format("it holds {} bytes; its {} points need {}", grouped(got),
                                grouped(head.points), grouped(records.size())));
    return records;
}

}  // namespace

Expected<std::vector<std::byte>> decodeTile(const RequestHead& head, std::span<const std::byte>,
                                            std::span<const std::byte> tile) {
    if (head.packing == Packing::LazFile) return decodeLaz(head, tile);
    if (head.packing == Packing::Zstd) return decodeZstd(head, tile);
    return fail(ErrorCode::Unsupported, "it is no tile of EPT");
}

}  // namespace scancast::import_octree
