#include "importers/laz/decoder/random_access.hpp"

#include <algorithm>
#include <cstring>

namespace scancast::laz {

Expected<std::size_t> MemoryAccess::readAt(std::uint64_t offset, std::span<std::byte> into) const {
    if (offset >= bytes_.size()) return std::size_t{0};
    const auto there = std::min<std::uint64_t>(into.size(), bytes_.size() - offset);
    const auto count = static_cast<std::size_t>(there);
    if (count > 0) std::memcpy(into.data(), bytes_.data() + offset, count);
    return count;
}

Expected<void> readAll(const RandomAccess& bytes, std::uint64_t offset, std::span<std::byte> into,
                       const char* what) {
    const auto got = bytes.readAt(offset, into);
    if (!got) return passOn(got);
    if (*got == into.size()) return {};
    return fail(ErrorCode::Truncated,
                "it ends at byte " + grouped(offset + *got) + ", within " + std::string(what));
}

}  // namespace scancast::laz
