// The saved views and tours of a project file, which the page writes and opens (docs/project-file.md). What else it holds -
// measurements, annotations, what later versions add - is not looked at.
//
// A pure function of outside bytes; any thread. Pipeline: file → **parseProjectTours** → TourFlight → film.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "protocol/view/query.hpp"

namespace scancast::client {

inline constexpr std::size_t longestProject = std::size_t(4) << 20;
inline constexpr std::size_t mostProjectViews = 200, mostProjectTours = 20, mostTourStops = 500;

/// Which axis is up: the page's own word of an address.
enum class UpAxis : std::uint8_t { FromCamera, Y, MinusY };

struct ProjectView {
    std::string name;
    WordValues words;  ///< those of a view (protocol/view/view_words.hpp), not judged yet
    UpAxis up = UpAxis::FromCamera;
    bool operator==(const ProjectView&) const = default;
};

struct ProjectTour {
    std::string name = "Tour";
    std::vector<std::size_t> stops;  ///< numbers of views, in the tour's order
    double seconds = 4;              ///< from one to the next
    double pause = 2;                ///< at each
    bool loop = false;               ///< back to the first
    bool operator==(const ProjectTour&) const = default;
};

struct ProjectTours {
    std::string cloud;  ///< id
    std::vector<ProjectView> views;
    std::vector<ProjectTour> tours;  ///< one along all views where the file names none
    bool operator==(const ProjectTours&) const = default;

    /// The tour of that name; without a name, the first. NotFound, with the names that there are.
    Expected<ProjectTour> tour(const std::string& name) const;
};

/// Malformed for what is no JSON or no project, InvalidArgument, with the JSON path ("tours[1].views[0]") as field, for what
/// is wrong in one; ResourceLimit for a text longer than longestProject.
Expected<ProjectTours> parseProjectTours(std::string_view json);

}  // namespace scancast::client
