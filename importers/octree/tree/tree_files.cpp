#include "importers/octree/tree/tree_files.hpp"

#include <fmt/format.h>

#include <system_error>

#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_octree {

namespace {

std::string called(const std::string& name) {
    return "its file " + printableText(name, 200);
}

/// What opening it says, without the path of its folder.
tl::unexpected<Error> notOpened(const std::string& name, const Error& error) {
    switch (error.code) {
        case ErrorCode::NotFound:
            return fail(ErrorCode::NotFound, called(name) + " is missing");
        case ErrorCode::InvalidArgument:
            return fail(ErrorCode::Malformed, called(name) + " is outside its folder");
        case ErrorCode::Unsupported:
            return fail(ErrorCode::Malformed, called(name) + " is no file");
        default:
            return fail(ErrorCode::Io, called(name) + " cannot be opened");
    }
}

class DiskFile final : public TreeFile {
  public:
    DiskFile(InputFile file, std::string name) : file_(std::move(file)), name_(std::move(name)) {}

    std::uint64_t bytes() const override { return file_.bytes(); }

    Expected<void> read(std::uint64_t offset, std::span<std::byte> into) const override {
        const auto got = file_.readAt(offset, into);
        if (!got) return fail(ErrorCode::Io, called(name_) + " cannot be read");
        if (*got == into.size()) return {};
        return fail(ErrorCode::Truncated, fmt::format("{} ends at byte {}, within its points", called(name_),
                                                      grouped(offset + *got)));
    }

  private:
    InputFile file_;
    std::string name_;
};

}  // namespace

bool TreeFiles::has(const std::string& name) const {
    const auto file = open(name);
    return file || file.error().code != ErrorCode::NotFound;
}

Expected<std::vector<std::byte>> TreeFiles::readAll(const std::string& name, std::uint64_t longest) const {
    const auto file = open(name);
    if (!file) return passOn(file);
    const auto bytes = (*file)->bytes();
    if (bytes > longest)
        return fail(ErrorCode::ResourceLimit, fmt::format("{} has {} bytes; {} at most are read",
                                                          called(name), grouped(bytes), grouped(longest)));
    std::vector<std::byte> content(bytes);
    if (auto ok = (*file)->read(0, content); !ok) return passOn(ok);
    return content;
}

Expected<nlohmann::json> readJsonObject(const TreeFiles& files, const std::string& name) {
    const auto bytes = files.readAll(name, longestJson);
    if (!bytes) return passOn(bytes);
    return parseJsonObject(*bytes, name);
}

Expected<std::unique_ptr<TreeFile>> FolderFiles::open(const std::string& name) const {
    auto file = folder_.file(name);
    if (!file) return notOpened(name, file.error());
    return std::make_unique<DiskFile>(std::move(*file), name);
}

Expected<std::vector<TreeEntry>> FolderFiles::list(const std::string& folder) const {
    const auto opened = folder_.at(folder);
    if (!opened) return notOpened(folder, opened.error());
    const auto* found = std::get_if<InputFolder>(&*opened);
    if (!found) return fail(ErrorCode::Malformed, called(folder) + " is no folder");
    // By the descriptor: what has the folder's name by now does not matter.
    std::error_code error;
    std::vector<TreeEntry> entries;
    const std::string path = "/proc/self/fd/" + std::to_string(found->descriptor()) + "/.";
    std::filesystem::directory_iterator at(path, error);
    for (const std::filesystem::directory_iterator end; !error && at != end; at.increment(error)) {
        std::error_code ignored;
        const auto kind = at->symlink_status(ignored).type();
        entries.push_back({at->path().filename().string(), kind == std::filesystem::file_type::directory});
    }
    if (error) return fail(ErrorCode::Io, called(folder) + " cannot be listed");
    return entries;
}

}  // namespace scancast::import_octree
