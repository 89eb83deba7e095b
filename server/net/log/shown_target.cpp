#include "server/net/log/shown_target.hpp"

#include <algorithm>

#include "protocol/text/plain_text.hpp"
#include "protocol/view/query.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast {
namespace {

constexpr std::size_t longestShown = 700, longestWord = 40, longestValue = 120, charactersOfSession = 8;
constexpr std::string_view leftOut = "…";

bool isKnown(std::string_view word) {
    if (word == "fps") return true;
    return std::ranges::any_of(viewWords(), [&](const ViewWord& known) {
        if (known.word == word) return true;
        const std::string_view group = known.group();
        return !group.empty() && word.size() > group.size() && word.starts_with(group) &&
               word[group.size()] == '.';
    });
}

/// Names that somebody may have given to a word; others may be secrets themselves.
bool isWordName(std::string_view word) {
    return !word.empty() && word.size() <= longestWord && std::ranges::all_of(word, [](char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' ||
               c == '_' || c == '-';
    });
}

std::string shownWord(std::string_view text) {
    const auto equals = text.find('=');
    if (equals == std::string_view::npos) return "*";
    const std::string_view word = text.substr(0, equals), value = text.substr(equals + 1);
    if (!isWordName(word)) return "*";
    const bool shown = isKnown(word) && value.size() <= longestValue;
    return std::string(word) + "=" + (shown ? std::string(value) : "*");
}

bool isSessionId(std::string_view text) {
    constexpr std::size_t shortest = 17;
    return text.size() >= shortest && text.front() == 's' &&
           text.substr(1).find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

/// A session's id is found wherever it stands, whether that address is served or not, and however it is spelled.
std::string shownPath(std::string_view path) {
    if (!path.starts_with('/')) return "*";  // no path: perhaps with a user's name and password
    std::string shown;
    while (!path.empty()) {
        path.remove_prefix(1);
        const std::string_view segment = path.substr(0, path.find('/'));
        path.remove_prefix(segment.size());
        const auto decoded = percentDecode(segment, "The address");
        shown += '/';
        shown += decoded && isSessionId(*decoded) ? shownSession(*decoded) : std::string(segment);
    }
    return shown;
}

}  // namespace

std::string shownSession(std::string_view id) {
    if (id.size() <= charactersOfSession)
        return std::string(id.substr(0, id.size() / 2)) + std::string(leftOut);
    return std::string(id.substr(0, charactersOfSession)) + std::string(leftOut);
}

std::string shownTarget(std::string_view target) {
    const auto mark = target.find('?');
    std::string shown = shownPath(target.substr(0, mark));
    std::string_view rest = mark == std::string_view::npos ? std::string_view() : target.substr(mark + 1);
    for (char before = '?'; !rest.empty() && shown.size() < longestShown; before = '&') {
        const auto end = rest.find('&');
        shown += before + shownWord(rest.substr(0, end));
        rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
    }
    if (shown.size() > longestShown) shown.resize(longestShown);
    if (shown.size() == longestShown || !rest.empty()) shown += leftOut;
    return plainLine(shown);
}

}  // namespace scancast
