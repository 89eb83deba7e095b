// Where compiled GPU programs are kept from run to run. Reads the environment; any thread.
#pragma once

#include <filesystem>

namespace scancast {

/// "programs" in `cacheDir`; without one in scancast's folder of $XDG_CACHE_HOME, else of $HOME/.cache. Empty
/// when there is none of these: then nothing is kept. Need not exist.
std::filesystem::path programFolder(const std::filesystem::path& cacheDir = {});

}  // namespace scancast
