#include "server/base/native_cloud.hpp"

#include <fmt/format.h>

#include <array>

#include "renderer/cloud/copc/copc_cloud.hpp"
#include "renderer/cloud/copc/copc_layout.hpp"
#include "renderer/look/decide_look.hpp"

namespace scancast {

namespace {

std::optional<Look> lookOf(const std::shared_ptr<const Cloud>& upper) {
    auto look = decideLook(*upper);
    return look ? std::optional(std::move(*look)) : std::nullopt;
}

}  // namespace

bool canBeNative(const RandomReader& reader) {
    std::array<std::byte, copcStartBytes> start{};
    const auto got = reader.readAt(0, start);
    return got && isCopc(std::span<const std::byte>(start).first(*got));
}

bool isCopcFile(const InputFile& file) {
    std::array<std::byte, copcStartBytes> start{};
    const auto got = file.readAt(0, start);
    return got && isCopc(std::span<const std::byte>(start).first(*got));
}

Expected<std::shared_ptr<const CloudFile>> openNative(std::unique_ptr<RandomReader> reader,
                                                      const std::filesystem::path& name,
                                                      const std::string& identity,
                                                      const NativeOpening& opening,
                                                      std::vector<Mirror> mirrors) {
    NativeCloudOptions options{.name = name,
                               .title = name.filename().string(),
                               .identity = identity,
                               .surfels = opening.surfels,
                               .memory = opening.memory,
                               .crs = opening.crs,
                               .mirrors = std::move(mirrors)};
    if (opening.look) options.look = lookOf;
    return openCopc(std::move(reader), opening.decoders ? opening.decoders : ChunkDecoders::create({}),
                    std::move(options));
}

Expected<std::shared_ptr<const CloudFile>> openNative(InputFile file, const NativeOpening& opening,
                                                      std::vector<Mirror> mirrors) {
    const std::filesystem::path name = file.name();
    const FileIdentity identity = file.identity();
    return openNative(readerOf(std::move(file)), name, fmt::format("{} {}", identity.bytes, identity.changed),
                      opening, std::move(mirrors));
}

}  // namespace scancast
