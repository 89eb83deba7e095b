#include "renderer/cloud/build/nodes/inner_columns.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <limits>

#include "files/machine.hpp"
#include "renderer/cloud/build/progress_meter.hpp"
#include "renderer/cloud/columns/column_choice.hpp"
#include "renderer/cloud/file/blocks/block_codec.hpp"

namespace scancast {
namespace {

/// Nodes worked on at once, before what they give is written in order; and what a sample below one takes meanwhile: itself, its position twice,
/// its place in a grid, a value.
constexpr std::size_t mostNodesAtOnce = 16;
constexpr std::uint64_t bytesPerSampleBelow = 16 + 2 * 24 + 3 * 4 + 2 * 8;

/// Points in cells of a grid over them, for the nearest one to a place. Of equally near ones the first.
class NearestGrid {
  public:
    NearestGrid(std::vector<glm::dvec3> points, double pitch) : points_(std::move(points)) {
        low_ = glm::dvec3(std::numeric_limits<double>::max());
        glm::dvec3 high = -low_;
        for (const glm::dvec3& p : points_) low_ = glm::min(low_, p), high = glm::max(high, p);
        const glm::dvec3 size = high - low_;
        // Cells as wide as samples above are apart, but never many more than there are points.
        const double most = 4.0 * double(points_.size()) + 64;
        pitch_ = std::max(pitch, 1e-300);
        const auto along = [&](int a) { return std::floor(size[a] / pitch_) + 1; };
        while (!(along(0) * along(1) * along(2) <= most)) pitch_ *= 2;
        for (int a = 0; a < 3; ++a) cells_[a] = std::int64_t(along(a));
        first_.assign(std::size_t(cells_[0] * cells_[1] * cells_[2]) + 1, 0);
        for (const glm::dvec3& p : points_) ++first_[indexOf(cellOf(p)) + 1];
        for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
        order_.resize(points_.size());
        std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
        for (std::uint32_t i = 0; i < points_.size(); ++i) order_[next[indexOf(cellOf(points_[i]))]++] = i;
    }

    std::uint32_t nearest(const glm::dvec3& place) const {
        const Cell middle = cellOf(place);
        std::uint32_t best = 0;
        double least = std::numeric_limits<double>::infinity();
        const std::int64_t farthest = std::max({cells_[0], cells_[1], cells_[2]});
        for (std::int64_t ring = 0; ring <= farthest; ++ring) {
            // What lies in farther rings is at least so far away; a place outside of the grid, farther.
            const double reach = double(ring - 1) * pitch_;
            if (ring > 0 && reach > 0 && reach * reach > least) break;
            lookAround(middle, ring, place, best, least);
        }
        return best;
    }

  private:
    using Cell = std::array<std::int64_t, 3>;

    Cell cellOf(const glm::dvec3& p) const {
        Cell cell;
        for (int a = 0; a < 3; ++a)
            cell[std::size_t(a)] = std::clamp<std::int64_t>(
                std::int64_t(std::floor(std::clamp((p[a] - low_[a]) / pitch_, -1.0, 1e15))), 0,
                cells_[std::size_t(a)] - 1);
        return cell;
    }
    std::size_t indexOf(const Cell& cell) const {
        return std::size_t((cell[2] * cells_[1] + cell[1]) * cells_[0] + cell[0]);
    }

    /// Cells whose farthest axis is so many cells away.
    void lookAround(const Cell& middle, std::int64_t ring, const glm::dvec3& place, std::uint32_t& best,
                    double& least) const {
        Cell low, high;
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = std::max<std::int64_t>(middle[a] - ring, 0);
            high[a] = std::min(middle[a] + ring, cells_[a] - 1);
        }
        for (std::int64_t z = low[2]; z <= high[2]; ++z)
            for (std::int64_t y = low[1]; y <= high[1]; ++y) {
                const bool isFace = std::abs(z - middle[2]) == ring || std::abs(y - middle[1]) == ring;
                if (isFace) {
                    for (std::int64_t x = low[0]; x <= high[0]; ++x) look({x, y, z}, place, best, least);
                    continue;
                }
                if (middle[0] - ring >= low[0]) look({middle[0] - ring, y, z}, place, best, least);
                if (ring > 0 && middle[0] + ring <= high[0])
                    look({middle[0] + ring, y, z}, place, best, least);
            }
    }

    void look(const Cell& cell, const glm::dvec3& place, std::uint32_t& best, double& least) const {
        const std::size_t at = indexOf(cell);
        for (std::uint32_t i = first_[at]; i < first_[at + 1]; ++i) {
            const glm::dvec3 way = points_[order_[i]] - place;
            const double distance = way.x * way.x + way.y * way.y + way.z * way.z;
            if (distance > least || (distance == least && order_[i] > best)) continue;
            least = distance;
            best = order_[i];
        }
    }

    std::vector<glm::dvec3> points_;
    glm::dvec3 low_{0};
    double pitch_ = 1;
    Cell cells_{1, 1, 1};
    std::vector<std::uint32_t> first_, order_;  ///< by cell; points in the order of their cells
};

/// One run: from the deepest level up, so that children's values stand when their parent's are found.
class InnerColumns {
  public:
    InnerColumns(BuiltOctree& octree, BlockSink& file, const CloudFacts& facts,
                 std::vector<std::size_t> columns, std::size_t planes, std::uint64_t memory,
                 ProgressMeter& progress)
        : octree_(octree),
          file_(file),
          facts_(facts),
          columns_(std::move(columns)),
          planes_(planes),
          memory_(memory),
          progress_(progress) {
        found_.resize(octree.nodes.size() * columns_.size());
    }

    Expected<void> run(const std::stop_token& stop) {
        // Breadth first: nodes of a level stand together, and children behind their parents.
        std::size_t end = octree_.nodes.size();
        while (end > 0) {
            std::size_t first = end - 1;
            while (first > 0 && levelOf(first - 1) == levelOf(end - 1)) --first;
            if (auto ok = runLevel(first, end, stop); !ok) return ok;
            end = first;
        }
        return {};
    }

    /// Of all nodes: the octree's places, and behind each node's the new ones.
    std::vector<BlockPlace> places() const {
        std::vector<BlockPlace> all;
        all.reserve(octree_.planes.size() + found_.size());
        for (std::size_t node = 0; node < octree_.nodes.size(); ++node) {
            const auto before = octree_.planes.begin() + std::ptrdiff_t(node * planes_);
            const auto own = found_.begin() + std::ptrdiff_t(node * columns_.size());
            all.insert(all.end(), before, before + std::ptrdiff_t(planes_));
            all.insert(all.end(), own, own + std::ptrdiff_t(columns_.size()));
        }
        return all;
    }

  private:
    using Blocks = std::vector<std::vector<std::byte>>;

    const Node& node(std::size_t index) const { return octree_.nodes[index].node; }
    std::uint8_t levelOf(std::size_t index) const { return node(index).level; }
    const Column& column(std::size_t c) const { return facts_.columns[columns_[c]].column; }

    Expected<void> runLevel(std::size_t first, std::size_t end, const std::stop_token& stop) {
        std::vector<std::size_t> inner;
        for (std::size_t i = first; i < end; ++i)
            if (!node(i).isLeaf()) inner.push_back(i);
        for (std::size_t begin = 0, count = 0; begin < inner.size(); begin += count) {
            count = fitting(std::span(inner).subspan(begin));
            std::vector<Expected<Blocks>> work(count);
            tbb::parallel_for(std::size_t(0), work.size(),
                              [&](std::size_t i) { work[i] = blocksOf(inner[begin + i]); });
            for (std::size_t i = 0; i < work.size(); ++i) {
                if (!work[i]) return passOn(work[i]);
                for (std::size_t c = 0; c < columns_.size(); ++c) {
                    const auto place = file_.append((*work[i])[c]);
                    if (!place) return passOn(place);
                    found_[inner[begin + i] * columns_.size() + c] = *place;
                }
            }
            progress_.add(count);
            if (stop.stop_requested()) return fail(ErrorCode::Cancelled, "Building the cloud was abandoned.");
        }
        return {};
    }

    /// How many of these can be worked on at once.
    std::size_t fitting(std::span<const std::size_t> inner) const {
        std::uint64_t bytes = 0;
        for (std::size_t i = 0; i < inner.size() && i < mostNodesAtOnce; ++i) {
            const Node& own = node(inner[i]);
            for (std::size_t child = own.firstChild; child < own.firstChild + own.childCount; ++child)
                bytes += node(child).sampleCount * bytesPerSampleBelow;
            if (i > 0 && bytes > memory_) return i;
        }
        return std::min(inner.size(), mostNodesAtOnce);
    }

    Expected<std::vector<glm::dvec3>> positionsOf(std::size_t index) const {
        const StoredNode& stored = octree_.nodes[index];
        const auto block = file_.readBack(stored.samples);
        if (!block) return passOn(block);
        std::vector<Sample> samples(stored.node.sampleCount);
        if (auto ok = decodeSamples(*block, samples); !ok) return passOn(ok);
        std::vector<glm::dvec3> positions;
        positions.reserve(samples.size());
        for (const Sample& sample : samples) positions.push_back(position(stored.node, sample));
        return positions;
    }

    /// A leaf's own, or what was found for an inner node.
    Expected<std::vector<std::byte>> valuesOfNode(std::size_t index, std::size_t c) const {
        const BlockPlace& place = node(index).isLeaf() ? octree_.planes[index * planes_ + columns_[c]]
                                                       : found_[index * columns_.size() + c];
        const auto block = file_.readBack(place);
        if (!block) return passOn(block);
        return decodeRows(*block, bytesOf(column(c).type), node(index).sampleCount);
    }

    Expected<Blocks> blocksOf(std::size_t index) const {
        const Node& own = node(index);
        std::vector<glm::dvec3> below;
        for (std::size_t child = own.firstChild; child < own.firstChild + own.childCount; ++child) {
            const auto some = positionsOf(child);
            if (!some) return passOn(some);
            below.insert(below.end(), some->begin(), some->end());
        }
        const auto places = positionsOf(index);
        if (!places) return passOn(places);
        const NearestGrid grid(std::move(below), own.meanSpacing);
        std::vector<std::uint32_t> nearest(places->size());
        for (std::size_t i = 0; i < nearest.size(); ++i) nearest[i] = grid.nearest((*places)[i]);
        Blocks blocks(columns_.size());
        for (std::size_t c = 0; c < columns_.size(); ++c) {
            const std::size_t bytes = bytesOf(column(c).type);
            std::vector<std::byte> all;
            for (std::size_t child = own.firstChild; child < own.firstChild + own.childCount; ++child) {
                const auto some = valuesOfNode(child, c);
                if (!some) return passOn(some);
                all.insert(all.end(), some->begin(), some->end());
            }
            std::vector<std::byte> chosen(nearest.size() * bytes);
            for (std::size_t i = 0; i < nearest.size(); ++i)
                std::memcpy(chosen.data() + i * bytes, all.data() + nearest[i] * bytes, bytes);
            blocks[c] = encodeRows(chosen, bytes);
        }
        return blocks;
    }

    const BuiltOctree& octree_;
    BlockSink& file_;
    const CloudFacts& facts_;
    const std::vector<std::size_t> columns_;  ///< among the facts'
    const std::size_t planes_;                ///< of each node, before these
    const std::uint64_t memory_;
    ProgressMeter& progress_;
    std::vector<BlockPlace> found_;  ///< node by node
};

}  // namespace

Expected<void> addInnerColumns(CloudFacts& facts, BuiltOctree& octree, BlockSink& file,
                               const InnerColumnsRoom& room, const ProgressSink& sink,
                               const std::stop_token& stop) {
    std::vector<std::size_t> columns = choosableColumns(facts);
    if (columns.empty() || octree.nodes.size() < 2) return {};
    if (columns.size() > mostInnerColumns) columns.resize(mostInnerColumns);
    const std::size_t planes = planesOf(facts).size();
    const auto isInner = [](const StoredNode& stored) { return !stored.node.isLeaf(); };
    ProgressMeter progress(sink, "columns", std::uint64_t(std::ranges::count_if(octree.nodes, isInner)),
                           "nodes");
    InnerColumns inner(octree, file, facts, columns, planes, room.memory, progress);
    Expected<void> done;
    tbb::task_arena arena(coresOf(room.threads));
    arena.execute([&] { done = inner.run(stop); });
    if (!done) return done;
    progress.finish();
    octree.planes = inner.places();
    for (const std::size_t c : columns) facts.companions.push_back(innerPlane(facts.columns[c].column));
    return {};
}

}  // namespace scancast
