// `scancast-client measure`: lengths, areas, volumes and fitted shapes, by HTTP.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "client/cpp/program/command.hpp"
#include "client/cpp/program/points/say_values.hpp"
#include "client/cpp/program/say.hpp"
#include "protocol/json_text.hpp"

namespace scancast::client {
namespace {

struct MeasureFlags {
    CloudFlags cloud;
    std::string what, base, axis, clip;
    std::string surface = std::string(volumeSurfaceNames[0]);
    std::vector<std::string> points;
    std::vector<int> classes;
    double cell = 0, within = 0;  // 0 = not given
    bool json = false;
};

/// "1,2.5,-3"; empty: it is none.
std::vector<double> numbersIn(const std::string& text) {
    std::vector<double> numbers;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (true) {
        double number = 0;
        const auto [next, wrong] = std::from_chars(at, end, number);
        if (wrong != std::errc() || !std::isfinite(number)) return {};
        numbers.push_back(number);
        if (next == end) return numbers;
        if (*next != ',') return {};
        at = next + 1;
    }
}

/// A check of CLI11's: so many numbers, or one more than the least.
auto numbersOf(std::size_t least, std::size_t most) {
    return [=](const std::string& text) {
        const std::size_t count = numbersIn(text).size();
        return count >= least && count <= most
                   ? std::string()
                   : "'" + text + "' is not " + std::to_string(most) + " numbers with commas between them";
    };
}

nlohmann::json bodyOf(const MeasureFlags& flags) {
    nlohmann::json body{{"measure", flags.what}, {"points", nlohmann::json::array()}};
    for (const std::string& point : flags.points) body["points"].push_back(numbersIn(point));
    if (flags.what == name(MeasureKind::Volume)) {
        body["surface"] = flags.surface;
        const auto height = numbersIn(flags.base);
        if (height.size() == 1)
            body["base"] = height.front();
        else if (!flags.base.empty())
            body["base"] = flags.base;
    }
    if (flags.cell > 0) body["cell"] = flags.cell;
    if (flags.within > 0) body["within"] = flags.within;
    if (!flags.axis.empty()) body["axis"] = numbersIn(flags.axis);
    if (!flags.classes.empty()) body["view"]["classes"] = flags.classes;
    if (const auto box = numbersIn(flags.clip); !box.empty())
        body["view"]["clip"] = {{"min", {box[0], box[1], box[2]}}, {"max", {box[3], box[4], box[5]}}};
    return body;
}

Expected<void> run(const MeasureFlags& flags) {
    // The protocol's own reader judges it, before anybody is asked.
    const auto request = parseMeasureRequest(printJson(bodyOf(flags)));
    if (!request) return passOn(request);
    const auto cloud = flags.cloud.choose();
    if (!cloud) return passOn(cloud);
    const auto measured = cloud->server.measure(cloud->id, *request);
    if (!measured) return passOn(measured);
    if (flags.json)
        sayOn(stdout, "%s\n", printJson(*measured).c_str());
    else
        sayValues(*measured);
    return {};
}

}  // namespace

void addMeasure(CLI::App& app, int& exitCode) {
    const auto flags = std::make_shared<MeasureFlags>();
    auto& command =
        *app.add_subcommand("measure", "Measure lengths, angles, areas, volumes, planes and round things");
    flags->cloud.server.addTo(command);
    command.add_option("WHAT", flags->what, "What is measured")
        ->check(CLI::IsMember(std::vector<std::string>(measureNames.begin(), measureNames.end())))
        ->required();
    flags->cloud.addCloudTo(command);
    command
        .add_option("--point", flags->points,
                    "A vertex, a corner or a picked point, in file coordinates; may be repeated. Of a volume "
                    "over a base that "
                    "is a number, X,Y does")
        ->type_name("X,Y,Z")
        ->allow_extra_args(false)
        ->check(numbersOf(2, 3))
        ->required();
    command
        .add_option("--base", flags->base,
                    "Of a volume: the height that it is measured from, or lowest, mean or fit of the "
                    "corners. Default: lowest")
        ->type_name("HEIGHT|lowest|mean|fit");
    command
        .add_option("--surface", flags->surface,
                    "Of a volume: which of a raster cell's points are its height")
        ->type_name("WHICH")
        ->check(CLI::IsMember(std::vector<std::string>(volumeSurfaceNames.begin(), volumeSurfaceNames.end())))
        ->capture_default_str();
    command
        .add_option("--cell", flags->cell,
                    "Of a volume: side of the raster's cells. Default: three times the scan's spacing")
        ->type_name("LENGTH")
        ->check(CLI::Validator(CLI::PositiveNumber).description({}));  // what the meaning says already
    command
        .add_option("--within", flags->within,
                    "Of planes and round things: the scan's points that are so near to these are fitted. "
                    "Without it a plane, or "
                    "a circle of three points, goes through these themselves")
        ->type_name("LENGTH")
        ->check(CLI::Validator(CLI::PositiveNumber).description({}));  // what the meaning says already
    command
        .add_option("--axis", flags->axis,
                    "Of a circle: what it is at right angles to. Default: as the points lie, or upright")
        ->type_name("X,Y,Z")
        ->check(numbersOf(3, 3));
    command
        .add_option("--classes", flags->classes, "Of volumes and fits: points of these classifications only")
        ->type_name("N,N,...")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::Range(0, 255));
    command.add_option("--clip", flags->clip, "The same: points in this box only")
        ->type_name("X0,Y0,Z0,X1,Y1,Z1")
        ->check(numbersOf(6, 6));
    command.add_flag("--json", flags->json, "Print the server's answer, one JSON object");
    command.footer(
        "What the words mean exactly: docs/measure.md. Examples:\n"
        "  scancast-client measure http://127.0.0.1:8080/ distance town --point 389500,5819800,35 --point "
        "389512.5,5819800,35\n"
        "  scancast-client measure http://127.0.0.1:8080/ volume pit --point 10,10,0 --point 60,10,0 --point "
        "60,40,0 "
        "--base lowest --cell 0.25\n"
        "  scancast-client measure http://127.0.0.1:8080/ cylinder plant --point 4.1,7.2,1.5 --within 0.3");
    command.callback([flags, &exitCode] { exitCode = report(run(*flags)); });
}

}  // namespace scancast::client
