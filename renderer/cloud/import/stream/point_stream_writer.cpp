#include "renderer/cloud/import/stream/point_stream_writer.hpp"

#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <string>

#include "files/bytes.hpp"
#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/stream/stream_photos.hpp"
#include "renderer/cloud/import/stream/stream_stations.hpp"

namespace scancast {

namespace stream = point_stream;

PointStreamWriter::Sink PointStreamWriter::toDescriptor(int fd) {
    return [fd](std::span<const std::byte> bytes) {
        while (!bytes.empty()) {
            const auto written = ::write(fd, bytes.data(), bytes.size());
            if (written < 0 && errno == EINTR) continue;
            if (written <= 0) return false;
            bytes = bytes.subspan(static_cast<std::size_t>(written));
        }
        return true;
    };
}

Expected<void> PointStreamWriter::send(std::span<const std::byte> bytes) {
    if (sink_(bytes)) return {};
    return fail(ErrorCode::Io, "the reader of the point stream is gone");
}

void PointStreamWriter::append(const void* bytes, std::size_t count) {
    const auto* from = static_cast<const std::byte*>(bytes);
    buffer_.insert(buffer_.end(), from, from + count);
}

Expected<void> PointStreamWriter::writeHeader(const ScanHeader& header, bool newest) {
    assert(!headerSent_);
    headerSent_ = true;
    attributes_ = header.attributes;
    return send(stream::encodeHeader(header, false, newest));
}

Expected<void> PointStreamWriter::writeHeaderOfSteps(const ScanHeader& header) {
    assert(!headerSent_);
    headerSent_ = true;
    attributes_ = header.attributes;
    grid_ = {header.gridOrigin, header.gridStep};
    return send(stream::encodeHeader(header, true));
}

Expected<void> PointStreamWriter::writeLasHeader(const stream::LasPreamble& las) {
    constexpr std::size_t atRecordBytes = 105;  // of the head
    assert(!headerSent_ && las.head.size() >= atRecordBytes + 2);
    headerSent_ = true;
    lasRecordBytes_ = loadLe<std::uint16_t>(las.head.data() + atRecordBytes);
    return send(stream::encodeLasHeader(las));
}

void PointStreamWriter::startRecord(const std::array<char, 4>& tag, std::size_t n) {
    assert(headerSent_);
    const auto count = static_cast<std::uint32_t>(n);
    buffer_.clear();
    append(tag.data(), tag.size());
    append(&count, 4);
}

Expected<void> PointStreamWriter::writeChunk(const PointBatch& batch) {
    if (batch.size() == 0) return {};
    points_ += batch.size();
    return writePoints(stream::chunkTag, batch);
}

Expected<void> PointStreamWriter::writeGlance(const PointBatch& batch) {
    if (batch.size() == 0) return {};
    return writePoints(stream::glanceTag, batch);
}

Expected<void> PointStreamWriter::endGlance() {
    startRecord(stream::glanceTag, 0);
    return send(buffer_);
}

Expected<void> PointStreamWriter::writeRecords(std::span<const std::byte> records) {
    points_ += records.size() / lasRecordBytes_;
    return writeSomeRecords(stream::recordsTag, records);
}

Expected<void> PointStreamWriter::writeGlanceOfRecords(std::span<const std::byte> records) {
    return writeSomeRecords(stream::glanceTag, records);
}

// The records themselves are sent from where they are.
Expected<void> PointStreamWriter::writeSomeRecords(const std::array<char, 4>& tag,
                                                   std::span<const std::byte> records) {
    assert(lasRecordBytes_ > 0 && records.size() % lasRecordBytes_ == 0);
    const auto most = lasRecordBytes_ *
                      std::min<std::size_t>(stream::chunkPoints, stream::longestLasRecords / lasRecordBytes_);
    for (; !records.empty(); records = records.subspan(std::min(most, records.size()))) {
        const auto piece = records.first(std::min(most, records.size()));
        startRecord(tag, piece.size() / lasRecordBytes_);
        if (auto ok = send(buffer_); !ok) return ok;
        if (auto ok = send(piece); !ok) return ok;
    }
    return {};
}

Expected<void> PointStreamWriter::writePeak(std::uint16_t highest) {
    startRecord(stream::peakTag, highest);
    return send(buffer_);
}

Expected<void> PointStreamWriter::writePoints(const std::array<char, 4>& tag, const PointBatch& batch) {
    const auto n = batch.size();
    assert(n <= stream::chunkPoints && lasRecordBytes_ == 0);
    startRecord(tag, n);
    const auto& position = batch.position;
    assert(!grid_ || (position.areSteps() && position.grid() == *grid_));
    if (grid_)
        append(position.asSteps().data(), n * stream::stepBytes);
    else if (position.areSteps())
        position.forEach([&](const glm::dvec3& p) { append(&p, sizeof p); });
    else
        append(position.asDoubles().data(), n * sizeof(glm::dvec3));
    if (attributes_.color) append(batch.color.data(), n * 3);
    if (attributes_.intensity) append(batch.intensity.data(), n * 2);
    if (attributes_.classification) append(batch.classification.data(), n);
    if (attributes_.normal) append(batch.normal.data(), n * sizeof(glm::vec3));
    append(batch.rows.data(), batch.rows.size());
    return send(buffer_);
}

Expected<void> PointStreamWriter::writeNote(std::string_view sentence) {
    assert(headerSent_);
    const auto text = printableText(sentence, stream::longestNote);
    if (text.empty()) return {};
    startRecord(stream::noteTag, text.size());
    append(text.data(), text.size());
    return send(buffer_);
}

Expected<void> PointStreamWriter::writeStation(const Station& station) {
    const auto text = stream::encodeStation(station);
    startRecord(stream::stationTag, text.size());
    append(text.data(), text.size());
    return send(buffer_);
}

Expected<void> PointStreamWriter::writeFrom(std::optional<std::uint32_t> station) {
    startRecord(stream::fromTag, station.value_or(stream::fromNowhere));
    return send(buffer_);
}

Expected<void> PointStreamWriter::writePhoto(const Photo& photo) {
    const auto text = stream::encodePhoto(photo);
    startRecord(stream::photoTag, text.size());
    append(text.data(), text.size());
    return send(buffer_);
}

Expected<void> PointStreamWriter::startPhotoBytes(std::uint32_t photo) {
    startRecord(stream::photoBytesTag, photo);
    return send(buffer_);
}

Expected<void> PointStreamWriter::finish(std::uint64_t droppedPoints) {
    startRecord(stream::doneTag, 0);
    append(&points_, 8);
    append(&droppedPoints, 8);
    return send(buffer_);
}

Expected<void> PointStreamWriter::writeFailure(const Error& error) {
    if (!headerSent_)
        if (auto ok = writeHeader({}); !ok) return ok;
    auto text = printableText(error.message, stream::longestFailure);
    if (text.empty()) text = "it failed without saying why";
    const auto code = stream::failureCode(error.code);
    startRecord(stream::failTag, text.size());
    append(&code, 4);
    append(text.data(), text.size());
    return send(buffer_);
}

}  // namespace scancast
