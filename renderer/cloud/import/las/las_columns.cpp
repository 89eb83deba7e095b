#include "renderer/cloud/import/las/las_columns.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "files/bytes.hpp"
#include "renderer/cloud/exact_columns.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast {

namespace {

// One descriptor of the Extra Bytes record, ASPRS LAS 1.4 R15, table 24.
constexpr std::size_t descriptorBytes = 192;
enum InDescriptor : std::size_t {
    inType = 2,
    inOptions = 3,
    inName = 4,
    inScale = 112,
    inOffset = 136,
    inDescription = 160,
};
constexpr std::size_t textBytes = 32;
constexpr unsigned hasScale = 8, hasOffset = 16;

struct Type {
    ColumnType type;
    std::uint8_t bytes;
};
// Types 1 to 10; 11 to 20 are pairs of them and 21 to 30 triples, both deprecated since.
constexpr Type types[] = {
    {ColumnType::Uint8, 1},   {ColumnType::Int8, 1},    {ColumnType::Uint16, 2}, {ColumnType::Int16, 2},
    {ColumnType::Uint32, 4},  {ColumnType::Int32, 4},   {ColumnType::Uint64, 8}, {ColumnType::Int64, 8},
    {ColumnType::Float32, 4}, {ColumnType::Float64, 8},
};
constexpr unsigned highestType = 30;

LasColumn field(const char* name, std::uint32_t at, ColumnType type, std::uint8_t bytes,
                const std::string& description = "") {
    LasColumn result;
    result.column = {name, type, 1, 0, description};
    result.at = at;
    result.bytes = bytes;
    return result;
}

LasColumn bitsOf(const char* name, std::uint32_t at, int shift, int bits, const char* description = "") {
    auto result = field(name, at, ColumnType::Uint8, 1, description);
    result.shift = static_cast<std::uint8_t>(shift);
    result.bits = static_cast<std::uint8_t>(bits);
    return result;
}

constexpr const char* flagMeaning = "1 synthetic, 2 key point, 4 withheld";
constexpr const char* newFlagMeaning = "1 synthetic, 2 key point, 4 withheld, 8 overlap";

std::string timeMeaning(const std::optional<std::uint64_t>& offset) {
    if (!offset) return "seconds of the GPS week";
    if (*offset == 1'000'000'000) return adjustedTimeText;
    return "offset GPS time: seconds since 1980-01-06, less " + std::to_string(*offset / 1'000'000) + "e6";
}

/// Point formats 0-5, table 7.
void addOldFields(std::vector<LasColumn>& columns) {
    columns.push_back(bitsOf("return_number", 14, 0, 3));
    columns.push_back(bitsOf("number_of_returns", 14, 3, 3));
    columns.push_back(bitsOf("scan_direction_flag", 14, 6, 1));
    columns.push_back(bitsOf("edge_of_flight_line", 14, 7, 1));
    columns.push_back(bitsOf("class_flags", 15, 5, 3, flagMeaning));
    columns.push_back(field("scan_angle", 16, ColumnType::Int8, 1, "degrees"));
    columns.push_back(field("user_data", 17, ColumnType::Uint8, 1));
    columns.push_back(field("point_source_id", 18, ColumnType::Uint16, 2));
}

/// Point formats 6-10, table 14.
void addNewFields(std::vector<LasColumn>& columns) {
    columns.push_back(bitsOf("return_number", 14, 0, 4));
    columns.push_back(bitsOf("number_of_returns", 14, 4, 4));
    columns.push_back(bitsOf("class_flags", 15, 0, 4, newFlagMeaning));
    columns.push_back(bitsOf("scanner_channel", 15, 4, 2));
    columns.push_back(bitsOf("scan_direction_flag", 15, 6, 1));
    columns.push_back(bitsOf("edge_of_flight_line", 15, 7, 1));
    columns.push_back(field("scan_angle", 18, ColumnType::Int16, 2, "degrees"));
    columns.back().column.scale = 0.006;
    columns.push_back(field("user_data", 17, ColumnType::Uint8, 1));
    columns.push_back(field("point_source_id", 20, ColumnType::Uint16, 2));
}

std::string textAt(std::span<const std::byte> bytes, std::size_t at) {
    return printableText({reinterpret_cast<const char*>(bytes.data()) + at, textBytes}, textBytes);
}

/// A name that no column before has: the points' own fields come first.
std::string uniqueName(const std::vector<LasColumn>& columns, const std::string& wanted) {
    auto name = wanted;
    const auto taken = [&] {
        return std::any_of(columns.begin(), columns.end(),
                           [&](const LasColumn& c) { return c.column.name == name; });
    };
    for (int copy = 2; taken(); ++copy) name = wanted + "_" + std::to_string(copy);
    return name;
}

/// Extra bytes being given their columns, front to back.
class ExtraColumns {
  public:
    ExtraColumns(std::vector<LasColumn>& columns, std::uint32_t begin, std::uint32_t end)
        : columns_(columns), at_(begin), end_(end) {}

    /// False when the bytes that it speaks of are not there, or it makes no sense.
    bool describe(std::span<const std::byte> descriptor) {
        const auto type = loadLe<std::uint8_t>(descriptor.data() + inType);
        const unsigned options = loadLe<std::uint8_t>(descriptor.data() + inOptions);
        const auto name = textAt(descriptor, inName);
        const auto text = textAt(descriptor, inDescription);
        if (type == 0) return undocumented(name, options);
        if (type > highestType) return false;
        const auto& [columnType, bytes] = types[(type - 1) % 10];
        const std::size_t values = 1 + (type - 1) / 10;
        if (values * bytes > end_ - at_) return false;
        for (std::size_t i = 0; i < values; ++i) {
            LasColumn column = field("", at_, columnType, bytes);
            if (options & hasScale) column.column.scale = number(descriptor, inScale + 8 * i, 1);
            if (options & hasOffset) column.column.offset = number(descriptor, inOffset + 8 * i, 0);
            column.column.description = text;
            add(std::move(column), values == 1 ? name : name.empty() ? name : name + "_" + std::to_string(i));
        }
        return true;
    }

    /// All that are left, one by one.
    void rest() {
        while (at_ < end_ && room()) add(field("", at_, ColumnType::Uint8, 1), "");
    }

  private:
    /// `options` of type 0 is the number of bytes.
    bool undocumented(const std::string& name, unsigned bytes) {
        if (bytes > end_ - at_) return false;
        for (unsigned i = 0; i < bytes; ++i)
            add(field("", at_, ColumnType::Uint8, 1), name.empty() ? name : name + "_" + std::to_string(i));
        return true;
    }

    void add(LasColumn column, const std::string& name) {
        const auto width = column.bytes;
        if (room()) {
            const auto wanted = name.empty() ? "extra_" + std::to_string(unnamed_++) : name;
            column.column.name = uniqueName(columns_, wanted);
            columns_.push_back(std::move(column));
            ++added_;
        }
        at_ += width;
    }

    bool room() const { return added_ < mostExtraColumns; }

    static double number(std::span<const std::byte> descriptor, std::size_t at, double otherwise) {
        const auto value = loadLe<double>(descriptor.data() + at);
        const bool good = std::isfinite(value) && (otherwise == 0 || value != 0);
        return good ? value : otherwise;
    }

    std::vector<LasColumn>& columns_;
    std::uint32_t at_, end_;
    std::size_t added_ = 0;
    int unnamed_ = 0;
};

template <class T>
void copyColumn(const std::byte* from, std::size_t stride, std::size_t count, std::byte* to,
                std::size_t rowBytes) {
    for (std::size_t i = 0; i < count; ++i, from += stride, to += rowBytes) std::memcpy(to, from, sizeof(T));
}

void copyBits(const std::byte* from, std::size_t stride, std::size_t count, const LasColumn& column,
              std::byte* to, std::size_t rowBytes) {
    const unsigned mask = (1U << column.bits) - 1;
    for (std::size_t i = 0; i < count; ++i, from += stride, to += rowBytes)
        *to = static_cast<std::byte>((std::to_integer<unsigned>(*from) >> column.shift) & mask);
}

}  // namespace

std::vector<LasColumn> lasColumns(const LasHeader& header, std::span<const std::byte> description,
                                  bool fullColors) {
    std::vector<LasColumn> columns;
    const int format = header.pointFormat;
    if (format >= 6) {
        addNewFields(columns);
    } else {
        addOldFields(columns);
    }
    const std::string time = timeMeaning(header.timeOffset);
    if (format == 1 || (format >= 3 && format <= 5))
        columns.push_back(field("gps_time", 20, ColumnType::Float64, 8, time));
    if (format >= 6) columns.push_back(field("gps_time", 22, ColumnType::Float64, 8, time));
    if (format == 8 || format == 10) columns.push_back(field("nir", 36, ColumnType::Uint16, 2));

    if (const int color = lasRecordLayout(format).color; fullColors && color >= 0)
        for (std::uint32_t c = 0; c < 3; ++c)
            columns.push_back(field(fullColorNames[c].data(), std::uint32_t(color) + 2 * c,
                                    ColumnType::Uint16, 2, "as the file has it"));

    ExtraColumns extra(columns, lasRecordLayout(format).bytes, header.recordBytes);
    for (; description.size() >= descriptorBytes; description = description.subspan(descriptorBytes))
        if (!extra.describe(description.first(descriptorBytes))) break;
    extra.rest();
    return columns;
}

void decodeLasColumns(std::span<const std::byte> records, std::size_t recordBytes,
                      std::span<const LasColumn> columns, std::vector<std::byte>& rows) {
    const auto bytes = std::accumulate(columns.begin(), columns.end(), std::size_t(0),
                                       [](std::size_t sum, const LasColumn& c) { return sum + c.bytes; });
    const auto count = records.size() / recordBytes;
    rows.resize(count * bytes);
    auto* to = rows.data();
    for (const auto& column : columns) {
        const auto* from = records.data() + column.at;
        if (column.bits < 8) {
            copyBits(from, recordBytes, count, column, to, bytes);
        } else if (column.bytes == 1) {
            copyColumn<std::uint8_t>(from, recordBytes, count, to, bytes);
        } else if (column.bytes == 2) {
            copyColumn<std::uint16_t>(from, recordBytes, count, to, bytes);
        } else if (column.bytes == 4) {
            copyColumn<std::uint32_t>(from, recordBytes, count, to, bytes);
        } else {
            copyColumn<std::uint64_t>(from, recordBytes, count, to, bytes);
        }
        to += column.bytes;
    }
}

}  // namespace scancast
