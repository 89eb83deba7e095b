// A cloud in memory as a cloud file, node by node: tests of what reads such files need no ingest.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

#include "renderer/cloud/file/blocks/block_codec.hpp"
#include "renderer/cloud/file/cloud_file_writer.hpp"

namespace scancast::test {

inline void writeCloud(const Cloud& cloud, const std::filesystem::path& path) {
    auto writer = CloudFileWriter::create(path);
    ASSERT_TRUE(writer) << writer.error().message;
    std::vector<StoredNode> stored;
    std::vector<BlockPlace> curvatures;
    for (std::uint32_t i = 0; i < cloud.octree.nodes().size(); ++i) {
        const auto run = cloud.octree.run(i);
        ASSERT_TRUE(run);
        const auto place = (*writer)->append(encodeSamples(run->samples));
        ASSERT_TRUE(place) << place.error().message;
        stored.push_back({cloud.octree.node(i), *place});
        if (!hasCurvature(cloud)) continue;
        const auto beside = (*writer)->append(encodeRows(std::as_bytes(run->beside), sizeof(CurvatureCode)));
        ASSERT_TRUE(beside) << beside.error().message;
        curvatures.push_back(*beside);
    }
    const auto finished = (*writer)->finish(cloud, stored, curvatures);
    ASSERT_TRUE(finished) << finished.error().message;
}

}  // namespace scancast::test
