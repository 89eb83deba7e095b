#include "server/base/remote_cloud.hpp"

#include "renderer/cloud/native/ept/ept_cloud.hpp"

namespace scancast {

namespace {

NativeName nameOf(const RemoteUrl& url, std::string title, const ObjectState& state) {
    return {url.shown(), std::move(title),
            std::to_string(state.bytes) + " " + (state.etag.empty() ? state.lastModified : state.etag)};
}

}  // namespace

std::string titleOf(const RemoteUrl& url) {
    std::string folder = url.name() == eptDescriptionName ? url.folderName() : std::string();
    return folder.empty() ? url.name() : folder;
}

Expected<RemoteCloud> openRemoteCloud(RemoteFiles& remote, const std::string& url,
                                      const NativeOpening& native) {
    const auto parsed = RemoteUrl::parse(url);
    if (!parsed) return passOn(parsed);
    auto object = remote.open(*parsed);
    if (!object) return passOn(std::move(object));
    const NativeName name = nameOf(*parsed, titleOf(*parsed), (*object)->state());
    if (parsed->name() == eptDescriptionName) {
        auto folder = remote.around(*parsed, *object);
        if (!folder) return passOn(std::move(folder));
        auto scan = openNative(std::move(*folder), name, native);
        if (!scan) return passOn(std::move(scan));
        return RemoteCloud{std::move(*object), std::move(*scan)};
    }
    if (canBeNative(**object)) {
        auto scan = openNative(readerOf(*object), name, native);
        if (!scan) return passOn(std::move(scan));
        return RemoteCloud{std::move(*object), std::move(*scan)};
    }
    auto file = CloudFile::open(readerOf(*object), parsed->shown());
    if (!file) {
        if (file.error().code == ErrorCode::Unsupported)
            file.error().message +=
                " Over the network cloud files are read, scans in COPC, and sets of EPT by their ept.json: "
                "ingest "
                "the scan, and upload what comes of it.";
        return passOn(std::move(file));
    }
    return RemoteCloud{std::move(*object), std::move(*file)};
}

}  // namespace scancast
