#include "client/cpp/program/orbit_start.hpp"

#include <algorithm>

#include "protocol/view/view_words.hpp"

namespace scancast::client {

Expected<OrbitStart> orbitStart(const ViewFlags& flags, const CloudInfo& cloud) {
    const auto words = flags.words();
    if (!words) return passOn(words);
    const auto view = applyWords(cloud.view, *words);
    if (!view) return passOn(view);
    if (view->camera.viewMatrix)
        return fail(ErrorCode::InvalidArgument,
                    "an orbit is made of --eye and --target, not of --view-matrix", "viewMatrix");
    const bool targetGiven =
        std::any_of(words->begin(), words->end(), [](const auto& w) { return w.first == "target"; });
    OrbitStart start{*view, targetGiven ? view->camera.target : (cloud.bounds[0] + cloud.bounds[1]) * 0.5,
                     cloud.view.camera.viewMatrix ? glm::dvec3(0, 0, 1) : cloud.view.camera.up};
    start.view = start.at(0);
    if (auto ok = validate(start.view); !ok) return passOn(ok);
    return start;
}

}  // namespace scancast::client
