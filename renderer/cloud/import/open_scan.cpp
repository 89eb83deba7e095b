#include "renderer/cloud/import/open_scan.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <optional>
#include <system_error>

#include "renderer/cloud/import/byte_source.hpp"
#include "renderer/cloud/import/importer_source.hpp"
#include "renderer/cloud/import/las_source.hpp"
#include "renderer/cloud/import/ptx_source.hpp"
#include "renderer/cloud/import/scan_format.hpp"
#include "renderer/cloud/import/text_source.hpp"

namespace scancast {

namespace {

const ImporterProgram pclImporter{.name = "scancast-import-pcl"};
const ImporterProgram lazImporter{
    .name = "scancast-import-laz", .memory = ImporterProgram::Memory::Data, .knowsKeepAttributes = true};
const ImporterProgram potreeImporter{.name = "scancast-import-potree",
                                     .memory = ImporterProgram::Memory::Data};

/// The folder of the Potree octree that a path means: a folder with its description, or that file itself.
std::optional<std::filesystem::path> potreeFolder(const std::filesystem::path& path) {
    std::error_code ignored;
    for (const char* description : {"metadata.json", "cloud.js"}) {
        if (std::filesystem::is_regular_file(path / description, ignored)) return path;
        if (path.filename() == description && std::filesystem::is_regular_file(path, ignored))
            return path.parent_path();
    }
    return std::nullopt;
}

/// Of all files in a folder, however deep; links are not followed.
std::uint64_t folderBytes(const std::filesystem::path& folder) {
    namespace fs = std::filesystem;
    std::error_code error;
    std::uint64_t bytes = 0;
    fs::recursive_directory_iterator at(folder.empty() ? "." : folder,
                                        fs::directory_options::skip_permission_denied, error);
    for (const fs::recursive_directory_iterator end; !error && at != end; at.increment(error)) {
        std::error_code ignored;
        if (!at->is_regular_file(ignored)) continue;
        const auto size = at->file_size(ignored);
        if (!ignored) bytes += size;
    }
    return bytes;
}

Expected<UniqueFd> openRegularFile(const std::string& name) {
    // O_NONBLOCK: opening a named pipe without a writer must not hang; for regular files it means nothing.
    UniqueFd fd(::open(name.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
    if (!fd) {
        const int error = errno;
        if (error == ENOENT || error == ENOTDIR)
            return fail(ErrorCode::NotFound, name + ": there is no such file");
        return fail(ErrorCode::Io, name + " cannot be opened: " + std::generic_category().message(error));
    }
    struct stat info {};
    if (::fstat(fd.get(), &info) != 0)
        return fail(ErrorCode::Io, name + ": " + std::generic_category().message(errno));
    if (S_ISDIR(info.st_mode))
        return fail(ErrorCode::Unsupported, name +
                                                " is a directory without cloud.js or metadata.json, so no "
                                                "Potree octree; give the scan files in it, for example " +
                                                name + (name.ends_with('/') ? "" : "/") + "scan.las");
    if (!S_ISREG(info.st_mode))
        return fail(ErrorCode::Unsupported, name + " is a device, a pipe or a socket, not a file");
    return fd;
}

/// ".PTS" and ".pts" say the same.
std::string extensionOf(const std::filesystem::path& file) {
    auto extension = file.extension().string();
    for (char& c : extension)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return extension;
}

template <class Source>
Expected<std::unique_ptr<PointSource>> opened(Expected<std::unique_ptr<Source>> source) {
    if (!source) return tl::unexpected(source.error());
    return std::unique_ptr<PointSource>(std::move(*source));
}

}  // namespace

Expected<std::unique_ptr<PointSource>> openScan(const std::filesystem::path& file,
                                                const ImportOptions& options) {
    const auto name = file.string();
    if (const auto folder = potreeFolder(file))
        return opened(ImporterSource::create(potreeImporter, file, folderBytes(*folder), options));
    auto fd = openRegularFile(name);
    if (!fd) return tl::unexpected(fd.error());
    auto bytes = FileByteSource::create(std::move(*fd), name);
    if (!bytes) return tl::unexpected(bytes.error());

    std::array<std::byte, identifyBytes> start{};
    const auto got = (*bytes)->readAt(0, start);
    if (!got) return tl::unexpected(got.error());
    if (*got == 0) return fail(ErrorCode::Empty, name + " is an empty file (0 bytes)");
    const auto extension = extensionOf(file);
    const auto identified = identifyScan(std::span(start).first(*got), extension);
    switch (identified.format) {
        case ScanFormat::Las: {
            auto source = LasSource::create(std::move(*bytes), name, options.keepAttributes);
            if (!source) return tl::unexpected(source.error());
            return std::unique_ptr<PointSource>(std::move(*source));
        }
        case ScanFormat::Laz:
            return opened(ImporterSource::create(lazImporter, file, *(*bytes)->size(), options));
        case ScanFormat::Ply:
        case ScanFormat::Pcd:
            return opened(ImporterSource::create(pclImporter, file, *(*bytes)->size(), options));
        case ScanFormat::Text:
            return opened(
                TextSource::create(std::move(*bytes), name,
                                   {.pts = extension == ".pts", .keepAttributes = options.keepAttributes}));
        case ScanFormat::Ptx:
            return opened(PtxSource::create(std::move(*bytes), name));
        case ScanFormat::Unknown:
            break;
    }
    return fail(ErrorCode::Unsupported,
                name + ", byte 0: " + identified.reason + ". " + std::string(readableFormats()) + ".");
}

}  // namespace scancast
