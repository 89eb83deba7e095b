// What PointStreamReader reads of a stream with records of LAS.
#include <algorithm>
#include <array>

#include "files/bytes.hpp"
#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/stream/point_stream_reader.hpp"

namespace scancast {

namespace stream = point_stream;

namespace {

// Of the head: the point format's byte, whose two highest bits LASzip sets.
constexpr std::size_t atPointFormat = 104;
constexpr std::byte lazBits{0xc0};

}  // namespace

Expected<std::vector<std::byte>> PointStreamReader::readLasPart(std::uint32_t bytes, const char* what) {
    if (bytes > stream::longestLasPart) return wrong(std::string(what) + " of " + grouped(bytes) + " bytes");
    std::vector<std::byte> part(bytes);
    if (auto ok = readExactly(part); !ok) return passOn(ok);
    return part;
}

Expected<void> PointStreamReader::readLas() {
    std::array<std::byte, stream::lasLengthsBytes> lengths{};
    if (auto ok = readExactly(lengths); !ok) return ok;
    const auto head = readLasPart(loadLe<std::uint32_t>(lengths.data()), "a head of LAS");
    if (!head) return passOn(head);
    const auto evlrs = readLasPart(loadLe<std::uint32_t>(lengths.data() + 4), "extended records of LAS");
    if (!evlrs) return passOn(evlrs);
    if (head->size() > atPointFormat && ((*head)[atPointFormat] & lazBits) != std::byte(0))
        return wrong("its head is one of LAZ, and records of LAS come uncompressed");
    auto las = LasReader::create(std::span(*head).first(std::min(head->size(), lasHeaderBytes)), {},
                                 options_.keepAttributes);
    if (!las) return passOn(std::move(las));
    if (options_.fullColors) las->keepFullColors();
    if (head->size() < las->las().headerBytes || head->size() > las->las().pointOffset)
        return wrong("a head of LAS of " + grouped(head->size()) +
                     " bytes, which is not what it says of itself");
    if (header_.points && *header_.points != las->points())
        return wrong("it declares " + grouped(*header_.points) + " points, the head of LAS " +
                     grouped(las->points()));
    las->takeVlrs(std::span(*head).subspan(las->las().headerBytes));
    las->takeEvlrs(*evlrs);
    las->understand();
    const auto declared = header_.points;
    auto format = std::move(header_.format);
    header_ = las->header();
    header_.points = declared;
    if (!format.empty()) header_.format = std::move(format);
    las_.emplace(std::move(*las));
    return {};
}

Expected<void> PointStreamReader::readPeak() {
    if (head_.n > 0xffff) return wrong("a colour of more than 16 bits");
    if (wasToldPeak_ || points_ > 0) return wrong("the highest colour twice, or behind points");
    wasToldPeak_ = true;
    las_->hasBeenTold(static_cast<std::uint16_t>(head_.n));
    return {};
}

/// As many as the record's head says, into records_.
Expected<void> PointStreamReader::readRecordsOfLas() {
    const std::uint64_t bytes = std::uint64_t(head_.n) * las_->las().recordBytes;
    if (bytes > stream::longestLasRecords) return wrong(grouped(bytes) + " bytes of records of LAS at once");
    records_.resize(bytes);
    return readExactly(records_);
}

Expected<void> PointStreamReader::readGlance(PointBatch& batch) {
    if (!las_) return readColumns(batch);
    if (auto ok = readRecordsOfLas(); !ok) return ok;
    las_->see(records_);
    las_->glance(records_, batch);
    return {};
}

std::vector<std::string> PointStreamReader::notes() const {
    auto notes = las_ ? las_->notes() : std::vector<std::string>();
    notes.insert(notes.end(), notes_.begin(), notes_.end());
    noteLostPhotos(notes);
    return notes;
}

}  // namespace scancast
