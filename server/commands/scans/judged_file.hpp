// Whether a file that lies in a folder is a scan: nobody has named it, so it has to say so itself. Reads its beginning alone;
// any thread. Place: folder → **files of it** → scans.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace scancast {

struct JudgedFile {
    enum class Kind : std::uint8_t {
        Scan,
        CloudFile,
        Mirrors,  ///< of the scan beside it, which brings them
        Other,
    };
    Kind kind = Kind::Other;
    std::string what;  ///< for people: ".jpg", "without an extension", "not regular"
};

/// By its content, and by its name where that promises a scan: a file `tile.laz` that is broken has to fail when it is read, or
/// its tile would be missing and nobody know. What looks like a text of points is one only under a name that such texts have.
JudgedFile judgeFile(const std::filesystem::path& path);

/// The folder of an octree of another program (Potree, Entwine): one scan.
bool isOctreeFolder(const std::filesystem::path& folder);

}  // namespace scancast
