// Writes a point stream (POINT_STREAM.md): the importers' side, and the tests'.
// Owned and used by one thread.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

class PointStreamWriter {
  public:
    /// Takes all the bytes; false when nobody wants them any more.
    using Sink = std::function<bool(std::span<const std::byte>)>;

    explicit PointStreamWriter(Sink sink) : sink_(std::move(sink)) {}
    /// A sink that writes to a file descriptor that somebody else owns.
    static Sink toDescriptor(int fd);

    /// Once, before anything else.
    Expected<void> writeHeader(const ScanHeader& header);
    /// Any number of points up to PointSource::batchPoints; none is allowed and writes nothing. Columns as
    /// announced.
    Expected<void> writeChunk(const PointBatch& batch);
    /// Something about the scan that whoever reads it should hear: one sentence, without the file's name or
    /// an end.
    Expected<void> writeNote(std::string_view sentence);
    /// The scan was sound to its end.
    Expected<void> finish(std::uint64_t droppedPoints);
    /// It was not; sends an empty header first if none was sent. `error.message` without the file's name.
    Expected<void> writeFailure(const Error& error);

    std::uint64_t points() const { return points_; }

  private:
    Expected<void> send(std::span<const std::byte> bytes);
    void append(const void* bytes, std::size_t count);

    Sink sink_;
    Attributes attributes_;
    bool headerSent_ = false;
    std::uint64_t points_ = 0;
    std::vector<std::byte> buffer_;
};

}  // namespace scancast
