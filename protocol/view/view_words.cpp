#include "protocol/view/view_words.hpp"

#include <algorithm>

#include "protocol/nearest_name.hpp"

namespace scancast {
namespace {

bool isCalled(const ViewWord& known, std::string_view word) {
    constexpr std::string_view parameter = "param.";
    return known.word == word || (known.word.starts_with(parameter) && word.starts_with(parameter));
}

bool has(const WordValues& given, std::string_view word) {
    return std::any_of(given.begin(), given.end(), [&](const auto& pair) { return pair.first == word; });
}

/// What can only be seen by looking at all words together.
Expected<void> checkTogether(const WordValues& given) {
    if (given.size() > mostWords) return fail(ErrorCode::InvalidArgument, "there are more than 256 words");
    std::vector<std::string_view> sorted;
    for (const auto& [word, value] : given) sorted.push_back(word);
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end())
        return fail(ErrorCode::InvalidArgument, quoteText(*twice) + " is given twice", std::string(*twice));
    if (has(given, "viewMatrix") && (has(given, "eye") || has(given, "target") || has(given, "up")))
        return fail(ErrorCode::InvalidArgument,
                    "viewMatrix: stands beside eye, target or up; give one or the other", "viewMatrix");
    return {};
}

}  // namespace

std::string_view ViewWord::group() const {
    const auto dot = word.find('.');
    return dot == std::string_view::npos ? std::string_view() : word.substr(0, dot);
}

std::string ViewWord::flag() const {
    std::string flag = "--";
    for (const char c : word.substr(0, word.find('.')))
        flag += c >= 'A' && c <= 'Z' ? std::string{'-', char(c - 'A' + 'a')} : std::string(1, c);
    return flag;
}

std::string ViewWord::description() const {
    std::string text(meaning);
    return value.range ? text + " Must " + std::string(value.range->must) + "." : text;
}

Expected<void> applyWord(View& view, std::string_view word, std::string_view value) {
    std::vector<std::string_view> names;
    for (const auto& known : viewWords()) {
        names.push_back(known.word);
        if (!isCalled(known, word)) continue;
        const auto parsed = known.value.parse(view, word, value);
        if (parsed) return {};
        return fail(ErrorCode::InvalidArgument, std::string(word) + ": " + parsed.error(), std::string(word));
    }
    const auto at = word.substr(0, 64);
    return fail(ErrorCode::InvalidArgument, unknownName(at, word, names), std::string(at));
}

Expected<void> checkWord(std::string_view word, std::string_view value) {
    View view;
    if (auto ok = applyWord(view, word, value); !ok) return ok;
    const auto known = std::ranges::find_if(viewWords(), [&](const auto& w) { return isCalled(w, word); });
    return known->value.check(view, known->word);
}

Expected<View> applyWords(const View& base, const WordValues& given) {
    if (auto ok = checkTogether(given); !ok) return passOn(ok);
    View view = base;
    // The method goes first, because it drops the parameters of the one before.
    for (const bool methodPass : {true, false})
        for (const auto& [word, value] : given)
            if ((word == "method") == methodPass)
                if (auto ok = applyWord(view, word, value); !ok) return passOn(ok);
    if (auto ok = validate(view); !ok) return passOn(ok);
    return view;
}

}  // namespace scancast
