#include "renderer/cloud/import/stream/point_stream_writer.hpp"

#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <string>

#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/stream/point_stream.hpp"

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

Expected<void> PointStreamWriter::writeHeader(const ScanHeader& header) {
    assert(!headerSent_);
    headerSent_ = true;
    attributes_ = header.attributes;
    return send(stream::encodeHeader(header));
}

Expected<void> PointStreamWriter::writeChunk(const PointBatch& batch) {
    const auto n = batch.size();
    assert(headerSent_ && n <= stream::chunkPoints);
    if (n == 0) return {};
    const auto count = static_cast<std::uint32_t>(n);
    buffer_.clear();
    append(stream::chunkTag.data(), 4);
    append(&count, 4);
    append(batch.position.data(), n * sizeof(glm::dvec3));
    if (attributes_.color) append(batch.color.data(), n * 3);
    if (attributes_.intensity) append(batch.intensity.data(), n * 2);
    if (attributes_.classification) append(batch.classification.data(), n);
    if (attributes_.normal) append(batch.normal.data(), n * sizeof(glm::vec3));
    append(batch.rows.data(), batch.rows.size());
    points_ += n;
    return send(buffer_);
}

Expected<void> PointStreamWriter::writeNote(std::string_view sentence) {
    assert(headerSent_);
    const auto text = printableText(sentence, stream::longestNote);
    if (text.empty()) return {};
    const auto bytes = static_cast<std::uint32_t>(text.size());
    buffer_.clear();
    append(stream::noteTag.data(), 4);
    append(&bytes, 4);
    append(text.data(), text.size());
    return send(buffer_);
}

Expected<void> PointStreamWriter::finish(std::uint64_t droppedPoints) {
    const std::uint32_t nothing = 0;
    buffer_.clear();
    append(stream::doneTag.data(), 4);
    append(&nothing, 4);
    append(&points_, 8);
    append(&droppedPoints, 8);
    return send(buffer_);
}

Expected<void> PointStreamWriter::writeFailure(const Error& error) {
    if (!headerSent_)
        if (auto ok = writeHeader({}); !ok) return ok;
    auto text = printableText(error.message, stream::longestFailure);
    if (text.empty()) text = "it failed without saying why";
    const auto bytes = static_cast<std::uint32_t>(text.size());
    const auto code = stream::failureCode(error.code);
    buffer_.clear();
    append(stream::failTag.data(), 4);
    append(&bytes, 4);
    append(&code, 4);
    append(text.data(), text.size());
    return send(buffer_);
}

}  // namespace scancast
