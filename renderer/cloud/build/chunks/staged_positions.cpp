#include "renderer/cloud/build/chunks/staged_positions.hpp"

#include <algorithm>
#include <cmath>

namespace scancast {

namespace {

using Kind = PackedPositions::Kind;

bool hasGrid(const ScanHeader& header) {
    for (int a = 0; a < 3; ++a)
        if (!(header.gridStep[a] > 0) || !std::isfinite(header.gridStep[a]) ||
            !std::isfinite(header.gridOrigin[a]))
            return false;
    return true;
}

StepGrid ownGridOf(const ScanHeader& header) {
    return {header.gridOrigin, header.gridStep};
}

bool isOwnStep(std::int64_t step) {
    return step == std::int32_t(step);
}

/// Of steps that count from elsewhere; nothing where the scan's own numbers end.
std::optional<OwnRange> rangeOf(std::span<const GridSteps> steps, const OwnSteps& between) {
    GridSteps low = steps.front(), high = low;
    for (const GridSteps& s : steps)
        for (std::size_t a = 0; a < 3; ++a)
            low[a] = std::min(low[a], s[a]), high[a] = std::max(high[a], s[a]);
    OwnRange range;
    for (std::size_t a = 0; a < 3; ++a) {
        range.low[a] = low[a] + between[a];
        range.high[a] = high[a] + between[a];
        if (!isOwnStep(range.low[a]) || !isOwnStep(range.high[a])) return std::nullopt;
    }
    return range;
}

/// The nearest number on the grid; nothing where the position does not lie there.
std::optional<OwnSteps> ownStepsOf(const glm::dvec3& position, const StepGrid& grid) {
    OwnSteps steps{};
    for (int a = 0; a < 3; ++a) {
        const double p = position[a];
        const double q = std::nearbyint((p - grid.origin[a]) / grid.step[a]);
        const double off = std::abs(grid.origin[a] + q * grid.step[a] - p);
        const double tolerance = 1e-3 * grid.step[a] + 1e-15 * (std::abs(p) + std::abs(grid.origin[a]));
        if (!(std::abs(q) <= 2147483647.0 || q == -2147483648.0) || !(off <= tolerance)) return std::nullopt;
        steps[std::size_t(a)] = std::int64_t(q);
    }
    return steps;
}

/// float64 as steps of the grid, where these give every bit of it back.
bool toSteps(std::span<const glm::dvec3> positions, const StepGrid& grid, GridSteps* out) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const auto steps = ownStepsOf(positions[i], grid);
        if (!steps) return false;
        for (std::size_t a = 0; a < 3; ++a) out[i][a] = std::int32_t((*steps)[a]);
        if (grid.at(out[i]) != positions[i]) return false;
    }
    return true;
}

bool areSinglePrecision(const Positions& positions) {
    return std::all_of(positions.begin(), positions.end(),
                       [](const glm::dvec3& p) { return glm::dvec3(glm::vec3(p)) == p; });
}

GridPosition onGrid(const glm::dvec3& p, const Grid& grid) {
    GridPosition q;
    for (int a = 0; a < 3; ++a)
        q[a] =
            static_cast<std::uint64_t>(std::max(0.0, std::nearbyint((p[a] - grid.corner[a]) / grid.step[a])));
    return q;
}

GridPosition onOwnGrid(const OwnSteps& steps, const OwnSteps& low, const Grid& grid) {
    GridPosition q;
    for (std::size_t a = 0; a < 3; ++a)
        q[a] = static_cast<std::uint64_t>(steps[a] - low[a]) << grid.ownShift[a];
    return q;
}

template <class T>
T* as(std::vector<std::byte>& bytes) {
    return reinterpret_cast<T*>(bytes.data());
}

}  // namespace

std::size_t bytesOf(PackedPositions::Kind kind) {
    return kind == Kind::Full ? sizeof(glm::dvec3) : sizeof(glm::vec3);
}

std::optional<OwnRange> ownRangeOf(const Positions& positions, const ScanHeader& header) {
    if (!hasGrid(header)) return std::nullopt;
    const StepGrid grid = ownGridOf(header);
    if (positions.areSteps())
        if (const auto between = positions.grid().stepsIn(grid))
            return rangeOf(positions.asSteps(), *between);
    std::optional<OwnRange> range;
    for (const glm::dvec3& position : positions) {
        const auto steps = ownStepsOf(position, grid);
        if (!steps) return std::nullopt;
        if (!range) range = OwnRange{*steps, *steps};
        for (std::size_t a = 0; a < 3; ++a) {
            range->low[a] = std::min(range->low[a], (*steps)[a]);
            range->high[a] = std::max(range->high[a], (*steps)[a]);
        }
    }
    return range;
}

PackedPositions packPositions(const Positions& positions, const ScanHeader& header, bool isOnOwnGrid,
                              std::size_t beside, std::vector<std::byte>& out) {
    PackedPositions packed;
    packed.grid = positions.areSteps() ? positions.grid() : ownGridOf(header);
    const auto makeRoom = [&](Kind kind) {
        packed.kind = kind;
        out.resize(positions.size() * (bytesOf(kind) + beside));
    };
    makeRoom(Kind::Steps);
    if (positions.areSteps()) {
        std::ranges::copy(positions.asSteps(), as<GridSteps>(out));
        return packed;
    }
    if (isOnOwnGrid && toSteps(positions.asDoubles(), packed.grid, as<GridSteps>(out))) return packed;
    if (areSinglePrecision(positions)) {
        makeRoom(Kind::Single);
        std::copy(positions.begin(), positions.end(), as<glm::vec3>(out));
    } else {
        makeRoom(Kind::Full);
        std::copy(positions.begin(), positions.end(), as<glm::dvec3>(out));
    }
    return packed;
}

void placePositions(const PackedPositions& packed, std::span<const std::byte> bytes, const ScanHeader& header,
                    const OwnSteps* ownLow, const Grid& grid, std::span<BuildPoint> out) {
    const auto* steps = reinterpret_cast<const GridSteps*>(bytes.data());
    const auto* single = reinterpret_cast<const glm::vec3*>(bytes.data());
    const auto* full = reinterpret_cast<const glm::dvec3*>(bytes.data());
    const auto position = [&](std::size_t i) {
        if (packed.kind == Kind::Steps) return packed.grid.at(steps[i]);
        return packed.kind == Kind::Single ? glm::dvec3(single[i]) : full[i];
    };
    if (!ownLow) {
        for (std::size_t i = 0; i < out.size(); ++i) out[i].setPosition(onGrid(position(i), grid));
        return;
    }
    const StepGrid own = ownGridOf(header);
    const auto between = packed.kind == Kind::Steps ? packed.grid.stepsIn(own) : std::nullopt;
    for (std::size_t i = 0; i < out.size(); ++i) {
        OwnSteps at{};
        if (between)
            for (std::size_t a = 0; a < 3; ++a) at[a] = steps[i][a] + (*between)[a];
        else
            at = ownStepsOf(position(i), own).value_or(*ownLow);
        out[i].setPosition(onOwnGrid(at, *ownLow, grid));
    }
}

}  // namespace scancast
