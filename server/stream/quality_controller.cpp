#include "server/stream/quality_controller.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "protocol/messages.hpp"

namespace scancast {
namespace {

// How the bytes of a JPEG follow its settings, near enough: what is measured of one frame corrects it for the
// next. Quantisation steps are `scale` times the standard's tables (libjpeg's rule).
constexpr double bytesFallWith = 2.0 / 3;
// The same of a video's frames (→ decision 37).
constexpr double videoFallsWith = 1;

double weightOf(double quality, bool isVideo) {
    const double scale = quality < 50 ? 50 / quality : 2 - quality / 50;
    return std::pow(std::max(scale, 0.01), isVideo ? -videoFallsWith : -bytesFallWith);
}

double qualityOf(double weight, bool isVideo) {
    const double scale = std::pow(weight, -1 / (isVideo ? videoFallsWith : bytesFallWith));
    return scale > 1 ? 50 / scale : 100 - 50 * scale;
}

double weightOf(Subsampling subsampling) {
    switch (subsampling) {
        case Subsampling::S444:
            return 1.35;
        case Subsampling::S422:
            return 1.15;
        case Subsampling::S420:
            break;
    }
    return 1;
}

// Where pixels are given up rather than more of the quality of each, as a share of the view's own quality;
// they come back when the larger picture can have that much more.
constexpr double goodEnough = 0.6;
constexpr double betterBy = 1.2;
constexpr int patienceWithPoor = 4, patienceWithGood = 12;  // frames
constexpr double steepestRise = 6;                          // of JPEG quality, from frame to frame
// Chroma comes back at once when the network allows it, and goes when it costs this much quality.
constexpr double chromaCosts = 10;
// The estimate of the bandwidth errs towards too much, never towards a blur; this makes up for it.
constexpr double shareOfLink = 0.7;
// Where the round trip decides the rate anyway, because the window is at its end, frames may take their share of it.
constexpr double shareOfLatency = 1.0 / maxUnacknowledgedFrames;
constexpr double rivalsSmoothing = 0.2;

}  // namespace

double QualityController::frameSeconds(const MovingLimits& limits) const {
    return std::max(1 / limits.fps, link_.latency() * shareOfLatency);
}

MovingQuality QualityController::choose(const View& wanted, double ownDetail, const MovingLimits& limits,
                                        bool isVideo) {
    if (std::exchange(isVideo_, isVideo) != isVideo) bytesPerPixel_.reset();
    MovingQuality quality = movingQuality(effort_, ownDetail, limits, resolution_);
    resolution_ = quality.resolution;
    quality.jpegQuality = wanted.quality.jpegQuality;
    quality.subsampling = isVideo ? Subsampling::S420 : wanted.quality.subsampling;
    if (link_.bandwidth() && bytesPerPixel_)
        fitBytes(quality, wanted, limits, *link_.bandwidth() * shareOfLink * frameSeconds(limits));
    quality.byNetwork = quality.resolution < resolution_ ||
                        quality.jpegQuality < wanted.quality.jpegQuality ||
                        quality.subsampling != wanted.quality.subsampling;
    sentResolution_ = quality.resolution;
    news_ = 0;
    return quality;
}

// A size is given up when its pixels get poor, and another taken when they can be good there: at once where
// there is no doubt, else only when most of several qualities agree, because a picture that changes its size
// again and again is worse than one that is too small.
template <class QualityAt>
double QualityController::steadySide(double most, double least, double floor, double own,
                                     QualityAt qualityAt) {
    const double good = std::clamp(goodEnough * own, floor, own);
    double side = std::clamp(sentResolution_, std::min(least, most), most);
    const auto larger = [&] { return std::min(side + resolutionStep, most); };
    const double now = qualityAt(side), then = qualityAt(larger());
    strained_ = now < good ? strained_ + news_ : 0;
    eased_ = side < most && then > betterBy * good ? eased_ + news_ : std::max(eased_ - 2 * news_, 0);
    if (now < floor || strained_ > patienceWithPoor) {
        while (side > least && qualityAt(side) < good) side = std::max(side - resolutionStep, least);
    } else if (then > own || eased_ > patienceWithGood) {
        while (side < most && qualityAt(larger()) > betterBy * good) side = larger();
    } else {
        return side;
    }
    strained_ = eased_ = 0;
    return side;
}

void QualityController::fitBytes(MovingQuality& quality, const View& wanted, const MovingLimits& limits,
                                 double budget) {
    const double pixels = double(wanted.width) * double(wanted.height);
    const double own = wanted.quality.jpegQuality;
    const auto qualityAt = [&](double resolution, Subsampling chroma) {
        const double bytes = *bytesPerPixel_ * pixels * resolution * resolution * weightOf(chroma);
        return qualityOf(budget / bytes, isVideo_);
    };
    const double atFull = qualityAt(quality.resolution, quality.subsampling);
    coarseChroma_ = atFull < (coarseChroma_ ? own : own - chromaCosts);
    if (coarseChroma_) quality.subsampling = Subsampling::S420;
    const double floor = std::min(double(limits.minJpegQuality), own);
    const double side =
        steadySide(quality.resolution, limits.minResolution, floor, own,
                   [&](double resolution) { return qualityAt(resolution, quality.subsampling); });
    quality.resolution = side;
    const double affordable = std::clamp(qualityAt(side, quality.subsampling), floor, own);
    jpegQuality_ = std::min(affordable, jpegQuality_.value_or(own) + steepestRise * news_);
    quality.jpegQuality = int(std::lround(std::clamp(*jpegQuality_, floor, own)));
}

void QualityController::drawn(const MovingQuality& quality, const FrameCost& cost, double ownDetail,
                              const MovingLimits& limits) {
    rivals_ += rivalsSmoothing * (double(cost.rivals) - rivals_);
    // The device is shared: a frame costs a session the turns of the others, too.
    const double milliseconds = cost.renderMs * (1 + rivals_) + cost.encodeMs;
    effort_ = nextEffort(quality, milliseconds, ownDetail, limits);
}

void QualityController::sent(std::uint64_t frame, const View& view, std::size_t bytes, Time now,
                             Coding coding) {
    // Of a session with video: neither its stills nor keys say how large the next frame will be.
    if (coding == (isVideo_ ? Coding::Video : Coding::Jpeg)) {
        const double weight =
            weightOf(view.quality.jpegQuality, isVideo_) * weightOf(view.quality.subsampling);
        bytesPerPixel_ = double(bytes) / (double(view.width) * double(view.height) * weight);
    }
    link_.sent(frame, bytes, now);
    news_ = 1;
}

void QualityController::acknowledged(std::uint64_t frame, const MovingLimits& limits, Time now) {
    link_.acknowledged(frame, frameSeconds(limits), now);
}

}  // namespace scancast
