// What the importer makes of an E57 file in memory: its point stream, read as the server reads it.
#pragma once

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "importers/e57/e57_import.hpp"
#include "renderer/cloud/import/stream/point_stream_reader.hpp"
#include "renderer/cloud/import/stream/point_stream_writer.hpp"
#include "tests/support/clouds/read_all.hpp"
#include "tests/support/e57/e57_writer.hpp"

namespace scancast::test {

struct Imported {
    ScanHeader header;
    PointBatch points;
    std::uint64_t dropped = 0;
    std::vector<std::string> notes;
    std::vector<Station> stations;
    std::vector<Photo> photos;
    bool asSteps = false;  ///< by the stream's header
};

/// The error is the importer's own, with the code that the stream hands on.
inline Expected<Imported> imported(const std::string& file, const import_e57::Choices& choices = {}) {
    std::vector<std::byte> stream;
    PointStreamWriter writer([&](std::span<const std::byte> more) {
        stream.insert(stream.end(), more.begin(), more.end());
        return true;
    });
    auto bytes =
        std::make_unique<MemoryByteSource>(std::as_bytes(std::span<const char>(file.data(), file.size())));
    if (const auto done = import_e57::importE57(std::move(bytes), choices, writer); !done) {
        EXPECT_THAT(done.error().message, ::testing::Not(::testing::HasSubstr("\n")));
        return passOn(done);
    }
    constexpr std::size_t atKnown = 12;  // of the header: what is known, 16 for steps
    const bool asSteps = (std::to_integer<unsigned>(stream[atKnown]) & 16U) != 0;
    auto reader = PointStreamReader::create(std::make_unique<MemoryByteSource>(stream, false),
                                            {.photos = std::filesystem::temp_directory_path()});
    if (!reader) return passOn(reader);
    Imported result{
        .header = (*reader)->header(), .points = {}, .dropped = 0, .notes = {}, .stations = {}, .photos = {}};
    auto points = readAll(**reader);
    if (!points) return passOn(points);
    result.points = std::move(*points);
    result.asSteps = asSteps;
    result.dropped = (*reader)->droppedPoints();
    result.notes = (*reader)->notes();
    result.stations = (*reader)->stations();
    result.photos = (*reader)->photos();
    return result;
}

inline void expectRefused(const std::string& file, ErrorCode code, const char* reason) {
    const auto result = imported(file);
    ASSERT_FALSE(result) << reason;
    EXPECT_EQ(name(result.error().code), name(code)) << result.error().message;
    EXPECT_THAT(result.error().message, ::testing::HasSubstr(reason));
}

}  // namespace scancast::test
