#include "client/cpp/program/tour/tour_flight.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "protocol/view/view_words.hpp"

namespace scancast::client {
namespace {

constexpr double quarterTurn = std::numbers::pi / 2;
constexpr double poleZone =
    1e-3;  // radians; nearer to the pole than this, the axis is no usable up direction
constexpr double usualFov = 60;

/// From a frame in which Z is up to the cloud's, and back; `axis` as TourFlight::upAxis_.
glm::dvec3 toCloud(const glm::dvec3& v, int axis) {
    return axis == 0 ? v : axis > 0 ? glm::dvec3(v.x, v.z, -v.y) : glm::dvec3(v.x, -v.z, v.y);
}
glm::dvec3 toUpright(const glm::dvec3& v, int axis) {
    return axis == 0 ? v : axis > 0 ? glm::dvec3(v.x, -v.z, v.y) : glm::dvec3(v.x, v.z, -v.y);
}

double tangentOf(double fov) {
    return std::tan(fov * std::numbers::pi / 360);
}

/// Which axis the camera takes for up, as far as it says it: a model's is Y, or -Y.
int upAxisOf(const Camera& camera) {
    const auto back = camera.eye - camera.target;
    const bool fromAbove = std::hypot(back.x, back.y) < 1e-3 * std::abs(back.z);  // there, Y is north
    if (fromAbove || std::abs(camera.up.y) < 0.9 * glm::length(camera.up)) return 0;
    return camera.up.y > 0 ? 1 : -1;
}

int upAxisOf(const ProjectView& view, const Camera& camera) {
    return view.up == UpAxis::Y ? 1 : view.up == UpAxis::MinusY ? -1 : upAxisOf(camera);
}

glm::dvec3 backOf(double azimuth, double elevation, int axis) {
    return toCloud({std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                    std::sin(elevation)},
                   axis);
}

/// At a place between two legs: their harmonic mean, or none where the way turns back.
double slopeBetween(double before, double after) {
    return before * after > 0 ? 2 * before * after / (before + after) : 0;
}

Error ofView(const std::string& name, Error error) {
    error.message = "the view \"" + name + "\": " + error.message;
    return error;
}

}  // namespace

Expected<TourFlight::Stop> TourFlight::stopOf(View view, int upAxis) {
    const auto& camera = view.camera;
    if (camera.viewMatrix)
        return fail(ErrorCode::InvalidArgument, "a tour is made of eye and target, not of viewMatrix",
                    "viewMatrix");
    const auto offset = toUpright(camera.eye - camera.target, upAxis);
    const double away = glm::length(offset);
    const double elevation = std::asin(std::clamp(offset.z / away, -1.0, 1.0));
    const auto up = toUpright(camera.up, upAxis);
    // At the pole the eye says nothing about the azimuth, but the picture's up direction does.
    const bool atPole = quarterTurn - std::abs(elevation) < poleZone && std::hypot(up.x, up.y) > 1e-9;
    const double side = elevation > 0 ? -1 : 1;
    const double azimuth = atPole ? std::atan2(up.y * side, up.x * side) : std::atan2(offset.y, offset.x);
    const bool orthographic = camera.projection == Projection::Orthographic;
    const double fov = orthographic ? usualFov : camera.fov;
    const double distance = orthographic ? camera.viewHeight / (2 * tangentOf(fov)) : away;
    const Place place{
        camera.target.x, camera.target.y, camera.target.z, azimuth, elevation, std::log(distance), fov};
    return Stop{std::move(view), place};
}

Expected<TourFlight> TourFlight::create(const View& base, const ProjectTours& project,
                                        const ProjectTour& tour, const WordValues& changes,
                                        const Surroundings& surroundings) {
    if (tour.stops.size() < 2)
        return fail(ErrorCode::InvalidArgument, "a tour needs two saved views; \"" + tour.name + "\" has " +
                                                    std::to_string(tour.stops.size()));
    TourFlight flight;
    flight.seconds_ = tour.seconds;
    flight.pause_ = tour.pause;
    flight.surroundings_ = surroundings;
    auto numbers = tour.stops;
    if (tour.loop) numbers.push_back(numbers.front());
    for (const auto number : numbers) {
        const auto& saved = project.views[number];
        const auto said = applyWords(base, saved.words);
        if (!said) return tl::unexpected(ofView(saved.name, said.error()));
        const auto view = applyWords(*said, changes);
        if (!view) return passOn(view);
        if (!(view->camera == said->camera))
            return fail(ErrorCode::InvalidArgument, "the camera of a tour is that of its saved views");
        const int axis = upAxisOf(saved, view->camera);
        if (flight.stops_.empty()) flight.upAxis_ = axis;
        if (axis != flight.upAxis_)
            return fail(
                ErrorCode::InvalidArgument,
                "the view \"" + saved.name + "\" takes another axis for up than the first one of the tour");
        auto stop = stopOf(*view, axis);
        if (!stop) return tl::unexpected(ofView(saved.name, stop.error()));
        if (!flight.stops_.empty()) {  // by the shorter way round
            const double before = flight.stops_.back().place[3], turn = stop->place[3] - before;
            stop->place[3] = before + std::atan2(std::sin(turn), std::cos(turn));
        }
        flight.stops_.push_back(std::move(*stop));
    }
    if (!(tour.pause > 0)) flight.findSlopes(tour.loop);
    return flight;
}

void TourFlight::findSlopes(bool loop) {
    const std::size_t last = stops_.size() - 1;
    for (std::size_t i = 0; i <= last; ++i) {
        if (!loop && (i == 0 || i == last)) continue;
        const std::size_t before = i == 0 ? last - 1 : i - 1, after = i == last ? 0 : i;
        const auto leg = [&](std::size_t from, std::size_t k) {
            return stops_[from + 1].place[k] - stops_[from].place[k];
        };
        for (std::size_t k = 0; k < stops_[i].place.size(); ++k)
            stops_[i].slope[k] = slopeBetween(leg(before, k), leg(after, k));
    }
}

View TourFlight::between(std::size_t i, double s) const {
    const auto &from = stops_[i], &to = stops_[i + 1];
    const double s2 = s * s, s3 = s2 * s;
    Place place;
    for (std::size_t k = 0; k < place.size(); ++k)
        place[k] = from.place[k] * (2 * s3 - 3 * s2 + 1) + to.place[k] * (3 * s2 - 2 * s3) +
                   from.slope[k] * (s3 - 2 * s2 + s) + to.slope[k] * (s3 - s2);
    const double elevation = std::clamp(place[4], -quarterTurn, quarterTurn), fov = place[6];
    double distance = std::clamp(std::exp(place[5]), 1e-6, 1e11);  // as the page's cameras are

    View view = from.view;
    auto& camera = view.camera;
    camera.near = camera.far = std::nullopt;
    camera.target = {place[0], place[1], place[2]};
    if (camera.projection == Projection::Orthographic) {
        camera.viewHeight = 2 * distance * tangentOf(fov);
        distance = std::max(distance,
                            glm::distance(camera.target, surroundings_.center) + 1.1 * surroundings_.radius);
    } else {
        camera.fov = fov;
    }
    camera.eye = camera.target + backOf(place[3], elevation, upAxis_) * distance;
    const bool atPole = quarterTurn - std::abs(elevation) < poleZone;
    // Across the view direction and upwards: at the pole the axis itself is none.
    camera.up = atPole ? toCloud({-std::sin(elevation) * std::cos(place[3]),
                                  -std::sin(elevation) * std::sin(place[3]), std::cos(elevation)},
                                 upAxis_)
                       : toCloud({0, 0, 1}, upAxis_);
    return view;
}

double TourFlight::seconds() const {
    return static_cast<double>(stops_.size() - 1) * (seconds_ + pause_) + pause_;
}

View TourFlight::at(double time) const {
    const double leg = seconds_ + pause_;
    const double passed =
        std::clamp(std::floor(time / leg + 1e-9), 0.0, static_cast<double>(stops_.size() - 1));
    const auto i = static_cast<std::size_t>(passed);
    const double within = time - passed * leg;
    if (within <= pause_ || i + 1 == stops_.size()) return stops_[i].view;
    return between(i, std::min(1.0, (within - pause_) / seconds_));
}

}  // namespace scancast::client
