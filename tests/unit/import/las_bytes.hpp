// Writes LAS files into memory for tests, straight from the tables of ASPRS LAS 1.4 R15 (and 1.5 R00) and apart from the
// reader's own tables: a field in the wrong place shows.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace scancast::test {

struct LasPoint {
    std::int32_t x = 0, y = 0, z = 0;
    std::uint16_t intensity = 0;
    std::uint8_t classification = 0;  ///< the class alone
    std::uint16_t red = 0, green = 0, blue = 0, infrared = 0;
};

struct LasRecord {
    bool extended = false;  ///< behind the points
    std::string user;
    std::uint16_t id = 0;
    std::string content;
};

struct LasFile {
    int minor = 2;
    int format = 3;
    std::uint16_t extraBytes = 0;
    double scale = 0.01, offset = 1000;
    std::vector<LasPoint> points;
    std::vector<LasRecord> records;
    bool flags = false;  ///< sets every bit that is not part of the class

    std::vector<std::byte> bytes() const;
};

template <class T>
void put(std::vector<std::byte>& bytes, std::size_t at, T value) {
    if (bytes.size() < at + sizeof value) bytes.resize(at + sizeof value);
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

inline void putText(std::vector<std::byte>& bytes, std::size_t at, const std::string& text) {
    if (bytes.size() < at + text.size()) bytes.resize(at + text.size());
    std::memcpy(bytes.data() + at, text.data(), text.size());
}

inline bool lasHasInfrared(int format) {
    return format == 8 || format == 10;
}

inline std::uint16_t lasRecordLength(int format) {
    // Table 7 and following: what each format adds to what.
    const bool modern = format >= 6;
    int length = modern ? 30 : 20;
    const bool time = format == 1 || format == 3 || format == 4 || format == 5;
    const bool color =
        format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
    const bool infrared = lasHasInfrared(format);
    const bool wave = format == 4 || format == 5 || format == 9 || format == 10;
    length += (time ? 8 : 0) + (color ? 6 : 0) + (infrared ? 2 : 0) + (wave ? 29 : 0);
    return static_cast<std::uint16_t>(length);
}

inline bool lasHasColor(int format) {
    return format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
}

inline void putPoint(std::vector<std::byte>& out, const LasFile& file, const LasPoint& point) {
    const auto at = out.size();
    // Bytes that a reader has no business with are 0xee.
    out.resize(at + lasRecordLength(file.format) + file.extraBytes, std::byte(0xee));
    put(out, at, point.x);
    put(out, at + 4, point.y);
    put(out, at + 8, point.z);
    put(out, at + 12, point.intensity);
    if (file.format >= 6) {
        put(out, at + 16, point.classification);
    } else {
        put(out, at + 15, static_cast<std::uint8_t>(point.classification | (file.flags ? 0xe0 : 0)));
    }
    if (!lasHasColor(file.format)) return;
    // Colour follows what stands before it: the core, and the time where there is one.
    const auto color = at + (file.format >= 6 ? 30 : file.format == 2 ? 20 : 28);
    put(out, color, point.red);
    put(out, color + 2, point.green);
    put(out, color + 4, point.blue);
    if (lasHasInfrared(file.format)) put(out, color + 6, point.infrared);
}

inline std::vector<std::byte> LasFile::bytes() const {
    const std::size_t headerBytes = minor >= 5 ? 393 : minor == 4 ? 375 : minor == 3 ? 235 : 227;
    std::vector<std::byte> out(headerBytes);
    putText(out, 0, "LASF");
    put(out, 24, std::uint8_t(1));
    put(out, 25, static_cast<std::uint8_t>(minor));
    put(out, 94, static_cast<std::uint16_t>(headerBytes));
    std::uint32_t plain = 0, extended = 0;
    for (const auto& record : records) {
        if (record.extended) {
            ++extended;
            continue;
        }
        ++plain;
        const auto at = out.size();
        out.resize(at + 54);
        putText(out, at + 2, record.user);
        put(out, at + 18, record.id);
        put(out, at + 20, static_cast<std::uint16_t>(record.content.size()));
        putText(out, at + 54, record.content);
    }
    put(out, 96, static_cast<std::uint32_t>(out.size()));
    put(out, 100, plain);
    put(out, 104, static_cast<std::uint8_t>(format));
    put(out, 105, static_cast<std::uint16_t>(lasRecordLength(format) + extraBytes));
    if (minor < 4 || (minor == 4 && format < 6)) put(out, 107, static_cast<std::uint32_t>(points.size()));
    for (std::size_t i = 0; i < 3; ++i) {
        put(out, 131 + 8 * i, scale);
        put(out, 155 + 8 * i, offset);
    }
    for (const auto& point : points) putPoint(out, *this, point);
    if (minor < 4) return out;
    put(out, 247, static_cast<std::uint64_t>(points.size()));
    put(out, 243, extended);
    put(out, 235, static_cast<std::uint64_t>(extended > 0 ? out.size() : 0));
    for (const auto& record : records) {
        if (!record.extended) continue;
        const auto at = out.size();
        out.resize(at + 60);
        putText(out, at + 2, record.user);
        put(out, at + 18, record.id);
        put(out, at + 20, static_cast<std::uint64_t>(record.content.size()));
        putText(out, at + 60, record.content);
    }
    return out;
}

}  // namespace scancast::test
