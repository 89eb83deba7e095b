#include "renderer/look/keep_look.hpp"

#include <nlohmann/json.hpp>

#include "renderer/cloud/file/change_facts.hpp"
#include "renderer/look/decide_look.hpp"
#include "renderer/residency/open_cloud.hpp"

namespace scancast {

namespace {

/// What is looked at are the upper levels, in small pictures.
constexpr std::uint64_t memoryToLook = std::uint64_t(256) << 20;

}  // namespace

Expected<void> keepLook(const std::filesystem::path& file, const Look& look) {
    return changeFacts(file, [&](CloudFacts& facts) {
        facts.look = look;
        return Expected<void>();
    });
}

Expected<Look> decideAndKeepLook(const std::filesystem::path& file, const nlohmann::json& changes) {
    BlockCacheOptions options;
    options.memoryLimit = memoryToLook;
    const auto cloud = openCloud(file, BlockCache::create(options));
    if (!cloud) return passOn(cloud);
    auto look = decideLook(**cloud);
    if (look && !changes.is_null()) look = applyLook(*look, changes);
    if (!look) return look;
    if (auto ok = validate(*look); !ok) return passOn(ok);
    if (auto kept = keepLook(file, *look); !kept) return passOn(kept);
    return look;
}

}  // namespace scancast
