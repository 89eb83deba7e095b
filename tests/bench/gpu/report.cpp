#include "tests/bench/gpu/report.hpp"

#include <cmath>
#include <fstream>

#include "tests/bench/gpu/marks.hpp"
#include "tests/bench/gpu/open.hpp"

namespace scancast::bench {
namespace {

using Json = nlohmann::ordered_json;

std::string agreementText(const Row& row) {
    if (!row.agreement) return "-";
    if (row.agreement->identical()) return "same bytes";
    char text[40];
    std::snprintf(text, sizeof text, row.agreement->psnr < owedDecibels ? "**%.1f dB**" : "%.1f dB",
                  row.agreement->psnr);
    return text;
}

std::string stagesText(const Cost& cost) {
    std::string all;
    for (const StageTime& stage : cost.stages) {
        char one[80];
        std::snprintf(one, sizeof one, "%s%s %.3f", all.empty() ? "" : ", ", stage.name.c_str(),
                      stage.milliseconds);
        all += one;
    }
    return all;
}

std::string marksText(const std::vector<Mark>& marks) {
    std::string all;
    for (const Mark& mark : marks) all += (all.empty() ? "" : "; ") + mark.text();
    return all;
}

void printRow(const Row& row, const std::vector<Mark>& marks) {
    std::printf("| %s | %d x %d | %s |", row.title().c_str(), row.size.width, row.size.height,
                agreementText(row).c_str());
    if (const auto& cost = row.cost)
        std::printf(" %.2f | %.3f | %.3f | %.2f | %.2f | %s | %s |\n", double(cost->samples) / 1e6,
                    cost->host(), cost->gpu(), cost->frame, cost->jpeg, marksText(marks).c_str(),
                    stagesText(*cost).c_str());
    else
        std::printf(" - | - | - | - | - | **not timed: the picture is wrong** | |\n");
    std::fflush(stdout);
}

Json jsonOf(const Row& row, const std::vector<Mark>& marks) {
    Json json{{"method", row.method},
              {"bruteForce", row.bruteForce},
              {"width", row.size.width},
              {"height", row.size.height}};
    if (const auto& agreement = row.agreement) {
        json["sameBytes"] = agreement->identical();
        // Infinite where all colours are the same; JSON has no such number.
        json["psnrDb"] = std::isfinite(agreement->psnr) ? Json(agreement->psnr) : Json();
        json["pixelsChanged"] = agreement->changed;
        json["depthsChanged"] = agreement->changedDepth;
    }
    if (const auto& cost = row.cost) {
        json["frames"] = cost->frames;
        json["samples"] = cost->samples;
        json["hostMs"] = cost->host();
        json["gpuMs"] = cost->gpu();
        json["frameMs"] = cost->frame;
        json["jpegMs"] = cost->jpeg;
        for (const StageTime& stage : cost->stages) json["stagesMs"][stage.name] = stage.milliseconds;
    }
    for (const Mark& mark : marks) {
        Json one{{"what", mark.what}, {"measuredMs", mark.measured}, {"mostMs", mark.most}};
        if (mark.published.empty())
            one["met"] = mark.met();
        else
            one["published"] = mark.published;
        json["marks"].push_back(one);
    }
    return json;
}

}  // namespace

Report::Report(const DeviceInfo& device, const Settings& settings)
    : file_(settings.json), scene_(settings.scene) {
    std::printf("## %s\n\n", title(device).c_str());
    printDevice(device);
    std::printf("\nMedians of up to %d frames after %g s of warm-up, one sample a pixel; ms.\n",
                settings.repeat, settings.warmUp);
    std::fflush(stdout);
    json_ = {{"complete", false},
             {"backend", device.name},
             {"hardware", device.hardware},
             {"vendor", device.vendor},
             {"renderer", device.renderer},
             {"driver", device.version},
             {"memoryBytes", device.memory},
             {"atomics64", device.atomics64},
             {"roundsExactly", device.exact},
             {"tellsResets", device.tellsLoss},
             {"node", device.node},
             {"repeat", settings.repeat},
             {"warmUpSeconds", settings.warmUp},
             {"clouds", Json::array()}};
    save();
}

void Report::beginCloud(const Cloud& cloud, double seconds) {
    std::printf("\n### %s, %llu points%s (built in %.0f s)\n\n", scene_.c_str(),
                static_cast<unsigned long long>(cloud.points), cloud.surfels ? "" : " without surfels",
                seconds);
    std::printf(
        "| method | size | against `cpu` | million samples | host | GPU | frame | JPEG | marks | passes |\n");
    std::printf("|---|---|---|---|---|---|---|---|---|---|\n");
    std::fflush(stdout);
    json_["clouds"].push_back({{"scene", scene_},
                               {"points", cloud.points},
                               {"surfels", cloud.surfels},
                               {"buildSeconds", seconds},
                               {"rows", Json::array()}});
    save();
}

void Report::add(const Row& row) {
    const std::vector<Mark> marks = marksOf(row);
    printRow(row, marks);
    json_["clouds"].back()["rows"].push_back(jsonOf(row, marks));
    save();
    if (const auto& agreement = row.agreement) {
        ++compared_;
        same_ += agreement->identical();
        wrong_ += agreement->psnr < owedDecibels;
    }
    for (const Mark& mark : marks) {
        if (!mark.published.empty()) continue;
        ++marks_;
        met_ += mark.met();
    }
}

void Report::end() {
    std::printf("\n");
    if (marks_ > 0) std::printf("%d of %d marks met. ", met_, marks_);
    if (compared_ > 0)
        std::printf("Of %d pictures %d are the same bytes as the cpu device's, %d are below %.0f dB.",
                    compared_, same_, wrong_, owedDecibels);
    std::printf("\n");
    std::fflush(stdout);
    json_["complete"] = true;
    save();
}

void Report::save() const {
    if (file_.empty()) return;
    // Written beside its name first: a program that is stopped leaves the whole file of the row before.
    const std::filesystem::path unfinished = file_.string() + ".unfinished";
    std::ofstream out(unfinished);
    out << json_.dump(1) << '\n';
    out.close();
    std::error_code failed;
    if (out) std::filesystem::rename(unfinished, file_, failed);
    if (out && !failed) return;
    std::fprintf(stderr, "%s could not be written.\n", file_.c_str());
    std::exit(1);
}

}  // namespace scancast::bench
