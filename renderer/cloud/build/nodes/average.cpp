#include "renderer/cloud/build/nodes/average.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "renderer/cloud/build/morton.hpp"

namespace scancast {

namespace {

using NormalSum = std::array<std::int64_t, 3>;

// One view of the two things that can be averaged.

GridPosition cellOf(const BuildPoint& p, int, int cellLevel) {
    const GridPosition q = p.position();
    return {q[0] >> cellLevel, q[1] >> cellLevel, q[2] >> cellLevel};
}
GridPosition cellOf(const Average& a, int ownCellLevel, int cellLevel) {
    const int up = cellLevel - ownCellLevel;
    return {a.cell[0] >> up, a.cell[1] >> up, a.cell[2] >> up};
}

NormalSum normalOf(const BuildPoint& p) {
    const glm::dvec3 n = glm::dvec3(decodeNormal(p.normal)) * 4096.0;
    // To nearest, halves away from 0: the sums are exact in double.
    const auto round = [](double v) { return std::int64_t(std::int32_t(v + (v < 0 ? -0.5 : 0.5))); };
    return {round(n.x), round(n.y), round(n.z)};
}
NormalSum normalOf(const Average& a) {
    return a.normal;
}

class Votes {
  public:
    void add(std::uint8_t classification, std::uint64_t count) {
        if (counts_[classification] == 0) seen_.push_back(classification);
        counts_[classification] += count;
    }
    void writeTo(Average& average, std::vector<Vote>& out) {
        std::sort(seen_.begin(), seen_.end());
        average.firstVote = std::uint32_t(out.size());
        average.votes = std::uint32_t(seen_.size());
        for (const std::uint8_t c : seen_) {
            out.push_back({c, counts_[c]});
            counts_[c] = 0;
        }
        seen_.clear();
    }

  private:
    std::array<std::uint64_t, 256> counts_{};
    std::vector<std::uint8_t> seen_;
};

/// What belongs to the things that are averaged, and stands elsewhere.
struct Elsewhere {
    std::span<const Vote> votes{};         ///< of averages
    const BuildPoint* first = nullptr;     ///< of points, whose words these are
    std::span<const BesideWord> beside{};  ///< empty: there are none

    std::uint64_t nearInfraredOf(const BuildPoint& p) const {
        return beside.empty() ? 0 : nearInfraredIn(beside[std::size_t(&p - first)]);
    }
};

void add(Average& sum, const BuildPoint& p, const NormalSum& normal, int sign, const AverageRules& rules,
         const Elsewhere& elsewhere, Votes& votes) {
    for (int a = 0; a < 3; ++a) {
        sum.position[a] += p.axis(a);
        sum.color[a] += p.color[a];
    }
    sum.count += 1;
    sum.intensity += p.intensity;
    if (rules.attributes.nearInfrared) sum.nearInfrared += elsewhere.nearInfraredOf(p);
    if (const Bulk bulk = p.bulk(); bulk != Bulk::Surface) ++sum.bulks[std::size_t(bulk) - 1];
    if (rules.attributes.normal && rules.sides)
        for (int a = 0; a < 3; ++a) sum.normal[a] += sign * normal[a];
    if (rules.attributes.classification) votes.add(p.classification, 1);
}

void add(Average& sum, const Average& other, const NormalSum& normal, int sign, const AverageRules& rules,
         const Elsewhere& elsewhere, Votes& votes) {
    for (int a = 0; a < 3; ++a) {
        sum.position[a] += other.position[a];
        sum.color[a] += other.color[a];
        if (rules.sides) sum.normal[a] += sign * normal[a];
        sum.bulks[std::size_t(a)] += other.bulks[std::size_t(a)];
    }
    sum.count += other.count;
    sum.intensity += other.intensity;
    sum.nearInfrared += other.nearInfrared;
    if (rules.attributes.classification)
        for (std::uint32_t i = 0; i < other.votes; ++i) {
            const Vote& v = elsewhere.votes[other.firstVote + i];
            votes.add(v.classification, v.count);
        }
}

Bulk bulkOf(const BuildPoint& p) {
    return p.bulk();
}

// How far the farthest position averaged into a thing is from a point; grid steps count from `from`.

float reachFrom(const glm::dvec3& mean, const BuildPoint& p, const GridPosition& from,
                const glm::dvec3& step) {
    const glm::dvec3 offset(double(p.axis(0) - from[0]), double(p.axis(1) - from[1]),
                            double(p.axis(2) - from[2]));
    return float(glm::length((offset - mean) * step));
}
float reachFrom(const glm::dvec3& mean, const Average& a, const GridPosition& from, const glm::dvec3& step) {
    return float(glm::length((meanPosition(a, from) - mean) * step)) + a.reach;
}

/// The direction that all normals of a cell lie about when n and -n are the same: one step of the power
/// iteration on Σ n nᵀ from the axis with the largest diagonal.
class SignFreeAxis {
  public:
    void add(const NormalSum& s) {
        const glm::dvec3 n{double(s[0]), double(s[1]), double(s[2])};
        for (int a = 0; a < 3; ++a) sum_[a] += n * n[a];
    }
    void finish() {
        int largest = 0;
        for (int a = 1; a < 3; ++a)
            if (sum_[a][a] > sum_[largest][largest]) largest = a;
        axis_ = sum_[largest];
        length_ = std::sqrt(axis_.x * axis_.x + axis_.y * axis_.y + axis_.z * axis_.z);
    }
    /// More than 96° away from the direction; 6° are left to noise, so that a right angle is not cut at
    /// random.
    bool opposite(const NormalSum& s) const {
        const glm::dvec3 n{double(s[0]), double(s[1]), double(s[2])};
        return glm::dot(n, axis_) < -0.1 * length_ * glm::length(n);
    }
    bool behind(const NormalSum& s) const {
        return glm::dot(glm::dvec3(double(s[0]), double(s[1]), double(s[2])), axis_) < 0;
    }

  private:
    std::array<glm::dvec3, 3> sum_{glm::dvec3(0), glm::dvec3(0), glm::dvec3(0)};
    glm::dvec3 axis_{0};
    double length_ = 0;
};

const BuildPoint& at(const BuildPoint& p) {
    return p;
}
const Average& at(const Average& a) {
    return a;
}
const Average& at(const Average* a) {
    return *a;
}

/// Of one thing in a run: its normal, on which side of the cell that is, and which way it counts.
struct Turned {
    NormalSum normal{};
    std::size_t side = 0;
    int sign = 1;
};

/// One run of things in one cell → one sample or two.
template <class Things>
void averageRun(Things run, const GridPosition& cell, const AverageRules& rules, const Elsewhere& elsewhere,
                AverageList& out) {
    thread_local std::array<Votes, 2> votes;
    std::array<Average, 2> sides;
    sides[0].cell = sides[1].cell = cell;
    const bool looks = rules.attributes.normal && run.size() > 1;
    thread_local std::vector<Turned> turned;  // decoded once, asked for four times
    turned.assign(run.size(), {});
    if (rules.attributes.normal)
        for (std::size_t i = 0; i < run.size(); ++i) turned[i].normal = normalOf(at(run[i]));
    if (looks) {
        SignFreeAxis axis;
        for (const Turned& t : turned) axis.add(t.normal);
        axis.finish();
        for (Turned& t : turned) {
            t.side = rules.oriented && axis.opposite(t.normal);
            if (!rules.oriented && axis.behind(t.normal)) t.sign = -1;
        }
    }
    for (std::size_t i = 0; i < run.size(); ++i) {
        const Turned& t = turned[i];
        add(sides[t.side], at(run[i]), t.normal, t.sign, rules, elsewhere, votes[t.side]);
    }
    if (rules.reach) {
        const GridPosition from{cell[0] << out.cellLevel, cell[1] << out.cellLevel, cell[2] << out.cellLevel};
        std::array<glm::dvec3, 2> mean;
        for (std::size_t side = 0; side < 2; ++side)
            if (sides[side].count > 0) mean[side] = meanPosition(sides[side], from);
        for (std::size_t i = 0; i < run.size(); ++i) {
            const std::size_t side = turned[i].side;
            if (bulkOf(at(run[i])) == Bulk::Stray && bulkOf(sides[side]) != Bulk::Stray) continue;
            sides[side].reach =
                std::max(sides[side].reach, reachFrom(mean[side], at(run[i]), from, rules.gridStep));
        }
    }
    for (std::size_t side = 0; side < 2; ++side) {
        if (sides[side].count == 0) continue;
        if (rules.attributes.classification) votes[side].writeTo(sides[side], out.votes);
        out.averages.push_back(sides[side]);
    }
}

template <class Things>
void averageRuns(Things things, int ownCellLevel, const AverageRules& rules, const Elsewhere& elsewhere,
                 AverageList& out) {
    for (std::size_t first = 0; first < things.size();) {
        const GridPosition cell = cellOf(at(things[first]), ownCellLevel, out.cellLevel);
        std::size_t last = first + 1;
        while (last < things.size() && cellOf(at(things[last]), ownCellLevel, out.cellLevel) == cell) ++last;
        averageRun(things.subspan(first, last - first), cell, rules, elsewhere, out);
        first = last;
    }
}

}  // namespace

void appendCells(std::span<const BuildPoint> points, std::span<const BesideWord> beside,
                 const AverageRules& rules, AverageList& list) {
    averageRuns(points, 0, rules, {.first = points.data(), .beside = beside}, list);
}

void appendCells(const AverageList& finer, const AverageRules& rules, AverageList& list) {
    averageRuns(std::span(finer.averages), finer.cellLevel, rules, {.votes = finer.votes}, list);
}

AverageList merge(const AverageList& runs, std::span<const std::size_t> starts, const AverageRules& rules) {
    std::vector<const Average*> order(runs.averages.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = &runs.averages[i];
    const auto less = [](const Average* a, const Average* b) { return mortonLess(a->cell, b->cell); };
    const auto place = [&](std::size_t run) {
        return order.begin() + std::ptrdiff_t(run < starts.size() ? starts[run] : order.size());
    };
    for (std::size_t width = 1; width < starts.size(); width *= 2)
        for (std::size_t run = 0; run + width < starts.size(); run += 2 * width)
            std::inplace_merge(place(run), place(run + width), place(run + 2 * width), less);

    AverageList merged{.cellLevel = runs.cellLevel, .averages = {}, .votes = {}};
    merged.averages.reserve(order.size());
    averageRuns(std::span(std::as_const(order)), runs.cellLevel, rules, {.votes = runs.votes}, merged);
    return merged;
}

glm::dvec3 meanPosition(const Average& average, const GridPosition& from) {
    glm::dvec3 mean;
    for (int a = 0; a < 3; ++a)
        mean[a] = double(average.position[a] - WideSum(from[a]) * average.count) / double(average.count);
    return mean;
}

Bulk bulkOf(const Average& average) {
    const auto& [wire, foliage, stray] = average.bulks;
    const std::array<std::uint64_t, 4> counts{average.count - wire - foliage - stray, wire, foliage, stray};
    return Bulk(std::max_element(counts.begin(), counts.end()) - counts.begin());
}

namespace {

std::uint64_t mean(std::uint64_t sum, std::uint64_t count) {
    return (2 * sum + count) / (2 * count);
}

}  // namespace

std::uint8_t meanNearInfrared(const Average& average) {
    return std::uint8_t(mean(average.nearInfrared, average.count));
}

Sample meanAttributes(const Average& average, const AverageList& list) {
    Sample s{};
    s.r = std::uint8_t(mean(average.color[0], average.count));
    s.g = std::uint8_t(mean(average.color[1], average.count));
    s.b = std::uint8_t(mean(average.color[2], average.count));
    s.intensity = std::uint16_t(mean(average.intensity, average.count));
    std::uint64_t most = 0;
    for (std::uint32_t i = 0; i < average.votes; ++i) {
        const Vote& v = list.votes[average.firstVote + i];
        if (v.count > most) {
            most = v.count;
            s.classification = v.classification;
        }
    }
    s.normal =
        encodeNormal(glm::vec3(float(average.normal[0]), float(average.normal[1]), float(average.normal[2])));
    return s;
}

}  // namespace scancast
