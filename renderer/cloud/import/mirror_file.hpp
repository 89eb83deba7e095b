// The mirrors of a scan: a JSON file beside it (MIRRORS.md), read, checked and written. Pure functions but
// for the reading of the file; any thread. Pipeline: file → **mirrors** → cloud.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "files/input_file.hpp"
#include "renderer/cloud/cloud.hpp"

namespace scancast {

inline constexpr std::size_t mostMirrors = 64;

/// Unit vectors come out, `up` at right angles to `normal`. `name` is what messages call the text. Errors:
/// Malformed, with the path of the field ("mirrors[2].width"). Unknown fields are errors.
Expected<std::vector<Mirror>> parseMirrors(std::string_view text, const std::string& name);

/// Errors: parseMirrors()'s, Io.
Expected<std::vector<Mirror>> readMirrors(const InputFile& file);
/// The same, and those of InputFile::open().
Expected<std::vector<Mirror>> readMirrors(const std::filesystem::path& path);

/// "scan.las" → "scan.las.mirrors.json".
std::filesystem::path mirrorsFileOf(const std::filesystem::path& scan);

/// Those of mirrorsFileOf(scan); none where there is no such file.
Expected<std::vector<Mirror>> mirrorsBeside(const std::filesystem::path& scan);

/// What parseMirrors() reads back as the same mirrors. Ends with a line break.
std::string printMirrors(const std::vector<Mirror>& mirrors);

}  // namespace scancast
