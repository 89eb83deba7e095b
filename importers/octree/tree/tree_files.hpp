// The files of an octree that is kept as a folder: opened by their names in it, and nothing outside of it ever. On disk
// here; tests and fuzzers keep them in memory. *Thread safety*: const functions from any thread. Pipeline: folder →
// **files** → hierarchy, points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "files/input_folder.hpp"
#include "protocol/error.hpp"
#include "renderer/cloud/import/octree/json_values.hpp"

namespace scancast::import_octree {

/// One of them, open. *Thread safety*: as above.
class TreeFile {
  public:
    virtual ~TreeFile() = default;
    virtual std::uint64_t bytes() const = 0;
    /// All of `into`, from `offset` on. Errors: Truncated where the file ends before, Io; they name the file.
    virtual Expected<void> read(std::uint64_t offset, std::span<std::byte> into) const = 0;
};

/// What a folder holds.
struct TreeEntry {
    std::string name;
    bool isFolder = false;
};

class TreeFiles {
  public:
    virtual ~TreeFiles() = default;
    /// `name` as "ept-data/0-0-0-0.bin". Errors, which name the file: NotFound; Malformed for what leads out of the folder,
    /// or is no file; Io.
    virtual Expected<std::unique_ptr<TreeFile>> open(const std::string& name) const = 0;
    /// Folders and files in a folder beneath, in any order; a link is a file. Errors as above.
    virtual Expected<std::vector<TreeEntry>> list(const std::string& folder) const = 0;

    /// Whether there is something of that name.
    bool has(const std::string& name) const;
    /// All of a file. Errors: open()'s; ResourceLimit beyond `longest` bytes.
    Expected<std::vector<std::byte>> readAll(const std::string& name, std::uint64_t longest) const;
};

/// The object in a file of JSON (parseJsonObject()).
Expected<nlohmann::json> readJsonObject(const TreeFiles& files, const std::string& name);

/// On disk.
class FolderFiles final : public TreeFiles {
  public:
    explicit FolderFiles(InputFolder folder) : folder_(std::move(folder)) {}

    Expected<std::unique_ptr<TreeFile>> open(const std::string& name) const override;
    Expected<std::vector<TreeEntry>> list(const std::string& folder) const override;

  private:
    InputFolder folder_;
};

}  // namespace scancast::import_octree
