// Decides for one stream how good its next moving frame is: detail and resolution after what drawing takes,
// chroma, JPEG quality and resolution after what the network takes, towards the wanted frames a second and
// never below the client's limits. The first frames are as good as the view asks for; only what has been
// measured lowers them. Nothing here has a clock: the same measurements give the same decisions.
//
// Owned by a stream session; its thread.
#pragma once

#include "server/stream/link_estimate.hpp"
#include "server/stream/quality.hpp"

namespace scancast {

/// What a moving frame took.
struct FrameCost {
    double renderMs = 0, encodeMs = 0;
    std::size_t rivals = 0;  ///< others who shared the device's time meanwhile
};

/// How a frame that goes out was packed.
enum class Coding : std::uint8_t {
    Jpeg,
    Video,     ///< builds on the frame before it
    VideoKey,  ///< a frame of a video that builds on none: its size says nothing of the next one's
};

class QualityController {
  public:
    using Time = LinkEstimate::Time;

    /// `isVideo`: moving frames are, and what JPEGs take says nothing of them.
    MovingQuality choose(const View& wanted, double ownDetail, const MovingLimits& limits,
                         bool isVideo = false);

    /// A moving frame of that quality is ready.
    void drawn(const MovingQuality& quality, const FrameCost& cost, double ownDetail,
               const MovingLimits& limits);
    /// Any frame goes out; `view` is what was encoded.
    void sent(std::uint64_t frame, const View& view, std::size_t bytes, Time now,
              Coding coding = Coding::Jpeg);
    void acknowledged(std::uint64_t frame, const MovingLimits& limits, Time now);

    const LinkEstimate& link() const { return link_; }

  private:
    double frameSeconds(const MovingLimits& limits) const;
    template <class QualityAt>
    double steadySide(double most, double least, double floor, double own, QualityAt qualityAt);
    void fitBytes(MovingQuality& quality, const View& wanted, const MovingLimits& limits, double budget);

    LinkEstimate link_;
    bool isVideo_ = false;
    double effort_ = 1;
    double rivals_ = 0;                    // smoothed
    std::optional<double> bytesPerPixel_;  // that the newest frame would have had at weight 1
    double resolution_ = 1;                // of the newest quality, as far as it was drawing's decision
    double sentResolution_ = 1;            // the same after the network's
    int strained_ = 0, eased_ = 0;         // qualities for which another resolution would have been better
    std::optional<double> jpegQuality_;    // of the newest quality that the network limited
    int news_ = 1;  // 0 = no frame went out since the newest quality: asking again teaches nothing
    bool coarseChroma_ = false;
};

}  // namespace scancast
