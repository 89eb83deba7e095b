#include "server/commands/scans/found_scans.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>

#include "remote/remote_url.hpp"
#include "server/commands/scans/glob.hpp"
#include "server/commands/scans/judged_file.hpp"
#include "server/terminal/terminal.hpp"

namespace scancast {
namespace {

namespace fs = std::filesystem;

std::optional<struct stat> statOf(const std::string& path) {
    struct stat found {};
    if (::stat(path.c_str(), &found) != 0) return std::nullopt;
    return found;
}

/// A name exists, whatever a link leads to.
bool isThere(const std::string& path) {
    struct stat found {};
    return ::lstat(path.c_str(), &found) == 0;
}

std::string beneath(const std::string& folder, const std::string& name) {
    return folder.ends_with('/') ? folder + name : folder + "/" + name;
}

/// "2 .jpg, 1 .txt": the most frequent first, and not more than a line of them.
std::string kindsText(const std::map<std::string, std::size_t>& kinds) {
    std::vector<std::pair<std::string, std::size_t>> sorted(kinds.begin(), kinds.end());
    std::ranges::stable_sort(sorted, std::greater(), [](const auto& kind) { return kind.second; });
    constexpr std::size_t mostKinds = 8;
    std::string text;
    std::size_t others = 0;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        if (i >= mostKinds)
            others += sorted[i].second;
        else
            text += fmt::format("{}{} {}", i == 0 ? "" : ", ", sorted[i].second, sorted[i].first);
    }
    return others == 0 ? text : fmt::format("{}, {} others", text, others);
}

}  // namespace

Expected<void> FoundScans::add(const std::string& argument) {
    if (isRemoteUrl(argument)) return addUrl(argument);
    const auto there = statOf(argument);
    if (!there && !isThere(argument) && isPattern(argument)) return addPattern(argument);
    if (!there || !S_ISDIR(there->st_mode) || isOctreeFolder(argument)) {
        addNamed(argument);
        return {};
    }
    Search search{.argument = argument};
    search.folders.emplace(there->st_dev, there->st_ino);
    if (auto ok = lookIn(argument, 0, search); !ok) return ok;
    return settle(search, false);
}

Expected<void> FoundScans::addUrl(const std::string& argument) {
    const auto url = RemoteUrl::parse(argument);
    if (!url) return passOn(url);
    if (!options_.urls)
        return fail(ErrorCode::InvalidArgument,
                    url->shown() + ": here files are read, and no URLs; download it first");
    if (named_.insert(argument).second) files_.push_back(argument);
    return {};
}

void FoundScans::addNamed(const std::string& file) {
    const auto there = statOf(file);
    const Identity identity = there ? Identity(there->st_dev, there->st_ino) : Identity();
    if (there && inFolders_.contains(identity)) return;
    if (!named_.insert(fs::path(file).lexically_normal().string()).second) return;
    if (there) all_.insert(identity);
    files_.push_back(file);
}

Expected<void> FoundScans::addPattern(const std::string& pattern) {
    const auto paths = pathsOf(pattern, options_.most);
    if (!paths) return passOn(paths);
    Search search{.argument = pattern, .looked = paths->size()};
    for (const std::string& path : *paths)
        if (auto ok = lookAt(path, 0, search); !ok) return ok;
    return settle(search, true);
}

/// Moves what a search has found to the files.
Expected<void> FoundScans::settle(Search& search, bool pattern) {
    for (const auto& [kind, count] : search.kinds) kinds_[kind] += count;
    if (search.found.empty()) {
        const std::string there = search.kinds.empty() ? "" : " (" + kindsText(search.kinds) + ")";
        if (search.looked == 0 && pattern)
            return fail(ErrorCode::InvalidArgument, search.argument + ": no file has such a name");
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("{}: there is no scan {}{}", search.argument,
                                pattern ? "among the files with such names" : "in this folder", there));
    }
    std::ranges::sort(search.found, {}, &Found::path);
    for (Found& one : search.found) {
        if (!all_.insert(one.identity).second) continue;
        inFolders_.insert(one.identity);
        named_.insert(fs::path(one.path).lexically_normal().string());
        files_.push_back(std::move(one.path));
    }
    return {};
}

Expected<void> FoundScans::lookIn(const std::string& folder, int depth, Search& search) {
    std::error_code error;
    std::vector<std::string> names;
    for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
        if (++search.looked > options_.most)
            return fail(ErrorCode::ResourceLimit,
                        fmt::format("{} holds more than {} files; name folders further down", search.argument,
                                    options_.most));
        names.push_back(i->path().filename().string());
    }
    if (error && depth == 0)
        return fail(ErrorCode::Io, fmt::format("{} cannot be read: {}", folder, error.message()));
    if (error) leaveOut(folder, "unreadable", search);
    std::ranges::sort(names);
    for (const std::string& name : names) {
        const std::string path = beneath(folder, name);
        if (name.starts_with('.'))
            leaveOut(path, "hidden", search);
        else if (auto ok = lookAt(path, depth + 1, search); !ok)
            return ok;
    }
    return {};
}

Expected<void> FoundScans::lookAt(const std::string& path, int depth, Search& search) {
    const auto there = statOf(path);
    if (!there) {
        leaveOut(path, "linked to nowhere", search);
        return {};
    }
    const Identity identity(there->st_dev, there->st_ino);
    if (S_ISDIR(there->st_mode)) {
        if (!search.folders.insert(identity).second) return {};
        if (isOctreeFolder(path)) {
            search.found.push_back({path, identity});
            return {};
        }
        if (depth < deepest) return lookIn(path, depth, search);
        leaveOut(path, "too deep", search);
        return {};
    }
    const JudgedFile judged = judgeFile(path);
    if (judged.kind == JudgedFile::Kind::Scan ||
        (judged.kind == JudgedFile::Kind::CloudFile && options_.cloudFiles))
        search.found.push_back({path, identity});
    else if (judged.kind != JudgedFile::Kind::Mirrors)
        leaveOut(path, judged.what + (judged.kind == JudgedFile::Kind::CloudFile ? " (cloud file)" : ""),
                 search);
    return {};
}

void FoundScans::leaveOut(const std::string& path, const std::string& kind, Search& search) {
    ++search.kinds[kind];
    leftOut_.push_back(fmt::format("{} ({})", path, kind));
}

std::string FoundScans::leftOutText() const {
    std::size_t all = 0;
    for (const auto& [kind, count] : kinds_) all += count;
    if (all == 0) return {};
    return fmt::format("{}: {}", all == 1 ? "1 file is no scan" : fmt::format("{} files are no scans", all),
                       kindsText(kinds_));
}

Expected<FoundScans> findScans(std::span<const std::string> arguments, FindScansOptions options) {
    FoundScans found(options);
    for (const std::string& argument : arguments)
        if (auto ok = found.add(argument); !ok) return passOn(ok);
    return found;
}

void tellLeftOut(const FoundScans& found, bool byName) {
    if (found.leftOut().empty()) return;
    tell("{}{}\n", found.leftOutText(), byName ? ":" : "; --verbose names them");
    if (byName)
        for (const std::string& one : found.leftOut()) tell("  {}\n", one);
}

}  // namespace scancast
