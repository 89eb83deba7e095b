#include "renderer/cloud/file/file_contents.hpp"

#include <spdlog/fmt/fmt.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <memory>
#include <new>

#include "renderer/cloud/file/file_layout.hpp"
#include "renderer/cloud/file/node_index.hpp"
#include "renderer/cloud/file/packed_index.hpp"

namespace scancast {

namespace {

/// How far ahead of what is read a reader is told; it keeps what it is told of.
constexpr std::uint64_t mostExpected = 8 << 20;

/// What a packed index of so many bytes may take in memory is said in CLOUD_FILE.md.
static_assert(sizeof(StoredNode) <= 30 * leastPackedBytes && sizeof(BlockPlace) <= 30 * leastPackedBytes);

/// What a file says of itself, read part by part. Errors without the file's name.
class Opening {
  public:
    explicit Opening(const RandomReader& reader) : reader_(reader) {}

    /// Index, planes and facts stand side by side at the end: of a file far away they come together.
    void expectAll(const CloudFileHeader& header) const {
        const std::uint64_t first = std::min(header.index.offset, header.facts.offset);
        const std::uint64_t bytes = header.index.bytes + header.planes.bytes + header.facts.bytes;
        if (bytes <= mostExpected) return reader_.expect(first, bytes);
        reader_.expect(header.facts.offset, std::min(header.facts.bytes, mostExpected));
        reader_.expect(header.index.offset, std::min(header.index.bytes, mostExpected));
    }

    /// Somebody may be changing the facts: the file becomes longer before its header does, so the size is asked for
    /// last, and a header that was caught in between is whole a moment later.
    Expected<CloudFileHeader> header() const {
        auto header = headerNow();
        return header || header.error().code != ErrorCode::Malformed ? header : headerNow();
    }

    Expected<StoredFacts> facts(const CloudFileHeader& header) const {
        const FilePart& part = header.facts;
        if (part.bytes > longestFacts)
            return fail(ErrorCode::Malformed,
                        fmt::format("byte {}: the description is too long", part.offset));
        std::vector<std::byte> bytes(part.bytes);
        if (auto ok = whole(part.offset, bytes); !ok) return passOn(ok);
        if (checksumOf(bytes) != part.checksum)
            return fail(
                ErrorCode::Malformed,
                fmt::format("byte {}: the description is damaged, its checksum is wrong", part.offset));
        auto facts = parseFacts({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, header.version);
        if (!facts)
            return fail(facts.error().code,
                        fmt::format("byte {}: the description: {}", part.offset, facts.error().message));
        return facts;
    }

    /// Nodes, and in version 1 the places of their rows.
    Expected<void> nodes(const CloudFileHeader& header, FileContents& into) const {
        into.nodes.reserve(header.nodes);
        if (header.version == 1) into.places.reserve(header.nodes);
        ExpectedNodes expected;
        const auto take = [&](std::span<std::byte, nodeRecordBytes> record) {
            if (header.version >= firstPackedVersion) expected.apply(into.nodes, record, record);
            StoredNode& stored = into.nodes.emplace_back(decodeNode(record));
            if (header.version == 1) {
                into.places.push_back(decodeRowsPlace(record));
                stored.node.confidence = into.facts.facts.oriented ? certainSide : 0;
            }
            return reservedAreZero(record, header.version);
        };
        return records<packedNodes>(header, header.index, header.nodes, "index of nodes", take);
    }

    /// Of nodes that have been read.
    Expected<void> planes(const CloudFileHeader& header, FileContents& into) const {
        const bool packed = header.version >= firstPackedVersion;
        // A length of 32 bits times some thousand planes.
        const std::uint64_t count =
            packed ? std::uint64_t(header.nodes) * into.lists.size() : header.planes.bytes / planeRecordBytes;
        if (packed && header.planes.bytes / leastPackedBytes < count)
            return fail(
                ErrorCode::Malformed,
                fmt::format("byte {}: the index of planes has {} bytes, too few for {} nodes with {} planes",
                            header.planes.offset, header.planes.bytes, header.nodes, into.lists.size()));
        into.places.reserve(count);
        ExpectedPlaces expected(into.nodes, into.lists.size());
        const auto take = [&](std::span<std::byte, planeRecordBytes> record) {
            if (packed) expected.apply(record, record);
            into.places.push_back(decodePlane(record));
            return reservedAreZero(PlaneRecord(record));
        };
        return records<packedPlaces>(header, header.planes, count, "index of planes", take);
    }

  private:
    Expected<CloudFileHeader> headerNow() const {
        std::array<std::byte, cloudHeaderBytes> bytes;
        const auto got = reader_.readAt(0, bytes);
        if (!got) return passOn(got);
        return parseHeader(std::span(bytes).first(*got), reader_.size());
    }

    /// Calls `take` with each of `count` records, which says whether it may be so. In pieces that stay in the cache: an
    /// index of 40 MB takes milliseconds.
    template <PackedLayout layout, class Take>
    Expected<void> records(const CloudFileHeader& header, const FilePart& part, std::uint64_t count,
                           const char* what, Take take) const {
        constexpr std::size_t pieceBytes = 2048 * layout.recordBytes;
        bool clean = true;
        const auto takeAll = [&](std::span<std::byte> all) {
            for (std::size_t at = 0; at < all.size(); at += layout.recordBytes)
                clean = take(all.subspan(at).template first<layout.recordBytes>()) && clean;
        };
        Expected<void> read;
        if (header.version >= firstPackedVersion) {
            RecordUnpacker unpacker(layout, count);
            read = pieces(part, what, layout.longestChunk(), [&](std::span<std::byte> piece, bool last) {
                return unpack(unpacker, piece, last ? 0 : layout.longestChunk(), takeAll);
            });
            if (read && unpacker.left() > 0)
                read = fail(ErrorCode::Malformed,
                            fmt::format("byte {}: the {} ends before its last record", part.offset, what));
        } else {
            read = pieces(part, what, pieceBytes, [&](std::span<std::byte> piece, bool) {
                takeAll(piece);
                return Expected<std::size_t>(piece.size());
            });
        }
        if (!read || clean) return read;
        return fail(ErrorCode::Malformed,
                    fmt::format("byte {}: the {} has something where zeros must be", part.offset, what));
    }

    /// Chunks while `piece` has more than `keep` bytes, which may be half a chunk; how many bytes they took.
    template <class TakeAll>
    static Expected<std::size_t> unpack(RecordUnpacker& unpacker, std::span<const std::byte> piece,
                                        std::size_t keep, TakeAll takeAll) {
        auto left = piece;
        while (!left.empty() && left.size() >= keep) {
            const auto chunk = unpacker.next(left);
            if (!chunk) return passOn(chunk);
            takeAll(*chunk);
        }
        return piece.size() - left.size();
    }

    /// A part front to back: calls `take` with up to `most` bytes that it has not taken yet, and whether they are the last
    /// ones; it says how many it took. What it objects to counts where the checksum is right.
    template <class Take>
    Expected<void> pieces(const FilePart& part, const char* what, std::size_t most, Take take) const {
        const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> hash(XXH3_createState(),
                                                                            &XXH3_freeState);
        if (!hash) throw std::bad_alloc();
        XXH3_64bits_reset(hash.get());
        std::vector<std::byte> space(std::min<std::uint64_t>(most, part.bytes));
        Expected<std::size_t> taken = 0;
        std::size_t kept = 0;
        for (std::uint64_t done = 0; done < part.bytes;) {
            reader_.expect(part.offset + done, std::min(part.bytes - done, mostExpected));
            const auto piece = std::span(space).subspan(kept).first(
                std::min<std::uint64_t>(space.size() - kept, part.bytes - done));
            if (auto ok = whole(part.offset + done, piece); !ok) return ok;
            XXH3_64bits_update(hash.get(), piece.data(), piece.size());
            done += piece.size();
            const auto here = std::span(space).first(kept + piece.size());
            if (taken) taken = take(here, done == part.bytes);
            const auto left = here.subspan(taken.value_or(here.size()));
            std::copy(left.begin(), left.end(), space.begin());
            kept = left.size();
        }
        if (XXH3_64bits_digest(hash.get()) != part.checksum)
            return fail(ErrorCode::Malformed,
                        fmt::format("byte {}: the {} is damaged, its checksum is wrong", part.offset, what));
        if (!taken)
            return fail(taken.error().code, fmt::format("byte {}: the {} cannot be unpacked: {}", part.offset,
                                                        what, taken.error().message));
        return {};
    }

    Expected<void> whole(std::uint64_t offset, std::span<std::byte> into) const {
        const auto got = reader_.readAt(offset, into);
        if (!got) return passOn(got);
        if (*got < into.size())
            return fail(ErrorCode::Truncated,
                        fmt::format("the file ends at byte {}, within its index", offset + *got));
        return {};
    }

    const RandomReader& reader_;
};

Expected<void> checkPhotos(const std::vector<BlockPlace>& photos, std::uint64_t blocksEnd) {
    for (std::size_t i = 0; i < photos.size(); ++i)
        if (photos[i].offset < cloudHeaderBytes || photos[i].offset > blocksEnd ||
            photos[i].bytes > blocksEnd - photos[i].offset)
            return fail(
                ErrorCode::Malformed,
                fmt::format("photo {} is said to be at byte {}, outside of the blocks", i, photos[i].offset));
    return {};
}

Expected<FileContents> readOnce(const RandomReader& reader) {
    const Opening opening(reader);
    const auto header = opening.header();
    if (!header) return passOn(header);
    FileContents contents;
    contents.version = header->version;
    opening.expectAll(*header);
    auto facts = opening.facts(*header);
    if (!facts) return passOn(facts);
    contents.facts = std::move(*facts);
    contents.lists = listsBesideSamples(contents.facts.facts, header->version);
    if (auto ok = opening.nodes(*header, contents); !ok) return passOn(ok);
    if (header->version != 1)
        if (auto ok = opening.planes(*header, contents); !ok) return passOn(ok);
    const std::uint64_t blocksEnd = header->index.offset;
    if (auto ok = checkPhotos(contents.facts.photos, blocksEnd); !ok) return passOn(ok);
    if (auto ok = checkNodes(contents.nodes, contents.facts.facts, blocksEnd); !ok) return passOn(ok);
    if (auto ok = checkPlaces(contents.places, contents.lists, contents.nodes, blocksEnd); !ok)
        return passOn(ok);
    return contents;
}

/// What is kept of the index; true = it may be another when it is read again.
bool forgetIndex(const RandomReader& reader) {
    if (!reader.forget(0, cloudHeaderBytes)) return false;
    const auto header = Opening(reader).header();
    if (!header) return true;
    for (const FilePart& part : {header->index, header->planes, header->facts})
        reader.forget(part.offset, part.bytes);
    return true;
}

}  // namespace

// What came over a network, and is kept of it, may be sound the second time.
Expected<FileContents> readContents(const RandomReader& reader) {
    auto contents = readOnce(reader);
    if (contents) return contents;
    const ErrorCode code = contents.error().code;
    if (code != ErrorCode::Malformed && code != ErrorCode::Truncated) return contents;
    return forgetIndex(reader) ? readOnce(reader) : std::move(contents);
}

}  // namespace scancast
