// A rendered picture and what it cost. Pipeline: device → **frame** → encode. A plain value, row 0 is the top.
//
// A device may lend its pixels from where they arrived (pixels.hpp): such a frame may outlive the device, and
// be copied, encoded and dropped on any thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/image/pixels.hpp"

namespace scancast {

struct StageTime {
    std::string name;  ///< "select", "nearest", "resolve", "eyedome", "average", "encode"
    double milliseconds = 0;
};

struct FrameStats {
    std::vector<StageTime> stages;   ///< in the order in which they ran; one entry per name
    std::uint64_t samplesDrawn = 0;  ///< in the cut (of one anti-aliasing frame)
    std::uint64_t pointsShown = 0;   ///< scan points that they stand for
    std::uint32_t nodesVisited = 0, nodesCulled = 0;
    std::uint32_t nodesClipped = 0;    ///< of those culled: cut away by clip box or shapes
    double spacingReached = 0;         ///< px
    std::uint32_t nodesMissing = 0;    ///< drawn by ancestors, because their blocks were not in memory
    std::uint64_t samplesMissing = 0;  ///< in those
    bool away = false;  ///< some of those cannot be had at present: what they come from is out of reach
    std::uint32_t nodesDamaged = 0;    ///< lacking, each counted once, because their blocks cannot be read
    std::uint64_t bytesUploaded = 0;   ///< of samples, to the device's own memory, since the picture before
    std::uint64_t deviceBytes = 0;     ///< of the device's own memory, for samples
    std::uint32_t mirrorsDrawn = 0;    ///< that the picture looks into
    std::uint32_t mirrorsLeftOut = 0;  ///< in view, too, but this device draws none: their glass is empty
    std::string method, device;
    std::string methodReason;  ///< why this method, where the request said auto
    std::string color;         ///< what it is coloured by, also where the request said auto
    std::string colormap;      ///< by which ramp, where that takes one
    std::optional<std::array<double, 2>> colorRange;  ///< the values at its ends, in file coordinates
    double exposure = 0;                              ///< of rgb, stops; the same
    /// Adds to the stage of that name, or appends it.
    void add(std::string_view stage, double milliseconds);
};

struct Frame {
    int width = 0, height = 0;
    Pixels<std::uint8_t> rgba;  ///< width·height·4, straight alpha; 255 everywhere unless transparent
    /// width·height linear depth, cloud units; +infinity = background. Empty where none was asked for, on
    /// every device alike.
    Pixels<float> depth;
    FrameStats stats;
};

}  // namespace scancast
