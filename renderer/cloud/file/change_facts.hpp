// Changes what a finished cloud file tells of its cloud, and none of its blocks: new facts are written behind the
// old ones, and the header then says where they are (CLOUD_FILE.md, "Changing the facts"). Whatever interrupts
// it, the file has the old facts or the new ones; who has it open keeps reading. Any thread.
#pragma once

#include <filesystem>
#include <functional>

#include "renderer/cloud/cloud.hpp"

namespace scancast {

/// `facts` are those of the file but for what is to change; what its indices depend on - points, columns,
/// companions - stays: InvalidArgument. Other errors: CloudFile::open()'s; Unsupported for a version 1 file;
/// InvalidArgument where somebody else is changing it; Io; ResourceLimit for a full disk. The file has its old
/// facts after each, but for a disk that fails at the very last: then those or the new ones.
Expected<void> rewriteFacts(const std::filesystem::path& file, const CloudFacts& facts);

/// The same for a part of them: `change` gets the facts as they are while nobody else can change them, so that two who change
/// different things at once both succeed or are told; where it fails, so does this, and nothing is written.
Expected<void> changeFacts(const std::filesystem::path& file,
                           const std::function<Expected<void>(CloudFacts&)>& change);

}  // namespace scancast
