#include "tests/bench/gpu/marks.hpp"

#include <cstdio>

namespace scancast::bench {
namespace {

constexpr Size papersSize{1248, 768}, fullHd{1920, 1080};

void addBruteForce(std::vector<Mark>& marks, const Row& row) {
    if (row.points == 100'000'000) {
        marks.push_back({"GPU", row.cost->gpu(), 2});
        marks.push_back({"frame", row.cost->frame, 4});
    }
    if (row.points == 796'000'000) {
        marks.push_back({"GPU", row.cost->gpu(), 10});
        marks.push_back({"frame", row.cost->frame, 16.1, "16.1 on an RTX 3090, published"});
    }
}

void addPyramid(std::vector<Mark>& marks, const Cost& cost) {
    marks.push_back({"screen passes", cost.of({"hidden points", "pull-push", "normals", "phong"}), 0.45});
    marks.push_back({"hidden points", cost.of({"hidden points"}), 2.7, "2.1-2.7 on a GTX 1080, published"});
    marks.push_back({"geometry", cost.of({"nearest"}), 11.4, "1.4-11.4 on a GTX 1080, published"});
}

}  // namespace

std::string Mark::text() const {
    char text[160];
    if (published.empty())
        std::snprintf(text, sizeof text, "%s %.2f <= %g ms: %s", what.c_str(), measured, most,
                      met() ? "met" : "**missed**");
    else
        std::snprintf(text, sizeof text, "%s %.2f ms (%s)", what.c_str(), measured, published.c_str());
    return text;
}

std::vector<Mark> marksOf(const Row& row) {
    std::vector<Mark> marks;
    if (!row.cost) return marks;
    if (row.bruteForce) {
        if (row.method == "point" && row.size == fullHd) addBruteForce(marks, row);
        return marks;
    }
    if (row.method == "pyramid" && row.size == papersSize) addPyramid(marks, *row.cost);
    if (row.size == fullHd) marks.push_back({"view to JPEG", row.cost->jpeg, 10});
    return marks;
}

}  // namespace scancast::bench
