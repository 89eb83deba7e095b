// A scan as it was opened, once: its file, for an octree of EPT or Potree the folder around it, and the mirrors
// beside it. Whatever reads it reads these, however often and however late; what has their names by then does
// not matter. Owned by who loads it, used on one thread. Pipeline: outside → **scan input** → reader,
// importer process.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "files/input_folder.hpp"
#include "renderer/cloud/cloud.hpp"

namespace scancast {

/// Where a scan is looked for, whenever it is: by a path, or by a name beneath a folder.
struct ScanPlace {
    std::filesystem::path root{};  ///< empty = `name` is a path
    std::filesystem::path name;
};

class ScanInput {
  public:
    /// A file, or the folder of an octree, or its description in there (ept.json, metadata.json, cloud.js). Links are
    /// followed. Errors: NotFound, Io, Unsupported for what can be no scan; they name the path.
    static Expected<ScanInput> open(const std::filesystem::path& path);
    /// The same for what lies beneath `root`, and nothing else: InvalidArgument for a name or a link that
    /// leads out.
    static Expected<ScanInput> openBeneath(const InputFolder& root, const std::filesystem::path& name);

    /// By one or the other; what has the root's name now is the root.
    static Expected<ScanInput> open(const ScanPlace& place);

    const ScanPlace& place() const { return place_; }
    /// As it was asked for; what messages call it.
    const std::filesystem::path& path() const { return path_; }
    /// A scan, a cloud file, or the description of an octree.
    const InputFile& file() const { return file_; }
    /// Around file() for an octree of EPT or Potree, else nullptr.
    const InputFolder* octree() const { return octree_ ? &*octree_ : nullptr; }
    /// Of file(), or of everything in octree().
    std::uint64_t bytes() const { return octree_ ? octree_->bytes() : file_.bytes(); }

    /// Those of the file beside it (MIRRORS.md); none where there is none. Errors: readMirrors()'s.
    Expected<std::vector<Mirror>> mirrors() const;
    /// When they were written, in nanoseconds since 1970; 0 without.
    std::int64_t mirrorsChanged() const;

  private:
    struct Lookup;
    static Expected<ScanInput> find(const Lookup& lookup);

    ScanInput(const Lookup& lookup, InputFile file);

    ScanPlace place_;
    std::filesystem::path path_;
    InputFile file_;
    std::optional<InputFolder> octree_;
    Expected<InputFile> mirrors_ = fail(ErrorCode::NotFound, {});
};

}  // namespace scancast
