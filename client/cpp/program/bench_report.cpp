#include "client/cpp/program/bench_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

namespace scancast::client {
namespace {

using nlohmann::json;

json spread(const std::vector<double>& values) {
    if (values.empty()) return nullptr;
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    return {{"count", values.size()},        {"min", *least},
            {"p50", percentile(values, 50)}, {"p90", percentile(values, 90)},
            {"p99", percentile(values, 99)}, {"max", *most}};
}

using Group = std::vector<const BenchResult*>;

template <class Member>
std::vector<double> together(const Group& group, Member member) {
    std::vector<double> all;
    for (const auto* result : group)
        all.insert(all.end(), (result->*member).begin(), (result->*member).end());
    return all;
}

template <class Member>
std::vector<double> present(const Group& group, Member member) {
    std::vector<double> all;
    for (const auto* result : group)
        if (result->*member) all.push_back(*(result->*member));
    return all;
}

json groupReport(const BenchOptions& options, Behaviour behaviour, const Group& group) {
    std::vector<double> rates;
    std::set<std::string> errors;
    std::uint64_t bytes = 0;
    int failed = 0, videoFrames = 0, idleFrames = 0, secondBeforeAll = 0;
    json subsamplings = json::object();
    for (const auto* result : group) {
        rates.push_back(result->frames / options.seconds);
        bytes += result->bytes;
        failed += result->error.empty() ? 0 : 1;
        if (!result->error.empty()) errors.insert(result->error);
        videoFrames += result->videoFrames;
        idleFrames += result->idleFrames;
        secondBeforeAll += result->secondBeforeAll ? 1 : 0;
        for (const auto& [subsampling, count] : result->subsamplings)
            subsamplings[subsampling] = subsamplings.value(subsampling, 0) + count;
    }
    json report{{"behaviour", name(behaviour)},
                {"sessions", group.size()},
                {"failed", failed},
                {"errors", errors},
                {"bytes", bytes}};
    if (behaviour == Behaviour::Idle) {
        report["idleFrames"] = idleFrames;
        report["answerMs"] = spread(present(group, &BenchResult::answerMs));
        report["secondBeforeAll"] = secondBeforeAll;
        return report;
    }
    report["framesPerSecond"] = spread(rates);
    report["latencyMs"] = spread(together(group, &BenchResult::latencies));
    report["frameBytes"] = spread(together(group, &BenchResult::frameBytes));
    report["resolution"] = spread(together(group, &BenchResult::resolutions));
    report["jpegQuality"] = spread(together(group, &BenchResult::qualities));
    report["detail"] = spread(together(group, &BenchResult::details));
    report["subsampling"] = subsamplings;
    report["videoFrames"] = videoFrames;
    report["finalMs"] = spread(present(group, &BenchResult::finalMs));
    return report;
}

std::string line(const json& values, const char* title, const char* unit, int digits) {
    if (values.is_null()) return {};
    char text[200];
    const auto of = [&](const char* key) { return values.at(key).get<double>(); };
    std::snprintf(text, sizeof text, "  %-16s p50 %.*f, p90 %.*f, p99 %.*f, least %.*f, most %.*f%s\n", title,
                  digits, of("p50"), digits, of("p90"), digits, of("p99"), digits, of("min"), digits,
                  of("max"), unit);
    return text;
}

}  // namespace

double percentile(std::vector<double> values, double percent) {
    if (values.empty()) return 0;
    const auto rank = static_cast<std::size_t>(std::ceil(percent / 100 * double(values.size())));
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

json benchReport(const BenchOptions& options, const std::vector<BenchResult>& results) {
    json groups = json::array();
    for (const auto behaviour : behaviours) {
        Group group;
        for (const auto& result : results)
            if (result.behaviour == behaviour) group.push_back(&result);
        if (!group.empty()) groups.push_back(groupReport(options, behaviour, group));
    }
    const auto& view = options.start.view;
    return {{"sessions", results.size()}, {"seconds", options.seconds},  {"width", view.width},
            {"height", view.height},      {"method", view.style.method}, {"cloud", options.cloud},
            {"groups", std::move(groups)}};
}

std::string benchText(const json& report) {
    std::string text;
    for (const auto& group : report.at("groups")) {
        text += group.at("sessions").dump() + " " + group.at("behaviour").get<std::string>() + ", " +
                group.at("bytes").dump() + " bytes";
        if (group.at("failed") != 0) text += ", " + group.at("failed").dump() + " FAILED";
        text += "\n";
        for (const auto& error : group.at("errors")) text += "  " + error.get<std::string>() + "\n";
        if (group.at("behaviour") == "idle") {
            text += "  " + group.at("idleFrames").dump() + " frames while idle\n";
            text += line(group.at("answerMs"), "woken: answered", " ms", 1);
            continue;
        }
        text += line(group.at("framesPerSecond"), "frames/s", "", 1);
        text += line(group.at("latencyMs"), "view to frame", " ms", 1);
        text += line(group.at("frameBytes"), "size of a frame", " bytes", 0);
        text += line(group.at("resolution"), "resolution", " of width and height", 2);
        if (group.at("videoFrames") != 0)
            text += "  " + group.at("videoFrames").dump() + " frames as video\n";
        text += line(group.at("jpegQuality"), "JPEG quality", "", 0);
        text += line(group.at("detail"), "detail", " px", 2);
        text += line(group.at("finalMs"), "to the final", " ms", 1);
    }
    return text;
}

}  // namespace scancast::client
