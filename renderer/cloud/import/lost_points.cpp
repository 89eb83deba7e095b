#include "renderer/cloud/import/lost_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "renderer/cloud/import/printable_text.hpp"

namespace scancast {

std::string lostShare(std::uint64_t promised, std::uint64_t there) {
    const auto lost = promised - std::min(there, promised);
    const double percent = promised > 0 ? 100 * double(lost) / double(promised) : 0;
    // What is lost is never 0 %, and what is there never nothing.
    const std::string share = lost == promised  ? "100 %"
                              : percent < 0.05  ? "less than 0.1 %"
                              : percent > 99.95 ? "more than 99.9 %"
                                                : fmt::format("{:.1f} %", percent);
    return fmt::format("of the {} points that it promises, {} are whole and were read; {} ({}) are lost",
                       grouped(promised), grouped(there), grouped(lost), share);
}

std::string lostPoints(const std::string& what, std::uint64_t promised, std::uint64_t there) {
    return what + " ends too early: " + lostShare(promised, there);
}

std::string noteOf(const std::string& file, const std::string& words) {
    return std::filesystem::path(file).filename().string() + ": " + words;
}

}  // namespace scancast
