// Small LAZ files made here: points that move in x, compressed as POINT10 version 1 (format 0) or POINT14 (format 6), in every way to cut a
// file into chunks. What a decoder has to give stands beside it.
#pragma once

#include <cstring>
#include <string>

#include "files/bytes.hpp"
#include "importers/laz/decoder/items/median.hpp"
#include "tests/unit/laz/arithmetic_encoder.hpp"

namespace scancast::test {

using Bytes = std::vector<std::byte>;

struct LazPlan {
    int pointFormat = 0;           ///< 0, 6
    std::uint16_t compressor = 2;  ///< 1, 2, 3
    std::uint32_t chunkPoints = 50;
    std::vector<std::uint32_t> chunks{50, 50, 20};  ///< points of each
    bool tableIsWritten = true;
    bool placeIsAtEnd = false;
};

struct LazBytes {
    Bytes file;
    Bytes records;
};

inline void append(Bytes& bytes, const Bytes& more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
}

template <class T>
void put(Bytes& bytes, std::size_t at, T value) {
    storeLe(bytes.data() + at, value);
}

inline std::size_t recordBytesOf(int pointFormat) {
    return pointFormat == 6 ? 30 : 20;
}

/// x of point i: steps of all sizes, both ways.
inline std::int32_t xOf(std::uint32_t i) {
    const std::uint32_t noise = i * 2654435761U;
    return static_cast<std::int32_t>(1000 * i) + static_cast<std::int32_t>(noise >> (8 + noise % 23));
}

inline Bytes recordOf(int pointFormat, std::uint32_t i) {
    Bytes record(recordBytesOf(pointFormat));
    put<std::int32_t>(record, 0, xOf(i));
    put<std::int32_t>(record, 4, 77);
    put<std::int32_t>(record, 8, -5);
    put<std::uint16_t>(record, 12, 300);
    record[14] = pointFormat == 6 ? std::byte{0x11} : std::byte{0x09};  // return 1 of 1
    return record;
}

/// The stream of points first + 1 … first + points - 1.
inline Bytes pointStream10(std::uint32_t first, std::uint32_t points) {
    ArithmeticEncoder encoder;
    IntegerEncoder x(1), y(20), z(20);
    laz::SymbolModel<64> changed;
    std::array<std::int32_t, 3> before{};
    for (std::uint32_t i = 1; i < points; ++i) {
        const auto [low, high] = std::minmax(before[0], before[1]);
        const std::int32_t step = xOf(first + i) - xOf(first + i - 1);
        x.encode(encoder, std::clamp(before[2], low, high), step);
        y.encode(encoder, 0, 0, std::min(x.lastSize(), 19U));
        z.encode(encoder, -5, -5, std::min((x.lastSize() + y.lastSize()) / 2, 19U));
        encoder.symbol(changed, 0);
        before[(i - 1) % 3] = step;
    }
    return encoder.finish();
}

/// The number of points, the bytes of nine layers, and the only one of them that is not empty.
inline Bytes pointLayers14(std::uint32_t first, std::uint32_t points) {
    ArithmeticEncoder encoder;
    IntegerEncoder x(2), y(22);
    laz::SymbolModel<128> changed;
    laz::Median median;
    for (std::uint32_t i = 1; i < points; ++i) {
        const std::int32_t step = xOf(first + i) - xOf(first + i - 1);
        encoder.symbol(changed, 0);
        x.encode(encoder, median.get(), step, 1);
        median.add(step);
        y.encode(encoder, 0, 0, 1 + (x.lastSize() < 20 ? x.lastSize() & ~1U : 20));
    }
    const Bytes layer = encoder.finish();
    Bytes head(4 + 9 * 4);
    put(head, 0, points);
    put(head, 4, static_cast<std::uint32_t>(layer.size()));
    append(head, layer);
    return head;
}

inline Bytes lasHead(const LazPlan& plan, std::uint64_t points) {
    const std::uint16_t headerBytes = plan.pointFormat == 6 ? 375 : 227;
    Bytes head(headerBytes + 54 + 34 + 6);
    std::memcpy(head.data(), "LASF", 4);
    head[24] = std::byte{1};
    head[25] = plan.pointFormat == 6 ? std::byte{4} : std::byte{2};
    put(head, 94, headerBytes);
    put(head, 96, static_cast<std::uint32_t>(head.size()));
    put<std::uint32_t>(head, 100, 1);
    head[104] = static_cast<std::byte>(0x80 | plan.pointFormat);
    put(head, 105, static_cast<std::uint16_t>(recordBytesOf(plan.pointFormat)));
    put(head, 107, static_cast<std::uint32_t>(points));
    for (std::size_t axis = 0; axis < 3; ++axis) put(head, 131 + 8 * axis, 0.01);
    if (plan.pointFormat == 6) put(head, 247, points);
    const std::size_t vlr = headerBytes;
    std::memcpy(head.data() + vlr + 2, "laszip encoded", 14);
    put<std::uint16_t>(head, vlr + 18, 22204);
    put<std::uint16_t>(head, vlr + 20, 40);
    put(head, vlr + 54, plan.compressor);
    put(head, vlr + 54 + 12, plan.chunkPoints);
    put<std::uint16_t>(head, vlr + 54 + 32, 1);
    put<std::uint16_t>(head, vlr + 88, plan.pointFormat == 6 ? 10 : 6);
    put(head, vlr + 90, static_cast<std::uint16_t>(recordBytesOf(plan.pointFormat)));
    put<std::uint16_t>(head, vlr + 92, plan.pointFormat == 6 ? 3 : 1);
    return head;
}

inline Bytes chunkTable(const LazPlan& plan, const std::vector<std::uint32_t>& sizes) {
    ArithmeticEncoder encoder;
    IntegerEncoder numbers(2);
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        const auto before = [&](const std::vector<std::uint32_t>& of) {
            return static_cast<std::int32_t>(i > 0 ? of[i - 1] : 0);
        };
        if (plan.chunkPoints == 0xffffffff || plan.chunkPoints == 0)
            numbers.encode(encoder, before(plan.chunks), static_cast<std::int32_t>(plan.chunks[i]), 0);
        numbers.encode(encoder, before(sizes), static_cast<std::int32_t>(sizes[i]), 1);
    }
    Bytes table(8);
    put(table, 4, static_cast<std::uint32_t>(sizes.size()));
    append(table, encoder.finish());
    return table;
}

inline LazBytes makeLaz(const LazPlan& plan) {
    LazBytes made;
    std::uint32_t points = 0;
    for (const auto count : plan.chunks) points += count;
    for (std::uint32_t i = 0; i < points; ++i) append(made.records, recordOf(plan.pointFormat, i));
    made.file = lasHead(plan, points);
    const std::size_t place = made.file.size();
    if (plan.compressor != 1) made.file.resize(place + 8);
    std::vector<std::uint32_t> sizes;
    std::uint32_t first = 0;
    for (const auto count : plan.chunks) {
        const std::size_t start = made.file.size();
        append(made.file, recordOf(plan.pointFormat, first));
        append(made.file, plan.pointFormat == 6 ? pointLayers14(first, count) : pointStream10(first, count));
        sizes.push_back(static_cast<std::uint32_t>(made.file.size() - start));
        first += count;
    }
    if (plan.compressor == 1) return made;
    const auto table = static_cast<std::int64_t>(made.file.size());
    put(made.file, place, plan.tableIsWritten ? table : static_cast<std::int64_t>(place));
    if (plan.tableIsWritten) append(made.file, chunkTable(plan, sizes));
    if (plan.placeIsAtEnd) {
        put<std::int64_t>(made.file, place, -1);
        made.file.resize(made.file.size() + 8);
        put(made.file, made.file.size() - 8, table);
    }
    return made;
}

}  // namespace scancast::test
