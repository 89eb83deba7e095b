#include "importers/pcl/ply_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>

#include "importers/pcl/header_words.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_pcl {

namespace {

constexpr std::size_t mostElements = 100;
constexpr std::size_t mostProperties = 1000;

struct TypeName {
    std::string_view name;
    ColumnType type;
};
constexpr TypeName typeNames[] = {
    {"char", ColumnType::Int8},       {"int8", ColumnType::Int8},       {"uchar", ColumnType::Uint8},
    {"uint8", ColumnType::Uint8},     {"short", ColumnType::Int16},     {"int16", ColumnType::Int16},
    {"ushort", ColumnType::Uint16},   {"uint16", ColumnType::Uint16},   {"int", ColumnType::Int32},
    {"int32", ColumnType::Int32},     {"uint", ColumnType::Uint32},     {"uint32", ColumnType::Uint32},
    {"float", ColumnType::Float32},   {"float32", ColumnType::Float32}, {"double", ColumnType::Float64},
    {"float64", ColumnType::Float64},
};

std::optional<ColumnType> typeOf(std::string_view name) {
    for (const auto& known : typeNames)
        if (known.name == name) return known.type;
    return std::nullopt;
}

/// Takes the header line by line; knows where it is.
class HeaderReader {
  public:
    Expected<void> take(std::string_view line, std::size_t at);
    bool ended() const { return ended_; }
    bool hasFormat() const { return hasFormat_; }
    PlyHeader& header() { return header_; }

  private:
    Expected<void> takeFormat(const std::vector<std::string_view>& w);
    Expected<void> takeElement(const std::vector<std::string_view>& w);
    Expected<void> takeProperty(const std::vector<std::string_view>& w);
    tl::unexpected<Error> wrong(const std::string& reason) const {
        return fail(ErrorCode::Malformed, fmt::format("its PLY header is wrong at byte {}: {}", at_, reason));
    }

    PlyHeader header_;
    std::size_t at_ = 0;
    bool hasFormat_ = false, ended_ = false;
};

Expected<void> HeaderReader::take(std::string_view line, std::size_t at) {
    at_ = at;
    const auto w = words(line);
    if (w.empty()) return {};
    if (at == 0) {
        if (w[0] != "ply" || w.size() != 1) return wrong("the first line is not \"ply\"");
        return {};
    }
    if (w[0] == "comment" || w[0] == "obj_info") return {};
    if (w[0] == "format") return takeFormat(w);
    if (w[0] == "element") return takeElement(w);
    if (w[0] == "property") return takeProperty(w);
    if (w[0] == "end_header") {
        ended_ = true;
        return {};
    }
    return wrong(quotedText(w[0]) + " is not a word of PLY headers");
}

Expected<void> HeaderReader::takeFormat(const std::vector<std::string_view>& w) {
    if (hasFormat_ || w.size() != 3) return wrong("the format line is repeated or incomplete");
    hasFormat_ = true;
    if (w[2] != "1.0")
        return fail(ErrorCode::Unsupported,
                    "PLY version " + printableText(w[2], 20) + " is not known here, 1.0 is");
    if (w[1] == "ascii")
        header_.format = PlyFormat::Ascii;
    else if (w[1] == "binary_little_endian")
        header_.format = PlyFormat::BinaryLittleEndian;
    else if (w[1] == "binary_big_endian")
        header_.format = PlyFormat::BinaryBigEndian;
    else
        return wrong("the format " + quotedText(w[1]) + " is unknown");
    return {};
}

Expected<void> HeaderReader::takeElement(const std::vector<std::string_view>& w) {
    PlyElement element;
    if (w.size() != 3) return wrong("an element needs a name and a count");
    if (header_.elements.size() >= mostElements) return wrong("more than 100 kinds of elements");
    element.name = w[1];
    const auto* end = w[2].data() + w[2].size();
    const auto parsed = std::from_chars(w[2].data(), end, element.count);
    if (parsed.ec != std::errc{} || parsed.ptr != end)
        return wrong("the count " + quotedText(w[2]) + " is not a number");
    if (element.count > mostItems)
        return wrong("a count of " + grouped(element.count) + " is more than any file holds");
    for (const auto& other : header_.elements)
        if (other.name == element.name) return wrong("the element " + quotedText(w[1]) + " is there twice");
    header_.elements.push_back(std::move(element));
    return {};
}

Expected<void> HeaderReader::takeProperty(const std::vector<std::string_view>& w) {
    if (header_.elements.empty()) return wrong("a property before the first element");
    auto& properties = header_.elements.back().properties;
    if (properties.size() >= mostProperties) return wrong("more than 1,000 properties of one element");
    const bool list = w.size() == 5 && w[1] == "list";
    if (!list && w.size() != 3) return wrong("a property needs a type and a name");
    const auto type = typeOf(list ? w[3] : w[1]);
    const auto size = list ? typeOf(w[2]) : std::nullopt;
    if (!type) return wrong("the type " + quotedText(list ? w[3] : w[1]) + " is unknown");
    if (list && (!size || isFloat(*size)))
        return wrong(quotedText(w[2]) + " cannot be the type of a list's length");
    const auto name = w.back();
    for (const auto& other : properties)
        if (other.name == name) return wrong("the property " + quotedText(name) + " is there twice");
    properties.push_back({std::string(name), *type, size});
    return {};
}

/// Bytes that one item has at least: lists may be empty; in text a value is a digit and a space.
std::uint64_t leastBytes(const PlyElement& element, PlyFormat format) {
    std::uint64_t bytes = 0;
    for (const auto& property : element.properties)
        bytes += format == PlyFormat::Ascii ? 2 : bytesOf(property.listSize.value_or(property.type));
    return bytes;
}

Expected<void> checkVertices(PlyHeader& header, const PlyElement& vertex) {
    header.vertices = vertex.count;
    for (const auto& property : vertex.properties) {
        const auto meaning = meaningOf(property.name);
        if (!meaning || property.listSize) continue;
        // A packed colour has four bytes; anything else under such a name is not one.
        if (*meaning == Meaning::PackedColor && bytesOf(property.type) != 4) continue;
        auto& known = header.propertyOf[static_cast<std::size_t>(*meaning)];
        if (header.fields.has(*meaning)) {
            // Two intensities are one too many, but harm nobody; two x do.
            if (*meaning <= Meaning::Z)
                return fail(ErrorCode::Malformed, "its vertices have " + quotedText(property.name) +
                                                      " and another property of the same meaning");
            if (!isPlainer(property.name, known)) continue;
        }
        header.fields[*meaning] = property.type;
        known = property.name;
    }
    for (const auto& [meaning, name] : {std::pair(Meaning::X, "x"), {Meaning::Y, "y"}, {Meaning::Z, "z"}})
        if (!header.fields.has(meaning))
            return fail(ErrorCode::Malformed, std::string("its vertices have no property \"") + name + "\"");
    if (vertex.count == 0) return fail(ErrorCode::Empty, "it declares 0 vertices");
    return {};
}

Expected<void> checkExtent(const PlyHeader& header, std::uint64_t fileBytes, bool recover) {
    const bool text = header.format == PlyFormat::Ascii;
    std::uint64_t at = header.bytes;
    for (const auto& element : header.elements) {
        const auto each = leastBytes(element, header.format);
        // The last line of text may lack its end.
        const auto room = (fileBytes > at ? fileBytes - at : 0) + (text ? 1 : 0);
        if (recover && element.name == "vertex") return {};
        if (each > 0 && element.count > room / each)
            return fail(ErrorCode::Truncated,
                        fmt::format("it ends at byte {}: its header promises {} items of {} of at least {} "
                                    "bytes from byte {} on, there is room for {}",
                                    grouped(fileBytes), grouped(element.count), quotedText(element.name),
                                    grouped(each), grouped(at), grouped(room / each)));
        if (each > 0) at += element.count * each;
        if (element.name == "vertex") return {};  // what follows harms no point
        if (each == 0 && element.count > fileBytes)
            return fail(ErrorCode::Malformed,
                        "it promises " + grouped(element.count) + " items without properties");
    }
    return {};
}

}  // namespace

Expected<PlyHeader> checkPlyHeader(std::string_view start, std::uint64_t fileBytes, bool recover) {
    HeaderReader reader;
    std::size_t at = 0;
    while (!reader.ended()) {
        const auto end = start.find('\n', at);
        // Behind such a header, bytes of points may look like a line's end.
        if (const auto line = start.substr(0, end); at == 0 && line.find('\r') < line.size() - 1)
            return fail(ErrorCode::Unsupported,
                        "the lines of its header end in carriage returns only; save it with a newer program");
        if (end == std::string_view::npos) {
            if (start.size() >= longestPlyHeader)
                return fail(ErrorCode::Malformed, "its header has no end within 1 MiB");
            if (start.substr(at).starts_with("end_header") && words(start.substr(at)).size() == 1) {
                if (auto ok = reader.take(start.substr(at), at); !ok) return passOn(ok);
                at = start.size();
                break;
            }
            return fail(ErrorCode::Truncated,
                        "it ends at byte " + grouped(fileBytes) + ", within its PLY header");
        }
        if (auto ok = reader.take(start.substr(at, end - at), at); !ok) return passOn(ok);
        at = end + 1;
    }
    auto& header = reader.header();
    if (!reader.hasFormat()) return fail(ErrorCode::Malformed, "its PLY header has no format line");
    header.bytes = at;
    const auto vertex = std::find_if(header.elements.begin(), header.elements.end(),
                                     [](auto& element) { return element.name == "vertex"; });
    if (vertex == header.elements.end())
        return fail(ErrorCode::Malformed,
                    "its PLY header declares no vertices (no line \"element vertex …\")");
    if (auto ok = checkVertices(header, *vertex); !ok) return passOn(ok);
    if (auto ok = checkExtent(header, fileBytes, recover); !ok) return passOn(ok);
    return header;
}

std::optional<VertexRows> vertexRows(const PlyHeader& header) {
    if (header.format == PlyFormat::Ascii) return std::nullopt;
    VertexRows rows{.at = header.bytes};
    rows.layout.bigEndian = header.format == PlyFormat::BinaryBigEndian;
    for (const auto& element : header.elements) {
        const bool lists =
            std::ranges::any_of(element.properties, [](auto& p) { return p.listSize.has_value(); });
        if (lists) return std::nullopt;
        if (element.name == "vertex") {
            for (const auto& property : element.properties) {
                const auto meaning = meaningOf(property.name);
                if (meaning && header.propertyOf[static_cast<std::size_t>(*meaning)] == property.name)
                    rows.layout.fields.push_back({rows.layout.bytes, property.type, *meaning});
                rows.layout.bytes += static_cast<std::uint32_t>(bytesOf(property.type));
            }
            return rows;
        }
        rows.at +=
            element.count * leastBytes(element, header.format);  // exact, without lists; within the file
    }
    return std::nullopt;
}

}  // namespace scancast::import_pcl
