// A point stream of positions alone, record by record, right or wrong. For tests of the records that stand beside points.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/cloud/import/stream/point_stream_reader.hpp"
#include "renderer/cloud/import/stream/point_stream_writer.hpp"

namespace scancast::test {

struct SmallStream {
    std::vector<std::byte> bytes;
    PointStreamWriter writer{[this](std::span<const std::byte> more) {
        bytes.insert(bytes.end(), more.begin(), more.end());
        return true;
    }};

    explicit SmallStream(bool newest = true) {
        ScanHeader header;
        header.format = "TEST 1";
        EXPECT_TRUE(writer.writeHeader(header, newest));
    }
    void chunk(std::size_t n) {
        PointBatch batch;
        for (std::size_t i = 0; i < n; ++i) batch.position.emplace_back(1, 2, double(i));
        EXPECT_TRUE(writer.writeChunk(batch));
    }
    /// A record with any head and content.
    void raw(std::string_view tag, std::uint32_t n, std::string_view content = {}) {
        for (const char c : tag) bytes.push_back(std::byte(c));
        for (int i = 0; i < 4; ++i) bytes.push_back(std::byte(n >> (8 * i)));
        for (const char c : content) bytes.push_back(std::byte(c));
    }
    Expected<std::unique_ptr<PointStreamReader>> open(const StreamOptions& options = {}) const {
        return PointStreamReader::create(std::make_unique<MemoryByteSource>(bytes, false), options);
    }
    /// The error that it ends with.
    std::string error() const {
        auto reader = open();
        if (!reader) return reader.error().message;
        PointBatch batch;
        for (;;) {
            const auto more = (*reader)->read(batch);
            if (!more) return more.error().message;
            if (!*more) return "none";
        }
    }
};

}  // namespace scancast::test
