// Our surfels and PCL's normals, one measurement a process, as JSON; tests/bench/pcl.py runs it and makes the
// tables of docs/decisions.
//   bench_pcl estimate ours|pcl|pcl-radii CLOUD [--points N] [--threads N] [--shuffled]   (time, memory,
//   digest) bench_pcl compare CLOUD [--points N]   (with each other, with the truth, with themselves in
//   another order)
// CLOUD is a scan, a scene of the simulator, whose normals are true, or `rows`: scan lines far apart. Points
// are distinct and in Morton order, as the octree builder hands them over, unless --shuffled. Digests are of
// results in Morton order, whatever the order was.
#include <malloc.h>
#include <oneapi/tbb/global_control.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <sstream>
#include <string>

#include "renderer/cloud/import/open_scan.hpp"
#include "renderer/cloud/surfels/spatial_sort.hpp"
#include "renderer/cloud/surfels/surfels.hpp"
#include "simulator/scene.hpp"
#include "tests/bench/bench_tools.hpp"
#include "tests/support/clouds/surfel_references.hpp"

using namespace scancast;

namespace {

using Results = std::vector<glm::vec4>;  // normal and radius

constexpr int k = 10;

struct Settings {
    std::string work, who, cloud;
    std::uint64_t points = 1'000'000;
    int threads = 2, pclNeighbours = k;
    bool shuffled = false;
};

Settings parse(int argc, char** argv) {
    Settings s;
    std::vector<std::string> words;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--points" && i + 1 < argc)
            s.points = std::strtoull(argv[++i], nullptr, 10);
        else if (word == "--threads" && i + 1 < argc)
            s.threads = std::max(1, std::atoi(argv[++i]));
        else if (word == "--pcl-neighbours" && i + 1 < argc)
            s.pclNeighbours = std::clamp(std::atoi(argv[++i]), 3, 1000);
        else if (word == "--shuffled")
            s.shuffled = true;
        else
            words.push_back(word);
    }
    const bool compares = words.size() == 2 && words[0] == "compare";
    if (!compares && !(words.size() == 3 && words[0] == "estimate")) {
        std::fprintf(stderr, "bench_pcl estimate ours|pcl|pcl-radii CLOUD, or bench_pcl compare CLOUD\n");
        std::exit(2);
    }
    s.work = words[0];
    s.who = compares ? "" : words[1];
    s.cloud = words.back();
    return s;
}

/// Distinct positions as offsets from the first, in Morton order, and their normals where they are known.
struct Points {
    std::vector<glm::vec3> position, truth;
};

/// A ground of hills as a scanner that turns quickly and drives on slowly records it: rows 16 times as far
/// apart as the points in them, with 2 mm of noise.
Points rows(std::uint64_t count) {
    std::mt19937_64 random(1);
    const auto uniform = [&] { return double(random() >> 11) / 9007199254740992.0 - 0.5; };
    const double row = 0.08, step = row / 16;
    const auto perRow = std::max<std::uint64_t>(1, std::uint64_t(std::sqrt(double(count) * 16)));
    Points points;
    for (std::uint64_t i = 0; i < count; ++i) {
        const double x = (double(i % perRow) + 0.5 * uniform()) * step,
                     y = (double(i / perRow) + 0.05 * uniform()) * row;
        const double noise = 0.002 * (uniform() + uniform() + uniform() + uniform()) * std::sqrt(3.0);
        points.position.emplace_back(x, y, 0.5 * std::sin(x) * std::cos(y) + noise);
        points.truth.push_back(
            glm::normalize(glm::vec3(-0.5 * std::cos(x) * std::cos(y), 0.5 * std::sin(x) * std::sin(y), 1)));
    }
    return points;
}

Points distinctInMortonOrder(const Points& all) {
    const SpatialOrder sorted = spatialOrder(all.position);
    Points points;
    for (std::size_t i = 0; i + 1 < sorted.firstOf.size(); ++i) {
        const std::uint32_t at = sorted.order[sorted.firstOf[i]];
        points.position.push_back(all.position[at]);
        if (!all.truth.empty()) points.truth.push_back(all.truth[at]);
    }
    return points;
}

Points read(const Settings& s) {
    if (s.cloud == "rows") return distinctInMortonOrder(rows(s.points));
    const bool isScan = std::filesystem::exists(s.cloud);
    SceneOptions scene;
    scene.scene = s.cloud;
    scene.points = s.points;
    const auto source =
        bench::orExit(isScan ? openScan(s.cloud, {.importerDirectory = SCANCAST_BIN_DIR}) : simulate(scene));
    Points all;
    glm::dvec3 origin{0};
    for (PointBatch batch; bench::orExit(source->read(batch));) {
        if (all.position.empty()) origin = batch.position.front();
        for (const glm::dvec3& p : batch.position) all.position.emplace_back(p - origin);
        if (!isScan) all.truth.insert(all.truth.end(), batch.normal.begin(), batch.normal.end());
    }
    return distinctInMortonOrder(all);
}

/// The same permutation in every process.
std::vector<std::uint32_t> shuffle(std::size_t count) {
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0U);
    std::mt19937_64 random(1);
    for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random() % i]);
    return order;
}

template <class T>
std::vector<T> permuted(const std::vector<T>& values, const std::vector<std::uint32_t>& order) {
    std::vector<T> out;
    for (const std::uint32_t i : order) out.push_back(values[i]);
    return out;
}

template <class T>
std::vector<T> putBack(const std::vector<T>& values, const std::vector<std::uint32_t>& order) {
    std::vector<T> out(values.size());
    for (std::size_t i = 0; i < order.size(); ++i) out[order[i]] = values[i];
    return out;
}

test::PclTrial trial(const Settings& s, const std::string& who, const std::vector<glm::vec3>& points) {
    if (who == "pcl") return test::normalsByPcl(points, s.pclNeighbours, s.threads);
    if (who == "pcl-radii") return test::normalsAndRadiiByPcl(points, s.pclNeighbours, s.threads);
    const auto surfels = std::make_shared<std::vector<Surfel>>();
    const auto run = [surfels, &points] {
        surfels->resize(points.size());
        estimateSurfels(points, {.neighbours = k}, *surfels);
    };
    const auto results = [surfels] {
        Results all;
        for (const Surfel& surfel : *surfels) all.emplace_back(surfel.normal, surfel.radius);
        return all;
    };
    return {run, results};
}

/// Kilobytes that the kernel counts under this name.
double statusOf(const char* name) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.rfind(name, 0) == 0) return std::strtod(line.c_str() + std::strlen(name) + 1, nullptr);
    return 0;
}

/// The largest resident set from now on is counted anew; what was freed before counts for nobody.
double residentFromNow() {
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << "5";
    return statusOf("VmRSS");
}

std::string digestOf(const Results& results) {
    std::ostringstream text;
    text << std::hex << XXH3_64bits(results.data(), results.size() * sizeof(glm::vec4));
    return text.str();
}

nlohmann::json estimate(const Settings& s, const Points& points) {
    const std::vector<std::uint32_t> order =
        s.shuffled ? shuffle(points.position.size()) : std::vector<std::uint32_t>();
    const std::vector<glm::vec3> position = s.shuffled ? permuted(points.position, order) : points.position;
    const test::PclTrial work = trial(s, s.who, position);
    const double before = residentFromNow();
    const std::clock_t processor = std::clock();
    const double milliseconds = bench::timed(work.run);
    const double ticks = double(std::clock() - processor);
    const double peak = statusOf("VmHWM") - before;
    const Results results = work.results();
    return {{"points", position.size()},
            {"seconds", milliseconds / 1000},
            {"processorSeconds", ticks / CLOCKS_PER_SEC},
            {"peakBytes", peak * 1024},
            {"digest", digestOf(s.shuffled ? putBack(results, order) : results)}};
}

/// Degrees between two normals, whatever their signs; 90 where one of them is none.
double angle(const glm::vec3& a, const glm::vec3& b) {
    const glm::dvec3 n(a), m(b);
    if (!(glm::length(n) > 0.5) || !(glm::length(m) > 0.5)) return 90;
    return std::atan2(glm::length(glm::cross(n, m)), std::abs(glm::dot(n, m))) * 57.29577951308232;
}

nlohmann::json quantiles(std::vector<double> values) {
    if (values.empty()) return nullptr;
    std::sort(values.begin(), values.end());
    const auto at = [&](double q) { return values[std::size_t(q * double(values.size() - 1))]; };
    return {{"count", values.size()}, {"median", at(0.5)}, {"p90", at(0.9)}, {"p99", at(0.99)}};
}

/// Of the points that `wanted` names by number.
template <class Value, class Wanted>
nlohmann::json quantilesOf(std::size_t count, const Value& value, const Wanted& wanted) {
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i)
        if (wanted(i)) values.push_back(value(i));
    return quantiles(std::move(values));
}

/// How many results are other bytes in another order of the points, and by how much.
nlohmann::json reordered(const Settings& s, const std::string& who, const Points& points,
                         const Results& inOrder) {
    const std::vector<std::uint32_t> order = shuffle(points.position.size());
    const std::vector<glm::vec3> position = permuted(points.position, order);
    const test::PclTrial work = trial(s, who, position);
    work.run();
    const Results other = putBack(work.results(), order);
    std::size_t different = 0, beyond = 0;
    for (std::size_t i = 0; i < other.size(); ++i) {
        different += std::memcmp(&other[i], &inOrder[i], sizeof(glm::vec4)) != 0;
        beyond += angle(glm::vec3(other[i]), glm::vec3(inOrder[i])) > 1;
    }
    return {{"different", double(different) / double(other.size())},
            {"beyondOneDegree", double(beyond) / double(other.size())}};
}

Results resultsOf(const Settings& s, const std::string& who, const Points& points) {
    const test::PclTrial work = trial(s, who, points.position);
    work.run();
    return work.results();
}

nlohmann::json compare(const Settings& s, const Points& points) {
    const Results ours = resultsOf(s, "ours", points), theirs = resultsOf(s, "pcl-radii", points);
    const test::ReferenceSurfels facts = test::surfelsByPcl(points.position, k, s.threads);
    const std::size_t count = ours.size();
    const auto line = [&](std::size_t i) { return facts.surfels[i].lineRatio < 1.0 / 16; };
    const auto alike = [&](std::size_t i) { return !line(i) && !facts.surfels[i].tie; };
    const auto apart = [&](std::size_t i) { return angle(glm::vec3(ours[i]), glm::vec3(theirs[i])); };
    const auto radius = [&](std::size_t i) { return std::abs(ours[i].w / theirs[i].w - 1); };
    const auto all = [](std::size_t) { return true; };
    const auto shareOf = [&](const auto& is) {
        std::size_t n = 0;
        for (std::size_t i = 0; i < count; ++i) n += is(i);
        return double(n) / double(count);
    };
    nlohmann::json out = {
        {"points", count},
        {"lines", shareOf(line)},
        {"ties", shareOf([&](std::size_t i) { return !line(i) && facts.surfels[i].tie; })},
        {"angle", quantilesOf(count, apart, alike)},
        {"radius", quantilesOf(count, radius, alike)},
        {"angleOfAll", quantilesOf(count, apart, all)},
        {"withinOneDegree", shareOf([&](std::size_t i) { return apart(i) <= 1; })},
        {"reordered",
         {{"ours", reordered(s, "ours", points, ours)}, {"pcl", reordered(s, "pcl-radii", points, theirs)}}}};
    if (points.truth.empty()) return out;
    for (const auto& [name, results] : {std::pair("ours", &ours), std::pair("pcl", &theirs)}) {
        const auto error = [&r = *results, &points](std::size_t i) {
            return angle(glm::vec3(r[i]), points.truth[i]);
        };
        out["truth"][name] = {{"all", quantilesOf(count, error, all)},
                              {"lines", quantilesOf(count, error, line)}};
    }
    return out;
}

}  // namespace

int main(int argc, char** argv) {
    const Settings settings = parse(argc, argv);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    std::size_t(settings.threads));
    const Points points = read(settings);
    std::printf("%s\n", (settings.work == "estimate" ? estimate(settings, points) : compare(settings, points))
                            .dump()
                            .c_str());
}
