#include "renderer/cloud/import/stream/point_stream_reader.hpp"

#include <array>
#include <cmath>
#include <cstring>

#include "files/bytes.hpp"
#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/stream/stream_columns.hpp"

namespace scancast {

namespace stream = point_stream;

static_assert(sizeof(glm::dvec3) == 24 && sizeof(glm::vec3) == 12, "columns are read in place");

tl::unexpected<Error> PointStreamReader::wrong(const std::string& reason) const {
    return fail(ErrorCode::Importer, "its point stream is wrong before byte " + grouped(at_) + ": " + reason);
}

Expected<std::unique_ptr<PointStreamReader>> PointStreamReader::create(std::unique_ptr<ByteSource> bytes,
                                                                       const StreamOptions& options) {
    std::unique_ptr<PointStreamReader> reader(new PointStreamReader(std::move(bytes), options));
    if (auto ok = reader->readHeader(); !ok) return passOn(ok);
    if (auto ok = reader->readHead(); !ok) return passOn(ok);
    if (reader->head_.tag == stream::failTag) return tl::unexpected(reader->readFailure().error());
    return reader;
}

Expected<void> PointStreamReader::readExactly(std::span<std::byte> into) {
    const auto got = readFully(*bytes_, into);
    if (!got) return passOn(got);
    at_ += *got;
    if (*got == into.size()) return {};
    return fail(ErrorCode::Importer, "its point stream broke off at byte " + grouped(at_) + ", after " +
                                         grouped(points_) + " points");
}

Expected<void> PointStreamReader::readText(std::size_t length, std::size_t longest, std::string& text) {
    std::vector<std::byte> bytes(length);
    if (auto ok = readExactly(bytes); !ok) return ok;
    text = printableText({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, longest);
    return {};
}

Expected<void> PointStreamReader::readHeader() {
    std::array<std::byte, stream::headerBytes> bytes{};
    if (auto ok = readExactly(bytes); !ok) return ok;
    auto decoded = stream::decodeHeader(bytes);
    if (!decoded) return passOn(decoded);
    header_ = std::move(decoded->header);
    areSteps_ = decoded->areSteps;
    version_ = decoded->version;
    if (decoded->hasScanner)
        if (auto ok = readScanner(); !ok) return ok;
    if (auto ok = readText(decoded->formatBytes, stream::longestFormat, header_.format); !ok) return ok;
    if (auto ok = readText(decoded->wktBytes, stream::longestWkt, header_.crsWkt); !ok) return ok;
    if (decoded->isLas) return readLas();
    if (decoded->columnsBytes == 0) return {};
    std::string list(decoded->columnsBytes, '\0');
    if (auto ok = readExactly(std::as_writable_bytes(std::span(list))); !ok) return ok;
    auto columns = stream::decodeColumns(list);
    if (!columns) return passOn(columns);
    header_.columns = std::move(*columns);
    rowBytes_ = scancast::rowBytes(header_.columns);
    return {};
}

Expected<void> PointStreamReader::readScanner() {
    std::array<std::byte, stream::scannerBytes> bytes{};
    if (auto ok = readExactly(bytes); !ok) return ok;
    const auto scanner = stream::decodeScanner(bytes);
    if (!scanner) return passOn(scanner);
    header_.scannerOrigin = *scanner;
    return {};
}

Expected<void> PointStreamReader::readHead() {
    for (;;) {
        std::array<std::byte, stream::recordHeadBytes> bytes{};
        if (auto ok = readExactly(bytes); !ok) return ok;
        std::memcpy(head_.tag.data(), bytes.data(), head_.tag.size());
        head_.n = loadLe<std::uint32_t>(bytes.data() + 4);
        const bool newest = version_ >= stream::newestVersion;
        Expected<void> ok;
        if (head_.tag == stream::noteTag)
            ok = readNote();
        else if (las_ && head_.tag == stream::peakTag)
            ok = readPeak();
        else if (newest && head_.tag == stream::stationTag)
            ok = readStation();
        else if (newest && head_.tag == stream::fromTag)
            ok = readFrom();
        else if (newest && head_.tag == stream::photoTag)
            ok = readPhoto();
        else if (newest && head_.tag == stream::photoBytesTag)
            ok = readPhotoBytes();
        else
            return {};
        if (!ok) return ok;
    }
}

Expected<void> PointStreamReader::readNote() {
    if (head_.n == 0 || head_.n > stream::longestNote)
        return wrong("a note of " + grouped(head_.n) + " bytes");
    if (notes_.size() == stream::mostNotes)
        return wrong("more than " + grouped(stream::mostNotes) + " notes");
    return readText(head_.n, stream::longestNote, notes_.emplace_back());
}

Expected<void> PointStreamReader::readStation() {
    if (head_.n == 0 || head_.n > stream::longestStation)
        return wrong("a station of " + grouped(head_.n) + " bytes");
    if (stations_.size() == stream::mostStreamStations)
        return wrong("more than " + grouped(stream::mostStreamStations) + " stations");
    std::string text(head_.n, '\0');
    if (auto ok = readExactly(std::as_writable_bytes(std::span(text))); !ok) return ok;
    auto station = stream::decodeStation(text);
    if (!station) return passOn(station);
    stations_.push_back(std::move(*station));
    return {};
}

Expected<void> PointStreamReader::readFrom() {
    if (head_.n != stream::fromNowhere && head_.n >= stations_.size())
        return wrong("points from station " + grouped(head_.n) + ", of " + grouped(stations_.size()));
    from_ = head_.n;
    return {};
}

template <class T>
Expected<void> PointStreamReader::readColumn(std::vector<T>& column, bool present, std::size_t count) {
    column.resize(present ? count : 0);
    return readExactly(std::as_writable_bytes(std::span(column)));
}

Expected<void> PointStreamReader::readPositions(Positions& position, std::size_t count) {
    if (areSteps_) return readColumn(position.steps({header_.gridOrigin, header_.gridStep}), true, count);
    if (position.areSteps()) position.clear();  // somebody else's: nothing worth being converted
    return readColumn(position.doubles(), true, count);
}

/// As many as the record's head says.
Expected<void> PointStreamReader::readColumns(PointBatch& batch) {
    const auto n = head_.n;
    const auto& has = header_.attributes;
    if (auto ok = readPositions(batch.position, n); !ok) return ok;
    if (auto ok = readColumn(batch.color, has.color, n); !ok) return ok;
    if (auto ok = readColumn(batch.intensity, has.intensity, n); !ok) return ok;
    if (auto ok = readColumn(batch.classification, has.classification, n); !ok) return ok;
    if (auto ok = readColumn(batch.normal, has.normal, n); !ok) return ok;
    if (auto ok = readColumn(batch.rows, rowBytes_ > 0, n * rowBytes_); !ok) return ok;
    batch.nearInfrared.clear();
    return checkChunk(batch);
}

Expected<void> PointStreamReader::readChunk(PointBatch& batch) {
    const auto n = head_.n;
    if (n == 0 || n > stream::chunkPoints)
        return wrong("a chunk of " + grouped(n) + " points; 1 to 65,536 are allowed");
    if (header_.points && n > *header_.points - points_)
        return wrong("more points than the " + grouped(*header_.points) + " that it declared");
    if (n > options_.mostPoints - points_) return wrong("more points than such a file can hold");
    if (las_) {
        if (auto ok = readRecordsOfLas(); !ok) return ok;
        if (auto ok = las_->decode(records_, batch); !ok) return ok;
    } else if (auto ok = readColumns(batch); !ok) {
        return ok;
    }
    points_ += n;
    batch.scanner.reset();
    if (from_ != stream::fromNowhere) {
        batch.scanner = stations_[from_].position;
        stations_[from_].points += batch.size();
    }
    return {};
}

// What follows the last of these records may take long: it is not waited for.
Expected<PointBatch> PointStreamReader::glance() {
    PointBatch all, part;
    while (head_.tag == stream::glanceTag) {
        const RecordHead head = head_;
        if (points_ > 0) return wrong("points to look at first, behind others");
        if (head.n > stream::glancePoints - all.size())
            return wrong("more than " + grouped(stream::glancePoints) + " points to look at first");
        if (head.n > 0)
            if (auto ok = readGlance(part); !ok) return passOn(ok);
        head_ = {};
        if (head.n == 0) break;
        append(all, part);
        if (auto ok = readHead(); !ok) return passOn(ok);
    }
    return all;
}

Expected<void> PointStreamReader::checkChunk(const PointBatch& batch) const {
    bool finite = true;  // steps are, with a grid that was checked
    if (!areSteps_)
        for (const auto& p : batch.position.asDoubles())
            finite = finite && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    if (!finite) return wrong("a coordinate is NaN or infinite");
    bool unit = true;
    for (const auto& n : batch.normal) {
        const auto square = n.x * n.x + n.y * n.y + n.z * n.z;  // NaN fails both comparisons
        unit = unit && (square == 0.0F || (square > 0.98F && square < 1.02F));
    }
    if (!unit) return wrong("a normal is neither of unit length nor 0");
    return {};
}

Expected<void> PointStreamReader::readDone() {
    std::array<std::byte, 16> bytes{};
    if (auto ok = readExactly(bytes); !ok) return ok;
    const auto total = loadLe<std::uint64_t>(bytes.data());
    dropped_ = loadLe<std::uint64_t>(bytes.data() + 8);
    if (head_.n != 0) return wrong("its end record has a length");
    if (total != points_)
        return wrong("it claims to have sent " + grouped(total) + " points, it has sent " + grouped(points_));
    if (las_ && dropped_ > 0) return wrong("records of LAS are not dropped by who sends them");
    if (header_.points && *header_.points - points_ != dropped_)
        return wrong("it declared " + grouped(*header_.points) + " points, sent " + grouped(points_) +
                     " and dropped " + grouped(dropped_));
    if (points_ == 0 && dropped_ > 0)
        return fail(ErrorCode::Empty, "none of its " + grouped(dropped_) + " points has finite coordinates");
    if (points_ == 0) return fail(ErrorCode::Empty, "it has no points");
    if (las_) return las_->checkEnd();
    return {};
}

Expected<void> PointStreamReader::readFailure() {
    if (head_.n == 0 || head_.n > stream::longestFailure)
        return wrong("a failure text of " + grouped(head_.n) + " bytes");
    std::array<std::byte, 4> code{};
    if (auto ok = readExactly(code); !ok) return ok;
    std::string text;
    if (auto ok = readText(head_.n, stream::longestFailure, text); !ok) return ok;
    if (text.empty()) text = "it failed, and did not say why";  // blanks, or what is no text
    return fail(stream::failureCode(loadLe<std::uint32_t>(code.data())), text);
}

Expected<bool> PointStreamReader::read(PointBatch& batch) {
    if (done_) {
        batch.clear();
        return false;
    }
    Expected<void> ok;
    do {
        ok = readRecord(batch);
    } while (ok && !done_ && batch.size() == 0);  // no record of LAS in it had finite coordinates
    if (ok && !done_) return true;
    batch.clear();
    if (!ok) return passOn(ok);
    return false;
}

Expected<void> PointStreamReader::readRecord(PointBatch& batch) {
    if (const auto unwanted = glance(); !unwanted) return passOn(unwanted);
    if (head_.tag == RecordHead().tag)
        if (auto ok = readHead(); !ok) return ok;
    const auto tag = head_.tag;
    Expected<void> ok;
    if (tag == (las_ ? stream::recordsTag : stream::chunkTag)) {
        ok = readChunk(batch);
        if (ok) ok = readHead();
    } else if (tag == stream::doneTag) {
        ok = readDone();
        done_ = ok.has_value();
    } else if (tag == stream::failTag) {
        ok = readFailure();
    } else {
        ok = wrong("a record of unknown kind");
    }
    return ok;
}

std::array<std::uint64_t, 2> PointStreamReader::bytesRead() const {
    if (!header_.points) return {at_, 0};
    const auto size =
        las_ ? las_->las().recordBytes : stream::pointBytes(header_.attributes, areSteps_) + rowBytes_;
    if (*header_.points > std::numeric_limits<std::uint64_t>::max() / size) return {at_, 0};
    return {points_ * size, *header_.points * size};
}

}  // namespace scancast
