#include "renderer/device/cpu/pyramid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scancast::cpu {
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();
/// Levels of fewer rows are one thread's work: handing it out would take longer.
constexpr int rowsWorthSharing = 48;
/// Beside rows of bytes, more than widestClosing; and columns that one thread takes.
constexpr std::int32_t bytePadding = 64, columnsAtOnce = 128;

/// Room for padding, and for reading whole vectors.
std::int32_t strideOf(std::int32_t width) {
    return (width + 15) / 16 * 16 + 2 * paddingX;
}

template <class Work>
void overRows(const Workers& workers, int rows, const Work& work) {
    if (rows < rowsWorthSharing) {
        work(0, rows);
    } else {
        workers.overRows(rows, work);
    }
}

}  // namespace

float* Pyramid::takePlane(LevelMemory& block, std::int32_t stride, std::int32_t height, std::size_t& offset) {
    const std::size_t first = offset;
    offset +=
        static_cast<std::size_t>(stride) * static_cast<std::size_t>(height + 2 * paddingY) + 2 * paddingX;
    if (block.values.size() < offset) return nullptr;
    return block.values.data() + first + static_cast<std::size_t>(stride) * paddingY + paddingX;
}

void Pyramid::layOut(const PyramidPlanes& s) {
    if (s.width == width_ && s.height == height_) return;
    width_ = s.width;
    height_ = s.height;
    shape_ = pyramidShape(width_, height_);
    // Twice: the first time only counts.
    for (int turn = 0; turn < 2; ++turn) {
        std::size_t points = 0, fills = 0, normals = 0;
        for (int k = 0; k < shape_.levels; ++k) {
            const std::int32_t w = shape_.width[static_cast<std::size_t>(k)];
            const std::int32_t h = shape_.height[static_cast<std::size_t>(k)];
            const std::int32_t stride = strideOf(w);
            const auto take = [&](LevelMemory& block, std::size_t& offset) {
                return takePlane(block, stride, h, offset);
            };
            PointLevel& p = points_[k];
            p = {take(pointBlock_, points), nullptr, nullptr, nullptr, stride, w, h};
            if (k > 0) {
                for (float** const plane : {&p.x, &p.y, &p.square}) *plane = take(pointBlock_, points);
                FillLevel& f = fills_[k];
                f = {nullptr, nullptr, nullptr, nullptr, stride, w, h};
                for (float** const plane : {&f.depth, &f.red, &f.green, &f.blue}) {
                    *plane = take(fillBlock_, fills);
                }
            }
            NormalLevel& n = normals_[k];
            n = {nullptr, nullptr, nullptr, stride, w, h};
            for (float** const plane : {&n.x, &n.y, &n.z}) *plane = take(normalBlock_, normals);
        }
        if (turn > 0) break;
        for (const auto& [block, size] :
             {std::pair{&pointBlock_, points}, {&fillBlock_, fills}, {&normalBlock_, normals}}) {
            if (block->values.size() < size) block->values.resize(size);
            block->used = size;
        }
    }
    // Nothing lies beyond the picture.
    std::fill_n(pointBlock_.values.begin(), pointBlock_.used, infinite);
    labelStride_ = strideOf(width_);
    const std::size_t labels = static_cast<std::size_t>(labelStride_) * static_cast<std::size_t>(height_ + 2);
    if (labels_.size() < labels) labels_.resize(labels);
    blocksPerRow_ = (width_ + blockSize - 1) / blockSize;
    const std::size_t blocks = static_cast<std::size_t>(blocksPerRow_) *
                               static_cast<std::size_t>((height_ + blockSize - 1) / blockSize);
    for (auto* const plane : {&reach_, &wide_, &uncovered_})
        if (plane->size() < blocks) plane->resize(blocks);
    for (auto* const sizes : {&sizes_, &settled_})
        if (sizes->size() < blocks) sizes->resize(blocks);
    byteStride_ = (width_ + 31) / 32 * 32 + 2 * bytePadding;
    const std::size_t bytes = static_cast<std::size_t>(byteStride_) * static_cast<std::size_t>(height_);
    // Beyond the border nothing is near, and nothing is uncovered.
    distances_.assign(bytes, 255);
    covered_.assign(bytes, 1);
}

void Pyramid::chooseReach(const HiddenPointsNumbers& numbers) {
    const PointLevel& coarse = points_[blockLevel];
    for (std::int32_t y = 0; y < coarse.height; ++y) {
        for (std::int32_t x = 0; x < coarse.width; ++x) {
            float depth = infinite;
            for (int k = blockLevel; k < shape_.levels && !(depth < infinite); ++k) {
                const PointLevel& level = points_[k];
                depth = level.depth[std::ptrdiff_t{level.stride} * (y >> (k - blockLevel)) +
                                    (x >> (k - blockLevel))];
            }
            const auto block = static_cast<std::size_t>(y * blocksPerRow_ + x);
            reach_[block] = static_cast<std::uint8_t>(numbers.reachAt(depth, shape_.widest));
            sizes_[block] = numbers.closingAt(depth);
        }
    }
    // A pixel's radius lies between those of the four blocks around it, whose points are no nearer.
    for (std::int32_t y = 0; y < coarse.height; ++y) {
        for (std::int32_t x = 0; x < coarse.width; ++x) {
            std::int32_t most = 0;
            for (std::int32_t j = std::max(0, y - 1); j <= std::min(y + 1, coarse.height - 1); ++j)
                for (std::int32_t i = std::max(0, x - 1); i <= std::min(x + 1, coarse.width - 1); ++i)
                    most = std::max(most, sizes_[static_cast<std::size_t>(j * blocksPerRow_ + i)]);
            wide_[static_cast<std::size_t>(y * blocksPerRow_ + x)] = (most >> 3) > widestClosing ? 1 : 0;
        }
    }
}

void Pyramid::hidePoints(const PyramidPlanes& s, const HiddenPointsPass& pass, const PyramidKernels& kernels,
                         const Workers& workers) {
    layOut(s);
    const Unprojection u = unprojectionOf(s);
    overRows(workers, height_,
             [&](int y0, int y1) { kernels.copyDepth(s.depth, s.stride, points_[0], y0, y1); });
    overRows(workers, points_[1].height,
             [&](int y0, int y1) { kernels.firstPoints(points_[0], u, points_[1], y0, y1); });
    for (int k = 2; k < shape_.levels; ++k) {
        overRows(workers, points_[k].height,
                 [&](int y0, int y1) { kernels.nextPoints(points_[k - 1], points_[k], y0, y1); });
    }
    const HiddenPointsNumbers numbers = hiddenPointsNumbers(s, pass);
    chooseReach(numbers);
    HiddenPoints h;
    std::copy_n(points_, shape_.levels, h.levels);
    h.unprojection = u;
    h.reach = reach_.data();
    h.blocksPerRow = blocksPerRow_;
    h.wide = wide_.data();
    h.size = numbers.closing;
    h.sizes = sizes_.data();
    h.minGap = numbers.minGap;
    h.threshold = numbers.threshold;
    h.sureLevel = numbers.sureLevel;
    h.labels = labels_.data();
    h.labelStride = labelStride_;
    workers.inParallel((height_ + blockSize - 1) / blockSize, [&](int block) {
        kernels.hidePoints(h, block * blockSize, std::min(height_, (block + 1) * blockSize));
    });
    closeBackground(kernels, workers);
}

/// Where no point is visible: the least of the blocks around, or what the nearest depth says - which stays where that is
/// too wide for a closing.
void Pyramid::settleSizes() {
    const std::int32_t rows = points_[blockLevel].height;
    const auto sizeAt = [&](std::int32_t x, std::int32_t y) {
        return sizes_[static_cast<std::size_t>(y * blocksPerRow_ + x)];
    };
    for (std::int32_t y = 0; y < rows; ++y) {
        for (std::int32_t x = 0; x < blocksPerRow_; ++x) {
            std::int32_t size = sizeAt(x, y);
            if (size < 0) {
                size = -1 - size;
                const bool wide = (size >> 3) > widestClosing;
                for (std::int32_t j = std::max(0, y - 2); !wide && j <= std::min(y + 2, rows - 1); ++j)
                    for (std::int32_t i = std::max(0, x - 2); i <= std::min(x + 2, blocksPerRow_ - 1); ++i)
                        if (sizeAt(i, j) >= 0) size = std::min(size, sizeAt(i, j));
            }
            settled_[static_cast<std::size_t>(y * blocksPerRow_ + x)] = size;
        }
    }
}

void Pyramid::closeBackground(const PyramidKernels& kernels, const Workers& workers) {
    settleSizes();
    const PointLevel& picture = points_[0];
    const PointLevel& blocks = points_[blockLevel];
    Closing c;
    c.depth = picture.depth;
    c.depthStride = picture.stride;
    c.width = width_;
    c.height = height_;
    c.nearest = blocks.depth;
    c.nearestStride = blocks.stride;
    c.sizes = settled_.data();
    c.wide = wide_.data();
    c.uncovered = uncovered_.data();
    c.blocksPerRow = blocksPerRow_;
    c.blockRows = blocks.height;
    c.distance = distances_.data() + bytePadding;
    c.covered = covered_.data() + bytePadding;
    c.stride = byteStride_;
    c.labels = labels_.data();
    c.labelStride = labelStride_;
    for (const bool ofUncovered : {false, true}) {
        workers.inParallel((width_ + columnsAtOnce - 1) / columnsAtOnce, [&](int i) {
            const int x0 = i * columnsAtOnce;
            kernels.closingColumns(c, ofUncovered, x0, std::min(width_, x0 + columnsAtOnce));
        });
        workers.inParallel(c.blockRows, [&](int row) { kernels.closingRows(c, ofUncovered, row); });
    }
}

Pyramid::Labels Pyramid::labels() const {
    return {labels_.data(), labelStride_};
}

void Pyramid::showLabels(const PyramidPlanes& s, const VisibilityPass& pass, const Workers& workers) const {
    const VisibilityColors colors = visibilityColors(pass);
    workers.overRows(height_, [&](int y0, int y1) {
        for (int y = y0; y < y1; ++y) {
            const std::ptrdiff_t first = std::ptrdiff_t{y} * s.stride;
            const std::uint8_t* const labels = labels_.data() + std::ptrdiff_t{y} * labelStride_;
            for (int x = 0; x < width_; ++x) {
                const bool hole = !(s.depth[first + x] < infinite);
                std::uint32_t& color = s.rgba[first + x];
                if (labels[x] == foregroundLabel) color = colors.foreground;
                if (labels[x] == hiddenLabel) color = hole ? colors.hole : colors.hidden;
            }
        }
    });
}

void Pyramid::fill(const PyramidPlanes& s, const PullPushPass&, const PyramidKernels& kernels,
                   const Workers& workers) {
    FillPicture picture;
    picture.rgba = s.rgba;
    picture.depth = s.depth;
    picture.stride = s.stride;
    picture.width = width_;
    picture.height = height_;
    picture.points = points_[0].depth;
    picture.pointStride = points_[0].stride;
    picture.labels = labels_.data();
    picture.labelStride = labelStride_;
    overRows(workers, fills_[1].height,
             [&](int y0, int y1) { kernels.pullPicture(picture, fills_[1], y0, y1); });
    for (int k = 2; k < shape_.levels; ++k) {
        overRows(workers, fills_[k].height,
                 [&](int y0, int y1) { kernels.pull(fills_[k - 1], fills_[k], y0, y1); });
    }
    for (int k = shape_.levels - 1; k > 1; --k) {
        overRows(workers, fills_[k - 1].height,
                 [&](int y0, int y1) { kernels.push(fills_[k], fills_[k - 1], y0, y1); });
    }
    overRows(workers, height_, [&](int y0, int y1) { kernels.pushPicture(fills_[1], picture, y0, y1); });
}

void Pyramid::findNormals(const PyramidPlanes& s, const DepthNormalsPass& pass, const PyramidKernels& kernels,
                          const Workers& workers, std::uint32_t* out, std::int32_t outStride) {
    const NormalNumbers numbers = normalNumbers(s, shape_, pass);
    PixelNormals p;
    p.count = numbers.count;
    const int first = numbers.first(), last = numbers.last(points_[shape_.levels - 1].depth[0]);
    for (int k = first; k <= last; ++k) {
        LevelNormals n;
        n.depth = k == 0 ? points_[0].depth : fills_[k].depth;
        n.depthStride = points_[k].stride;
        n.unprojection = unprojectionOf(s);
        n.texel = static_cast<float>(std::ldexp(1.0, k));
        n.out = normals_[k];
        if (k == 0) {
            overRows(workers, height_,
                     [&](int y0, int y1) { kernels.copyDepth(s.depth, s.stride, points_[0], y0, y1); });
        }
        overRows(workers, n.out.height, [&](int y0, int y1) { kernels.levelNormals(n, y0, y1); });
    }
    std::copy_n(normals_, p.count, p.levels);
    p.depth = s.depth;
    p.depthStride = s.stride;
    p.width = width_;
    p.height = height_;
    p.perspective = s.perspective;
    p.size = static_cast<float>(numbers.scaled);
    p.smallest = static_cast<float>(numbers.least);
    p.out = out;
    p.outStride = outStride;
    overRows(workers, height_, [&](int y0, int y1) { kernels.pixelNormals(p, y0, y1); });
}

}  // namespace scancast::cpu
