// From a planned view to the samples that are drawn: the cuts of its picture, chosen and in memory. Needs no
// device. Pipeline: plan → **select, provide** → draw. Any thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "renderer/plan.hpp"

namespace scancast {

/// A poster needs no more memory than a screen, and can be abandoned between tiles.
inline constexpr int largestTile = 2048;

struct RenderOptions {
    bool bruteForce = false;  ///< every leaf sample, no selection, no culling
    /// Blocks of a cloud file that are not in memory are waited for, as is what is not on the GPU; else
    /// ancestors are drawn for them, and they are requested.
    bool wait = true;
    std::uint64_t requester = 0;  ///< on whose behalf (renderer/residency/provide.hpp)
    /// Coarser nodes are chosen where there would be more samples than this: mostSamplesOn() the device that
    /// will draw. Without wait only; what waits is drawn in parts, if it must.
    std::optional<std::uint64_t> mostSamples{};
    /// Where the camera will be soon: its blocks are requested, too. Without wait only.
    std::optional<Camera> ahead{};
    /// Pictures wider or higher than this are drawn in tiles of at most this side, px, unless the device
    /// draws so many pixels at once (Device::pixelsAtOnce) and the method's bytes are the same then:
    /// pyramid's are not, which looks farther than a tile. Smaller for tests.
    int tileSide = largestTile;
    bool depth = true;  ///< the frame shall have its depth: what is only encoded comes sooner without
};

/// A view of a cloud with everything decided, and the samples that it draws in memory: they stay there as
/// long as this lives. The cloud must outlive it. Immutable.
struct PreparedView {
    std::shared_ptr<const PlannedView> planned;
    const Cloud* cloud = nullptr;
    std::vector<CutView> cuts;     ///< the main view, then its reflections
    std::optional<CutView> sun{};  ///< what it sees, where there are shadows
    bool depth = true;
    int tileSide = largestTile;
    double selectMs = 0, provideMs = 0;
};

/// The cuts that a planned view draws, with nothing selected yet: its own, and one for each mirror that shows
/// something.
std::vector<CutView> cutsOf(const Cloud& cloud, const PlannedView& planned);

/// How many samples all cuts of the complete picture have together; nothing is loaded for it.
std::uint64_t samplesWanted(const Cloud& cloud, const PlannedView& planned);

/// With options.wait it may take as long as loading does. Errors: Cancelled; Unavailable; ResourceLimit when brute force
/// would exceed the memory limit.
Expected<std::shared_ptr<const PreparedView>> prepare(const Cloud& cloud,
                                                      std::shared_ptr<const PlannedView> planned,
                                                      const RenderOptions& options = {},
                                                      std::stop_token stop = {});

/// Drawn by ancestors, for now: 0 after waiting.
std::uint64_t samplesMissing(const PreparedView& prepared);

}  // namespace scancast
