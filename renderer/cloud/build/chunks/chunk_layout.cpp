#include "renderer/cloud/build/chunks/chunk_layout.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace scancast {

namespace {

/// Its number is that of its destination: a million of them need not be looked up.
struct NumberedCell : CountedCell {
    std::uint32_t number = 0;
};
using Cells = std::span<NumberedCell>;

/// What a set of cells looks like, each cell standing for its points; in cells.
struct CellMeasure {
    std::array<std::uint32_t, 3> low, high;
    std::array<double, 3> mean{}, variance{};
    std::uint64_t points = 0;
};

CellMeasure measure(Cells cells) {
    __extension__ using Wide = unsigned __int128;
    CellMeasure m{};
    m.low.fill(~0u);
    std::array<Wide, 3> sum{}, squares{};
    for (const NumberedCell& c : cells) {
        m.points += c.points;
        for (int a = 0; a < 3; ++a) {
            const std::uint32_t at = cellAxis(c.key, a);
            m.low[a] = std::min(m.low[a], at);
            m.high[a] = std::max(m.high[a], at);
            sum[a] += Wide(at) * c.points;
            squares[a] += Wide(at) * at * c.points;
        }
    }
    for (int a = 0; a < 3; ++a) {
        const double n = double(m.points);
        m.mean[a] = double(sum[a]) / n;
        m.variance[a] = std::max(0.0, double(squares[a]) / n - m.mean[a] * m.mean[a]);
    }
    return m;
}

/// Where a set is split: the first cells of the upper halves.
struct CellCut {
    std::array<std::uint32_t, 3> at;
    unsigned octant(CellKey key) const {
        unsigned o = 0;
        for (int a = 0; a < 3; ++a) o |= unsigned(cellAxis(key, a) >= at[a]) << a;
        return o;
    }
};

class Divider {
  public:
    Divider(const Grid& grid, std::uint64_t chunkPoints, ChunkLayout& layout)
        : grid_(grid), chunkPoints_(chunkPoints), layout_(layout) {}

    void split(Cells cells, LayoutNode& node) {
        const CellMeasure m = measure(cells);
        if (m.points <= chunkPoints_ || cells.size() == 1) {
            node.chunk = std::uint32_t(layout_.chunks.size());
            layout_.chunks.push_back({m.points, 0});
            for (const NumberedCell& c : cells) layout_.destinations[c.number].chunk = node.chunk;
            return;
        }
        const CellCut found = cut(m);
        const std::array<std::size_t, 9> first = sortByOctant(cells, found);
        for (std::size_t o = 0; o < 8; ++o)
            if (first[o] < first[o + 1])
                split(cells.subspan(first[o], first[o + 1] - first[o]), node.children.emplace_back());
    }

  private:
    /// Each keeps its order. The first of each octant, and one behind the last.
    std::array<std::size_t, 9> sortByOctant(Cells cells, const CellCut& found) {
        std::array<std::size_t, 9> first{};
        for (const NumberedCell& c : cells) ++first[found.octant(c.key) + 1];
        std::partial_sum(first.begin(), first.end(), first.begin());
        sorted_.resize(std::max(sorted_.size(), cells.size()));
        auto next = first;
        for (const NumberedCell& c : cells) sorted_[next[found.octant(c.key)]++] = c;
        std::copy_n(sorted_.begin(), cells.size(), cells.begin());
        return first;
    }

    /// At the cell boundary nearest the average; along flat axes not at all (splitter.hpp says why).
    CellCut cut(const CellMeasure& m) const {
        std::array<double, 3> spread;
        for (int a = 0; a < 3; ++a) spread[a] = m.variance[a] * grid_.step[a] * grid_.step[a];
        const double widest = *std::max_element(spread.begin(), spread.end());
        CellCut found;
        for (int a = 0; a < 3; ++a) {
            const bool splits = m.high[a] > m.low[a] && spread[a] * 16 >= widest;
            // Cells reach from their index to the next: their middles are half a cell further.
            const auto boundary = std::uint32_t(m.mean[a] + 1);
            found.at[a] = splits ? std::clamp(boundary, m.low[a] + 1, m.high[a]) : m.high[a] + 1;
        }
        return found;
    }

    const Grid& grid_;
    const std::uint64_t chunkPoints_;
    ChunkLayout& layout_;
    std::vector<NumberedCell> sorted_;
};

/// The cells of a coarser frame and the chunks that lie in each.
class Neighbourhood {
  public:
    Neighbourhood(const ChunkLayout& layout, Cells cells, int up) : up_(up) {
        std::vector<std::pair<CellKey, std::uint32_t>> pairs;
        for (const NumberedCell& c : cells)
            pairs.emplace_back(coarse(c.key), layout.destinations[c.number].chunk);
        std::sort(pairs.begin(), pairs.end());
        pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            if (i == 0 || pairs[i].first != pairs[i - 1].first) index_[pairs[i].first] = i + 1;
            chunks_.push_back(pairs[i]);
        }
    }

    /// All chunks but `own` in the 27 coarse cells around, ascending.
    std::vector<std::uint32_t> around(CellKey key, std::uint32_t own) const {
        std::vector<std::uint32_t> found;
        const CellKey middle = coarse(key);
        for (int i = 0; i < 27; ++i) {
            CellKey near = 0;
            bool inside = true;
            for (int a = 0, rest = i; a < 3; ++a, rest /= 3) {
                const std::int64_t at = std::int64_t(cellAxis(middle, a)) + rest % 3 - 1;
                inside = inside && at >= 0;
                near |= CellKey(std::max<std::int64_t>(at, 0)) << (21 * a);
            }
            const std::uint64_t* first = inside ? index_.find(near) : nullptr;
            if (!first) continue;
            for (std::size_t c = *first - 1; c < chunks_.size() && chunks_[c].first == near; ++c)
                if (chunks_[c].second != own) found.push_back(chunks_[c].second);
        }
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
        return found;
    }

  private:
    CellKey coarse(CellKey key) const {
        CellKey out = 0;
        for (int a = 0; a < 3; ++a) out |= CellKey(cellAxis(key, a) >> up_) << (21 * a);
        return out;
    }

    int up_;
    CellTable index_;
    std::vector<std::pair<CellKey, std::uint32_t>> chunks_;
};

int haloCellLevels(std::uint64_t points, std::size_t cells) {
    int up = 0;
    // On a surface, cells twice as large hold four times as many points.
    for (double each = double(points) / double(cells); each < 64 && up < 3; each *= 4) ++up;
    return up;
}

void layOutHalos(ChunkLayout& layout, Cells cells, std::uint64_t points) {
    const Neighbourhood neighbourhood(layout, cells, haloCellLevels(points, cells.size()));
    std::vector<std::vector<std::uint32_t>> found(cells.size());
    tbb::parallel_for(std::size_t(0), cells.size(), [&](std::size_t i) {
        found[i] = neighbourhood.around(cells[i].key, layout.destinations[cells[i].number].chunk);
    });
    for (std::size_t i = 0; i < cells.size(); ++i) {
        ChunkLayout::Destination& d = layout.destinations[cells[i].number];
        d.firstHalo = std::uint32_t(layout.haloChunks.size());
        d.halos = std::uint32_t(found[i].size());
        for (const std::uint32_t chunk : found[i]) {
            layout.haloChunks.push_back(chunk);
            layout.chunks[chunk].halo += cells[i].points;
        }
    }
}

}  // namespace

ChunkLayout layOutChunks(const CellFrame& frame, std::vector<CountedCell> cells, const Grid& grid,
                         std::uint64_t chunkPoints, bool halo) {
    ChunkLayout layout;
    layout.frame = frame;
    layout.index = CellTable(cells.size());
    layout.destinations.resize(cells.size());
    std::vector<NumberedCell> numbered;
    numbered.reserve(cells.size());
    std::uint64_t points = 0;
    for (const CountedCell& cell : cells) {
        layout.index[cell.key] = numbered.size();
        numbered.push_back({cell, std::uint32_t(numbered.size())});
        points += cell.points;
    }
    std::vector<CountedCell>().swap(cells);
    Divider(grid, chunkPoints, layout).split(numbered, layout.root);
    if (halo && layout.chunks.size() > 1) layOutHalos(layout, numbered, points);
    return layout;
}

}  // namespace scancast
