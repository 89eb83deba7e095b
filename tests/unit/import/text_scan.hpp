// Text in memory, read as a scan; for tests.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "renderer/cloud/import/byte_source.hpp"
#include "renderer/cloud/point_batch.hpp"
#include "tests/support/clouds/read_all.hpp"
#include "tests/unit/import/scan_summary.hpp"

namespace scancast::test {

inline std::unique_ptr<ByteSource> bytesOf(const std::string& text, bool seekable = true) {
    return std::make_unique<MemoryByteSource>(std::as_bytes(std::span(text)), seekable);
}

}  // namespace scancast::test
