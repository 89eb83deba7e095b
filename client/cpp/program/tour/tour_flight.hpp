// A flight along the views of a tour: what is looked at, the direction from which, and how far away it is, each along a cubic
// through the views that never leaves what lies between two of them (Fritsch, Butland: "A Method for Constructing Local
// Monotone Piecewise Cubic Interpolants", 1984). So the camera goes round what it looks at and never through it, and neither
// loops nor overshoots, however unlike the legs are. It passes each view at its time; where the tour pauses it comes to rest
// there, elsewhere it only changes its speed smoothly. The page flies the same way (client/web/views/tour.js).
//
// Plain values; any thread. Pipeline: project file → **TourFlight** → film.
#pragma once

#include <array>
#include <vector>

#include "client/cpp/program/tour/project_tours.hpp"
#include "protocol/view/view.hpp"

namespace scancast::client {

/// Where a cloud lies: an orthographic eye stands outside of it, so that nothing is cut off.
struct Surroundings {
    glm::dvec3 center{0};
    double radius = 0;
};

class TourFlight {
  public:
    /// `base`: the cloud's default view, on top of which a saved view says what it says; `changes`: words that hold for all
    /// of them, no camera's. InvalidArgument or ImpossibleView, naming the view, for one that is none, for fewer than two,
    /// for a viewMatrix, and where views do not agree about which axis is up.
    static Expected<TourFlight> create(const View& base, const ProjectTours& project, const ProjectTour& tour,
                                       const WordValues& changes, const Surroundings& surroundings);

    /// Until it has paused at the last view; of a tour that loops, until it is back at the first.
    double seconds() const;
    /// The view that many seconds after the beginning, at rest at the first view. Everything but the camera is as in the view
    /// where it was last; at a view it is that view itself.
    View at(double time) const;

  private:
    /// Target, azimuth, elevation (radians), logarithm of the distance, field of view (degrees; of an orthographic view, that
    /// of a perspective one that sees as much at its target).
    using Place = std::array<double, 7>;
    struct Stop {
        View view;
        Place place;
        Place slope{};  ///< how each of them changes there, in legs
    };
    TourFlight() = default;

    static Expected<Stop> stopOf(View view, int upAxis);
    void findSlopes(bool loop);
    View between(std::size_t i, double s) const;

    std::vector<Stop> stops_;
    double seconds_ = 4, pause_ = 2;
    int upAxis_ = 0;  ///< 0: Z, 1: Y, -1: -Y
    Surroundings surroundings_;
};

}  // namespace scancast::client
