#include "importers/pcl/raw_rows.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace scancast::import_pcl {

namespace {

static_assert(std::endian::native == std::endian::little);
constexpr std::uint64_t rowSliceBytes = std::uint64_t(1) << 20;

template <class T>
double number(const std::byte* at, bool bigEndian) {
    T value;
    if (bigEndian) {
        std::array<std::byte, sizeof(T)> turned;
        std::reverse_copy(at, at + sizeof(T), turned.begin());
        std::memcpy(&value, turned.data(), sizeof value);
    } else {
        std::memcpy(&value, at, sizeof value);
    }
    return static_cast<double>(value);
}

double number(const std::byte* at, ColumnType type, bool bigEndian) {
    switch (type) {
        case ColumnType::Int8:
            return number<std::int8_t>(at, false);
        case ColumnType::Uint8:
            return number<std::uint8_t>(at, false);
        case ColumnType::Int16:
            return number<std::int16_t>(at, bigEndian);
        case ColumnType::Uint16:
            return number<std::uint16_t>(at, bigEndian);
        case ColumnType::Int32:
            return number<std::int32_t>(at, bigEndian);
        case ColumnType::Uint32:
            return number<std::uint32_t>(at, bigEndian);
        case ColumnType::Int64:
            return number<std::int64_t>(at, bigEndian);
        case ColumnType::Uint64:
            return number<std::uint64_t>(at, bigEndian);
        case ColumnType::Float32:
            return number<float>(at, bigEndian);
        case ColumnType::Float64:
            break;
    }
    return number<double>(at, bigEndian);
}

}  // namespace

void readRow(const std::byte* row, const RowLayout& layout, RawPoint& into) {
    for (const RowField& field : layout.fields) {
        // Four bytes, as both headers' checks make sure.
        const auto type = field.meaning == Meaning::PackedColor ? ColumnType::Uint32 : field.type;
        into[static_cast<std::size_t>(field.meaning)] = number(row + field.offset, type, layout.bigEndian);
    }
}

Expected<std::uint64_t> readRows(std::istream& stream, const RowLayout& layout, std::uint64_t count,
                                 const RawPointSink& sink) {
    const auto inSlice = std::max<std::uint64_t>(1, rowSliceBytes / layout.bytes);
    std::vector<std::byte> slice;
    RawPoint point{};
    for (std::uint64_t done = 0; done < count;) {
        slice.resize(std::min(inSlice, count - done) * layout.bytes);
        stream.read(reinterpret_cast<char*>(slice.data()), static_cast<std::streamsize>(slice.size()));
        const auto there = static_cast<std::uint64_t>(stream.gcount()) / layout.bytes;
        for (std::uint64_t i = 0; i < there; ++i) {
            readRow(slice.data() + i * layout.bytes, layout, point);
            if (auto ok = sink(point); !ok) return passOn(ok);
        }
        done += there;
        if (there * layout.bytes < slice.size()) return done;
    }
    return count;
}

}  // namespace scancast::import_pcl
