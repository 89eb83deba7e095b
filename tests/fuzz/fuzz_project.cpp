// Project files, as the page saves them and anybody may send them: what is accepted refers to nothing that is not there, and every flight that can be
// made of it stays finite and passes its views.
#include <cmath>
#include <cstdlib>

#include "client/cpp/program/tour/tour_flight.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace scancast;
    using namespace scancast::client;
    const auto project = parseProjectTours({reinterpret_cast<const char*>(data), size});
    if (!project) return 0;
    if (project->tours.empty() || project->views.size() > mostProjectViews) std::abort();
    for (const auto& tour : project->tours) {
        for (const auto stop : tour.stops)
            if (stop >= project->views.size()) std::abort();
        const auto flight = TourFlight::create({}, *project, tour, {}, {});
        if (!flight) continue;
        for (int i = 0; i <= 16; ++i) {
            const auto camera = flight->at(flight->seconds() * i / 16).camera;
            for (int axis = 0; axis < 3; ++axis)
                if (!std::isfinite(camera.eye[axis]) || !std::isfinite(camera.target[axis])) std::abort();
        }
        if (!(flight->at(flight->seconds()).camera == flight->at(1e9).camera)) std::abort();
    }
    return 0;
}
