#include "renderer/cloud/file/cloud_file_writer.hpp"

#include <fcntl.h>
#include <spdlog/fmt/fmt.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <mutex>
#include <string>

#include "files/input_file.hpp"
#include "files/raw_writes.hpp"
#include "files/system_error.hpp"
#include "files/unfinished_file.hpp"
#include "renderer/cloud/file/facts_json.hpp"
#include "renderer/cloud/file/file_layout.hpp"
#include "renderer/cloud/file/node_index.hpp"
#include "renderer/cloud/file/packed_index.hpp"
#include "renderer/cloud/file/plane_index.hpp"

namespace scancast {

namespace {

namespace fs = std::filesystem;

class Writer final : public CloudFileWriter {
  public:
    Writer(UnfinishedFile file, fs::path path)
        : fd_(std::move(file.fd)),
          path_(std::move(path)),
          partialName_(file.name.name()),
          partial_(std::move(file.name)) {}

    Expected<void> begin() {
        // Zeros: what looks at the file before finish() sees no magic.
        const std::array<std::byte, cloudHeaderBytes> nothing{};
        return write(nothing);
    }

    Expected<BlockPlace> append(std::span<const std::byte> block) override {
        if (block.size() > std::numeric_limits<std::uint32_t>::max())
            return fail(ErrorCode::ResourceLimit,
                        "a node is too large for a cloud file: its block has 4 GiB or more");
        if (block.empty()) return BlockPlace{};
        const BlockPlace place{written_, std::uint32_t(block.size()), checksumOf(block)};
        if (auto ok = write(block); !ok) return passOn(ok);
        return place;
    }

    Expected<std::vector<std::byte>> readBack(const BlockPlace& place) const override {
        std::vector<std::byte> block(place.bytes);
        const auto got = readFullyAt(fd_.get(), place.offset, block, partialName_);
        if (!got) return passOn(got);
        if (*got < block.size() || (!block.empty() && checksumOf(block) != place.checksum))
            return fail(ErrorCode::Io,
                        fmt::format("{}, byte {}: what was written there a moment ago reads back "
                                    "differently; is the disk failing, or something else writing?",
                                    partialName_, place.offset));
        return block;
    }

    std::uint64_t bytesWritten() const override { return written_; }

    void withdraw() override {
        const std::lock_guard lock(naming_);
        isWithdrawn_ = true;
        partial_ = {};
    }

    Expected<void> finish(const CloudFacts& facts, std::span<const StoredNode> nodes,
                          std::span<const BlockPlace> planes, const std::stop_token& stop) override {
        if (auto sound = check(facts, nodes, planes); !sound) return sound;
        const auto photos = writePhotos(facts, stop);
        if (!photos) return passOn(photos);
        const auto json = printFacts(facts, programName(), *photos);
        if (!json)
            return fail(json.error().code, path_.string() + " was not written: " + json.error().message);

        CloudFileHeader header;
        header.nodes = std::uint32_t(nodes.size());
        const auto index = packRecords(residualsOf(nodes), packedNodes);
        if (auto ok = writePart(index, header.index); !ok) return ok;
        const auto beside = packRecords(residualsOf(planes, nodes, planesOf(facts).size()), packedPlaces);
        if (auto ok = writePart(beside, header.planes); !ok) return ok;
        if (auto ok = writePart(std::as_bytes(std::span(*json)), header.facts); !ok) return ok;
        header.fileBytes = written_;
        return publish(header);
    }

  private:
    /// A file that open() would refuse is not worth finishing; a fault of the builder shows here.
    Expected<void> check(const CloudFacts& facts, std::span<const StoredNode> nodes,
                         std::span<const BlockPlace> planes) const {
        if (nodes.size() > noNode - 1)
            return fail(ErrorCode::ResourceLimit, "the cloud has too many nodes for a cloud file");
        auto sound = checkNodes(nodes, facts, written_);
        if (sound) sound = checkPlaces(planes, listsBesideSamples(facts, cloudFileVersion), nodes, written_);
        if (sound) return {};
        return fail(ErrorCode::Internal, path_.string() + " was not written: " + sound.error().message);
    }

    /// From wherever they wait, one after the other.
    Expected<std::vector<BlockPlace>> writePhotos(const CloudFacts& facts, const std::stop_token& stop) {
        std::vector<BlockPlace> places;
        for (const Photo& photo : facts.photos) {
            if (stop.stop_requested()) return fail(ErrorCode::Cancelled, "Building the cloud was abandoned.");
            if (!photo.data) return fail(ErrorCode::Internal, path_.string() + ": a photo without its bytes");
            const auto bytes = photo.data->read();
            if (!bytes) return passOn(bytes);
            const auto place = append(*bytes);
            if (!place) return passOn(place);
            places.push_back(*place);
        }
        return places;
    }

    Expected<void> writePart(std::span<const std::byte> bytes, FilePart& part) {
        part = {.offset = written_, .bytes = bytes.size(), .checksum = checksumOf(bytes)};
        return write(bytes);
    }

    /// Everything is on disk before the header says so, and the header before the name does.
    Expected<void> publish(const CloudFileHeader& header) {
        if (auto ok = sync(); !ok) return ok;
        if (auto ok = writeAt(0, encodeHeader(header)); !ok) return ok;
        if (auto ok = sync(); !ok) return ok;
        if (auto ok = takeName(); !ok) return ok;
        const fs::path folder = path_.has_parent_path() ? path_.parent_path() : fs::path(".");
        const UniqueFd entry(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
        // Folders that cannot be opened or synced (some network file systems) have no more to give.
        if (entry) (void)::fsync(entry.get());
        return {};
    }

    Expected<void> takeName() {
        const std::lock_guard lock(naming_);
        // What has the name beside it by now may be somebody else's.
        if (isWithdrawn_) return fail(ErrorCode::Cancelled, "Building the cloud was abandoned.");
        if (const int refused = partial_.become(path_.string()))
            return fail(ErrorCode::Io,
                        fmt::format("{}: cannot get its name: {}", path_.string(), systemReason(refused)));
        return {};
    }

    Expected<void> sync() {
        if (const int refused = syncFile(fd_.get())) return failedToWrite(refused);
        return {};
    }

    Expected<void> write(std::span<const std::byte> bytes) {
        if (auto ok = writeAt(written_, bytes); !ok) return ok;
        written_ += bytes.size();
        return {};
    }

    Expected<void> writeAt(std::uint64_t offset, std::span<const std::byte> bytes) {
        if (const int refused = writeFullyAt(fd_.get(), offset, bytes)) return failedToWrite(refused);
        return {};
    }

    tl::unexpected<Error> failedToWrite(int error) const {
        if (isFull(error))
            return fail(
                ErrorCode::ResourceLimit,
                fmt::format("{}: there is no more room for it after {} bytes ({}); {}. Nothing of it is left",
                            path_.string(), written_, systemReason(error), wayOutOfFull(error)));
        return fail(ErrorCode::Io, fmt::format("{}: cannot be written after {} bytes: {}", path_.string(),
                                               written_, systemReason(error)));
    }

    const UniqueFd fd_;
    const fs::path path_;
    const std::string partialName_;  ///< for messages
    std::mutex naming_;
    bool isWithdrawn_ = false;
    /// Removed while the file is still locked: whoever waits for this name takes over an inode that has none,
    /// notices, and starts anew.
    UnfinishedName partial_;
    std::uint64_t written_ = 0;
};

/// Renaming would replace whatever has the name: only a file may be replaced.
Expected<void> checkTarget(const fs::path& path) {
    struct stat info {};
    if (!path.has_filename())
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("'{}' names no file; give one, for example cloud.scan", path.string()));
    if (::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode))
        return fail(ErrorCode::InvalidArgument,
                    path.string() +
                        ": there is a folder or a device of this name; give another, for example cloud.scan");
    return {};
}

}  // namespace

Expected<std::unique_ptr<CloudFileWriter>> CloudFileWriter::create(const fs::path& path, Readers readers) {
    if (auto ok = checkTarget(path); !ok) return passOn(ok);
    auto file = takeUnfinished(path, readers);
    if (!file) return passOn(file);
    auto writer = std::make_unique<Writer>(std::move(*file), path);
    if (auto ok = writer->begin(); !ok) return passOn(ok);
    return writer;
}

}  // namespace scancast
