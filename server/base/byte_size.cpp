#include "server/base/byte_size.hpp"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>

namespace scancast {

Expected<std::uint64_t> parseByteSize(std::string_view text, std::string_view flag) {
    const auto refuse = [&] {
        return fail(ErrorCode::InvalidArgument,
                    fmt::format("--{}: '{}' is no size; for example --{} 2G", flag, text, flag),
                    std::string(flag));
    };
    double number = 0;
    const char* const end = text.data() + text.size();
    const auto [next, problem] = std::from_chars(text.data(), end, number);
    if (problem != std::errc() || !std::isfinite(number) || number < 0) return refuse();
    std::string unit;
    for (const char* c = next; c != end; ++c)
        if (*c != ' ') unit.push_back(char(std::tolower(static_cast<unsigned char>(*c))));
    double factor = 1;
    if (!unit.empty() && unit != "b") {
        const auto power = std::string_view("kmgt").find(unit[0]);
        const std::string_view rest = std::string_view(unit).substr(1);
        if (power == std::string_view::npos || !(rest.empty() || rest == "b" || rest == "ib"))
            return refuse();
        factor = std::pow(1024.0, double(power + 1));
    }
    const double bytes = number * factor;
    if (bytes >= 9e18) return refuse();
    return std::uint64_t(bytes);
}

Expected<std::uint64_t> parseGpuMemoryLimit(std::string_view text) {
    if (text.empty()) return 0;
    constexpr std::uint64_t least = 16 << 20;
    auto limit = parseByteSize(text, "gpu-memory-limit");
    if (limit && *limit < least)
        return fail(ErrorCode::InvalidArgument,
                    "--gpu-memory-limit: 16M is the least that clouds are drawn with.", "gpu-memory-limit");
    return limit;
}

std::string byteSizeText(std::uint64_t bytes) {
    if (bytes < 1000) return fmt::format("{} bytes", bytes);
    double value = double(bytes);
    std::size_t unit = 0;
    constexpr std::string_view units[] = {"bytes", "kB", "MB", "GB", "TB", "PB", "EB"};
    while (value >= 999.5 && unit + 1 < std::size(units)) {
        value /= 1000;
        ++unit;
    }
    return fmt::format("{:.{}f} {}", value, value < 9.995 ? 2 : value < 99.95 ? 1 : 0, units[unit]);
}

}  // namespace scancast
