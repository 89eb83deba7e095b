#include "importers/pcl/pcd_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "importers/pcl/header_words.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_pcl {

namespace {

constexpr std::size_t mostFields = 1000;
constexpr std::uint32_t longestPoint = 65536;

struct Line {
    std::size_t at = 0;
    std::vector<std::string_view> values;
};
using Lines = std::map<std::string, Line, std::less<>>;

tl::unexpected<Error> wrong(std::size_t at, const std::string& reason) {
    return fail(ErrorCode::Malformed, fmt::format("its PCD header is wrong at byte {}: {}", at, reason));
}

std::optional<std::uint64_t> number(std::string_view text) {
    std::uint64_t value = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
    if (parsed.ec != std::errc{} || parsed.ptr != text.data() + text.size() || value > mostItems)
        return std::nullopt;
    return value;
}

/// Lines up to DATA, by keyword; sets where the body starts.
Expected<Lines> readLines(std::string_view start, std::uint64_t fileBytes, std::uint64_t& bodyAt) {
    Lines lines;
    for (std::size_t at = 0; !lines.contains("DATA");) {
        const auto end = start.find('\n', at);
        if (end == std::string_view::npos) {
            if (start.size() >= longestPcdHeader)
                return fail(ErrorCode::Malformed, "its PCD header has no line \"DATA …\" within 64 KiB");
            return fail(ErrorCode::Truncated,
                        "it ends at byte " + grouped(fileBytes) + ", within its PCD header");
        }
        auto values = words(start.substr(at, end - at));
        if (!values.empty() && !values[0].starts_with('#')) {
            auto key = std::string(values[0] == "COLUMNS" ? "FIELDS" : values[0]);
            static constexpr std::string_view known[] = {"VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
                                                         "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
            if (std::find(std::begin(known), std::end(known), key) == std::end(known))
                return wrong(at, quotedText(key) + " is not a word of PCD headers");
            values.erase(values.begin());
            if (!lines.emplace(key, Line{at, std::move(values)}).second)
                return wrong(at, key + " is there twice");
        }
        at = end + 1;
        bodyAt = at;
    }
    return lines;
}

std::optional<ColumnType> typeOf(std::string_view letter, std::string_view size) {
    if (size == "4" && letter == "F") return ColumnType::Float32;
    if (size == "8" && letter == "F") return ColumnType::Float64;
    if (letter != "I" && letter != "U") return std::nullopt;
    const bool isSigned = letter == "I";
    if (size == "1") return isSigned ? ColumnType::Int8 : ColumnType::Uint8;
    if (size == "2") return isSigned ? ColumnType::Int16 : ColumnType::Uint16;
    if (size == "4") return isSigned ? ColumnType::Int32 : ColumnType::Uint32;
    if (size == "8") return isSigned ? ColumnType::Int64 : ColumnType::Uint64;
    return std::nullopt;
}

Expected<void> readFields(const Lines& lines, PcdHeader& header) {
    for (const char* needed : {"FIELDS", "SIZE", "TYPE"})
        if (!lines.contains(needed))
            return fail(ErrorCode::Malformed, std::string("its PCD header has no line \"") + needed + " …\"");
    const auto& names = lines.at("FIELDS");
    const auto n = names.values.size();
    if (n == 0 || n > mostFields) return wrong(names.at, "1 to 1,000 fields are allowed");
    for (const char* key : {"SIZE", "TYPE", "COUNT"}) {
        const auto found = lines.find(key);
        if (found != lines.end() && found->second.values.size() != n)
            return wrong(found->second.at, fmt::format("{} has {} values for {} fields", key,
                                                       grouped(found->second.values.size()), grouped(n)));
    }
    const auto counts = lines.find("COUNT");
    for (std::size_t i = 0; i < n; ++i) {
        PcdField field;
        field.name = names.values[i];
        const auto type = typeOf(lines.at("TYPE").values[i], lines.at("SIZE").values[i]);
        if (!type)
            return wrong(lines.at("SIZE").at,
                         "field " + printableText(field.name, 40) + " has no known type");
        field.type = *type;
        const auto count = counts == lines.end() ? 1 : number(counts->second.values[i]).value_or(0);
        if (count == 0 || count > longestPoint)
            return wrong(counts->second.at,
                         "the count of " + printableText(field.name, 40) + " is not 1 to 65,536");
        field.count = static_cast<std::uint32_t>(count);
        field.offset = header.pointBytes;
        header.pointBytes += field.bytes();
        if (header.pointBytes > longestPoint) return wrong(names.at, "a point has more than 65,536 bytes");
        header.fields.push_back(std::move(field));
    }
    return {};
}

Expected<void> readMeanings(PcdHeader& header) {
    for (std::size_t i = 0; i < header.fields.size(); ++i) {
        const auto& field = header.fields[i];
        const auto meaning = meaningOf(field.name);
        if (!meaning || field.count != 1) continue;
        if (*meaning == Meaning::PackedColor && bytesOf(field.type) != 4) continue;
        if (header.meanings.has(*meaning)) {
            // Two intensities are one too many, but harm nobody; two x do.
            if (*meaning <= Meaning::Z)
                return fail(ErrorCode::Malformed,
                            "field " + quotedText(field.name) + " and another one have the same meaning");
            const auto& known = header.fields[header.fieldOf[static_cast<std::size_t>(*meaning)]];
            if (!isPlainer(field.name, known.name)) continue;
        }
        header.meanings[*meaning] = field.type;
        header.fieldOf[static_cast<std::size_t>(*meaning)] = i;
    }
    for (const auto& [meaning, name] : {std::pair(Meaning::X, "x"), {Meaning::Y, "y"}, {Meaning::Z, "z"}})
        if (!header.meanings.has(meaning))
            return fail(ErrorCode::Malformed, std::string("its points have no field \"") + name + "\"");
    return {};
}

Expected<void> readCounts(const Lines& lines, PcdHeader& header) {
    const auto read = [&](const char* key) -> Expected<std::optional<std::uint64_t>> {
        const auto found = lines.find(key);
        if (found == lines.end()) return std::optional<std::uint64_t>();
        const auto value = found->second.values.size() == 1 ? number(found->second.values[0]) : std::nullopt;
        if (!value) return wrong(found->second.at, std::string(key) + " is not a number");
        return value;
    };
    const auto width = read("WIDTH");
    const auto height = read("HEIGHT");
    const auto points = read("POINTS");
    for (const auto* value : {&width, &height, &points})
        if (!*value) return tl::unexpected(value->error());
    if (!*width && !*points)
        return fail(ErrorCode::Malformed, "its PCD header says neither WIDTH nor POINTS");
    if (!*width) {
        header.points = **points;
    } else {
        const auto rows = height->value_or(1);
        if (rows > 0 && **width > mostItems / rows)
            return wrong(lines.at("WIDTH").at, "WIDTH x HEIGHT is more than any file holds");
        header.points = **width * rows;
        if (*points && **points != header.points)
            return wrong(lines.at("POINTS").at, fmt::format("POINTS is {}, WIDTH x HEIGHT is {}",
                                                            grouped(**points), grouped(header.points)));
    }
    if (header.points == 0) return fail(ErrorCode::Empty, "it declares 0 points");
    return {};
}

/// Place and direction of the sensor: tx ty tz qw qx qy qz. Of those that are none nothing depends.
void readViewpoint(const Lines& lines, PcdHeader& header) {
    const auto found = lines.find("VIEWPOINT");
    if (found == lines.end() || found->second.values.size() != 7) return;
    glm::dvec3 place(0);
    for (int a = 0; a < 3; ++a) {
        const std::string_view text = found->second.values[std::size_t(a)];
        const auto parsed = std::from_chars(text.data(), text.data() + text.size(), place[a]);
        if (parsed.ec != std::errc{} || !std::isfinite(place[a])) return;
    }
    // A frame of a depth camera counts from the camera; elsewhere the origin says that nobody knows.
    const auto isMany = [&](const char* key) {
        const auto count = lines.find(key);
        return count != lines.end() && count->second.values.size() == 1 &&
               number(count->second.values[0]).value_or(0) > 1;
    };
    if ((isMany("WIDTH") && isMany("HEIGHT")) || place != glm::dvec3(0)) header.viewpoint = place;
}

Expected<void> readData(const Lines& lines, PcdHeader& header) {
    const auto& data = lines.at("DATA");
    const auto kind = data.values.empty() ? std::string_view() : data.values[0];
    if (kind == "ascii")
        header.data = PcdData::Ascii;
    else if (kind == "binary")
        header.data = PcdData::Binary;
    else if (kind == "binary_compressed")
        header.data = PcdData::BinaryCompressed;
    else
        return wrong(data.at,
                     "DATA is " + quotedText(kind) + "; ascii, binary and binary_compressed are known");
    return {};
}

Expected<void> checkExtent(const PcdHeader& header, std::uint64_t fileBytes) {
    if (header.data == PcdData::BinaryCompressed) return {};  // its own lengths tell
    std::uint64_t each = header.pointBytes;
    auto room = fileBytes > header.bytes ? fileBytes - header.bytes : 0;
    if (header.data == PcdData::Ascii) {
        each = 0;
        for (const auto& field : header.fields) each += 2 * field.count;  // a digit and a space
        ++room;                                                           // the last line may lack its end
    }
    if (header.points <= room / each) return {};
    return fail(
        ErrorCode::Truncated,
        fmt::format("it ends at byte {}: its header promises {} points of at least {} bytes from byte {} on, "
                    "there is room for {}",
                    grouped(fileBytes), grouped(header.points), grouped(each), grouped(header.bytes),
                    grouped(room / each)));
}

}  // namespace

Expected<PcdHeader> checkPcdHeader(std::string_view start, std::uint64_t fileBytes, bool recover) {
    PcdHeader header;
    const auto lines = readLines(start, fileBytes, header.bytes);
    if (!lines) return passOn(lines);
    if (const auto found = lines->find("VERSION"); found != lines->end() && !found->second.values.empty())
        header.version = printableText(found->second.values[0], 20);
    if (auto ok = readFields(*lines, header); !ok) return passOn(ok);
    if (auto ok = readMeanings(header); !ok) return passOn(ok);
    if (auto ok = readCounts(*lines, header); !ok) return passOn(ok);
    readViewpoint(*lines, header);
    if (auto ok = readData(*lines, header); !ok) return passOn(ok);
    if (recover) return header;
    if (auto ok = checkExtent(header, fileBytes); !ok) return passOn(ok);
    return header;
}

Expected<void> checkPcdCompression(const PcdHeader& header, std::uint32_t compressed,
                                   std::uint32_t uncompressed, std::uint64_t fileBytes) {
    const auto at = header.bytes + 8;
    if (compressed > fileBytes - std::min(at, fileBytes))
        return fail(ErrorCode::Truncated,
                    fmt::format("it ends at byte {}: {} bytes of compressed points should follow byte {}",
                                grouped(fileBytes), grouped(compressed), grouped(at)));
    if (uncompressed == header.points * header.pointBytes) return {};
    return fail(
        ErrorCode::Malformed,
        fmt::format("byte {}: its compressed points unpack to {} bytes; {} points of {} bytes are promised",
                    header.bytes + 4, grouped(uncompressed), grouped(header.points),
                    grouped(header.pointBytes)));
}

}  // namespace scancast::import_pcl
