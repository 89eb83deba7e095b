#include "protocol/view_values.hpp"

#include <array>
#include <span>

#include "protocol/hex_digit.hpp"
#include "protocol/nearest_name.hpp"

namespace scancast::values {
namespace {

template <class T, std::size_t N>
Parsed<T> choose(std::string_view text, const std::array<T, N>& choices, std::string_view others = {}) {
    std::array<std::string_view, N> names;
    for (std::size_t i = 0; i < N; ++i) {
        if constexpr (std::is_same_v<T, std::string_view>)
            names[i] = choices[i];
        else
            names[i] = name(choices[i]);
        if (names[i] == text) return choices[i];
    }
    std::string message = quoteText(text) + " is none of ";
    for (std::size_t i = 0; i < N; ++i) message += (i > 0 ? ", " : "") + std::string(names[i]);
    message += others;
    if (const auto nearest = nearestName(text, names); !nearest.empty())
        message += "; did you mean " + std::string(nearest) + "?";
    return tl::unexpected(message);
}

}  // namespace

Parsed<Projection> projection(std::string_view text) {
    return choose(text, std::array{Projection::Perspective, Projection::Orthographic});
}

Parsed<Shading> shading(std::string_view text) {
    return choose(text, std::array{Shading::Unlit, Shading::Phong, Shading::EyeDome});
}

Parsed<Subsampling> subsampling(std::string_view text) {
    if (text == "444") return Subsampling::S444;
    if (text == "422") return Subsampling::S422;
    if (text == "420") return Subsampling::S420;
    return choose(text, std::array{Subsampling::S444, Subsampling::S422, Subsampling::S420});
}

Parsed<std::string> colormap(std::string_view text) {
    return choose(text, std::array<std::string_view, 3>{"viridis", "turbo", "grey"})
        .map([](std::string_view known) { return std::string(known); });
}

Parsed<Rgb8> rgb(std::string_view text) {
    const auto digits = text.starts_with('#') ? text.substr(1) : text;
    Rgb8 color{};
    bool sound = digits.size() == 6;
    for (std::size_t i = 0; sound && i < 3; ++i) {
        const int high = hexDigit(digits[2 * i]), low = hexDigit(digits[2 * i + 1]);
        sound = high >= 0 && low >= 0;
        color[i] = static_cast<std::uint8_t>(sound ? high * 16 + low : 0);
    }
    if (!sound) return tl::unexpected(quoteText(text) + " is no colour: write #rrggbb, such as #ff8800");
    return color;
}

std::string print(Rgb8 color) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text = "#";
    for (const auto channel : color) {
        text += digits[channel >> 4u];
        text += digits[channel & 15u];
    }
    return text;
}

Parsed<Color> color(std::string_view text) {
    if (const auto flat = rgb(text)) return Color{ColorSource::Flat, *flat};
    return choose(text,
                  std::array{ColorSource::Rgb, ColorSource::Intensity, ColorSource::Elevation,
                             ColorSource::Classification, ColorSource::Normal, ColorSource::Depth,
                             ColorSource::Lod},
                  " or one colour as #rrggbb")
        .map([](ColorSource source) {
            return Color{source, Rgb8{255, 255, 255}};
        });
}

Parsed<Background> background(std::string_view text) {
    Background result;
    if (text == "transparent") {
        result.kind = Background::Kind::Transparent;
        return result;
    }
    const auto comma = text.find(',');
    const auto top = rgb(text.substr(0, comma));
    const auto bottom = comma == std::string_view::npos ? top : rgb(text.substr(comma + 1));
    if (!top || !bottom)
        return tl::unexpected(
            quoteText(text) +
            " is no background: write transparent, #rrggbb, or two colours, #rrggbb,#rrggbb, "
            "for a gradient from top to bottom");
    result.kind = comma == std::string_view::npos ? Background::Kind::Color : Background::Kind::Gradient;
    result.top = *top;
    if (result.kind == Background::Kind::Gradient) result.bottom = *bottom;
    return result;
}

}  // namespace scancast::values
