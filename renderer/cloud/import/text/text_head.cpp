#include "renderer/cloud/import/text/text_head.hpp"

#include <array>
#include <charconv>

#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/text/text_fields.hpp"
#include "renderer/cloud/import/text/text_names.hpp"

namespace scancast {

namespace {

constexpr std::string_view between(" \t,;\"");

struct Words {
    std::size_t all = 0, numbers = 0;
};

/// Whatever separates them.
Words wordsOf(std::string_view line) {
    Words words;
    while (!line.empty()) {
        const auto begin = line.find_first_not_of(between);
        if (begin == line.npos) break;
        line.remove_prefix(begin);
        const auto word = line.substr(0, line.find_first_of(between));
        ++words.all;
        words.numbers += numberIn(word).has_value();
        line.remove_prefix(word.size());
    }
    return words;
}

char lineEndOf(std::string_view text) {
    return text.find('\n') == text.npos ? '\r' : '\n';
}

}  // namespace

std::string_view takeLine(std::string_view& text, char lineEnd) {
    const auto end = text.find(lineEnd);
    auto line = text.substr(0, end);
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

std::optional<std::uint64_t> countIn(std::string_view line) {
    while (!line.empty() && isBlank(line.front())) line.remove_prefix(1);
    while (!line.empty() && isBlank(line.back())) line.remove_suffix(1);
    std::uint64_t count = 0;
    const auto [behind, problem] = std::from_chars(line.data(), line.data() + line.size(), count);
    if (problem != std::errc() || behind != line.data() + line.size()) return std::nullopt;
    return count;
}

Expected<TextHead> readTextHead(std::string_view start, char lineEnd, const std::string& name) {
    TextHead head;
    auto text = start;
    while (!text.empty()) {
        head.bytes = start.size() - text.size();
        const auto line = takeLine(text, lineEnd);
        const auto place = name + ", line " + grouped(head.lines + 1) + ": ";
        if (isComment(line)) {
            if (head.names.empty()) {
                head.names = namesIn(line, 3);
                head.namesLine = head.lines + 1;
                head.namesInComment = true;
            }
        } else if (const auto count = countIn(line)) {
            if (head.count)
                return fail(ErrorCode::Malformed,
                            place + "a second number of points; one was on a line before already");
            head.count = count;
        } else if (const auto words = wordsOf(line); words.numbers * 2 >= words.all) {
            return head;  // the first point, or what is meant for it
        } else {
            if (!head.names.empty() && !head.namesInComment)
                return fail(ErrorCode::Malformed,
                            place + quotedText(line) + " stands where points should be");
            head.names = namesIn(line, 2);
            head.namesLine = head.lines + 1;
            head.namesInComment = false;
            if (head.names.empty())
                return fail(ErrorCode::Malformed,
                            place + quotedText(line) +
                                " is neither a point nor a header; a header names the columns, for example "
                                "\"x y z red green blue\"");
        }
        ++head.lines;
    }
    return fail(ErrorCode::Empty, name + " is a text without points");
}

bool looksLikePoints(std::string_view start) {
    const char lineEnd = lineEndOf(start);
    std::size_t lines = 0, points = 0;
    while (!start.empty()) {
        const bool cut = start.find(lineEnd) == start.npos && lines > 0;
        const auto line = takeLine(start, lineEnd);
        if (cut || isComment(line)) continue;
        ++lines;
        const auto words = wordsOf(line);
        points += words.numbers >= 3 && words.numbers * 2 >= words.all;
    }
    return points > 0 && points * 3 >= lines;
}

bool looksLikePtx(std::string_view start) {
    if (start.starts_with("\xef\xbb\xbf")) start.remove_prefix(3);
    static constexpr std::array<std::size_t, 10> shape{1, 1, 3, 3, 3, 3, 4, 4, 4, 4};
    const char lineEnd = lineEndOf(start);
    for (const auto numbers : shape) {
        const auto line = takeLine(start, lineEnd);
        const auto words = wordsOf(line);
        if (words.all != numbers || words.numbers != numbers) return false;
        if (numbers == 1 && !countIn(line)) return false;
    }
    return true;
}

}  // namespace scancast
