#include "tests/ranks/draw/what_travels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "ranks/draw/packed_drawing.hpp"
#include "ranks/draw/rank_reduction.hpp"

namespace scancast {

int spansArrive(const Communicator& ranks) {
    RankTraffic traffic;
    RankReduction reduction(ranks, traffic, [] {});
    const auto n = std::size_t(ranks.size()), own = std::size_t(ranks.rank());
    // As many spans as the sender's number, each with the sender in its first byte and the receiver in its last; the last rank
    // gets nothing.
    const auto spansFrom = [](std::size_t from) { return from; };
    std::vector<std::vector<std::uint64_t>> marksOut(n), marksIn(n);
    std::vector<std::vector<std::byte>> out(n);
    std::vector<cpu::SentSpans> sent(n);
    std::vector<cpu::ReceivedSpans> received(n);
    for (std::size_t r = 0; r < n; ++r) {
        if (r == own) continue;
        if (r + 1 < n || n == 1) {
            marksOut[r] = {0, (std::uint64_t{1} << spansFrom(own)) - 1};
            out[r].resize(128 * spansFrom(own));
            for (std::size_t i = 0; i < spansFrom(own); ++i) {
                out[r][128 * i] = std::byte(own);
                out[r][128 * i + 127] = std::byte(r);
            }
            sent[r] = {marksOut[r], out[r]};
        }
        if (own + 1 < n) {
            marksIn[r] = {7, 7};
            received[r].marks = marksIn[r];
        }
    }
    std::size_t arrivals = 0;
    bool sound = true;
    reduction.exchange(sent, received, 128, [&](std::uint32_t from) {
        ++arrivals;
        sound = sound &&
                marksIn[from] == std::vector<std::uint64_t>{0, (std::uint64_t{1} << spansFrom(from)) - 1} &&
                received[from].spans.size() == 128 * spansFrom(from);
        for (std::size_t i = 0; sound && i < spansFrom(from); ++i)
            sound = received[from].spans[128 * i] == std::byte(from) &&
                    received[from].spans[128 * i + 127] == std::byte(own);
    });
    sound = sound && arrivals == (own + 1 < n ? n - 1 : 0);
    std::uint64_t word = std::uint64_t{1} << own;
    sound = reduction.agree(std::span(&word, 1)) && word == (std::uint64_t{1} << n) - 1 && sound;
    if (!sound) fmt::print(stderr, "rank {}: what was sent is not what arrived\n", own);
    return sound ? 0 : 1;
}

int everythingTravels() {
    std::vector<CutView> cuts(2);
    SampleFilter& filter = cuts[1].filter;
    filter.classes.emplace().fill(false);
    (*filter.classes)[77] = true;
    filter.clip = ClipBox{{1, 2, 3}, {4, 5, 6}};
    filter.outliers = true;
    filter.dropped.resize(2);
    filter.dropped[1].count = 3;
    filter.dropped[1].planes[2] = {1, 2, 3, 4};
    filter.shapes = clipRegions(ClipShapes{TurnedBox{}, HalfSpace{{1, 2, 3}, {0, 0, 1}}}, {});
    cuts[1].glass.emplace().margin = 9;
    cuts[1].cut.samples = 55;
    cuts[1].cut.beside = true;
    CutRun& run = cuts[1].cut.runs.emplace_back();
    run.nodeIndex = 7;
    run.firstOrdinal = 21;
    run.share = 0.25;
    CutView sun;
    sun.filter.outliers = true;
    const std::vector<glm::dvec2> jitter{{0.25, 0.5}, {0.75, 0.125}};
    const PassList passes(2);
    Drawing drawing;
    drawing.cuts = cuts;
    drawing.sun = &sun;
    drawing.surfels = drawing.oriented = drawing.orientedNodes = drawing.curvatures = true;
    drawing.depth = false;
    drawing.color.source = ColorSource::Infrared;
    drawing.color.flat = {1, 2, 3};
    drawing.color.ramp[200] = {4, 5, 6};
    drawing.color.low = -3;
    drawing.color.high = 17;
    drawing.color.toned = true;
    drawing.color.byIntensity.emplace().factors[9] = 8;
    drawing.color.byIntensity->high = 2.5;
    drawing.background.kind = Background::Kind::Transparent;
    drawing.window = {1, 2, 30, 40};
    drawing.jitter = jitter;
    drawing.passes = passes;
    const auto arrived = unpackDrawing(packDrawing({"a/b.scan", "rev"}, drawing));
    if (!arrived) return 1;
    const Drawing& d = (*arrived)->drawing;
    const SampleFilter& f = d.cuts[1].filter;
    const ColorRule& c = d.color;
    const CutRun& r = d.cuts[1].cut.runs.at(0);
    const auto same = [](Rgb8 a, Rgb8 b) { return std::memcmp(&a, &b, sizeof a) == 0; };
    const std::pair<const char*, bool> sound[] = {
        {"cloud", (*arrived)->cloud.path == "a/b.scan" && (*arrived)->cloud.revision == "rev"},
        {"classes", f.classes == filter.classes && !d.cuts[0].filter.classes},
        {"clip", f.clip == filter.clip && !d.cuts[0].filter.clip},
        {"outliers", f.outliers && !d.cuts[0].filter.outliers && d.sun != nullptr && d.sun->filter.outliers},
        {"regions", f.dropped.size() == 2 && f.dropped[1].count == 3 &&
                        f.dropped[1].planes[2] == filter.dropped[1].planes[2]},
        {"shapes", f.shapes.kept.size() == 1 && f.shapes.dropped.size() == 1 && f.shapes.kept[0].count == 6 &&
                       f.shapes.dropped[0].planes == filter.shapes.dropped[0].planes &&
                       d.cuts[0].filter.shapes.empty()},
        {"glass", d.cuts[1].glass && d.cuts[1].glass->margin == 9 && !d.cuts[0].glass},
        {"cut", d.cuts[1].cut.samples == 55 && d.cuts[1].cut.beside && !d.cuts[0].cut.beside},
        {"runs", r.nodeIndex == 7 && r.firstOrdinal == 21 && r.share == 0.25},
        {"flags", d.surfels && d.oriented && d.orientedNodes && d.curvatures && !d.depth},
        {"colour", c.source == ColorSource::Infrared && same(c.flat, {1, 2, 3}) &&
                       same(c.ramp[200], {4, 5, 6}) && c.low == -3 && c.high == 17 && c.toned},
        {"intensity", c.byIntensity && c.byIntensity->factors[9] == 8 && c.byIntensity->high == 2.5},
        {"background", d.background.kind == Background::Kind::Transparent},
        {"window", d.window.x == 1 && d.window.y == 2 && d.window.width == 30 && d.window.height == 40},
        {"jitter", std::ranges::equal(d.jitter, jitter)},
        {"passes", d.passes.size() == 2},
    };
    int faults = 0;
    for (const auto& [what, arrives] : sound) {
        if (arrives) continue;
        ++faults;
        fmt::print(stderr, "of a drawing, its {} do not arrive\n", what);
    }
    return faults;
}

}  // namespace scancast
