#include "server/commands/scans/judged_file.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>
#include <vector>

#include "files/input_file.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/import/scan_format.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;
using Kind = JudgedFile::Kind;

/// Names that nothing but scans have, of formats that are read.
constexpr std::array promising{".las", ".laz", ".copc", ".e57", ".ply", ".pcd", ".pts", ".ptx", ".xyz"};
/// Names under which texts of points are found, beside other texts.
constexpr std::array texts{".txt", ".csv", ".asc", ".xyb", ".xyzi", ".xyzn", ".xyzrgb", ".neu", ".obj"};

template <class Names>
bool isIn(const Names& names, std::string_view extension) {
    return std::find(names.begin(), names.end(), extension) != names.end();
}

std::string lowerExtension(const fs::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return extension;
}

std::vector<std::byte> startOf(const InputFile& file) {
    std::vector<std::byte> start(identifyBytes);
    start.resize(file.readAt(0, start).value_or(0));
    return start;
}

bool isTextFormat(ScanFormat format) {
    return format == ScanFormat::Text || format == ScanFormat::Ptx || format == ScanFormat::Obj;
}

Kind kindOf(const InputFile& file, std::string_view extension) {
    const auto start = startOf(file);
    if (isCloudFile(start) || extension == ".scan") return Kind::CloudFile;
    if (isIn(promising, extension)) return Kind::Scan;
    const auto format = identifyScan(start, extension).format;
    if (format == ScanFormat::Unknown) return Kind::Other;
    return !isTextFormat(format) || isIn(texts, extension) ? Kind::Scan : Kind::Other;
}

}  // namespace

JudgedFile judgeFile(const fs::path& path) {
    JudgedFile judged;
    if (path.native().ends_with(".mirrors.json")) {
        judged.kind = Kind::Mirrors;
        return judged;
    }
    const std::string extension = lowerExtension(path);
    judged.what = extension.empty() ? "without an extension" : extension;
    const auto file = InputFile::open(path);
    if (file) {
        judged.kind = kindOf(*file, extension);
        return judged;
    }
    if (file.error().code == ErrorCode::Unsupported) {
        judged.what = "not regular";
        return judged;
    }
    // Whoever reads it says why it cannot be.
    if (isIn(promising, extension)) judged.kind = Kind::Scan;
    if (extension == ".scan") judged.kind = Kind::CloudFile;
    if (judged.kind == Kind::Other) judged.what += " that cannot be read";
    return judged;
}

bool isOctreeFolder(const fs::path& folder) {
    std::error_code error;
    const auto has = [&](const char* name) { return fs::is_regular_file(folder / name, error); };
    if (has("cloud.js") || has("ept.json")) return true;
    if (!has("metadata.json")) return false;
    // Many programs call a file that; of an octree it describes the hierarchy.
    if (has("hierarchy.bin") || has("octree.bin")) return true;
    const auto file = InputFile::open(folder / "metadata.json");
    if (!file) return false;
    const auto start = startOf(*file);
    const std::string_view text(reinterpret_cast<const char*>(start.data()), start.size());
    return text.find("\"hierarchy\"") != text.npos;
}

}  // namespace scancast
