#include "server/base/remote_cloud.hpp"

namespace scancast {

Expected<RemoteCloud> openRemoteCloud(RemoteFiles& remote, const std::string& url) {
    const auto parsed = RemoteUrl::parse(url);
    if (!parsed) return passOn(parsed);
    auto object = remote.open(*parsed);
    if (!object) return passOn(std::move(object));
    auto file = CloudFile::open(readerOf(*object), parsed->shown());
    if (!file) {
        if (file.error().code == ErrorCode::Unsupported)
            file.error().message +=
                " Over the network only cloud files are read: ingest the scan, and upload what comes of it.";
        return passOn(std::move(file));
    }
    return RemoteCloud{std::move(*object), std::move(*file)};
}

}  // namespace scancast
