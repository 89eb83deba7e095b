#include "importers/laz/laz_chunk.hpp"

#include <memory>

#include "importers/laz/decoder/laz_file.hpp"

namespace scancast::import_laz {

Expected<std::vector<std::byte>> decodeChunk(const chunk_messages::RequestHead& head,
                                             std::span<const std::byte> laszip,
                                             std::span<const std::byte> chunk) {
    if (head.packing != chunk_messages::Packing::LazChunk)
        return fail(ErrorCode::Unsupported, "it is no chunk of LAZ");
    const auto file = laz::LazFile::ofChunk(std::make_shared<laz::MemoryAccess>(chunk), int(head.pointFormat),
                                            head.recordBytes, head.points, laszip);
    if (!file) return passOn(file);
    std::vector<std::byte> records(std::size_t(head.points) * head.recordBytes);
    if (auto ok = laz::decodeChunk(*file, file->chunks().front(), records); !ok) return passOn(ok);
    return records;
}

}  // namespace scancast::import_laz
