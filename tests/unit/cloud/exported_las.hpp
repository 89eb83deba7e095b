// A LAS file taken apart without our reader: its records as bytes, and what of them other point formats keep.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace scancast::test {

struct RawLas {
    std::string bytes;
    int minor = 0, format = 0;
    std::vector<std::string> records;  ///< sorted; without packets of waveforms

    template <class T>
    T at(std::size_t place) const {
        T value{};
        if (place + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + place, sizeof value);
        return value;
    }
    /// Of x, y, z.
    std::string grid() const { return bytes.substr(131, 48); }
};

/// Waveform formats are others with 29 bytes behind them (ASPRS LAS 1.4 R15, tables 11, 12, 16, 17): which, and
/// where the bytes are.
struct WithoutWaves {
    int format, at;
};
inline WithoutWaves withoutWaves(int format) {
    return format == 4    ? WithoutWaves{1, 28}
           : format == 5  ? WithoutWaves{3, 34}
           : format == 9  ? WithoutWaves{6, 30}
           : format == 10 ? WithoutWaves{8, 38}
                          : WithoutWaves{format, -1};
}

inline RawLas rawLas(std::string bytes) {
    RawLas las;
    las.bytes = std::move(bytes);
    las.minor = las.at<std::uint8_t>(25);
    const auto waves = withoutWaves(las.at<std::uint8_t>(104));
    las.format = waves.format;
    const std::size_t length = las.at<std::uint16_t>(105);
    std::uint64_t points = las.at<std::uint32_t>(107);
    if (las.minor >= 4 && las.at<std::uint64_t>(247) != 0) points = las.at<std::uint64_t>(247);
    std::size_t at = las.at<std::uint32_t>(96);
    for (std::uint64_t i = 0; i < points && at + length <= las.bytes.size(); ++i, at += length) {
        std::string record = las.bytes.substr(at, length);
        if (waves.at >= 0) record.erase(std::size_t(waves.at), 29);
        las.records.push_back(std::move(record));
    }
    std::sort(las.records.begin(), las.records.end());
    return las;
}

inline RawLas rawLas(const std::filesystem::path& file) {
    return rawLas(contentOf(file));
}

}  // namespace scancast::test
