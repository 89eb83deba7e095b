#include "server/commands/scans/glob.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

namespace scancast {
namespace {

namespace fs = std::filesystem;

/// Takes one character off `text`: a whole one of UTF-8, else a byte, beyond all of those.
char32_t takeCharacter(std::string_view& text) {
    const auto lead = static_cast<unsigned char>(text.front());
    const std::size_t length = lead < 0x80       ? 1
                               : lead >> 5 == 6  ? 2
                               : lead >> 4 == 14 ? 3
                               : lead >> 3 == 30 ? 4
                                                 : 0;
    constexpr char32_t beyond = 0x110000;
    char32_t character = length < 2 ? lead : lead & (0xff >> (length + 1));
    bool whole = length > 0 && length <= text.size();
    for (std::size_t i = 1; whole && i < length; ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        whole = byte >> 6 == 2;
        character = character << 6 | (byte & 0x3f);
    }
    text.remove_prefix(whole ? length : 1);
    return whole ? character : beyond + lead;
}

/// Behind the `[`: takes the set off `pattern`. False where it has no end, and then nothing is taken.
bool takeSet(std::string_view& pattern, char32_t character, bool& inside) {
    auto rest = pattern;
    const bool negated = !rest.empty() && (rest.front() == '!' || rest.front() == '^');
    if (negated) rest.remove_prefix(1);
    bool found = false;
    for (bool first = true; !rest.empty(); first = false) {
        if (rest.front() == ']' && !first) {
            rest.remove_prefix(1);
            pattern = rest;
            inside = found != negated;
            return true;
        }
        if (rest.front() == '\\' && rest.size() > 1) rest.remove_prefix(1);
        const char32_t low = takeCharacter(rest);
        char32_t high = low;
        if (rest.size() > 1 && rest[0] == '-' && rest[1] != ']') {
            rest.remove_prefix(1);
            if (rest.front() == '\\' && rest.size() > 1) rest.remove_prefix(1);
            high = takeCharacter(rest);
        }
        found = found || (low <= character && character <= high);
    }
    return false;
}

/// Takes what stands for one character - no `*` - off `pattern`: does it stand for this one?
bool takeOne(std::string_view& pattern, char32_t character) {
    if (pattern.front() == '?') {
        pattern.remove_prefix(1);
        return true;
    }
    if (pattern.front() == '[') {
        auto rest = pattern.substr(1);
        bool inside = false;
        if (takeSet(rest, character, inside)) {
            pattern = rest;
            return inside;
        }
    }
    if (pattern.front() == '\\' && pattern.size() > 1) pattern.remove_prefix(1);
    return takeCharacter(pattern) == character;
}

std::string unescaped(std::string_view component) {
    std::string name;
    for (std::size_t i = 0; i < component.size(); ++i) {
        if (component[i] == '\\' && i + 1 < component.size()) ++i;
        name += component[i];
    }
    return name;
}

/// Goes down a pattern, component by component.
class Walk {
  public:
    Walk(const std::string& pattern, std::size_t most) : pattern_(pattern), most_(most) {
        std::string_view rest(pattern_);
        onlyFolders_ = rest.ends_with('/');
        while (!rest.empty()) {
            const auto component = rest.substr(0, rest.find('/'));
            rest.remove_prefix(std::min(rest.size(), component.size() + 1));
            if (!component.empty()) components_.push_back(component);
        }
    }

    Expected<std::vector<std::string>> paths() {
        if (auto ok = from(pattern_.starts_with('/') ? "/" : "", 0); !ok) return passOn(ok);
        std::sort(paths_.begin(), paths_.end());
        paths_.erase(std::unique(paths_.begin(), paths_.end()), paths_.end());
        return std::move(paths_);
    }

  private:
    /// `folder` ends with a slash, or is empty: the one that this process is in.
    Expected<void> from(const std::string& folder, std::size_t component) {
        std::error_code error;
        if (component == components_.size()) {
            std::string path = folder.size() > 1 ? folder.substr(0, folder.size() - 1)
                               : folder.empty()  ? "."
                                                 : folder;
            paths_.push_back(std::move(path));
            return {};
        }
        const auto wanted = components_[component];
        const bool last = component + 1 == components_.size();
        if (wanted == "**") {
            if (auto ok = from(folder, component + 1); !ok || last)
                return ok;  // a folder at the end means all in it
            return eachIn(
                folder, [&](const std::string& name, const fs::directory_entry& entry) -> Expected<void> {
                    if (name.front() == '.' || entry.is_symlink(error) || !entry.is_directory(error))
                        return {};
                    return from(folder + name + "/", component);
                });
        }
        if (!isPattern(wanted)) return at(folder + unescaped(wanted), last, component);
        return eachIn(folder, [&](const std::string& name, const fs::directory_entry&) -> Expected<void> {
            return matchesName(wanted, name) ? at(folder + name, last, component) : Expected<void>();
        });
    }

    Expected<void> at(const std::string& path, bool last, std::size_t component) {
        std::error_code error;
        const auto found = fs::status(path, error);
        if (!last || onlyFolders_) {
            if (fs::is_directory(found)) return from(path + "/", component + 1);
        } else if (fs::exists(fs::symlink_status(path, error))) {
            paths_.push_back(path);
        }
        return {};
    }

    /// The folder is closed before the first call: however deep it goes, one is open.
    template <class F>
    Expected<void> eachIn(const std::string& folder, F f) {
        std::error_code error;
        std::vector<fs::directory_entry> entries;
        for (fs::directory_iterator i(folder.empty() ? "." : folder, error), end; !error && i != end;
             i.increment(error)) {
            if (++looked_ > most_)
                return fail(ErrorCode::ResourceLimit,
                            fmt::format("{} goes through more than {} files; name folders further down",
                                        pattern_, most_));
            entries.push_back(*i);
        }
        for (const auto& entry : entries)
            if (auto ok = f(entry.path().filename().string(), entry); !ok) return ok;
        return {};
    }

    const std::string& pattern_;
    const std::size_t most_;
    bool onlyFolders_ = false;
    std::vector<std::string_view> components_;
    std::vector<std::string> paths_;
    std::size_t looked_ = 0;
};

}  // namespace

bool isPattern(std::string_view text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '\\')
            ++i;
        else if (text[i] == '*' || text[i] == '?' || text[i] == '[')
            return true;
    }
    return false;
}

bool matchesName(std::string_view pattern, std::string_view name) {
    if (name.starts_with('.') && !pattern.starts_with('.') && !pattern.starts_with("\\.")) return false;
    // Where the last `*` stood, and how much of the name it is taken to stand for: only that one is ever tried anew.
    std::string_view behindStar, starName;
    bool star = false;
    while (!name.empty()) {
        if (!pattern.empty() && pattern.front() == '*') {
            pattern.remove_prefix(1);
            star = true;
            behindStar = pattern;
            starName = name;
            continue;
        }
        auto rest = name;
        if (!pattern.empty() && takeOne(pattern, takeCharacter(rest))) {
            name = rest;
            continue;
        }
        if (!star) return false;
        takeCharacter(starName);
        name = starName;
        pattern = behindStar;
    }
    return pattern.find_first_not_of('*') == pattern.npos;
}

Expected<std::vector<std::string>> pathsOf(const std::string& pattern, std::size_t most) {
    return Walk(pattern, most).paths();
}

}  // namespace scancast
