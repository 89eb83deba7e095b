// A cloud file as a view asks for it: the samples that its filter leaves, and the value of a column where devices look for
// intensity. To everybody else it is a CloudFile: devices, methods, clips, picks, exports know nothing of columns. It may stand
// before any other CloudFile, itself among them. Pipeline: cloud file → **pictured file** → residency.
//
// *Thread safety*: as every CloudFile.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "renderer/cloud/columns/column_choice.hpp"
#include "renderer/cloud/file/cloud_file.hpp"
#include "renderer/cloud/sample_store.hpp"

namespace scancast {

/// What a value becomes in a sample's intensity: 0 at the low end, 65535 at the high one and beyond; NaN is 0.
std::uint16_t codeOf(double value, const std::array<double, 2>& ends);
inline constexpr double greatestCode = 65535;

/// A node's samples that somebody has at hand, so that they need not be read; nullopt: nobody.
using SamplesAtHand = std::function<std::optional<SampleRun>(std::uint32_t node)>;

/// `choice`: of the same cloud's facts. Its nodes are the file's own, bounds, spacings and counts included: what is left of a node may
/// be nothing. Planes and rows are those of the samples that are left. point() tells the true intensity.
std::shared_ptr<const CloudFile> picturedFile(std::shared_ptr<const CloudFile> file, ColumnChoice choice,
                                              SamplesAtHand atHand = {});

/// A cloud file's leaves for who exports and draws their points: what the filter leaves, and, of a style whose colour is a column,
/// that. `file` itself where neither is asked for. Errors: chooseColumns()'s.
Expected<std::shared_ptr<const CloudFile>> picturedLeaves(std::shared_ptr<const CloudFile> file,
                                                          const ColumnRanges& filter,
                                                          const Style& style = {});

}  // namespace scancast
