// Stability in motion, measured: a camera moves in small steps, and successive pictures are compared. A
// change of level is isolated exactly: the new view is drawn twice, with the nodes that the new camera
// chooses and with those that the last one chose; where the two differ, nothing but levels moved.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <span>
#include <vector>

#include "renderer/mirrors.hpp"
#include "renderer/render.hpp"
#include "renderer/residency/provide.hpp"

namespace scancast::test {

/// What a step of the camera does to it.
enum class Motion {
    Orbit,  ///< about the target's vertical by so many degrees
    Zoom,   ///< towards the target by so many per cent of the distance; orthographic: of the picture's height
};

inline Camera moved(Camera camera, Motion motion, double amount) {
    if (motion == Motion::Zoom) {
        camera.eye = camera.target + (camera.eye - camera.target) * (1 - amount / 100);
        camera.viewHeight *= 1 - amount / 100;
        return camera;
    }
    const double angle = glm::radians(amount), c = std::cos(angle), s = std::sin(angle);
    const glm::dvec3 axis = glm::normalize(camera.up), arm = camera.eye - camera.target;
    const glm::dvec3 along = axis * glm::dot(axis, arm);
    camera.eye = camera.target + along + (arm - along) * c + glm::cross(axis, arm) * s;
    return camera;
}

/// Fraction of the pixels that differ by more than `threshold` of 255 in any channel, alpha included.
inline double changed(const Frame& a, const Frame& b, int threshold = 16) {
    std::size_t count = 0;
    const std::size_t pixels = a.rgba.size() / 4;
    for (std::size_t i = 0; i < pixels; ++i) {
        bool differs = false;
        for (std::size_t c = 4 * i; c < 4 * i + 4; ++c)
            differs |= std::abs(int(a.rgba[c]) - int(b.rgba[c])) > threshold;
        count += differs;
    }
    return pixels == 0 ? 0 : double(count) / double(pixels);
}

struct Extent {
    double worst = 0, sum = 0;
    int count = 0;
    void add(double value) {
        worst = std::max(worst, value);
        sum += value;
        ++count;
    }
    double mean() const { return count == 0 ? 0 : sum / count; }
};

/// Fractions of pixels, one a step.
struct Stability {
    Extent frames;        ///< between successive frames, levels on
    Extent bruteForce;    ///< the same pairs, every leaf sample; empty when not asked for
    Extent levels;        ///< by the change of level alone
    Extent samples;       ///< in the cut
    Extent milliseconds;  ///< per picture, levels on
};

struct StabilityOptions {
    Motion motion = Motion::Orbit;
    double step = 0.1;
    int steps = 100;
    bool bruteForce = true;
};

/// The view, with the nodes that another camera would choose, without culling.
inline Expected<Frame> renderWithLevelsOf(const Camera& camera, Device& device, const Cloud& cloud,
                                          const View& view) {
    const auto planned = plan(cloud, view);
    if (!planned) return passOn(planned);
    View other = view;
    other.camera = camera;
    const auto levels = Viewpoint::create(other, cloud.origin, cloud.bounds);
    if (!levels) return passOn(levels);
    PreparedView prepared;
    prepared.planned = *planned;
    prepared.cloud = &cloud;
    prepared.cuts = cutsOf(cloud, **planned);
    SelectOptions selection = (*planned)->selection;
    selection.cull = selection.cullBackFaces = false;
    const glm::dmat4 toCloud = glm::inverse((*planned)->viewpoint.cloudToView);
    for (CutView& seen : prepared.cuts) {
        Viewpoint from = *levels;
        if (seen.glass) from.cloudToView *= toCloud * seen.viewpoint.cloudToView;
        auto cut = provide(cloud.octree, select(cloud.octree, from, selectionOf(seen, selection)));
        if (!cut) return passOn(cut);
        seen.cut = std::move(*cut);
    }
    return draw(device, prepared);
}

inline Expected<Stability> measureStability(Device& device, const Cloud& cloud, View view,
                                            const StabilityOptions& options) {
    Stability result;
    std::optional<Frame> last, lastBrute;
    Camera lastCamera;
    const Camera start = view.camera;
    for (int i = 0; i <= options.steps; ++i) {
        view.camera = options.motion == Motion::Orbit
                          ? moved(start, options.motion, options.step * i)
                          : moved(start, options.motion, 100 - 100 * std::pow(1 - options.step / 100, i));
        auto frame = render(device, cloud, view);
        if (!frame) return passOn(frame);
        result.samples.add(double(frame->stats.samplesDrawn));
        double milliseconds = 0;
        for (const StageTime& stage : frame->stats.stages) milliseconds += stage.milliseconds;
        result.milliseconds.add(milliseconds);
        if (options.bruteForce) {
            auto brute = render(device, cloud, view, {.bruteForce = true});
            if (!brute) return passOn(brute);
            if (lastBrute) result.bruteForce.add(changed(*lastBrute, *brute));
            lastBrute = std::move(*brute);
        }
        if (last) {
            result.frames.add(changed(*last, *frame));
            auto before = renderWithLevelsOf(lastCamera, device, cloud, view);
            if (!before) return passOn(before);
            result.levels.add(changed(*before, *frame));
        }
        last = std::move(*frame);
        lastCamera = view.camera;
    }
    return result;
}

}  // namespace scancast::test
