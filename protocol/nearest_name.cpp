#include "protocol/nearest_name.hpp"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <vector>

#include "protocol/text/plain_text.hpp"

namespace scancast {
namespace {

constexpr std::size_t longestCompared = 64;
constexpr std::size_t longestQuote = 60;

char lower(char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

/// Edits (insert, delete, replace, swap neighbours) from one to the other; upper and lower case are the same.
std::size_t distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before(b.size() + 1), previous(b.size() + 1), current(b.size() + 1);
    std::iota(previous.begin(), previous.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        current[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const bool same = lower(a[i - 1]) == lower(b[j - 1]);
            current[j] = std::min({previous[j] + 1, current[j - 1] + 1, previous[j - 1] + (same ? 0 : 1)});
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]))
                current[j] = std::min(current[j], before[j - 2] + 1);
        }
        std::swap(before, previous);
        std::swap(previous, current);
    }
    return previous[b.size()];
}

/// "sampels" is a typo of "samples", "x" of nothing.
std::size_t tolerance(std::size_t length) {
    return length <= 2 ? 0 : length <= 5 ? 2 : 3;
}

}  // namespace

std::string_view nearestName(std::string_view name, std::span<const std::string_view> known) {
    if (name.size() > longestCompared) return {};
    std::string_view best;
    std::size_t least = tolerance(name.size()) + 1;
    for (const auto candidate : known) {
        // A typo keeps most of a name: two edits in a word of three letters make another word.
        const auto edits = distance(name, candidate);
        if (edits < least && 2 * edits <= std::max(name.size(), candidate.size())) {
            least = edits;
            best = candidate;
        }
    }
    if (!best.empty()) return best;
    // Shortened names: "ortho" for "orthographic".
    if (name.size() >= 3)
        for (const auto candidate : known)
            if (candidate.starts_with(name)) return candidate;
    return {};
}

std::string unknownName(std::string_view path, std::string_view name,
                        std::span<const std::string_view> known) {
    std::string message = std::string(path) + ": unknown";
    if (const auto nearest = nearestName(name, known); !nearest.empty())
        return message + "; did you mean " + std::string(nearest) + "?";
    if (known.empty()) return message;
    message += "; known are ";
    for (std::size_t i = 0; i < known.size(); ++i) {
        if (i > 0) message += ", ";
        message += known[i];
    }
    return message;
}

std::string quoteText(std::string_view text) {
    const bool cut = text.size() > longestQuote;
    if (cut) {
        auto end = longestQuote;  // not in the middle of a UTF-8 character
        while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0u) == 0x80u) --end;
        text = text.substr(0, end);
    }
    std::string quoted = plainText(text);
    std::ranges::replace_if(
        quoted, [](char c) { return c == '\n' || c == '\t'; }, '?');
    return '"' + quoted + (cut ? "…\"" : "\"");
}

}  // namespace scancast
