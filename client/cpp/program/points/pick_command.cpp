// `scancast-client pick`: what a pixel of a picture shows, by HTTP.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "client/cpp/program/command.hpp"
#include "client/cpp/program/points/say_values.hpp"
#include "client/cpp/program/say.hpp"
#include "protocol/flags/view_flags.hpp"
#include "protocol/json_text.hpp"
#include "protocol/view/view_json.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast::client {
namespace {

struct PickFlags {
    CloudFlags cloud;
    ViewFlags view;
    double x = 0, y = 0;
    bool json = false;
};

/// Of a view, what differs from another: what was said.
nlohmann::json saidOf(const View& base, const View& view) {
    const auto before = toJson(base);
    nlohmann::json said = nlohmann::json::object();
    const nlohmann::json whole = toJson(view);  // outlives the walk
    for (const auto& [key, value] : whole.items())
        if (before[key] != value) said[key] = value;
    return said;
}

Expected<void> run(const PickFlags& flags) {
    const auto words = flags.view.words();
    if (!words) return passOn(words);
    const auto from = flags.cloud.choose();
    if (!from) return passOn(from);
    nlohmann::json said = nlohmann::json::object();
    if (!words->empty()) {
        const auto cloud = from->info();
        if (!cloud) return passOn(cloud);
        const auto view = applyWords(cloud->view, *words);
        if (!view) return passOn(view);
        said = saidOf(cloud->view, *view);
    }
    const auto point = from->server.pick(from->id, said, flags.x, flags.y);
    if (!point) return passOn(point);
    if (flags.json) {
        sayOn(stdout, "%s\n", printJson(*point).c_str());
    } else if (point->is_null()) {
        sayOn(stdout, "nothing is there\n");
    } else {
        sayValues(*point);
    }
    return {};
}

}  // namespace

void addPick(CLI::App& app, int& exitCode) {
    const auto flags = std::make_shared<PickFlags>();
    auto& command = *app.add_subcommand("pick", "Tell the scan's point that a pixel of a picture shows");
    flags->cloud.addTo(command);
    command.add_option("--x", flags->x, "Pixels from the left edge of the picture")
        ->type_name("PIXELS")
        ->required();
    command.add_option("--y", flags->y, "Pixels from its upper edge")->type_name("PIXELS")->required();
    command.add_flag("--json", flags->json,
                     "Print the server's answer, one JSON object; null where nothing is");
    flags->view.addTo(command);
    command.footer(
        "Position (with its precision and unit), attributes and all that is kept of the point. The picture "
        "is that of the "
        "view's words; whatever is not given is the cloud's default. Examples:\n"
        "  scancast-client pick http://127.0.0.1:8080/ town --x 640 --y 360\n"
        "  scancast-client pick http://127.0.0.1:8080/ town --x 10 --y 20 --width 640 --height 360 --classes "
        "2 --json");
    command.callback([flags, &exitCode] { exitCode = report(run(*flags)); });
}

}  // namespace scancast::client
