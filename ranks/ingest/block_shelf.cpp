#include "ranks/ingest/block_shelf.hpp"

#include <algorithm>
#include <limits>

#include "renderer/cloud/file/file_layout.hpp"

namespace scancast {

Expected<BlockPlace> BlockShelf::append(std::span<const std::byte> block) {
    if (block.size() > std::numeric_limits<std::uint32_t>::max())
        return fail(ErrorCode::ResourceLimit,
                    "a node is too large for a cloud file: its block has 4 GiB or more");
    if (block.empty()) return BlockPlace{};
    const BlockPlace place{bytes_, std::uint32_t(block.size()), checksumOf(block)};
    while (!block.empty()) {
        const std::uint64_t at = bytes_ % boardBytes;
        if (at == 0) {
            auto board = workspace_.allocate(boardBytes);
            if (!board) return passOn(board);
            boards_.push_back(std::move(*board));
        }
        const auto some = block.first(std::min<std::size_t>(block.size(), boardBytes - at));
        if (auto ok = boards_.back().write(at, some); !ok) return passOn(ok);
        bytes_ += some.size();
        block = block.subspan(some.size());
    }
    return place;
}

Expected<void> BlockShelf::read(std::uint64_t offset, std::span<std::byte> into) const {
    if (offset > bytes_ || into.size() > bytes_ - offset)
        return fail(ErrorCode::Internal, "A block was looked for where none is.");
    while (!into.empty()) {
        const std::uint64_t at = offset % boardBytes;
        const auto some = into.first(std::min<std::size_t>(into.size(), boardBytes - at));
        if (auto ok = boards_[offset / boardBytes].read(at, some); !ok) return ok;
        offset += some.size();
        into = into.subspan(some.size());
    }
    return {};
}

Expected<std::vector<std::byte>> BlockShelf::readBack(const BlockPlace& place) const {
    std::vector<std::byte> block(place.bytes);
    if (auto ok = read(place.offset, block); !ok) return passOn(ok);
    if (checksumOf(block) != place.checksum)
        return fail(
            ErrorCode::Io,
            "What was set aside a moment ago reads back differently; is the disk of --scratch failing?");
    return block;
}

}  // namespace scancast
