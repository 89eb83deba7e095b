// What a cloud file tells of its cloud, as JSON: CloudFacts and who wrote it, exactly, in both directions.
// Pure functions, any thread. Pipeline: builder → **facts** → cloud file → residency, info.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/cloud/cloud.hpp"
#include "renderer/cloud/file/block_place.hpp"
#include "renderer/cloud/file/file_layout.hpp"

namespace scancast {

/// Longest text that is read: a cloud's facts are some kilobytes.
inline constexpr std::size_t longestFacts = std::size_t(16) << 20;

struct StoredFacts {
    CloudFacts facts;
    std::string writtenBy;           ///< "scancast 0.1.0"
    std::vector<BlockPlace> photos;  ///< where the bytes of facts.photos are
};

/// `photos`: where the bytes of facts.photos are. Doubles read back exactly; texts that are no UTF-8 are made some. InvalidArgument for facts that
/// parseFacts() would refuse, so that nothing is written which cannot be read.
Expected<std::string> printFacts(const CloudFacts& facts, std::string_view writtenBy,
                                 std::span<const BlockPlace> photos = {});
/// Of a cloud file of this version: version 1 knows neither planes nor photos. Photos come without their data. Malformed, naming the field, for what is missing, of
/// another type or impossible. Fields that are not known are passed over.
Expected<StoredFacts> parseFacts(std::string_view json, std::uint32_t version = cloudFileVersion);

/// "scancast 0.1.0": this program.
std::string_view programName();

}  // namespace scancast
