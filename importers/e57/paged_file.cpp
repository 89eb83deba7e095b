#include "importers/e57/paged_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "files/bytes.hpp"
#include "importers/e57/crc32c.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_e57 {

namespace {

constexpr std::uint64_t pagesAtOnce = 256;
constexpr std::uint64_t pagesAtFirst = 8;  ///< somewhere else: perhaps only a section's head is wanted

std::uint32_t checksumOf(std::span<const std::byte> page) {
    const auto stored = loadLe<std::uint32_t>(page.data() + PagedFile::contentBytes);
    return (stored >> 24) | ((stored >> 8) & 0xff00) | ((stored << 8) & 0xff0000) | (stored << 24);
}

}  // namespace

Expected<PagedFile> PagedFile::open(std::unique_ptr<ByteSource> bytes, bool recover) {
    PagedFile paged(std::move(bytes), recover);
    if (auto ok = paged.readHeader(); !ok) return passOn(ok);
    return paged;
}

Expected<void> PagedFile::readHeader() {
    std::array<std::byte, headerBytes> bytes{};
    const auto got = bytes_->readAt(0, bytes);
    if (!got) return passOn(got);
    const auto* data = bytes.data();
    if (std::memcmp(data, "ASTM-E57", std::min<std::size_t>(*got, 8)) != 0)
        return fail(ErrorCode::Malformed, "byte 0: it does not start as an E57 file does");
    if (*got < headerBytes)
        return fail(ErrorCode::Truncated,
                    fmt::format("it ends at byte {}, within its header of {} bytes", *got, headerBytes));
    header_.major = loadLe<std::uint32_t>(data + 8);
    header_.minor = loadLe<std::uint32_t>(data + 12);
    header_.bytes = loadLe<std::uint64_t>(data + 16);
    header_.xmlOffset = loadLe<std::uint64_t>(data + 24);
    header_.xmlBytes = loadLe<std::uint64_t>(data + 32);
    const auto page = loadLe<std::uint64_t>(data + 40);
    if (header_.major != 1 || header_.minor != 0)
        return fail(ErrorCode::Unsupported, fmt::format("byte 8: it is E57 version {}.{}; 1.0 can be read",
                                                        header_.major, header_.minor));
    if (page != pageBytes)
        return fail(ErrorCode::Unsupported,
                    fmt::format("byte 40: its pages have {} bytes; 1,024 can be read", grouped(page)));
    if (header_.bytes == 0 || header_.bytes % pageBytes != 0)
        return fail(ErrorCode::Malformed,
                    fmt::format("byte 16: its header gives it {} bytes, which are no whole pages of 1,024",
                                grouped(header_.bytes)));
    if (header_.bytes <= size_) return {};
    const auto cut = fmt::format("it ends at byte {}: its header gives it {} bytes", grouped(size_),
                                 grouped(header_.bytes));
    const auto descriptionEnd = header_.xmlOffset / pageBytes * contentBytes + header_.xmlOffset % pageBytes +
                                std::min(header_.xmlBytes, logicalBytes());
    if (descriptionEnd > logicalBytesThere())
        return fail(
            ErrorCode::Truncated,
            fmt::format("{}. What describes its scans (XML) began at byte {} and is lost, and without "
                        "it no point can be read, not by --recover either",
                        cut, grouped(header_.xmlOffset)));
    if (!recover_) return fail(ErrorCode::Truncated, cut);
    return {};
}

Expected<std::uint64_t> PagedFile::logicalOffset(std::uint64_t physical, std::string_view what) const {
    if (physical < headerBytes || physical >= header_.bytes || physical % pageBytes >= contentBytes)
        return fail(ErrorCode::Malformed, fmt::format("{} is said to begin at byte {}, where nothing can",
                                                      what, grouped(physical)));
    return physical / pageBytes * contentBytes + physical % pageBytes;
}

Expected<void> PagedFile::loadPages(std::uint64_t page) {
    const bool goesOn = loaded_ > 0 && page == first_ + loaded_;
    const auto count = std::min(goesOn ? pagesAtOnce : pagesAtFirst, pagesThere() - page);
    loaded_ = 0;
    pages_.resize(count * pageBytes);
    const auto got = bytes_->readAt(page * pageBytes, pages_);
    if (!got) return passOn(got);
    if (*got < pages_.size())
        return fail(ErrorCode::Truncated, fmt::format("it ends at byte {}: somebody cut it while it was read",
                                                      grouped(page * pageBytes + *got)));
    sound_.resize(count);
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto bytes = std::span(pages_).subspan(i * pageBytes, pageBytes);
        sound_[i] = crc32c(bytes.first(contentBytes)) == checksumOf(bytes);
    }
    first_ = page;
    loaded_ = count;
    return {};
}

Expected<void> PagedFile::readPages(std::uint64_t logical, std::span<std::byte> into,
                                    std::vector<LostBytes>* lost) {
    const auto end = lost != nullptr ? logicalBytes() : logicalBytesThere();
    if (into.size() > end || logical > end - into.size())
        return fail(ErrorCode::Truncated,
                    fmt::format("it ends at byte {}, within what begins at byte {}",
                                grouped(std::min(header_.bytes, size_)), grouped(physicalOffset(logical))));
    for (std::size_t at = 0; at < into.size();) {
        const auto page = (logical + at) / contentBytes;
        const auto within = static_cast<std::size_t>((logical + at) % contentBytes);
        const auto count = std::min(into.size() - at, contentBytes - within);
        const bool there = page < pagesThere();
        if (there && (page < first_ || page >= first_ + loaded_))
            if (auto ok = loadPages(page); !ok) return ok;
        if (there && isSound(page)) {
            std::memcpy(into.data() + at, pages_.data() + (page - first_) * pageBytes + within, count);
        } else if (lost != nullptr) {
            std::memset(into.data() + at, 0, count);
            if (lost->empty() || lost->back().end != at) lost->push_back({at, at});
            lost->back().end = at + count;
        } else {
            return fail(ErrorCode::Malformed,
                        fmt::format("the page at byte {} is damaged: its checksum is another",
                                    grouped(page * pageBytes)));
        }
        at += count;
    }
    return {};
}

}  // namespace scancast::import_e57
