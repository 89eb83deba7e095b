// Any bytes at all as a PLY or PCD header: an error, or a header whose promises fit into the file. Binary vertices are read.
#include <cstdlib>
#include <sstream>
#include <string>
#include <string_view>

#include "importers/pcl/pcd_header.hpp"
#include "importers/pcl/ply_header.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast::import_pcl;
    const std::string_view start(reinterpret_cast<const char*>(data), size);
    if (const auto ply = checkPlyHeader(start, size)) {
        // Three coordinates of at least a byte each, in text two (the last may lack its blank).
        if (ply->bytes > size || ply->vertices == 0 || ply->vertices > size / 3) std::abort();
        if (const auto rows = vertexRows(*ply)) {
            if (rows->at + ply->vertices * rows->layout.bytes > size) std::abort();
            std::istringstream stream{std::string(start)};
            stream.seekg(static_cast<std::streamoff>(rows->at));
            std::uint64_t seen = 0;
            const auto read = readRows(stream, rows->layout, ply->vertices, [&](const RawPoint&) {
                ++seen;
                return scancast::Expected<void>();
            });
            if (!read || *read != ply->vertices || seen != *read) std::abort();
        }
    }
    if (const auto pcd = checkPcdHeader(start, size)) {
        if (pcd->bytes > size || pcd->points == 0) std::abort();
        if (pcd->data != PcdData::BinaryCompressed && pcd->points > size / 3) std::abort();
    }
    return 0;
}
