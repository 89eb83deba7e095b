#include "renderer/cloud/import/text/text_fields.hpp"

#include <algorithm>
#include <array>

namespace scancast {

namespace {

std::string_view trimmed(std::string_view field) {
    while (!field.empty() && isBlank(field.front())) field.remove_prefix(1);
    while (!field.empty() && isBlank(field.back())) field.remove_suffix(1);
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
        field = field.substr(1, field.size() - 2);
    return field;
}

bool allNumbers(std::span<const std::string_view> lines, Separator separator) {
    std::vector<std::string_view> fields;
    bool any = false;
    for (const auto line : lines) {
        splitFields(line, separator, fields);
        for (const auto field : fields)
            if (!numberIn(field, separator.decimalComma)) return false;
        any = any || fields.size() >= 3;
    }
    return any;
}

}  // namespace

std::optional<double> numberIn(std::string_view field, bool decimalComma) {
    // Longer than any number that a program writes: 17 digits, sign, point, exponent - or 300 zeros.
    std::array<char, 512> copy{};
    if (field.size() > copy.size()) return std::nullopt;
    if (decimalComma && field.find(',') != field.npos) {
        std::replace_copy(field.begin(), field.end(), copy.begin(), ',', '.');
        field = {copy.data(), field.size()};
    }
    const char* end = field.data() + field.size();
    const char* at = skipBlanks(field.data(), end);
    double value = 0;
    if (!readNumber(at, end, value) || skipBlanks(at, end) != end) return std::nullopt;
    return value;
}

void splitFields(std::string_view line, Separator separator, std::vector<std::string_view>& fields) {
    fields.clear();
    const char* end = line.data() + line.size();
    const char* at = skipBlanks(line.data(), end);
    while (at != end) {
        const char* to =
            separator.mark == ' ' ? std::find_if(at, end, isBlank) : std::find(at, end, separator.mark);
        fields.push_back(trimmed({at, static_cast<std::size_t>(to - at)}));
        at = to;
        if (separator.mark != ' ' && at != end) ++at;
        at = skipBlanks(at, end);
    }
}

Separator separatorOf(std::span<const std::string_view> lines) {
    const auto all = [&](char mark) {
        return !lines.empty() && std::all_of(lines.begin(), lines.end(), [&](std::string_view line) {
            return line.find(mark) != line.npos;
        });
    };
    if (all(';')) return {';', !allNumbers(lines, {';', false}) && allNumbers(lines, {';', true})};
    // "1,5 2,5 3,5" has a comma in every line too, but no numbers between commas.
    if (all(',') && (allNumbers(lines, {',', false}) || !allNumbers(lines, {' ', true}))) return {',', false};
    return {' ', !allNumbers(lines, {' ', false}) && allNumbers(lines, {' ', true})};
}

}  // namespace scancast
