// The head of a LAS 1.4 file and its variable length records (ASPRS LAS 1.4 R15, tables 3, 4 and 24).
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>

#include "files/bytes.hpp"
#include "renderer/cloud/export/las_layout.hpp"
#include "renderer/cloud/import/crs_text.hpp"

namespace scancast {

namespace {

constexpr std::size_t headBytes = 375;  // of LAS 1.4; those of 1.5 are longer
constexpr std::size_t longestRecord = 65535, descriptorBytes = 192, textBytes = 32;
constexpr std::uint16_t wktRecord = 2112, geoKeyRecord = 34735, extraBytesRecord = 4;
constexpr std::uint16_t adjustedTimeBit = 1, wktBit = 16;

/// Numbers and texts one behind the other.
class Bytes {
  public:
    template <class T>
    void put(T value) {
        const std::size_t at = bytes_.size();
        bytes_.resize(at + sizeof value);
        storeLe(bytes_.data() + at, value);
    }
    void zeros(std::size_t count) { bytes_.resize(bytes_.size() + count); }
    /// Cut off or filled with zeros.
    void text(std::string_view text, std::size_t width) {
        const std::size_t at = bytes_.size();
        bytes_.resize(at + width);
        std::memcpy(bytes_.data() + at, text.data(), std::min(text.size(), width));
    }
    std::vector<std::byte> take() { return std::move(bytes_); }
    std::size_t size() const { return bytes_.size(); }

  private:
    std::vector<std::byte> bytes_;
};

void addRecord(LasRecords& records, std::string_view user, std::uint16_t number, std::string_view description,
               std::span<const std::byte> content) {
    Bytes head;
    head.put(std::uint16_t(0));
    head.text(user, 16);
    head.put(number);
    head.put(std::uint16_t(content.size()));
    head.text(description, textBytes);
    const auto bytes = head.take();
    records.bytes.insert(records.bytes.end(), bytes.begin(), bytes.end());
    records.bytes.insert(records.bytes.end(), content.begin(), content.end());
    ++records.count;
}

void addWkt(LasRecords& records, const std::string& wkt) {
    Bytes content;
    content.text(wkt, wkt.size() + 1);  // with a NUL at its end
    addRecord(records, "LASF_Projection", wktRecord, "coordinate reference system", content.take());
    records.wkt = true;
}

/// Where no more than its number is known.
void addGeoKeys(LasRecords& records, const ScanHeader& header) {
    const int epsg = *header.crsEpsg;
    const bool geographic = crsUnit(header.crsWkt, epsg) == "degree" || (epsg >= 4000 && epsg < 5000);
    Bytes keys;
    for (const std::uint16_t number : {1, 1, 0, 2}) keys.put(number);  // version 1.1.0, two keys
    for (const std::uint16_t number : {1024, 0, 1, geographic ? 2 : 1}) keys.put(number);
    for (const std::uint16_t number : {geographic ? 2048 : 3072, 0, 1, epsg}) keys.put(std::uint16_t(number));
    addRecord(records, "LASF_Projection", geoKeyRecord, "coordinate reference system", keys.take());
}

std::uint8_t extraType(ColumnType type) {
    switch (type) {
        case ColumnType::Uint8:
            return 1;
        case ColumnType::Int8:
            return 2;
        case ColumnType::Uint16:
            return 3;
        case ColumnType::Int16:
            return 4;
        case ColumnType::Uint32:
            return 5;
        case ColumnType::Int32:
            return 6;
        case ColumnType::Uint64:
            return 7;
        case ColumnType::Int64:
            return 8;
        case ColumnType::Float32:
            return 9;
        case ColumnType::Float64:
            return 10;
    }
    return 0;
}

void describe(Bytes& bytes, const Column& column) {
    const std::size_t begin = bytes.size();
    bytes.zeros(2);
    bytes.put(extraType(column.type));
    bytes.put(std::uint8_t((column.scale != 1 ? 8 : 0) | (column.offset != 0 ? 16 : 0)));
    bytes.text(column.name, textBytes);
    bytes.zeros(4 + 3 * 24);  // unused; no data, least, greatest
    bytes.put(column.scale);
    bytes.zeros(16);
    bytes.put(column.offset);
    bytes.zeros(16);
    bytes.text(column.description, textBytes);
    bytes.zeros(begin + descriptorBytes - bytes.size());
}

void addExtraBytes(LasRecords& records, const LasLayout& layout) {
    Bytes content;
    std::size_t left = longestRecord / descriptorBytes, undescribed = 0, cut = 0;
    const auto add = [&](const Column& column) {
        if (left == 0) return void(++undescribed);
        --left;
        cut += column.name.size() > textBytes;
        describe(content, column);
    };
    for (const LasExtra& extra : layout.extras) add(extra.column);
    if (layout.normals)
        for (const char* name : {"normal_x", "normal_y", "normal_z"})
            add({name, ColumnType::Float32, 1, 0, "normal, of unit length"});
    if (content.size() == 0) return;
    addRecord(records, "LASF_Spec", extraBytesRecord, "extra bytes", content.take());
    if (undescribed > 0)
        records.losses.push_back(
            fmt::format("{} columns of extra bytes have no name in the file, which describes {}", undescribed,
                        longestRecord / descriptorBytes));
    if (cut > 0) records.losses.push_back(fmt::format("{} names of columns are cut at 32 characters", cut));
}

}  // namespace

LasRecords lasRecords(const ScanHeader& header, const LasLayout& layout) {
    LasRecords records;
    const bool fits = header.crsWkt.size() < longestRecord;
    if (!header.crsWkt.empty() && fits)
        addWkt(records, header.crsWkt);
    else if (header.crsEpsg && *header.crsEpsg > 0 && *header.crsEpsg < 65536)
        addGeoKeys(records, header);
    else if (!header.crsWkt.empty() || header.crsEpsg)
        records.losses.push_back(
            "the coordinate reference system is too long, or has too high a number, for LAS");
    addExtraBytes(records, layout);
    if (layout.offsetTime)
        records.losses.emplace_back("GPS times count from an epoch that LAS 1.4 cannot name");
    return records;
}

std::vector<std::byte> lasHead(const LasLayout& layout, const LasRecords& records,
                               const PointSurvey& survey) {
    const bool geoKeys = records.count > 0 && !records.wkt && layout.isNew() && records.bytes.size() > 20 &&
                         loadLe<std::uint16_t>(records.bytes.data() + 18) == geoKeyRecord;
    Bytes head;
    head.text("LASF", 4);
    head.put(std::uint16_t(0));  // file source
    // Point formats from 6 on want WKT; where only a number is known, the keys that have it have to be believed.
    const bool wkt = records.wkt || (layout.isNew() && !geoKeys);
    head.put(std::uint16_t((layout.adjustedTime ? adjustedTimeBit : 0) | (wkt ? wktBit : 0)));
    head.zeros(16);  // project
    head.put(std::uint8_t(1));
    head.put(std::uint8_t(4));
    head.text("EXTRACTION", textBytes);
    head.text("scancast export", textBytes);
    head.zeros(4);  // day and year: left out, so that the same cloud is the same bytes tomorrow
    head.put(std::uint16_t(headBytes));
    head.put(std::uint32_t(headBytes + records.bytes.size()));
    head.put(records.count);
    head.put(std::uint8_t(layout.pointFormat));
    head.put(std::uint16_t(layout.recordBytes));
    const bool old = !layout.isNew() && survey.points <= std::numeric_limits<std::uint32_t>::max();
    head.put(std::uint32_t(old ? survey.points : 0));
    for (std::size_t r = 0; r < 5; ++r) head.put(std::uint32_t(old ? survey.returns[r] : 0));
    for (int a = 0; a < 3; ++a) head.put(layout.scale[a]);
    for (int a = 0; a < 3; ++a) head.put(layout.offset[a]);
    for (int a = 0; a < 3; ++a)
        for (const double end : {survey.high[a], survey.low[a]}) {
            const double q = std::nearbyint((end - layout.offset[a]) / layout.scale[a]);
            head.put(survey.points > 0 ? layout.offset[a] + q * layout.scale[a] : 0.0);
        }
    head.zeros(8 + 8 + 4);  // waveforms, extended records
    head.put(survey.points);
    for (const std::uint64_t returns : survey.returns) head.put(returns);
    return head.take();
}

}  // namespace scancast
