#include "renderer/cloud/import/stream/frame_reader.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "files/bytes.hpp"
#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/stream/point_stream_reader.hpp"

namespace scancast {

/// All frames read from the same bytes, and whether there are any more is known only by taking one.
class FrameReader::Bytes {
  public:
    explicit Bytes(std::unique_ptr<ByteSource> source) : source_(std::move(source)) {}

    Expected<std::size_t> read(std::span<std::byte> into) {
        if (first_ && !into.empty()) {
            into.front() = *std::exchange(first_, std::nullopt);
            return 1;
        }
        auto got = source_->read(into);
        failed_ = failed_ || !got;
        return got;
    }
    Expected<bool> atEnd() {
        std::array<std::byte, 1> byte{};
        const auto got = read(byte);
        if (!got) return passOn(got);
        if (*got > 0) first_ = byte.front();
        return *got == 0;
    }
    /// The bytes themselves, not what they say.
    bool failed() const { return failed_; }

  private:
    const std::unique_ptr<ByteSource> source_;
    std::optional<std::byte> first_;
    bool failed_ = false;
};

namespace {

/// A reader owns its source of bytes; these outlive it.
template <class Bytes>
class BorrowedBytes final : public ByteSource {
  public:
    explicit BorrowedBytes(std::shared_ptr<Bytes> bytes) : bytes_(std::move(bytes)) {}
    Expected<std::size_t> read(std::span<std::byte> into) override { return bytes_->read(into); }

  private:
    std::shared_ptr<Bytes> bytes_;
};

void reserve(PointBatch& points, const Attributes& has, std::size_t count) {
    points.position.reserve(count);
    if (has.color) points.color.reserve(count);
    if (has.intensity) points.intensity.reserve(count);
    if (has.classification) points.classification.reserve(count);
    if (has.normal) points.normal.reserve(count);
}

}  // namespace

FrameReader::FrameReader(std::unique_ptr<ByteSource> bytes, std::uint64_t mostPoints)
    : bytes_(std::make_shared<Bytes>(std::move(bytes))), mostPoints_(mostPoints) {}

FrameReader::~FrameReader() = default;

Expected<std::optional<PointFrame>> FrameReader::next() {
    const auto end = bytes_->atEnd();
    if (end && *end) return std::nullopt;
    auto frame = end ? read() : Expected<PointFrame>(tl::unexpected(end.error()));
    if (frame) return std::optional(std::move(*frame));
    // Importer is what a reader says of a stream that breaks its rules; everything else its sender said.
    const ErrorCode code = frame.error().code;
    mayGoOn_ = mayGoOn_ && !bytes_->failed() && code != ErrorCode::Importer;
    return passOn(std::move(frame));
}

void FrameReader::discardRest() {
    std::array<std::byte, 65536> rest{};
    for (auto got = bytes_->read(rest); got && *got > 0;) got = bytes_->read(rest);
}

Expected<PointFrame> FrameReader::read() {
    auto reader = PointStreamReader::create(std::make_unique<BorrowedBytes<Bytes>>(bytes_));
    if (!reader) return passOn(std::move(reader));
    PointFrame frame;
    frame.header = (*reader)->header();
    const auto refuse = [&](ErrorCode code, std::string reason) {
        mayGoOn_ = false;  // in the middle of it
        return fail(code, std::move(reason));
    };
    if (!frame.header.columns.empty())
        return refuse(ErrorCode::Unsupported,
                      "it has further columns, which frames of a live source must not have");
    const auto tooMany = [&] {
        return refuse(ErrorCode::ResourceLimit,
                      "it has more than " + grouped(mostPoints_) +
                          " points, which is what the memory limit leaves for a frame");
    };
    if (frame.header.points.value_or(0) > mostPoints_) return tooMany();
    reserve(frame.points, frame.header.attributes, std::size_t(frame.header.points.value_or(0)));
    PointBatch batch;
    for (;;) {
        const auto more = (*reader)->read(batch);
        if (!more) return passOn(more);
        if (!*more) break;
        if (batch.size() > mostPoints_ - frame.points.size()) return tooMany();
        append(frame.points, batch);
    }
    frame.droppedPoints = (*reader)->droppedPoints();
    frame.notes = (*reader)->notes();
    return frame;
}

}  // namespace scancast
