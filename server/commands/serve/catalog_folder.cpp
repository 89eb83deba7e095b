#include "server/commands/serve/catalog_folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <system_error>
#include <utility>

#include "renderer/cloud/file/cloud_file.hpp"

namespace scancast {

namespace fs = std::filesystem;

CatalogFolder::CatalogFolder(fs::path path, std::function<void(const std::string&)> onNote)
    : path_(std::move(path)), onNote_(std::move(onNote)), choice_(path_.string(), onNote_) {}

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

// A file that is being copied is another one with every look; that is told once and not every two seconds.
void CatalogFolder::leaveOut(const std::string& name, Known& known, Reason reason, const std::string& why) {
    if ((known.told & unsigned(reason)) != 0) return;
    known.told |= unsigned(reason);
    note(fmt::format("{} is not served{}: {}", (path_ / name).string(),
                     reason == Reason::NoCloudFile ? ""
                     : reason == Reason::NotWhole  ? " until it is whole"
                                                   : " until it can be read",
                     why));
}

// Only what its content says holds as long as that stays: what a disk, or this process's limits, did not let be seen is looked at again.
void CatalogFolder::judge(const std::string& name, const InputFile& file, Known& known) {
    std::array<std::byte, 8> start{};
    const auto got = file.readAt(0, start);
    if (!got) return leaveOut(name, known, Reason::Unreadable, got.error().message);
    if (*got < start.size() || !isCloudFile(std::span(start))) {
        known.judged = file.identity();
        if (fs::path(name).extension() != ".scan") return;
        if (*got < start.size())
            return leaveOut(name, known, Reason::NotWhole, fmt::format("it has {} bytes.", *got));
        return leaveOut(name, known, Reason::NoCloudFile, "it is no cloud file.");
    }
    auto shared = file.share();
    const auto opened = shared ? CloudFile::open(std::move(*shared))
                               : Expected<std::shared_ptr<const CloudFile>>(tl::unexpected(shared.error()));
    known.isWhole = opened.has_value();
    if (opened) return;
    const ErrorCode code = opened.error().code;
    const bool isOfContent = code != ErrorCode::Io && code != ErrorCode::ResourceLimit;
    if (isOfContent) known.judged = file.identity();
    leaveOut(name, known, isOfContent ? Reason::NotWhole : Reason::Unreadable, opened.error().message);
}

bool CatalogFolder::isServed(const std::string& name, Known& known) {
    if (known.isWhole) return true;
    const auto file = InputFile::open(path_ / name);
    if (!file) {
        const ErrorCode code = file.error().code;
        // Gone since the listing, a link to nowhere; a folder, a pipe.
        const bool isNone = code == ErrorCode::NotFound || code == ErrorCode::Unsupported;
        if (!isNone) leaveOut(name, known, Reason::Unreadable, file.error().message);
        return false;
    }
    if (known.judged != file->identity()) judge(name, *file, known);
    return known.isWhole;
}

bool CatalogFolder::look(std::size_t most) {
    const auto there = names();
    if (!there) return false;
    std::map<std::string, Known> known;
    for (const std::string& name : *there) {
        const auto before = known_.find(name);
        known.emplace(name, before == known_.end() ? Known{} : std::move(before->second));
    }
    known_ = std::move(known);
    std::vector<CatalogCandidate> candidates;
    for (auto& [name, one] : known_)
        if (isServed(name, one)) candidates.push_back({path_ / name, (path_ / name).string(), name});
    auto files = choice_.choose(std::move(candidates), most);
    const bool isOther = files != files_;
    files_ = std::move(files);
    return isOther;
}

}  // namespace scancast
