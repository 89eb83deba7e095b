#include "renderer/cloud/file/cloud_file.hpp"

#include <spdlog/fmt/fmt.h>
#include <xxhash.h>

#include <algorithm>
#include <new>
#include <string>

#include "renderer/cloud/file/block_codec.hpp"
#include "renderer/cloud/file/facts_json.hpp"
#include "renderer/cloud/file/file_layout.hpp"
#include "renderer/cloud/file/node_index.hpp"
#include "renderer/cloud/file/random_reader.hpp"

namespace scancast {

namespace {

namespace fs = std::filesystem;

class StoredCloudFile final : public CloudFile {
  public:
    StoredCloudFile(std::unique_ptr<RandomReader> reader, fs::path path, StoredFacts facts,
                    std::vector<StoredNode> nodes)
        : reader_(std::move(reader)),
          path_(std::move(path)),
          facts_(std::move(facts)),
          nodes_(std::move(nodes)),
          rowBytes_(rowBytes(facts_.facts.columns)) {}

    const fs::path& path() const override { return path_; }
    std::uint64_t bytes() const override { return reader_->size(); }
    const CloudFacts& facts() const override { return facts_.facts; }
    std::string_view writtenBy() const override { return facts_.writtenBy; }
    std::span<const StoredNode> nodes() const override { return nodes_; }

    Expected<std::vector<Sample>> samples(std::uint32_t node) const override {
        return guarded<std::vector<Sample>>([&]() -> Expected<std::vector<Sample>> {
            const auto block = read(node, &StoredNode::samples, "samples");
            if (!block) return passOn(block);
            std::vector<Sample> samples(nodes_[node].node.sampleCount);
            if (auto done = decodeSamples(*block, samples); !done)
                return damaged(node, nodes_[node].samples, "samples", done.error());
            return samples;
        });
    }

    Expected<std::vector<std::byte>> rows(std::uint32_t node) const override {
        return guarded<std::vector<std::byte>>([&]() -> Expected<std::vector<std::byte>> {
            const auto block = read(node, &StoredNode::rows, "rows");
            if (!block) return passOn(block);
            if (block->empty()) return std::vector<std::byte>();
            auto rows = decodeRows(*block, rowBytes_, nodes_[node].node.sampleCount);
            if (!rows) return damaged(node, nodes_[node].rows, "rows", rows.error());
            return rows;
        });
    }

  private:
    template <class T, class Work>
    Expected<T> guarded(Work work) const {
        try {
            return work();
        } catch (const std::bad_alloc&) {
            return fail(ErrorCode::ResourceLimit,
                        path_.string() + ": there is not enough memory for one block of it");
        }
    }

    tl::unexpected<Error> damaged(std::uint32_t node, const BlockPlace& place, const char* what,
                                  const Error& error) const {
        return fail(error.code, fmt::format("{}, node {}, {} at byte {}: {}", path_.string(), node, what,
                                            place.offset, error.message));
    }

    Expected<std::vector<std::byte>> read(std::uint32_t node, BlockPlace StoredNode::*which,
                                          const char* what) const {
        if (node >= nodes_.size())
            return fail(ErrorCode::InvalidArgument,
                        fmt::format("{} has {} nodes, and no node {}", path_.string(), nodes_.size(), node));
        const BlockPlace& place = nodes_[node].*which;
        std::vector<std::byte> block(place.bytes);
        const auto got = reader_->readAt(place.offset, block);
        if (!got) return damaged(node, place, what, got.error());
        if (*got < block.size())
            return damaged(
                node, place, what,
                {ErrorCode::Truncated, fmt::format("the file ends at byte {}", place.offset + *got), {}});
        if (!block.empty() && checksumOf(block) != place.checksum)
            return damaged(node, place, what,
                           {ErrorCode::Malformed, "its checksum is wrong; the block is damaged", {}});
        return block;
    }

    const std::unique_ptr<RandomReader> reader_;
    const fs::path path_;
    const StoredFacts facts_;
    const std::vector<StoredNode> nodes_;
    const std::size_t rowBytes_;
};

/// What a file says of itself, read part by part. Errors without the file's name.
class Opening {
  public:
    explicit Opening(const RandomReader& reader) : reader_(reader) {}

    Expected<CloudFileHeader> header() const {
        std::array<std::byte, cloudHeaderBytes> bytes;
        const auto got = reader_.readAt(0, bytes);
        if (!got) return passOn(got);
        return parseHeader(std::span(bytes).first(*got), reader_.size());
    }

    Expected<StoredFacts> facts(const CloudFileHeader& header) const {
        if (header.factsBytes > longestFacts)
            return fail(ErrorCode::Malformed,
                        fmt::format("byte {}: the description is too long", header.factsOffset));
        std::vector<std::byte> bytes(header.factsBytes);
        if (auto ok = whole(header.factsOffset, bytes); !ok) return passOn(ok);
        if (checksumOf(bytes) != header.factsChecksum)
            return fail(ErrorCode::Malformed,
                        fmt::format("byte {}: the description is damaged, its checksum is wrong",
                                    header.factsOffset));
        auto facts = parseFacts({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
        if (!facts)
            return fail(facts.error().code, fmt::format("byte {}: the description: {}", header.factsOffset,
                                                        facts.error().message));
        return facts;
    }

    /// In pieces that stay in the cache: an index of 40 MB takes milliseconds.
    Expected<std::vector<StoredNode>> nodes(const CloudFileHeader& header) const {
        constexpr std::size_t pieceNodes = 2048;
        const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> hash(XXH3_createState(),
                                                                            &XXH3_freeState);
        if (!hash) throw std::bad_alloc();
        XXH3_64bits_reset(hash.get());
        std::vector<StoredNode> nodes;
        nodes.reserve(header.nodes);
        std::vector<std::byte> piece(std::min<std::size_t>(pieceNodes, header.nodes) * nodeRecordBytes);
        bool clean = true;
        while (nodes.size() < header.nodes) {
            const auto bytes =
                std::span(piece).first(std::min(pieceNodes, header.nodes - nodes.size()) * nodeRecordBytes);
            if (auto ok = whole(header.index.offset + nodes.size() * nodeRecordBytes, bytes); !ok)
                return passOn(ok);
            XXH3_64bits_update(hash.get(), bytes.data(), bytes.size());
            for (std::size_t at = 0; at < bytes.size(); at += nodeRecordBytes) {
                const auto record = bytes.subspan(at).first<nodeRecordBytes>();
                nodes.push_back(decodeNode(record));
                clean = clean && reservedAreZero(record);
            }
        }
        if (XXH3_64bits_digest(hash.get()) != header.index.checksum || !clean)
            return fail(ErrorCode::Malformed,
                        fmt::format("byte {}: the index of nodes is damaged, its checksum is wrong",
                                    header.index.offset));
        return nodes;
    }

  private:
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

Expected<std::shared_ptr<const CloudFile>> openChecked(std::unique_ptr<RandomReader> reader,
                                                       const fs::path& name) {
    const Opening opening(*reader);
    const auto header = opening.header();
    if (!header) return passOn(header);
    auto facts = opening.facts(*header);
    if (!facts) return passOn(facts);
    auto nodes = opening.nodes(*header);
    if (!nodes) return passOn(nodes);
    if (auto ok = checkNodes(*nodes, facts->facts, header->index.offset); !ok) return passOn(ok);
    return std::make_shared<StoredCloudFile>(std::move(reader), name, std::move(*facts), std::move(*nodes));
}

}  // namespace

Expected<std::shared_ptr<const CloudFile>> CloudFile::open(std::unique_ptr<RandomReader> reader,
                                                           const fs::path& name) {
    try {
        auto file = openChecked(std::move(reader), name);
        if (!file) return fail(file.error().code, name.string() + ", " + file.error().message);
        return file;
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::ResourceLimit, name.string() + ": there is not enough memory for its index");
    }
}

Expected<std::shared_ptr<const CloudFile>> CloudFile::open(InputFile file) {
    const fs::path name = file.name();
    return open(readerOf(std::move(file)), name);
}

Expected<std::shared_ptr<const CloudFile>> CloudFile::open(const fs::path& path) {
    auto file = InputFile::open(path);
    if (!file) return passOn(std::move(file));
    return open(std::move(*file));
}

bool isCloudFile(std::span<const std::byte> start) {
    return start.size() >= cloudFileMagic.size() && std::equal(cloudFileMagic.begin(), cloudFileMagic.end(),
                                                               reinterpret_cast<const char*>(start.data()));
}

bool isCloudFile(const InputFile& file) {
    std::array<std::byte, cloudFileMagic.size()> start{};
    const auto got = file.readAt(0, start);
    return got && isCloudFile(std::span(start).first(*got));
}

}  // namespace scancast
