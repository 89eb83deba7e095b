#include "simulator/write/point_count.hpp"

#include <charconv>
#include <cmath>
#include <string>

namespace scancast {

Expected<std::uint64_t> parsePointCount(std::string_view text) {
    const auto bad = [&] {
        std::string message("'");
        message.append(text.substr(0, 60));
        message += "' is not a number of points from 1 to 1e12; write 20M, 500k, 1.5e6 or 2_000_000.";
        return fail(ErrorCode::InvalidArgument, std::move(message), "points");
    };
    std::string plain;
    for (const char letter : text.substr(0, 60))
        if (letter != '_') plain += letter;
    if (plain.empty() || text.front() == '_' || text.back() == '_') return bad();
    double scale = 1;
    switch (plain.back()) {
        case 'k':
        case 'K':
            scale = 1e3;
            break;
        case 'm':
        case 'M':
            scale = 1e6;
            break;
        case 'g':
        case 'G':
        case 'b':
        case 'B':
            scale = 1e9;
            break;
        default:
            break;
    }
    if (scale > 1) plain.pop_back();
    double value = 0;
    const auto [end, problem] = std::from_chars(plain.data(), plain.data() + plain.size(), value);
    if (problem != std::errc() || end != plain.data() + plain.size()) return bad();
    const double scaled = value * scale, count = std::round(scaled);
    if (!(count >= 1 && count <= 1e12) || std::abs(scaled - count) > 1e-6 * count) return bad();
    return std::uint64_t(count);
}

}  // namespace scancast
