#include "renderer/cloud/import/text/text_names.hpp"

#include <algorithm>
#include <array>

#include "renderer/cloud/import/printable_text.hpp"

namespace scancast {

namespace {

enum class Role : std::uint8_t { X, Y, Z, Red, Green, Blue, Nx, Ny, Nz, Intensity, Classification };

struct Word {
    std::string_view text;
    Role role;
};

constexpr Word words[] = {
    {"x", Role::X},
    {"easting", Role::X},
    {"y", Role::Y},
    {"northing", Role::Y},
    {"z", Role::Z},
    {"elevation", Role::Z},
    {"r", Role::Red},
    {"red", Role::Red},
    {"rf", Role::Red},
    {"diffuse_red", Role::Red},
    {"g", Role::Green},
    {"green", Role::Green},
    {"gf", Role::Green},
    {"diffuse_green", Role::Green},
    {"b", Role::Blue},
    {"blue", Role::Blue},
    {"bf", Role::Blue},
    {"diffuse_blue", Role::Blue},
    {"nx", Role::Nx},
    {"normal_x", Role::Nx},
    {"normalx", Role::Nx},
    {"ny", Role::Ny},
    {"normal_y", Role::Ny},
    {"normaly", Role::Ny},
    {"nz", Role::Nz},
    {"normal_z", Role::Nz},
    {"normalz", Role::Nz},
    {"i", Role::Intensity},
    {"intensity", Role::Intensity},
    {"scalar_intensity", Role::Intensity},
    {"reflectance", Role::Intensity},
    {"class", Role::Classification},
    {"classification", Role::Classification},
    {"scalar_classification", Role::Classification},
};

/// Lower case, without a unit in brackets: "X [m]" is x.
std::string plain(std::string_view name) {
    name = name.substr(0, name.find_first_of("(["));
    while (!name.empty() && isBlank(name.back())) name.remove_suffix(1);
    std::string text(name);
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

const Word* wordFor(std::string_view name) {
    const auto text = plain(name);
    const auto* found =
        std::find_if(std::begin(words), std::end(words), [&](const Word& w) { return w.text == text; });
    return found == std::end(words) ? nullptr : found;
}

int& placeOf(Role role, TextLayout& layout) {
    const auto index = static_cast<std::size_t>(role);
    switch (role) {
        case Role::X:
        case Role::Y:
        case Role::Z:
            return layout.position[index];
        case Role::Red:
        case Role::Green:
        case Role::Blue:
            return layout.color[index - 3];
        case Role::Nx:
        case Role::Ny:
        case Role::Nz:
            return layout.normal[index - 6];
        case Role::Intensity:
            return layout.intensity;
        case Role::Classification:
            break;
    }
    return layout.classification;
}

}  // namespace

std::vector<std::string> namesIn(std::string_view line, std::ptrdiff_t wanted) {
    const auto begin = line.find_first_not_of("/# \t");
    if (begin == line.npos) return {};
    line.remove_prefix(begin);
    const char mark = line.find(';') != line.npos ? ';' : line.find(',') != line.npos ? ',' : ' ';
    std::vector<std::string_view> fields;
    // "X\tY\tScan angle": between tabs, blanks belong to the name.
    const bool tabs = mark == ' ' && line.find('\t') != line.npos && line.find(' ') != line.npos;
    splitFields(line, {tabs ? '\t' : mark, false}, fields);
    std::vector<std::string> names;
    std::array<bool, 3> axes{};
    for (const auto field : fields) {
        names.push_back(printableText(field, 64));
        const auto* word = wordFor(field);
        if (word != nullptr && word->role <= Role::Z) axes[static_cast<std::size_t>(word->role)] = true;
    }
    return std::count(axes.begin(), axes.end(), true) >= wanted ? names : std::vector<std::string>();
}

Expected<void> assignByNames(const std::vector<std::string>& names, TextLayout& layout) {
    for (std::size_t c = 0; c < names.size(); ++c) {
        const auto* word = wordFor(names[c]);
        if (word == nullptr) continue;
        int& place = placeOf(word->role, layout);
        // An intensity and a reflectance may stand side by side; two columns x may not.
        if (place != TextLayout::none && word->role <= Role::Z)
            return fail(ErrorCode::Malformed, "two columns are called " + quotedText(names[c]));
        if (place == TextLayout::none) place = static_cast<int>(c);
    }
    static constexpr const char* axes[] = {"x", "y", "z"};
    for (std::size_t i = 0; i < 3; ++i)
        if (layout.position[i] == TextLayout::none)
            return fail(ErrorCode::Malformed,
                        std::string("no column is called \"") + axes[i] + "\"; x, y and z are needed");
    return {};
}

}  // namespace scancast
