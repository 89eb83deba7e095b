// Reads a point stream (POINT_STREAM.md) and believes nothing in it.
// Pipeline: importer process → **point stream** → points. Owned and used by one thread.
//
// Messages do not name the file; who knows it (ImporterSource) puts its name in front.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/cloud/import/byte_source.hpp"
#include "renderer/cloud/import/las/las_reader.hpp"
#include "renderer/cloud/import/stream/point_stream.hpp"
#include "renderer/cloud/import/stream/stream_photos.hpp"
#include "renderer/cloud/import/stream/stream_stations.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// What is wanted of a point stream.
struct StreamOptions {
    /// More than that is an error, whatever the stream declares.
    std::uint64_t mostPoints = std::numeric_limits<std::uint64_t>::max();
    /// Of records of LAS, fill ScanHeader::columns and PointBatch::rows; whether other streams have any, their importer was told.
    bool keepAttributes = false;
    /// Colours of 16 bits among them.
    bool fullColors = false;
    /// Of all photos together: the same.
    std::uint64_t mostPhotoBytes = std::numeric_limits<std::uint64_t>::max();
    /// Folder of the temporary file in which photos' bytes wait; nullopt: they are passed over.
    std::optional<std::filesystem::path> photos{};
};

class PointStreamReader final : public PointSource {
  public:
    /// Reads the header and looks at the first record, so that a scan that cannot be read fails here.
    static Expected<std::unique_ptr<PointStreamReader>> create(std::unique_ptr<ByteSource> bytes,
                                                               const StreamOptions& options = {});

    const ScanHeader& header() const override { return header_; }
    Expected<PointBatch> glance() override;
    /// Errors: those that the importer reports; Empty; Importer for a stream that breaks its rules or ends
    /// early.
    Expected<bool> read(PointBatch& batch) override;
    /// Known at the end of the stream only.
    std::uint64_t droppedPoints() const override { return las_ ? las_->droppedPoints() : dropped_; }
    std::vector<std::string> notes() const override;
    std::vector<Station> stations() const override { return stations_; }
    /// Their bytes are there at the end of the stream only, if they were wanted, and came.
    std::vector<Photo> photos() const override { return photos_; }
    std::array<std::uint64_t, 2> bytesRead() const override;

  private:
    PointStreamReader(std::unique_ptr<ByteSource> bytes, const StreamOptions& options)
        : bytes_(std::move(bytes)), options_(options), spool_(options.photos) {}

    struct RecordHead {
        std::array<char, 4> tag{};
        std::uint32_t n = 0;
    };

    Expected<void> readHeader();
    Expected<void> readText(std::size_t length, std::size_t longest, std::string& text);
    Expected<void> readScanner();
    /// Of the next record that has points or ends the stream; those before it are taken.
    Expected<void> readHead();
    Expected<void> readNote();
    Expected<void> readStation();
    Expected<void> readFrom();
    Expected<void> readPhoto();
    Expected<void> readPhotoBytes();
    void noteLostPhotos(std::vector<std::string>& notes) const;
    Expected<void> readLas();
    Expected<std::vector<std::byte>> readLasPart(std::uint32_t bytes, const char* what);
    Expected<void> readPeak();
    Expected<void> readRecordsOfLas();
    Expected<void> readPositions(Positions& position, std::size_t count);
    Expected<void> readColumns(PointBatch& batch);
    Expected<void> readExactly(std::span<std::byte> into);
    template <class T>
    Expected<void> readColumn(std::vector<T>& column, bool present, std::size_t count);
    Expected<void> readGlance(PointBatch& batch);
    Expected<void> readChunk(PointBatch& batch);
    Expected<void> readRecord(PointBatch& batch);
    Expected<void> checkChunk(const PointBatch& batch) const;
    Expected<void> readDone();
    Expected<void> readFailure();
    tl::unexpected<Error> wrong(const std::string& reason) const;

    std::unique_ptr<ByteSource> bytes_;
    StreamOptions options_;
    ScanHeader header_;
    bool areSteps_ = false;           ///< positions, of the header's grid
    std::optional<LasReader> las_;    ///< of a stream with records of LAS
    std::vector<std::byte> records_;  ///< of LAS, the last ones read
    bool wasToldPeak_ = false;
    std::size_t rowBytes_ = 0;  ///< of the further columns; 0 = none
    RecordHead head_;           ///< of the next record; all 0: not read yet
    std::uint64_t at_ = 0;      ///< bytes read
    std::uint64_t points_ = 0;
    std::uint64_t dropped_ = 0;
    std::vector<std::string> notes_;
    std::vector<Station> stations_;
    std::vector<Photo> photos_;
    std::uint64_t photoBytes_ = 0;  ///< of all that were described
    std::vector<bool> photosCame_;  ///< by photo: whether its bytes did
    PhotoSpool spool_;
    std::uint32_t from_ =
        point_stream::fromNowhere;  ///< index of the station that chunks come from, or fromNowhere
    std::uint16_t version_ = 0;
    bool done_ = false;
};

}  // namespace scancast
