// Files that hold secrets: access tokens, and the keys of certificates. Free functions; any thread.
#pragma once

#include <filesystem>
#include <string>

#include "protocol/error.hpp"

namespace scancast {

/// That it is a file, can be read, and is nobody else's to read or anybody else's to write: its owner's, at
/// most readable by its group (as service managers mount secrets). Errors: NotFound, Io, InvalidArgument;
/// each names the file and the way out.
Expected<void> checkSecretFile(const std::filesystem::path& path);

/// The token in a file: checked as above, trimmed, and parsed (protocol/bearer.hpp).
Expected<std::string> readTokenFile(const std::filesystem::path& path);

}  // namespace scancast
