#include "server/base/remote_cloud.hpp"

namespace scancast {

Expected<RemoteCloud> openRemoteCloud(RemoteFiles& remote, const std::string& url,
                                      const NativeOpening& native) {
    const auto parsed = RemoteUrl::parse(url);
    if (!parsed) return passOn(parsed);
    auto object = remote.open(*parsed);
    if (!object) return passOn(std::move(object));
    if (canBeNative(**object)) {
        const ObjectState& state = (*object)->state();
        auto scan = openNative(
            readerOf(*object), parsed->shown(),
            std::to_string(state.bytes) + " " + (state.etag.empty() ? state.lastModified : state.etag),
            native);
        if (!scan) return passOn(std::move(scan));
        return RemoteCloud{std::move(*object), std::move(*scan)};
    }
    auto file = CloudFile::open(readerOf(*object), parsed->shown());
    if (!file) {
        if (file.error().code == ErrorCode::Unsupported)
            file.error().message +=
                " Over the network cloud files are read, and scans in COPC: ingest the scan, and upload what "
                "comes of it.";
        return passOn(std::move(file));
    }
    return RemoteCloud{std::move(*object), std::move(*file)};
}

}  // namespace scancast
