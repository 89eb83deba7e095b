// `scancast-client info`: what a server has and what it can do.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "client/cpp/program/command.hpp"
#include "client/cpp/program/say.hpp"
#include "protocol/json_text.hpp"

namespace scancast::client {
namespace {

struct InfoFlags {
    CloudFlags cloud;
    bool json = false;
};

std::string text(const ParameterValue& value) {
    if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
    if (const auto* number = std::get_if<double>(&value)) return printJson(*number);
    return std::get<std::string>(value);
}

void print(const CloudInfo& cloud) {
    const auto size = cloud.bounds[1] - cloud.bounds[0];
    sayOn(stdout, "cloud %s: %s\n", cloud.id.c_str(), cloud.title.c_str());
    sayOn(stdout, "  %llu points (%s), %.1f MiB in memory, spacing %g\n",
          static_cast<unsigned long long>(cloud.points), cloud.format.c_str(),
          static_cast<double>(cloud.bytesResident) / (1 << 20), cloud.spacing);
    sayOn(stdout, "  from %.3f %.3f %.3f to %.3f %.3f %.3f, %g x %g x %g\n", cloud.bounds[0].x,
          cloud.bounds[0].y, cloud.bounds[0].z, cloud.bounds[1].x, cloud.bounds[1].y, cloud.bounds[1].z,
          size.x, size.y, size.z);
    std::string attributes;
    for (const auto& attribute : cloud.attributes) attributes += " " + attribute.name;
    sayOn(stdout, "  attributes:%s\n", attributes.empty() ? " none but position" : attributes.c_str());
    if (cloud.crsEpsg) sayOn(stdout, "  coordinate system: EPSG:%d\n", *cloud.crsEpsg);
}

void print(const MethodInfo& method) {
    sayOn(stdout, "method %s: %s\n  %s\n", method.name.c_str(), method.title.c_str(), method.summary.c_str());
    for (const auto& parameter : method.parameters) {
        std::string range;
        if (parameter.type == "number") range = printJson(parameter.min) + " to " + printJson(parameter.max);
        for (const auto& choice : parameter.choices) range += (range.empty() ? "" : "|") + choice;
        if (!parameter.unit.empty()) range += " " + parameter.unit;
        sayOn(stdout, "  --param %s=%s  %s (%s)\n", parameter.name.c_str(),
              text(parameter.defaultValue).c_str(), parameter.meaning.c_str(),
              range.empty() ? parameter.type.c_str() : range.c_str());
    }
}

/// All, or the one that is named.
Expected<std::vector<CloudInfo>> cloudsOf(const Server& server, const std::string& id) {
    if (id.empty()) return server.clouds();
    return server.cloud(id).map([](const CloudInfo& cloud) { return std::vector{cloud}; });
}

Expected<void> run(const InfoFlags& flags) {
    const auto server = flags.cloud.server.server();
    if (!server) return passOn(server);
    const auto clouds = cloudsOf(*server, flags.cloud.id);
    if (!clouds) return passOn(clouds);
    const auto methods = server->methods();
    if (!methods) return passOn(methods);
    if (flags.json) {
        auto object = toJson(*clouds);
        object.update(toJson(*methods));
        sayOn(stdout, "%s\n", printJson(object).c_str());
        return {};
    }
    if (clouds->empty()) sayOn(stdout, "no clouds\n");
    for (const auto& cloud : *clouds) print(cloud);
    for (const auto& method : *methods) print(method);
    return {};
}

}  // namespace

void addInfo(CLI::App& app, int& exitCode) {
    const auto flags = std::make_shared<InfoFlags>();
    auto& command = *app.add_subcommand("info", "List the server's clouds and rendering methods");
    flags->cloud.addTo(command, "all of them");
    command.add_flag("--json", flags->json, "Print one JSON object with `clouds` and `methods`");
    command.footer(
        "Examples:\n"
        "  scancast-client info http://127.0.0.1:8080/\n"
        "  scancast-client info http://127.0.0.1:8080/ town --json");
    command.callback([flags, &exitCode] { exitCode = report(run(*flags)); });
}

}  // namespace scancast::client
