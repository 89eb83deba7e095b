// A look and the cloud file that keeps it. Pipeline: finished cloud file → **look** → the same file.
#pragma once

#include <filesystem>

#include "protocol/look.hpp"

namespace scancast {

/// Changes the file in place (changeFacts()). Errors: that one's, and CloudFile::open()'s: a scan has no place
/// where a look could be kept.
Expected<void> keepLook(const std::filesystem::path& file, const Look& look);

/// Decides the look of what is in the file, changes it by `changes` (applyLook(); null = nothing), and keeps it.
/// Errors: those of openCloud(), decideLook(), applyLook() and keepLook().
Expected<Look> decideAndKeepLook(const std::filesystem::path& file, const nlohmann::json& changes);

}  // namespace scancast
