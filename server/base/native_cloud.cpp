#include "server/base/native_cloud.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <array>

#include "renderer/cloud/native/copc/copc_cloud.hpp"
#include "renderer/cloud/native/copc/copc_layout.hpp"
#include "renderer/cloud/native/ept/ept_cloud.hpp"
#include "renderer/look/decide_look.hpp"

namespace scancast {

namespace {

std::optional<Look> lookOf(const std::shared_ptr<const Cloud>& upper) {
    auto look = decideLook(*upper);
    return look ? std::optional(std::move(*look)) : std::nullopt;
}

NativeCloudOptions optionsOf(NativeName name, const NativeOpening& opening, std::vector<Mirror> mirrors) {
    NativeCloudOptions options{.name = std::move(name.name),
                               .title = std::move(name.title),
                               .identity = std::move(name.identity),
                               .surfels = opening.surfels,
                               .memory = opening.memory,
                               .crs = opening.crs,
                               .mirrors = std::move(mirrors)};
    if (opening.look) options.look = lookOf;
    return options;
}

std::shared_ptr<ChunkDecoders> decodersOf(const NativeOpening& opening) {
    return opening.decoders ? opening.decoders : ChunkDecoders::create({});
}

}  // namespace

bool canBeNative(const RandomReader& reader) {
    std::array<std::byte, copcStartBytes> start{};
    const auto got = reader.readAt(0, start);
    return got && isCopc(std::span<const std::byte>(start).first(*got));
}

bool canBeNative(const ScanInput& input) {
    if (input.octree()) return input.file().name().filename() == eptDescriptionName;
    std::array<std::byte, copcStartBytes> start{};
    const auto got = input.file().readAt(0, start);
    return got && isCopc(std::span<const std::byte>(start).first(*got));
}

Expected<std::shared_ptr<const CloudFile>> openNative(std::unique_ptr<RandomReader> reader, NativeName name,
                                                      const NativeOpening& opening,
                                                      std::vector<Mirror> mirrors) {
    return openCopc(std::move(reader), decodersOf(opening),
                    optionsOf(std::move(name), opening, std::move(mirrors)));
}

Expected<std::shared_ptr<const CloudFile>> openNative(std::shared_ptr<const FolderReader> files,
                                                      NativeName name, const NativeOpening& opening,
                                                      std::vector<Mirror> mirrors) {
    return openEpt(std::move(files), decodersOf(opening),
                   optionsOf(std::move(name), opening, std::move(mirrors)));
}

Expected<std::shared_ptr<const CloudFile>> openNative(const ScanInput& input, const NativeOpening& opening) {
    auto mirrors = input.mirrors();
    if (!mirrors) return passOn(std::move(mirrors));
    const FileIdentity identity = input.file().identity();
    NativeName name{input.path(), input.path().filename().string(),
                    fmt::format("{} {}", identity.bytes, identity.changed)};
    if (const InputFolder* octree = input.octree()) {
        auto folder =
            InputFolder::adopt(UniqueFd(::fcntl(octree->descriptor(), F_DUPFD_CLOEXEC, 0)), octree->name());
        if (!folder) return passOn(std::move(folder));
        return openNative(readerOf(std::move(*folder)), std::move(name), opening, std::move(*mirrors));
    }
    auto file = input.file().share();
    if (!file) return passOn(std::move(file));
    return openNative(readerOf(std::move(*file)), std::move(name), opening, std::move(*mirrors));
}

}  // namespace scancast
