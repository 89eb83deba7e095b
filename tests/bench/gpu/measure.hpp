// One row of bench_gpu's tables: a method's picture of a cloud, compared with the cpu device's, then drawn
// many times.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "renderer/render.hpp"
#include "tests/bench/gpu/settings.hpp"
#include "tests/support/pictures/agreement.hpp"

namespace scancast::bench {

/// Medians of some frames, ms.
struct Cost {
    std::vector<StageTime> stages;
    double frame = 0, jpeg = 0;
    int frames = 0;  ///< that were counted
    std::uint64_t samples = 0;

    /// Of the named stages together.
    double of(std::initializer_list<std::string_view> names) const;
    /// What the processor does before the device begins: select, provide, prepare.
    double host() const;
    /// What the device does: all stages but the host's and the way back.
    double gpu() const;
};

struct Row {
    std::string method;
    bool bruteForce = false;  ///< every point, without a hierarchy
    std::uint64_t points = 0;
    Size size;
    std::optional<test::Agreement> agreement{};  ///< with the cpu device's picture
    std::optional<Cost> cost{};                  ///< none: the picture is wrong

    /// "`point`, brute force"
    std::string title() const;
};

/// Fills in agreement and cost of `row`, the rest of which says what is drawn. With `truth` it compares
/// first, and times nothing below owedDecibels unless --anyway. A PNG lands in --pictures where the row is of
/// the first size.
Row measureRow(Device& device, Device* truth, const Cloud& cloud, const View& view, Row row,
               const Settings& settings);

}  // namespace scancast::bench
