#include "importers/pcl/ply_import.hpp"

#include <pcl/io/ply/ply_parser.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <system_error>

#include "importers/pcl/ply_header.hpp"
#include "importers/pcl/point_converter.hpp"
#include "importers/pcl/raw_rows.hpp"
#include "renderer/cloud/import/lost_points.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_pcl {

namespace {

namespace ply = pcl::io::ply;

Expected<void> breaksOff(const PlyHeader& header, std::uint64_t vertices, const std::string& where) {
    return fail(ErrorCode::Truncated, "it breaks off within vertex " + grouped(vertices + 1) + " of " +
                                          grouped(header.vertices) + where);
}

/// Leaves PCL's parser in the middle: it has no other way to be stopped.
struct Stop {};

/// One run of PCL's parser over the file, which calls `vertex` for every vertex.
class VertexPass {
  public:
    VertexPass(const PlyHeader& header, RawPointSink vertex) : header_(header), vertex_(std::move(vertex)) {}

    Expected<void> run(const std::string& file);

  private:
    template <class T>
    void listen(ply::ply_parser::scalar_property_definition_callbacks_type& callbacks);
    void endVertex();

    const PlyHeader& header_;
    RawPointSink vertex_;
    RawPoint point_{};
    std::uint64_t vertices_ = 0;
    std::size_t errorLine_ = 0;
    Expected<void> result_;
};

template <class T>
void VertexPass::listen(ply::ply_parser::scalar_property_definition_callbacks_type& callbacks) {
    ply::ply_parser::at<T>(callbacks) = [this](const std::string& element,
                                               const std::string& property) -> std::function<void(T)> {
        const auto meaning = meaningOf(property);
        if (element != "vertex" || !meaning) return {};
        const auto index = static_cast<std::size_t>(*meaning);
        if (header_.propertyOf[index] != property) return {};
        double& value = point_[index];
        if (*meaning != Meaning::PackedColor) return [&value](T v) { value = static_cast<double>(v); };
        return [&value](T v) {
            std::uint32_t bits = 0;
            static_assert(sizeof(T) <= sizeof(double));
            std::memcpy(&bits, &v, std::min(sizeof v, sizeof bits));
            value = bits;
        };
    };
}

void VertexPass::endVertex() {
    ++vertices_;
    result_ = vertex_(point_);
    if (!result_ || vertices_ == header_.vertices) throw Stop{};
}

Expected<void> VertexPass::run(const std::string& file) {
    ply::ply_parser parser;
    parser.error_callback([this](std::size_t line, const std::string&) { errorLine_ = line; });
    parser.element_definition_callback([this](const std::string& element, std::size_t) {
        ply::ply_parser::begin_element_callback_type begin = [] {};
        ply::ply_parser::end_element_callback_type end = [] {};
        if (element == "vertex") end = [this] { endVertex(); };
        return std::make_tuple(begin, end);
    });
    ply::ply_parser::scalar_property_definition_callbacks_type callbacks;
    listen<ply::int8>(callbacks);
    listen<ply::uint8>(callbacks);
    listen<ply::int16>(callbacks);
    listen<ply::uint16>(callbacks);
    listen<ply::int32>(callbacks);
    listen<ply::uint32>(callbacks);
    listen<ply::float32>(callbacks);
    listen<ply::float64>(callbacks);
    parser.scalar_property_definition_callbacks(callbacks);
    try {
        parser.parse(file);
    } catch (const Stop&) {
        return result_;
    }
    std::string where =
        header_.format == PlyFormat::Ascii && errorLine_ > 0 ? " (line " + grouped(errorLine_) + ")" : "";
    return breaksOff(header_, vertices_, where);
}

/// Calls `vertex` for every vertex.
Expected<void> readVertices(const std::string& file, const PlyHeader& header, const RawPointSink& vertex) {
    const auto rows = vertexRows(header);
    if (!rows) return VertexPass(header, vertex).run(file);
    std::ifstream stream(file, std::ios::binary);
    if (!stream || !stream.seekg(static_cast<std::streamoff>(rows->at)))
        return fail(ErrorCode::Io, "it cannot be opened");
    const auto read = readRows(stream, rows->layout, header.vertices, vertex);
    if (!read) return passOn(read);
    if (*read < header.vertices) return breaksOff(header, *read, "");
    return {};
}

std::string formatText(PlyFormat format) {
    switch (format) {
        case PlyFormat::Ascii:
            return "PLY, ascii";
        case PlyFormat::BinaryLittleEndian:
            return "PLY, binary little-endian";
        default:
            return "PLY, binary big-endian";
    }
}

/// Lines with an end, from there on. A last line without one may be part of a line.
Expected<std::uint64_t> wholeLines(const std::string& file, std::uint64_t from) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream || !stream.seekg(static_cast<std::streamoff>(from)))
        return fail(ErrorCode::Io, "it cannot be opened");
    std::uint64_t lines = 0;
    std::vector<char> piece(1 << 16);
    while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())), stream.gcount() > 0)
        lines += static_cast<std::uint64_t>(std::count(piece.begin(), piece.begin() + stream.gcount(), '\n'));
    return lines;
}

/// How many vertices are there before the file ends, or says what cannot be: at most as many as promised.
Expected<std::uint64_t> wholeVertices(const std::string& file, const PlyHeader& header) {
    std::uint64_t vertices = 0;
    const auto counted = readVertices(file, header, [&](const RawPoint&) -> Expected<void> {
        ++vertices;
        return {};
    });
    if (!counted && counted.error().code != ErrorCode::Truncated) return passOn(counted);
    if (header.format != PlyFormat::Ascii) return vertices;
    const auto lines = wholeLines(file, header.bytes);
    if (!lines) return passOn(lines);
    std::uint64_t before = 0;
    for (const auto& element : header.elements) {
        if (element.name == "vertex") break;
        before += element.count;
    }
    return std::min(vertices, *lines - std::min(before, *lines));
}

Expected<PlyHeader> readHeader(const std::string& file, bool recover) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream) return fail(ErrorCode::Io, "it cannot be opened: " + std::generic_category().message(errno));
    const auto size = static_cast<std::uint64_t>(stream.tellg());
    std::string start(std::min<std::uint64_t>(size, longestPlyHeader), '\0');
    stream.seekg(0);
    stream.read(start.data(), static_cast<std::streamsize>(start.size()));
    start.resize(static_cast<std::size_t>(stream.gcount()));
    return checkPlyHeader(start, size, recover);
}

}  // namespace

Expected<void> importPly(const std::string& file, PointStreamWriter& writer, bool recover) {
    auto header = readHeader(file, recover);
    if (!header) return passOn(header);
    std::string lost;
    if (recover) {
        const auto whole = wholeVertices(file, *header);
        if (!whole) return passOn(whole);
        if (*whole == 0) return fail(ErrorCode::Truncated, "it ends before its first vertex does");
        if (*whole < header->vertices) lost = lostPoints("it", header->vertices, *whole);
        header->vertices = *whole;
    }

    ValueRanges ranges;
    if (needsRanges(header->fields)) {
        const auto measured = readVertices(file, *header, [&](const RawPoint& point) -> Expected<void> {
            ranges.take(point, header->fields);
            return {};
        });
        if (!measured) return measured;
    }
    ScanHeader scan;
    scan.format = formatText(header->format);
    scan.points = header->vertices;
    scan.attributes = header->fields.attributes();
    if (auto ok = writer.writeHeader(scan); !ok) return ok;
    if (!lost.empty())
        if (auto ok = writer.writeNote(lost); !ok) return ok;
    PointConverter converter(header->fields, ranges, writer);
    const auto sent =
        readVertices(file, *header, [&](const RawPoint& point) { return converter.add(point); });
    if (!sent) return sent;
    return converter.finish();
}

}  // namespace scancast::import_pcl
