#include "protocol/classification.hpp"

#include <array>

namespace scancast {

std::string_view className(std::uint8_t classification) {
    static constexpr std::array<std::string_view, 19> names{
        "never classified",
        "unclassified",
        "ground",
        "low vegetation",
        "medium vegetation",
        "high vegetation",
        "building",
        "low point (noise)",
        "reserved",  // model key point until LAS 1.3
        "water",
        "rail",
        "road surface",
        "reserved",  // overlap until LAS 1.3
        "wire guard (shield)",
        "wire conductor (phase)",
        "transmission tower",
        "wire connector (insulator)",
        "bridge deck",
        "high noise",
    };
    if (classification < names.size()) return names[classification];
    return classification < 64 ? "reserved" : "user defined";
}

}  // namespace scancast
