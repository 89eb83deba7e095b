#include "client/cpp/program/tour/project_tours.hpp"

#include <algorithm>
#include <cmath>

#include "protocol/json_fields.hpp"
#include "protocol/json_text.hpp"

namespace scancast::client {
namespace {

constexpr std::size_t longestName = 120 * 4, longestView = 4096;  // bytes; the page counts letters
constexpr double leastSeconds = 0.2, mostSeconds = 600;

/// Words of an address that are the page's own: they change no picture, or say what is in the project anyway.
constexpr std::array<std::string_view, 4> pagesOwn{"cloud", "measures", "present", "compare"};

std::string at(std::string_view list, std::size_t index) {
    return std::string(list) + "[" + std::to_string(index) + "]";
}

/// The list's entries, one after the other, as long as `read(entry, path)` finds nothing wrong. A list may be missing.
template <typename Read>
Expected<void> eachOf(FieldReader& file, std::string_view name, std::size_t most, const Read& read) {
    const auto* list = file.find(name);
    if (!list) return {};
    const std::string field(name);
    if (!list->is_array()) return fail(ErrorCode::InvalidArgument, field + ": must be a list", field);
    if (list->size() > most)
        return fail(ErrorCode::InvalidArgument,
                    field + ": has " + std::to_string(list->size()) + " entries; " + std::to_string(most) +
                        " is the most",
                    field);
    for (std::size_t i = 0; i < list->size(); ++i) {
        const auto path = at(name, i);
        if (!(*list)[i].is_object())
            return fail(ErrorCode::InvalidArgument, path + ": must be an object", path);
        if (auto ok = read((*list)[i], path); !ok) return ok;
    }
    return {};
}

/// The words of an address, as behind its #.
Expected<void> readWords(const std::string& address, const std::string& path, ProjectView& view) {
    const auto words = parseQuery(address);
    if (!words)
        return fail(ErrorCode::InvalidArgument, path + ".view: " + words.error().message, path + ".view");
    for (const auto& [word, value] : *words) {
        if (std::ranges::find(pagesOwn, word) != pagesOwn.end()) continue;
        if (word != "upAxis") {
            view.words.emplace_back(word, value);
            continue;
        }
        if (value != "y" && value != "-y")
            return fail(ErrorCode::InvalidArgument, path + ".view: upAxis must be y or -y", path + ".view");
        view.up = value == "y" ? UpAxis::Y : UpAxis::MinusY;
    }
    return {};
}

Expected<std::size_t> numberOf(const std::vector<ProjectView>& views, const nlohmann::json& name,
                               const std::string& path) {
    if (name.is_string()) {
        const auto& text = name.get_ref<const std::string&>();
        const auto found = std::ranges::find(views, text, &ProjectView::name);
        if (found != views.end()) return static_cast<std::size_t>(found - views.begin());
    }
    return fail(ErrorCode::InvalidArgument, path + ": names no view of this file", path);
}

Expected<void> readStops(const nlohmann::json& list, const std::string& path,
                         const std::vector<ProjectView>& views, ProjectTour& tour) {
    if (!list.is_array() || list.size() > mostTourStops)
        return fail(ErrorCode::InvalidArgument,
                    path + ": must be a list of up to " + std::to_string(mostTourStops) + " names of views",
                    path);
    for (std::size_t i = 0; i < list.size(); ++i) {
        const auto number = numberOf(views, list[i], at(path, i));
        if (!number) return passOn(number);
        tour.stops.push_back(*number);
    }
    return {};
}

std::vector<std::size_t> allOf(const std::vector<ProjectView>& views) {
    std::vector<std::size_t> numbers(views.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = i;
    return numbers;
}

Expected<void> readViews(FieldReader& file, ProjectTours& project) {
    return eachOf(file, "views", mostProjectViews, [&](const nlohmann::json& entry, const std::string& path) {
        FieldReader fields(entry, path);
        ProjectView view;
        std::string address;
        fields.require("name");
        fields.text("name", view.name, longestName);
        fields.require("view");
        fields.text("view", address, longestView);
        if (view.name.empty()) fields.error("name", "is empty");
        if (auto ok = fields.finishLenient(); !ok) return ok;
        if (std::ranges::find(project.views, view.name, &ProjectView::name) != project.views.end())
            return Expected<void>(
                fail(ErrorCode::InvalidArgument, path + ".name: there are two of this name", path + ".name"));
        if (auto ok = readWords(address, path, view); !ok) return ok;
        project.views.push_back(std::move(view));
        return Expected<void>();
    });
}

Expected<void> readTours(FieldReader& file, ProjectTours& project) {
    return eachOf(file, "tours", mostProjectTours, [&](const nlohmann::json& entry, const std::string& path) {
        FieldReader fields(entry, path);
        ProjectTour tour;
        fields.require("name");
        fields.text("name", tour.name, longestName);
        fields.number("seconds", tour.seconds);
        fields.number("pause", tour.pause);
        fields.flag("loop", tour.loop);
        const auto* stops = fields.find("views");
        if (!(tour.seconds >= leastSeconds && tour.seconds <= mostSeconds))
            fields.error("seconds", "must lie between 0.2 and 600");
        if (!(tour.pause >= 0 && tour.pause <= mostSeconds))
            fields.error("pause", "must lie between 0 and 600");
        if (tour.name.empty()) fields.error("name", "is empty");
        if (std::ranges::find(project.tours, tour.name, &ProjectTour::name) != project.tours.end())
            fields.error("name", "there are two of this name");
        if (auto ok = fields.finishLenient(); !ok) return ok;
        if (!stops)
            tour.stops = allOf(project.views);
        else if (auto ok = readStops(*stops, path + ".views", project.views, tour); !ok)
            return ok;
        project.tours.push_back(std::move(tour));
        return Expected<void>();
    });
}

}  // namespace

Expected<ProjectTour> ProjectTours::tour(const std::string& name) const {
    const auto found = name.empty() ? tours.begin() : std::ranges::find(tours, name, &ProjectTour::name);
    if (found != tours.end()) return *found;
    std::string names;
    for (const auto& one : tours) names += (names.empty() ? "" : ", ") + one.name;
    return fail(ErrorCode::NotFound, "there is no tour \"" + name + "\"; there are: " + names);
}

Expected<ProjectTours> parseProjectTours(std::string_view json) {
    if (json.size() > longestProject)
        return fail(ErrorCode::ResourceLimit, "larger than 4 MiB, which no project file is");
    const auto value = parseJson(json);
    if (!value) return passOn(value);
    const auto noProject = [](const std::string& why) {
        return fail(ErrorCode::Malformed, "no project file: " + why);
    };
    if (!value->is_object() || value->value("format", nlohmann::json()) != "scancast-project")
        return noProject("it does not say \"format\": \"scancast-project\"");
    FieldReader file(*value);
    std::uint64_t version = 0;
    file.require("version");
    file.integer("version", version, 1, 1);
    const auto* cloud = file.require("cloud");
    if (auto ok = file.finishLenient(); !ok) return passOn(ok);
    if (!cloud->is_object()) return fail(ErrorCode::InvalidArgument, "cloud: must be an object", "cloud");
    ProjectTours project;
    FieldReader about(*cloud, "cloud");
    about.require("id");
    if (about.text("id", project.cloud, 64) && project.cloud.empty())
        about.error("id", "names no point cloud");
    if (auto ok = about.finishLenient(); !ok) return passOn(ok);
    if (auto ok = readViews(file, project); !ok) return passOn(ok);
    if (auto ok = readTours(file, project); !ok) return passOn(ok);
    if (project.tours.empty()) project.tours.push_back({.stops = allOf(project.views)});
    return project;
}

}  // namespace scancast::client
