#include "server/commands/serve/catalog_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <system_error>
#include <utility>

#include "renderer/cloud/file/cloud_file.hpp"
#include "server/catalog/catalog.hpp"

namespace scancast {

namespace fs = std::filesystem;

CatalogFolder::CatalogFolder(fs::path path, std::size_t most, std::function<void(const std::string&)> onNote)
    : path_(std::move(path)), most_(most), onNote_(std::move(onNote)) {}

void CatalogFolder::note(const std::string& text) {
    if (onNote_) onNote_(text);
}

std::optional<std::vector<std::string>> CatalogFolder::names() {
    std::error_code error;
    std::vector<std::string> names;
    std::size_t looked = 0;
    for (fs::directory_iterator i(path_, error), end; !error && i != end; i.increment(error)) {
        if (++looked > mostNames) break;
        std::string name = i->path().filename().string();
        // Hidden ones are being written, or are none of a person's.
        if (!name.starts_with('.')) names.push_back(std::move(name));
    }
    const bool isUnreadable = error || looked > mostNames;
    if (isUnreadable && !isUnreadable_)
        note(fmt::format("{}: the clouds stay as they are, because the folder cannot be read: {}",
                         path_.string(),
                         error ? error.message() : fmt::format("it holds more than {} files", mostNames)));
    isUnreadable_ = isUnreadable;
    if (isUnreadable) return std::nullopt;
    std::ranges::sort(names);
    return names;
}

void CatalogFolder::judge(const std::string& name, const InputFile& file, Known& known) {
    known.judged = file.identity();
    if (!isCloudFile(file)) {
        if (fs::path(name).extension() == ".scan")
            note(fmt::format("{} is not served: it is no cloud file.", (path_ / name).string()));
        return;
    }
    auto shared = file.share();
    const auto opened = shared ? CloudFile::open(std::move(*shared))
                               : Expected<std::shared_ptr<const CloudFile>>(tl::unexpected(shared.error()));
    known.isWhole = opened.has_value();
    if (!opened)
        note(fmt::format("{} is not served until it is whole: {}", (path_ / name).string(),
                         opened.error().message));
}

bool CatalogFolder::isServed(const std::string& name, Known& known) {
    const auto file = InputFile::open(path_ / name);
    if (!file) {  // no regular file, or one that nobody may read; what was served goes on from what is open
        if (file.error().code == ErrorCode::NotFound) known = {};
        return known.isWhole;
    }
    if (!known.isWhole && known.judged != file->identity()) judge(name, *file, known);
    return known.isWhole;
}

std::vector<fs::path> CatalogFolder::choose() {
    std::vector<fs::path> files;
    std::vector<std::string> namesakes;
    std::set<std::string> ids;
    std::size_t beyond = 0;
    for (auto& [name, known] : known_) {
        if (!isServed(name, known)) continue;
        if (!ids.insert(cloudIdFor(fs::path(name).stem().string())).second)
            namesakes.push_back(name);
        else if (files.size() < most_)
            files.push_back(path_ / name);
        else
            ++beyond;
    }
    for (const std::string& name : namesakes)
        if (std::ranges::find(namesakes_, name) == namesakes_.end())
            note(fmt::format("{} is not served: another file's cloud has the id {} already; rename one.",
                             (path_ / name).string(), cloudIdFor(fs::path(name).stem().string())));
    namesakes_ = std::move(namesakes);
    if (beyond > 0 && !isFull_)
        note(fmt::format("{}: {} clouds are not served, because --max-clouds is {}.", path_.string(), beyond,
                         most_));
    isFull_ = beyond > 0;
    return files;
}

bool CatalogFolder::look(Time now) {
    if (looked_ && now - *looked_ < interval) return false;
    looked_ = now;
    const auto there = names();
    if (!there) return false;
    std::map<std::string, Known> known;
    for (const std::string& name : *there) {
        const auto before = known_.find(name);
        known.emplace(name, before == known_.end() ? Known{} : std::move(before->second));
    }
    known_ = std::move(known);
    auto files = choose();
    const bool isOther = files != files_;
    files_ = std::move(files);
    return isOther;
}

}  // namespace scancast
