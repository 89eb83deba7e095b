// How true measures are: volumes of houses, lengths between picks and areas of fronts on a scan of the generated town, against the town
// itself; and what they take.
//     bench_measure [--points N]
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "renderer/cloud/build/build_cloud.hpp"
#include "renderer/measure/volume.hpp"
#include "simulator/scenes/town.hpp"
#include "tests/oracle/measure/clicks.hpp"
#include "tests/oracle/measure/town_truth.hpp"

namespace {

using namespace scancast;
using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

double at(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0
                          : values[std::min(values.size() - 1, std::size_t(share * double(values.size())))];
}

void print(const char* what, std::vector<double> errors, const char* unit) {
    for (double& e : errors) e = std::abs(e);
    std::printf("| %s | %zu | %.3f %s | %.3f %s | %.3f %s |\n", what, errors.size(), at(errors, 0.5), unit,
                at(errors, 0.95), unit, at(errors, 1), unit);
}

/// How many lengths are as true as asked for.
void lengthsAgainst(const char* what, const std::vector<double>& errors, double spacing) {
    const auto within = [&](double bound) {
        const auto count =
            std::ranges::count_if(errors, [&](double e) { return std::abs(e) <= 0.001 + bound; });
        return 100.0 * double(count) / double(errors.size());
    };
    std::printf("| %s | %zu | %.1f %% | %.1f %% | %.1f %% |\n", what, errors.size(), within(spacing / 2),
                within(spacing), within(1.5 * spacing));
}

/// The same as somebody has it who clicks into pictures.
void lengthsOfClicks(const Cloud& cloud, const RayCaster& town) {
    DeviceOptions options;
    options.backend = "cpu";
    const auto device = createDevice(options);
    constexpr int pictures = 12, perPicture = 200;
    const auto clicks = test::clicksInPictures(**device, cloud, town, pictures, perPicture);
    std::vector<double> points, surfaces, shown, offPoint, offSurface;
    for (std::size_t i = 0; i + 1 < clicks.size(); i += 2) {
        const auto &a = clicks[i], &b = clicks[i + 1];
        const double truth = glm::distance(a.truth, b.truth);
        points.push_back(glm::distance(a.point, b.point) - truth);
        surfaces.push_back(glm::distance(a.surface, b.surface) - truth);
        if (glm::distance(a.surface, a.truth) < 0.5 && glm::distance(b.surface, b.truth) < 0.5)
            shown.push_back(surfaces.back());
        for (const auto& click : {a, b}) {
            offPoint.push_back(glm::distance(click.point, click.truth) / cloud.spacing);
            offSurface.push_back(glm::distance(click.surface, click.truth) / cloud.spacing);
        }
    }
    lengthsAgainst("clicks, their points", points, cloud.spacing);
    lengthsAgainst("clicks, their surface", surfaces, cloud.spacing);
    lengthsAgainst("the same, where both pixels show what a ray meets", shown, cloud.spacing);
    std::printf("\nclicks are off by %.3f spacings in the middle at their points, by %.3f at their surface\n",
                at(offPoint, 0.5), at(offSurface, 0.5));
}

}  // namespace

int main(int argc, char** argv) {
    std::uint64_t points = 5'000'000;
    for (int i = 1; i + 1 < argc; ++i)
        if (std::strcmp(argv[i], "--points") == 0) points = std::strtoull(argv[i + 1], nullptr, 10);
    const SceneOptions scene{.scene = "town", .points = points};
    const auto town = RayCaster::create(scene).value();
    auto source = simulate(scene).value();
    BuildOptions options;
    options.title = "town";
    const auto cloud = *buildCloud(*source, options);
    std::printf("town of %llu points, spacing %.3f m\n\n", static_cast<unsigned long long>(points),
                cloud->spacing);
    std::printf("| measure | how many | median error | 95 %% | worst |\n|---|---|---|---|---|\n");

    std::vector<double> volumes, bodies, areas, lengths;
    double seconds = 0, worstTime = 0;
    std::uint64_t measuredPoints = 0;
    const auto houses = test::townHouses(town, pavementHeight);
    for (const test::TownHouse& house : houses) {
        MeasureRequest request;
        request.kind = MeasureKind::Volume;
        const auto corners = test::inset(house.corners, test::clearOfNeighbours);
        request.points.assign(corners.begin(), corners.end());
        const auto start = Clock::now();
        const auto measured = measureVolume(*cloud, {}, request);
        if (!measured) return std::printf("%s\n", measured.error().message.c_str()), 1;
        seconds += secondsSince(start);
        worstTime = std::max(worstTime, secondsSince(start));
        measuredPoints += measured->points;
        const auto truth = test::volumeByRays(town, corners, corners[0].z, 0.1);
        volumes.push_back(100 * (measured->above / truth.above - 1));
        bodies.push_back(100 * (measured->above / measured->area / (house.volume() / house.area()) - 1));
        areas.push_back(100 * test::frontArea(*cloud, house) / (house.width * (house.eaves - 0.3)) - 100);
    }
    std::vector<double> offs;
    for (const test::Length& length : test::lengthsBetweenPicks(*cloud, town, 400)) {
        lengths.push_back(length.measured - length.truth);
        offs.push_back(length.off / cloud->spacing);
    }
    print("volumes of houses, against rays from above", volumes, "%");
    print("the same, against the generator's body (without chimneys, dormers, eaves)", bodies, "%");
    print("areas of fronts between four picked corners", areas, "%");
    print("lengths between two picks", lengths, "m");
    std::printf(
        "\nthe nearest point is so far from a place, in spacings: %.2f in the middle, %.2f of 95 %%, %.2f at "
        "most\n",
        at(offs, 0.5), at(offs, 0.95), at(offs, 1));
    std::printf("a volume took %.1f ms on average, %.1f ms at most, of %llu points\n\n",
                1e3 * seconds / double(houses.size()), 1e3 * worstTime,
                static_cast<unsigned long long>(measuredPoints / houses.size()));
    lengthsAgainst("places all over, the nearest point", lengths, cloud->spacing);
    lengthsOfClicks(*cloud, town);
    return 0;
}
