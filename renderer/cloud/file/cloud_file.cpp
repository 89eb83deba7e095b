#include "renderer/cloud/file/cloud_file.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <new>
#include <string>

#include "files/random_reader.hpp"
#include "renderer/cloud/file/blocks/block_codec.hpp"
#include "renderer/cloud/file/blocks/row_columns.hpp"
#include "renderer/cloud/file/file_contents.hpp"

namespace scancast {

namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::byte>;

std::vector<PlaceInRow> columnsInRow(const CloudFacts& facts) {
    std::vector<ColumnType> types;
    for (const KeptColumn& kept : facts.columns) types.push_back(kept.column.type);
    return placesInRow(types);
}

class StoredPhoto final : public PhotoBytes {
  public:
    StoredPhoto(std::shared_ptr<const RandomReader> reader, const fs::path& path, std::size_t index,
                const BlockPlace& place)
        : reader_(std::move(reader)),
          called_(fmt::format("{}, photo {} at byte {}", path.string(), index, place.offset)),
          place_(place) {}

    Expected<Bytes> read() const override {
        Bytes bytes(place_.bytes);
        const auto got = reader_->readAt(place_.offset, bytes);
        if (!got) return fail(got.error().code, called_ + ": " + got.error().message);
        if (*got < bytes.size()) return fail(ErrorCode::Truncated, called_ + ": the file ends within it");
        if (checksumOf(bytes) != place_.checksum)
            return fail(ErrorCode::Malformed, called_ + ": its checksum is wrong; it is damaged");
        return bytes;
    }

  private:
    const std::shared_ptr<const RandomReader> reader_;
    const std::string called_;
    const BlockPlace place_;
};

class StoredCloudFile final : public CloudFile {
  public:
    StoredCloudFile(std::shared_ptr<const RandomReader> reader, fs::path path, FileContents contents)
        : reader_(std::move(reader)),
          path_(std::move(path)),
          contents_(std::move(contents)),
          planes_(planesOf(facts())),
          columns_(columnsInRow(facts())) {}

    const fs::path& path() const override { return path_; }
    std::uint64_t bytes() const override { return reader_->size(); }
    bool isRemote() const override { return reader_->isRemote(); }
    bool isAway() const override { return reader_->isAway(); }
    const CloudFacts& facts() const override { return contents_.facts.facts; }
    std::string_view writtenBy() const override { return contents_.facts.writtenBy; }
    std::span<const StoredNode> nodes() const override { return contents_.nodes; }
    std::span<const ValuePlane> planes() const override { return planes_; }
    std::span<const BlockPlace> photoPlaces() const override { return contents_.facts.photos; }

    Expected<std::vector<Sample>> samples(std::uint32_t node) const override {
        return guarded<std::vector<Sample>>([&]() -> Expected<std::vector<Sample>> {
            if (auto ok = checkNode(node); !ok) return passOn(ok);
            const StoredNode& stored = nodes()[node];
            const auto block = read(node, stored.samples, "samples");
            if (!block) return passOn(block);
            std::vector<Sample> samples(stored.node.sampleCount);
            if (auto done = decodeSamples(*block, samples); !done)
                return damaged(node, stored.samples, "samples", done.error());
            return samples;
        });
    }

    Expected<Bytes> plane(std::uint32_t node, std::size_t index) const override {
        return guarded<Bytes>([&]() -> Expected<Bytes> {
            if (auto ok = checkNode(node); !ok) return passOn(ok);
            if (auto ok = checkPlane(index); !ok) return passOn(ok);
            auto values = records(node, contents_.listOf(index));
            if (!values || contents_.version != 1) return values;
            return takeColumn(*values, columns_[index]);
        });
    }

    BlockPlace planePlace(std::uint32_t node, std::size_t index) const override {
        return contents_.place(node, contents_.listOf(index));
    }

    Expected<Bytes> rows(std::uint32_t node) const override {
        return guarded<Bytes>([&]() -> Expected<Bytes> {
            if (auto ok = checkNode(node); !ok) return passOn(ok);
            if (contents_.version == 1) return records(node, 0);
            if (columns_.empty() || !nodes()[node].node.isLeaf()) return Bytes();
            Bytes rows(std::size_t(nodes()[node].node.sampleCount) * columns_[0].rowBytes);
            for (std::size_t c = 0; c < columns_.size(); ++c) {
                const auto values = records(node, c);
                if (!values) return passOn(values);
                putColumn(*values, columns_[c], rows);
            }
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

    tl::unexpected<Error> damaged(std::uint32_t node, const BlockPlace& place, std::string_view what,
                                  const Error& error) const {
        return fail(error.code, fmt::format("{}, node {}, {} at byte {}: {}", path_.string(), node, what,
                                            place.offset, error.message));
    }

    Expected<void> checkNode(std::uint32_t node) const {
        if (node < nodes().size()) return {};
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("{} has {} nodes, and no node {}", path_.string(), nodes().size(), node));
    }

    Expected<void> checkPlane(std::size_t index) const {
        if (index < planes_.size()) return {};
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("{} has {} planes, and no plane {}", path_.string(), planes_.size(), index));
    }

    /// A node's block of a list, decoded; empty where there is none.
    Expected<Bytes> records(std::uint32_t node, std::size_t which) const {
        const BlockList& list = contents_.lists[which];
        const BlockPlace& place = contents_.place(node, which);
        if (place.bytes == 0) return Bytes();
        const auto block = read(node, place, list.what);
        if (!block) return passOn(block);
        auto values = decodeRows(*block, list.recordBytes, nodes()[node].node.sampleCount);
        if (!values) return damaged(node, place, list.what, values.error());
        return values;
    }

    Expected<Bytes> read(std::uint32_t node, const BlockPlace& place, std::string_view what) const {
        Bytes block(place.bytes);
        bool isSound = false;
        // What came over a network may be sound the second time.
        for (int tries = 2; tries > 0 && !isSound; --tries) {
            const auto got = reader_->readAt(place.offset, block);
            if (!got) return damaged(node, place, what, got.error());
            if (*got < block.size())
                return damaged(
                    node, place, what,
                    {ErrorCode::Truncated, fmt::format("the file ends at byte {}", place.offset + *got), {}});
            isSound = checksumOf(block) == place.checksum;
            if (!isSound && !reader_->forget(place.offset, place.bytes)) break;
        }
        if (!isSound)
            return damaged(node, place, what,
                           {ErrorCode::Malformed, "its checksum is wrong; the block is damaged", {}});
        return block;
    }

    const std::shared_ptr<const RandomReader> reader_;
    const fs::path path_;
    const FileContents contents_;
    const std::vector<ValuePlane> planes_;
    const std::vector<PlaceInRow> columns_;
};

}  // namespace

Expected<std::shared_ptr<const CloudFile>> CloudFile::open(std::unique_ptr<RandomReader> reader,
                                                           const fs::path& name) {
    try {
        const std::shared_ptr<const RandomReader> shared = std::move(reader);
        auto contents = readContents(*shared);
        if (!contents) return fail(contents.error().code, name.string() + ", " + contents.error().message);
        StoredFacts& facts = contents->facts;
        for (std::size_t i = 0; i < facts.photos.size(); ++i)
            facts.facts.photos[i].data = std::make_shared<StoredPhoto>(shared, name, i, facts.photos[i]);
        return std::make_shared<StoredCloudFile>(shared, name, std::move(*contents));
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
