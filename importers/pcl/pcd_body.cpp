#include "importers/pcl/pcd_body.hpp"

#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>

#include <array>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

#include "files/bytes.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_pcl {

namespace {

constexpr std::uint64_t sliceBytes = std::uint64_t(8) << 20;
constexpr int pcdVersion = 7;

std::uint8_t pclType(ColumnType type) {
    using F = pcl::PCLPointField;
    switch (type) {
        case ColumnType::Int8:
            return F::INT8;
        case ColumnType::Uint8:
            return F::UINT8;
        case ColumnType::Int16:
            return F::INT16;
        case ColumnType::Uint16:
            return F::UINT16;
        case ColumnType::Int32:
            return F::INT32;
        case ColumnType::Uint32:
            return F::UINT32;
        case ColumnType::Int64:
            return F::INT64;
        case ColumnType::Uint64:
            return F::UINT64;
        case ColumnType::Float32:
            return F::FLOAT32;
        default:
            return F::FLOAT64;
    }
}

/// Fills in what PCL's own header parser would have: the fields and the size of a cloud of `points` points.
void describe(const PcdHeader& header, std::uint64_t points, pcl::PCLPointCloud2& cloud) {
    cloud.fields.clear();
    for (const auto& field : header.fields) {
        pcl::PCLPointField f;
        f.name = field.name;
        f.offset = field.offset;
        f.datatype = pclType(field.type);
        f.count = field.count;
        cloud.fields.push_back(f);
    }
    cloud.height = 1;
    cloud.width = static_cast<std::uint32_t>(points);
    cloud.point_step = header.pointBytes;
    cloud.row_step = static_cast<std::uint32_t>(
        std::min<std::uint64_t>(points * header.pointBytes, std::numeric_limits<std::uint32_t>::max()));
    cloud.is_dense = true;
    cloud.data.resize(points * header.pointBytes);
}

RowLayout rowsOf(const PcdHeader& header) {
    RowLayout rows;
    rows.bytes = header.pointBytes;
    for (std::size_t m = 0; m < meanings; ++m) {
        if (!header.meanings.type[m]) continue;
        const auto& field = header.fields[header.fieldOf[m]];
        rows.fields.push_back({field.offset, field.type, static_cast<Meaning>(m)});
    }
    return rows;
}

Expected<void> hand(const PcdHeader& header, const pcl::PCLPointCloud2& cloud, std::uint64_t points,
                    const RawPointSink& sink) {
    if (cloud.data.size() < points * header.pointBytes)
        return fail(ErrorCode::Malformed, "PCL's reader made fewer bytes of it than its header promises");
    const auto* data = reinterpret_cast<const std::byte*>(cloud.data.data());
    const RowLayout rows = rowsOf(header);
    RawPoint point{};
    for (std::uint64_t i = 0; i < points; ++i, data += header.pointBytes) {
        readRow(data, rows, point);
        if (auto ok = sink(point); !ok) return ok;
    }
    return {};
}

Expected<void> readBinary(std::ifstream& stream, const PcdHeader& header, const RawPointSink& sink) {
    const auto read = readRows(stream, rowsOf(header), header.points, sink);
    if (!read) return passOn(read);
    if (*read < header.points) return fail(ErrorCode::Truncated, "it became shorter while it was read");
    return {};
}

Expected<void> readCompressed(std::ifstream& stream, std::uint64_t fileBytes, const PcdHeader& header,
                              const RawPointSink& sink) {
    // Two lengths, then the points, compressed by LZF.
    std::vector<unsigned char> bytes(8);
    stream.read(reinterpret_cast<char*>(bytes.data()), 8);
    if (stream.gcount() != 8)
        return fail(ErrorCode::Truncated,
                    "it ends at byte " + grouped(fileBytes) + ", before its compressed points");
    const auto* lengths = reinterpret_cast<const std::byte*>(bytes.data());
    const auto compressed = loadLe<std::uint32_t>(lengths);
    const auto uncompressed = loadLe<std::uint32_t>(lengths + 4);
    if (auto ok = checkPcdCompression(header, compressed, uncompressed, fileBytes); !ok) return ok;
    bytes.resize(8 + std::size_t(compressed));
    stream.read(reinterpret_cast<char*>(bytes.data() + 8), compressed);
    if (stream.gcount() != static_cast<std::streamsize>(compressed))
        return fail(ErrorCode::Truncated, "it became shorter while it was read");
    pcl::PCDReader reader;
    pcl::PCLPointCloud2 cloud;
    describe(header, header.points, cloud);
    if (reader.readBodyBinary(bytes.data(), cloud, pcdVersion, true, 0) != 0)
        return fail(ErrorCode::Malformed, "its compressed points, from byte " + grouped(header.bytes + 8) +
                                              " on, do not unpack: they are damaged");
    bytes = {};
    return hand(header, cloud, header.points, sink);
}

/// Text, with the separators that people use made those that PCL knows, and nothing in it but numbers: PCL
/// reads anything else as 0.
class TextLines {
  public:
    TextLines(std::ifstream& stream, const PcdHeader& header) : stream_(stream), at_(header.bytes) {
        for (const auto& field : header.fields) values_ += field.count;
    }

    /// The line that was taken last has no end: it is the file's last, and may be part of a line.
    bool unended() const { return stream_.eof(); }

    /// Appends the next line that holds a point.
    Expected<void> next(std::string& to, std::uint64_t point, std::uint64_t points) {
        for (;;) {
            const auto lineAt = at_;
            if (!std::getline(stream_, line_))
                return fail(ErrorCode::Truncated, "it ends at byte " + grouped(at_) +
                                                      ": its header promises " + grouped(points) +
                                                      " points, there are " + grouped(point));
            at_ += line_.size() + 1;
            const auto found = clean();
            if (found == 0) continue;
            if (found != values_ || bad_)
                return fail(ErrorCode::Malformed,
                            "byte " + grouped(lineAt) + ": point " + grouped(point + 1) +
                                (bad_ ? " has a value that is no number"
                                      : " has " + grouped(found) + " values instead of " + grouped(values_)));
            to += line_;
            to += '\n';
            return {};
        }
    }

  private:
    /// Replaces separators, counts values, and looks at their characters.
    std::size_t clean() {
        std::size_t found = 0;
        bool inside = false;
        bad_ = false;
        for (char& c : line_) {
            if (c == ',' || c == ';' || c == '\t' || c == '\r') c = ' ';
            if (c == ' ') {
                inside = false;
                continue;
            }
            if (!inside) ++found;
            inside = true;
            bad_ = bad_ || std::strchr("0123456789+-.eEnNaAiIfF", c) == nullptr || c == '\0';
        }
        return found;
    }

    std::ifstream& stream_;
    std::uint64_t at_;
    std::size_t values_ = 0;
    std::string line_;
    bool bad_ = false;
};

Expected<void> readText(std::ifstream& stream, const PcdHeader& declared, const RawPointSink& sink) {
    // Text has more digits than the declared four-byte float keeps: UTM coordinates are read as doubles.
    PcdHeader header = declared;
    header.pointBytes = 0;
    for (auto& field : header.fields) {
        const auto meaning = meaningOf(field.name);
        if (meaning && *meaning <= Meaning::Z && field.count == 1 && field.type == ColumnType::Float32)
            field.type = ColumnType::Float64;
        field.offset = header.pointBytes;
        header.pointBytes += field.bytes();
    }
    const auto slice =
        std::min<std::uint64_t>(65536, std::max<std::uint64_t>(1, sliceBytes / header.pointBytes));
    TextLines lines(stream, header);
    pcl::PCDReader reader;
    pcl::PCLPointCloud2 cloud;
    for (std::uint64_t done = 0; done < header.points;) {
        const auto count = std::min(slice, header.points - done);
        std::string text;
        for (std::uint64_t i = 0; i < count; ++i)
            if (auto ok = lines.next(text, done + i, header.points); !ok) return ok;
        std::istringstream body(text);
        describe(header, count, cloud);
        if (reader.readBodyASCII(body, cloud, pcdVersion) != 0)
            return fail(ErrorCode::Malformed, "PCL cannot read its points after the first " + grouped(done));
        if (auto ok = hand(header, cloud, count, sink); !ok) return ok;
        done += count;
    }
    return {};
}

/// Lines of points that have an end, up to one that is none.
std::uint64_t wholeTextPoints(std::ifstream& stream, const PcdHeader& header) {
    TextLines lines(stream, header);
    std::string text;
    for (std::uint64_t point = 0; point < header.points; ++point) {
        text.clear();
        if (!lines.next(text, point, header.points) || lines.unended()) return point;
    }
    return header.points;
}

}  // namespace

Expected<std::uint64_t> wholePcdPoints(const std::string& file, std::uint64_t fileBytes,
                                       const PcdHeader& header) {
    const auto room = fileBytes > header.bytes ? fileBytes - header.bytes : 0;
    if (header.data == PcdData::Binary) return std::min(header.points, room / header.pointBytes);
    std::ifstream stream(file, std::ios::binary);
    if (!stream || !stream.seekg(static_cast<std::streamoff>(header.bytes)))
        return fail(ErrorCode::Io, "it cannot be opened");
    if (header.data == PcdData::Ascii) return wholeTextPoints(stream, header);
    std::array<std::byte, 4> length{};
    stream.read(reinterpret_cast<char*>(length.data()), 4);
    if (stream.gcount() == 4 && room >= 8 && loadLe<std::uint32_t>(length.data()) <= room - 8)
        return header.points;
    return fail(ErrorCode::Truncated,
                "it ends at byte " + grouped(fileBytes) +
                    ", within its compressed points, which come value by value of all points: "
                    "not one of them is whole");
}

Expected<void> readPcdPoints(const std::string& file, std::uint64_t fileBytes, const PcdHeader& header,
                             const RawPointSink& sink) {
    // What PCL would print goes with the error that it returns.
    pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
    std::ifstream stream(file, std::ios::binary);
    if (!stream || !stream.seekg(static_cast<std::streamoff>(header.bytes)))
        return fail(ErrorCode::Io, "it cannot be opened");
    try {
        switch (header.data) {
            case PcdData::Ascii:
                return readText(stream, header, sink);
            case PcdData::Binary:
                return readBinary(stream, header, sink);
            default:
                return readCompressed(stream, fileBytes, header, sink);
        }
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        return fail(ErrorCode::Malformed, std::string("PCL cannot read its points: ") + error.what());
    }
}

}  // namespace scancast::import_pcl
