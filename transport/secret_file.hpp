// Files that hold secrets: access tokens, and the keys of certificates. Free functions; any thread.
#pragma once

#include <filesystem>
#include <string>

#include "protocol/error.hpp"

namespace scancast {

/// What is in a file that is nobody else's to read or anybody else's to write: its owner's, at most readable
/// by its group (as service managers mount secrets). Errors: those of InputFile::open(), InvalidArgument,
/// ResourceLimit beyond `most` bytes; each names the file and the way out.
Expected<std::string> readSecretFile(const std::filesystem::path& path, std::size_t most);

/// The token in a file: read as above, trimmed, and parsed (protocol/bearer.hpp).
Expected<std::string> readTokenFile(const std::filesystem::path& path);

}  // namespace scancast
