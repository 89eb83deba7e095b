// Writes a point stream (POINT_STREAM.md): the importers' side, and the tests'.
// Owned and used by one thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/cloud/import/stream/point_stream.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

class PointStreamWriter {
  public:
    /// Takes all the bytes; false when nobody wants them any more.
    using Sink = std::function<bool(std::span<const std::byte>)>;

    explicit PointStreamWriter(Sink sink) : sink_(std::move(sink)) {}
    /// A sink that writes to a file descriptor that somebody else owns.
    static Sink toDescriptor(int fd);

    /// Once, before anything else. `newest`: as version 2, which stations and photos need.
    Expected<void> writeHeader(const ScanHeader& header, bool newest = false);
    /// In its place: positions of chunks will be steps of the header's grid.
    Expected<void> writeHeaderOfSteps(const ScanHeader& header);
    /// In its place: records of LAS instead of chunks.
    Expected<void> writeLasHeader(const point_stream::LasPreamble& las);
    /// Points to look at first, as many as stream::glancePoints in all; before any chunk.
    Expected<void> writeGlance(const PointBatch& batch);
    /// There are no more of those.
    Expected<void> endGlance();
    /// Any number of points up to PointSource::batchPoints; none is allowed and writes nothing. Columns as
    /// announced.
    Expected<void> writeChunk(const PointBatch& batch);
    /// Any number of whole records of LAS.
    Expected<void> writeRecords(std::span<const std::byte> records);
    /// The same as writeGlance().
    Expected<void> writeGlanceOfRecords(std::span<const std::byte> records);
    /// The highest number of any colour in records of LAS, or any above 255; before them.
    Expected<void> writePeak(std::uint16_t highest);
    /// Something about the scan that whoever reads it should hear: one sentence, without the file's name or
    /// an end.
    Expected<void> writeNote(std::string_view sentence);
    /// A place that the scanner stood at, known by its number from 0. All of them best directly behind the header. Its name is cut to what a
    /// station's may have; its points are counted by who reads them.
    Expected<void> writeStation(const Station& station);
    /// The chunks that follow were recorded from there, one that was sent; nullopt: nobody knows.
    Expected<void> writeFrom(std::optional<std::uint32_t> station);
    /// A photo, known by its number from 0; `photo.bytes` of it will follow. At most mostPhotos, best all of them directly behind the stations.
    Expected<void> writePhoto(const Photo& photo);
    /// All bytes of a photo that was sent come next, in pieces of any size: writePhotoPiece().
    Expected<void> startPhotoBytes(std::uint32_t photo);
    Expected<void> writePhotoPiece(std::span<const std::byte> bytes) { return send(bytes); }
    /// The scan was sound to its end.
    Expected<void> finish(std::uint64_t droppedPoints);
    /// It was not; sends an empty header first if none was sent. `error.message` without the file's name.
    Expected<void> writeFailure(const Error& error);

    std::uint64_t points() const { return points_; }

  private:
    Expected<void> send(std::span<const std::byte> bytes);
    void append(const void* bytes, std::size_t count);
    void startRecord(const std::array<char, 4>& tag, std::size_t n);
    Expected<void> writePoints(const std::array<char, 4>& tag, const PointBatch& batch);
    Expected<void> writeSomeRecords(const std::array<char, 4>& tag, std::span<const std::byte> records);

    Sink sink_;
    Attributes attributes_;
    std::optional<StepGrid> grid_;    ///< of positions as steps
    std::size_t lasRecordBytes_ = 0;  ///< 0 = no records of LAS
    bool headerSent_ = false;
    std::uint64_t points_ = 0;
    std::vector<std::byte> buffer_;
};

}  // namespace scancast
