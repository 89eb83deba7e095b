#include "renderer/device/cpu/pyramid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scancast::cpu {
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();
/// Levels of fewer rows are one thread's work: handing it out would take longer.
constexpr int rowsWorthSharing = 48;

std::int32_t half(std::int32_t size) {
    return (size + 1) / 2;
}

/// Room for padding, and for reading whole vectors.
std::int32_t strideOf(std::int32_t width) {
    return (width + 15) / 16 * 16 + 2 * paddingX;
}

Unprojection unprojectionOf(const PyramidPlanes& s) {
    Unprojection u;
    u.perspective = s.perspective;
    u.step = static_cast<float>(1 / s.pixelsPerUnit);
    u.centerX = static_cast<float>(s.center.x);
    u.centerY = static_cast<float>(s.center.y);
    return u;
}

template <class Work>
void overRows(const Workers& workers, int rows, const Work& work) {
    if (rows < rowsWorthSharing) {
        work(0, rows);
    } else {
        workers.overRows(rows, work);
    }
}

/// methods.md §8's s_eff = max(s0, 2τ/q), times a factor, as px · depth (orthographic: px) and least px.
struct Size {
    double scaled, least;
};

Size sizeOf(const PyramidPlanes& s, double factor, double spacing, double detail) {
    return {factor * std::max(0.0, spacing) * s.pixelsPerUnit, factor * 2 * std::max(0.0, detail)};
}

/// Neighbours of level l lie at most 2.5 texels away on each axis. Seen from the eye, pixels p px apart
/// differ by at most p/f, and 1 - cos a ≤ a²/2.
int sureLevel(const PyramidPlanes& s, double threshold) {
    if (!(threshold > 0)) return -1;
    if (!s.perspective) return maxPyramidLevels;
    int level = -1;
    const auto occlusion = [&](int l) {
        const double angle = 2.5 * std::sqrt(2.0) * std::ldexp(1.0, l) / s.pixelsPerUnit;
        return angle * angle / 2;
    };
    while (level < maxPyramidLevels && occlusion(level + 1) < 0.9 * threshold) ++level;
    return level;
}

}  // namespace

float* Pyramid::takePlane(Block& block, std::int32_t stride, std::int32_t height, std::size_t& offset) {
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
    // Twice: the first time only counts.
    for (int turn = 0; turn < 2; ++turn) {
        std::size_t points = 0, fills = 0, normals = 0;
        std::int32_t w = width_, h = height_;
        levels_ = 0;
        widest_ = 0;
        for (int k = 0; k < maxPyramidLevels; ++k, w = half(w), h = half(h)) {
            const std::int32_t stride = strideOf(w);
            const auto take = [&](Block& block, std::size_t& offset) {
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
            if (std::min(w, h) >= 4) widest_ = k;
            levels_ = k + 1;
            if (w == 1 && h == 1 && k >= blockLevel) break;
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
    if (reach_.size() < blocks) reach_.resize(blocks);
}

void Pyramid::chooseReach(const PyramidPlanes& s, const HiddenPointsPass& pass) {
    const Size size = sizeOf(s, pass.scale, pass.spacing, pass.detail);
    const PointLevel& coarse = points_[blockLevel];
    for (std::int32_t y = 0; y < coarse.height; ++y) {
        for (std::int32_t x = 0; x < coarse.width; ++x) {
            float depth = infinite;
            for (int k = blockLevel; k < levels_ && !(depth < infinite); ++k) {
                const PointLevel& level = points_[k];
                depth = level.depth[std::ptrdiff_t{level.stride} * (y >> (k - blockLevel)) +
                                    (x >> (k - blockLevel))];
            }
            const double px = std::max(s.perspective ? size.scaled / depth : size.scaled, size.least);
            const int reach = px >= 1 ? std::ilogb(std::min(px, 1e9)) : 0;
            reach_[static_cast<std::size_t>(y * blocksPerRow_ + x)] =
                static_cast<std::uint8_t>(std::clamp(reach, 0, widest_));
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
    for (int k = 2; k < levels_; ++k) {
        overRows(workers, points_[k].height,
                 [&](int y0, int y1) { kernels.nextPoints(points_[k - 1], points_[k], y0, y1); });
    }
    chooseReach(s, pass);
    HiddenPoints h;
    std::copy_n(points_, levels_, h.levels);
    h.unprojection = u;
    h.reach = reach_.data();
    h.blocksPerRow = blocksPerRow_;
    h.minGap = std::max(0.0f, pass.minGap);
    h.threshold = pass.threshold;
    h.sureLevel = sureLevel(s, pass.threshold);
    h.labels = labels_.data();
    h.labelStride = labelStride_;
    workers.inParallel((height_ + blockSize - 1) / blockSize, [&](int block) {
        kernels.hidePoints(h, block * blockSize, std::min(height_, (block + 1) * blockSize));
    });
}

Pyramid::Labels Pyramid::labels() const {
    return {labels_.data(), labelStride_};
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
    for (int k = 2; k < levels_; ++k) {
        overRows(workers, fills_[k].height,
                 [&](int y0, int y1) { kernels.pull(fills_[k - 1], fills_[k], y0, y1); });
    }
    for (int k = levels_ - 1; k > 1; --k) {
        overRows(workers, fills_[k - 1].height,
                 [&](int y0, int y1) { kernels.push(fills_[k], fills_[k - 1], y0, y1); });
    }
    overRows(workers, height_, [&](int y0, int y1) { kernels.pushPicture(fills_[1], picture, y0, y1); });
}

int Pyramid::normalLevels() const {
    int count = 1;
    while (count < levels_ && std::min(points_[count].width, points_[count].height) >= 2) ++count;
    return count;
}

void Pyramid::findNormals(const PyramidPlanes& s, const DepthNormalsPass& pass, const PyramidKernels& kernels,
                          const Workers& workers, std::uint32_t* out, std::int32_t outStride) {
    const Size size = sizeOf(s, pass.scale, pass.spacing, pass.detail);
    PixelNormals p;
    p.count = normalLevels();
    // The levels that some pixel needs; a little more, as logarithms round.
    const float nearest = points_[levels_ - 1].depth[0];
    const double largest = std::max(s.perspective ? size.scaled / nearest : size.scaled, size.least);
    const auto levelOf = [&](double px, double slack) {
        return std::clamp(std::log2(std::max(px, 1.0)) + slack, 0.0, p.count - 1.0);
    };
    const int first = static_cast<int>(levelOf(size.least, -0.01));
    const int last = static_cast<int>(std::ceil(levelOf(largest, 0.01)));
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
    p.size = static_cast<float>(size.scaled);
    p.smallest = static_cast<float>(size.least);
    p.out = out;
    p.outStride = outStride;
    overRows(workers, height_, [&](int y0, int y1) { kernels.pixelNormals(p, y0, y1); });
}

}  // namespace scancast::cpu
