// What a file is, told by its first bytes. Pure functions.
// Pipeline: file → **format** → reader.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace scancast {

/// How many first bytes identifyScan() wants to see.
inline constexpr std::size_t identifyBytes = 4096;

enum class ScanFormat : std::uint8_t {
    Unknown,
    Las,
    Laz,  ///< compressed LAS, COPC included
    E57,
    Ply,
    Pcd,
    Text,  ///< lines of points: XYZ, TXT, CSV, PTS
    Ptx,
    Obj  ///< Wavefront OBJ, of which vertices are read
};

struct Identified {
    ScanFormat format = ScanFormat::Unknown;
    /// For Unknown: why it cannot be read, and what to do, as the end of a sentence.
    std::string reason;
};

/// Goes by content. `extension` (".las") only chooses the words for a file whose content says nothing.
Identified identifyScan(std::span<const std::byte> start, std::string_view extension);

/// For messages: "Scancast reads LAS 1.0-1.4 …".
std::string_view readableFormats();

}  // namespace scancast
