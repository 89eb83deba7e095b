// How good a frame may be while the view moves. Pure functions of what was measured: one number, the
// *effort*, says which share of the full cost a frame may have; detail pays first, resolution second.
//
// Used by the stream session, once per moving frame. The controller that also follows the acknowledged
// bandwidth (and then JPEG quality) replaces nextEffort() and keeps the rest.
#pragma once

#include "protocol/view.hpp"

namespace scancast {

/// How far quality may fall; the client's `quality` message sets them.
struct MovingLimits {
    double fps = 30;             ///< wanted, frames a second
    double minResolution = 0.5;  ///< of width and height
    double maxDetail = 2;        ///< τ, px; a view that asks for a larger one gets it anyway
    int minJpegQuality = 40;     ///< the bandwidth controller's floor
};

/// What one effort means for one view.
struct MovingPlan {
    double detail = 1;      ///< τ, px
    double resolution = 1;  ///< of width and height
};

/// The smallest effort that changes anything: everything at its limit.
double leastEffort(double ownDetail, const MovingLimits& limits);

/// The effort for the next frame, after one of effort `effort` took `renderMs`. Falls at once to what the
/// wanted rate allows and rises by a quarter at most, so that one quick frame does not make the picture pump.
/// In [leastEffort, 1].
double nextEffort(double effort, double renderMs, double ownDetail, const MovingLimits& limits);

/// Rendering costs about 1/τ² until resolution matters, then about the number of pixels. `ownDetail` is the τ
/// of the full picture; effort 1 is that picture without anti-aliasing.
MovingPlan planMoving(double effort, double ownDetail, const MovingLimits& limits);

/// The view as it is drawn while moving: one sample a pixel, the plan's τ, the plan's size.
View movingView(const View& wanted, double ownDetail, double effort, const MovingLimits& limits);

}  // namespace scancast
