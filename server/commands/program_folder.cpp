#include "server/commands/program_folder.hpp"

#include <cstdlib>

namespace scancast {

std::filesystem::path programFolder(const std::filesystem::path& cacheDir) {
    const auto folderNamedBy = [](const char* variable) -> std::filesystem::path {
        const char* const value = std::getenv(variable);
        // The XDG specification: what is no absolute path is to be ignored.
        return value && value[0] == '/' ? value : "";
    };
    if (!cacheDir.empty()) return cacheDir / "programs";
    if (const auto xdg = folderNamedBy("XDG_CACHE_HOME"); !xdg.empty()) return xdg / "scancast" / "programs";
    const auto home = folderNamedBy("HOME");
    return home.empty() ? home : home / ".cache" / "scancast" / "programs";
}

}  // namespace scancast
