#include "renderer/cloud/exact_columns.hpp"

#include <algorithm>
#include <string>

namespace scancast {

std::array<ValuePlane, 3> gridPlanes() {
    std::array<ValuePlane, 3> planes;
    for (std::size_t a = 0; a < 3; ++a)
        planes[a] = {std::string(gridPlaneNames[a]), ColumnType::Int32, ValuePlane::Of::Points};
    return planes;
}

bool hasGridPlanes(const CloudFacts& facts) {
    return std::ranges::all_of(gridPlanes(), [&](const ValuePlane& plane) {
        return std::ranges::find(facts.companions, plane) != facts.companions.end();
    });
}

std::optional<std::array<std::size_t, 3>> findColumns(std::span<const Column> columns,
                                                      const ThreeNames& names, ColumnType type) {
    std::array<std::size_t, 3> found{};
    for (std::size_t a = 0; a < 3; ++a) {
        const auto at = std::ranges::find_if(
            columns, [&](const Column& c) { return c.name == names[a] && c.type == type; });
        if (at == columns.end()) return std::nullopt;
        found[a] = std::size_t(at - columns.begin());
    }
    return found;
}

}  // namespace scancast
