#include "renderer/cloud/import/scan_input.hpp"

#include <algorithm>
#include <array>

#include "renderer/cloud/import/mirror_file.hpp"

namespace scancast {

namespace fs = std::filesystem;

namespace {

/// The files that describe an octree, of EPT and of Potree, newest version first.
constexpr std::array descriptions{"ept.json", "metadata.json", "cloud.js"};

bool isDescription(const fs::path& name) {
    return std::find(descriptions.begin(), descriptions.end(), name) != descriptions.end();
}

Expected<InputFile> descriptionIn(const InputFolder& folder) {
    for (const char* name : descriptions) {
        auto file = folder.file(name);
        if (file || file.error().code != ErrorCode::NotFound) return file;
    }
    const std::string name = folder.name().string();
    return fail(ErrorCode::Unsupported,
                name +
                    " is a directory without ept.json, metadata.json or cloud.js, so no octree of EPT or Potree; "
                    "give the scan files in it, for example " +
                    name + (name.ends_with('/') ? "" : "/") + "scan.las");
}

}  // namespace

/// Where names are looked up: anywhere, or beneath a folder.
struct ScanInput::Lookup {
    const InputFolder* root = nullptr;
    fs::path name;

    Expected<Input> open(const fs::path& which) const { return root ? root->at(which) : openInput(which); }
    fs::path path() const { return root ? root->name() / name : name; }

    Expected<InputFolder> folderAround() const {
        const fs::path around = name.has_parent_path() ? name.parent_path() : fs::path(".");
        auto opened = open(around);
        if (!opened) return passOn(std::move(opened));
        if (auto* folder = std::get_if<InputFolder>(&*opened)) return std::move(*folder);
        return fail(ErrorCode::NotFound, path().string() + ": there is no such file");
    }

    Expected<InputFile> mirrors() const {
        auto opened = open(mirrorsFileOf(name));
        if (!opened) return passOn(std::move(opened));
        if (auto* file = std::get_if<InputFile>(&*opened)) return std::move(*file);
        return fail(ErrorCode::Unsupported, mirrorsFileOf(path()).string() + " is a folder, not a file");
    }
};

ScanInput::ScanInput(const Lookup& lookup, InputFile file)
    : place_{lookup.root ? lookup.root->name() : fs::path(), lookup.name},
      path_(lookup.path()),
      file_(std::move(file)) {}

Expected<ScanInput> ScanInput::find(const Lookup& lookup) {
    const auto inFolder = [&](Expected<InputFile> file, InputFolder folder) -> Expected<ScanInput> {
        if (!file) return passOn(std::move(file));
        ScanInput input(lookup, std::move(*file));
        input.octree_ = std::move(folder);
        input.mirrors_ = lookup.mirrors();
        return input;
    };
    if (isDescription(lookup.name.filename())) {
        auto folder = lookup.folderAround();
        if (!folder) return passOn(std::move(folder));
        auto file = folder->file(lookup.name.filename());
        return inFolder(std::move(file), std::move(*folder));
    }
    auto opened = lookup.open(lookup.name);
    if (!opened) return passOn(std::move(opened));
    if (auto* folder = std::get_if<InputFolder>(&*opened)) {
        auto file = descriptionIn(*folder);
        return inFolder(std::move(file), std::move(*folder));
    }
    ScanInput input(lookup, std::move(std::get<InputFile>(*opened)));
    input.mirrors_ = lookup.mirrors();
    return input;
}

Expected<ScanInput> ScanInput::open(const fs::path& path) {
    return find({nullptr, path});
}

Expected<ScanInput> ScanInput::openBeneath(const InputFolder& root, const fs::path& name) {
    return find({&root, name});
}

Expected<ScanInput> ScanInput::open(const ScanPlace& place) {
    if (place.root.empty()) return open(place.name);
    const auto root = InputFolder::open(place.root);
    if (!root) return passOn(root);
    return openBeneath(*root, place.name);
}

Expected<std::vector<Mirror>> ScanInput::mirrors() const {
    if (mirrors_) return readMirrors(*mirrors_);
    if (mirrors_.error().code == ErrorCode::NotFound) return std::vector<Mirror>();
    return passOn(mirrors_);
}

std::int64_t ScanInput::mirrorsChanged() const {
    return mirrors_ ? mirrors_->identity().changed : 0;
}

}  // namespace scancast
