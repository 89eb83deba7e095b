// A cloud file behind a URL, a scan in COPC, or a set of EPT by its ept.json, opened: for commands, and for the loader and its watch, who have to know the object, too. Waits for
// the network. Free function; any thread. Place: URL → **cloud file** → residency.
#pragma once

#include <memory>
#include <string>

#include "remote/remote_files.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "server/base/native_cloud.hpp"

namespace scancast {

struct RemoteCloud {
    std::shared_ptr<RemoteFile> object;  ///< of EPT, the description
    std::shared_ptr<const CloudFile> file;
};

/// What people call it: the file, "town.scan"; of EPT, whose description is called alike everywhere, the folder that it lies in.
std::string titleOf(const RemoteUrl& url);

/// A cloud file, or a scan that is shown as it is. Messages name it without its query. Errors: those of RemoteUrl::parse(), RemoteFiles::open(),
/// CloudFile::open() and openNative().
Expected<RemoteCloud> openRemoteCloud(RemoteFiles& remote, const std::string& url,
                                      const NativeOpening& native = {});

}  // namespace scancast
