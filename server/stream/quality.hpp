// How good a frame may be while the view moves: what is paid for drawing. Pure functions of what was
// measured: one number, the *effort*, says which share of the full cost a frame may have; detail pays first,
// resolution second. What the network asks for on top of that is the quality controller's
// (quality_controller.hpp), which the stream session asks once per moving frame.
#pragma once

#include "protocol/view/view.hpp"

namespace scancast {

/// How far quality may fall; the client's `quality` message sets them.
struct MovingLimits {
    double fps = 30;             ///< wanted, frames a second
    double minResolution = 0.5;  ///< of width and height
    double maxDetail = 2;        ///< τ, px; a view that asks for a larger one gets it anyway
    int minJpegQuality = 40;     ///< a view that asks for less gets it anyway
};

/// What a moving frame is to be.
struct MovingQuality {
    double effort = 1;      ///< it was made for
    double detail = 1;      ///< τ, px
    double resolution = 1;  ///< of width and height
    int jpegQuality = 90;
    Subsampling subsampling = Subsampling::S420;
    bool byNetwork = false;  ///< less than the device's effort allows
};

/// Sizes come in steps of this share, so that a client does not see a new size with every frame.
inline constexpr double resolutionStep = 1.0 / 8;
/// Part of a frame's time that making it may take: what is not taken is gained in latency.
inline constexpr double usableShare = 0.5;

/// The smallest effort that changes anything: everything at its limit.
double leastEffort(double ownDetail, const MovingLimits& limits);

/// What the quality costs to draw, as a share of the full picture without anti-aliasing: about 1/τ² and about
/// the number of pixels. `ownDetail` is the τ of the full picture.
double costOf(const MovingQuality& quality, double ownDetail);

/// The effort for the next frame, after one of that quality took `milliseconds`. Falls at once to what the
/// wanted rate allows and rises by a quarter at most, so that one quick frame does not make the picture pump.
/// In [leastEffort, 1].
double nextEffort(const MovingQuality& quality, double milliseconds, double ownDetail,
                  const MovingLimits& limits);

/// Detail and resolution for an effort; 1 is the full picture without anti-aliasing. Keeps to the resolution
/// `before` while that is near enough.
MovingQuality movingQuality(double effort, double ownDetail, const MovingLimits& limits, double before = 0);

/// The view as it is drawn while moving: one sample a pixel, as the quality says.
View movingView(const View& wanted, const MovingQuality& quality);

}  // namespace scancast
