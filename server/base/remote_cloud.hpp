// A cloud file behind a URL, or a scan in COPC, opened: for commands, and for the loader and its watch, who have to know the object, too. Waits for
// the network. Free function; any thread. Place: URL → **cloud file** → residency.
#pragma once

#include <memory>
#include <string>

#include "remote/remote_files.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "server/base/native_cloud.hpp"

namespace scancast {

struct RemoteCloud {
    std::shared_ptr<RemoteFile> object;
    std::shared_ptr<const CloudFile> file;
};

/// A cloud file, or a scan that is shown as it is. Messages name it without its query. Errors: those of RemoteUrl::parse(), RemoteFiles::open(),
/// CloudFile::open() and openNative().
Expected<RemoteCloud> openRemoteCloud(RemoteFiles& remote, const std::string& url,
                                      const NativeOpening& native = {});

}  // namespace scancast
