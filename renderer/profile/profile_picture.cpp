#include "renderer/profile/profile_picture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "files/bytes.hpp"
#include "renderer/profile/grow_dots.hpp"

namespace scancast {
namespace {

/// Offsets are told apart in so many steps across the corridor.
constexpr double offsetSteps = 0x1p31;

std::uint64_t keyOf(double offset, double width, const Rgb8& color) {
    const double across = std::clamp(offset / width + 0.5, 0.0, 1.0);
    return (std::uint64_t(across * offsetSteps) + 1) << 32 | std::uint64_t(color[0]) << 16 |
           std::uint64_t(color[1]) << 8 | color[2];
}

std::uint8_t between(std::uint8_t top, std::uint8_t bottom, double share) {
    return std::uint8_t(std::lround(top + (double(bottom) - top) * share));
}

}  // namespace

ProfileScale profileScale(const ProfilePicture& picture, double length, const std::array<double, 2>& heights,
                          std::uint64_t mostPixels) {
    // A flat profile has a height, too.
    const double range = std::max(heights[1] - heights[0], length * 1e-3);
    ProfileScale scale{.width = picture.width, .low = heights[0]};
    scale.perStation = picture.width / length;
    if (picture.height && !picture.exaggeration) {
        scale.height = *picture.height;
        scale.perHeight = scale.height / range;
        return scale;
    }
    const double times = picture.exaggeration.value_or(1);
    const double most = picture.height
                            ? double(*picture.height)
                            : std::min(double(mostProfileSide), double(mostPixels) / double(picture.width));
    scale.perStation = std::min(scale.perStation, most / (range * times));
    scale.perHeight = scale.perStation * times;
    scale.height = picture.height.value_or(
        int(std::clamp(std::ceil(range * scale.perHeight), 1.0, std::max(1.0, std::floor(most)))));
    return scale;
}

std::uint64_t mostProfilePixels(const ProfilePicture& picture, double length,
                                const std::array<double, 2>& heights, std::uint64_t mostPixels) {
    // The higher what is shown, the higher the picture, as long as it may be.
    const ProfileScale most = profileScale(picture, length, heights, mostPixels);
    return std::min(std::uint64_t(most.width) * std::uint64_t(most.height), mostPixels);
}

Expected<std::unique_ptr<ProfileDrawing>> ProfileDrawing::create(const Cloud& cloud,
                                                                 std::shared_ptr<const CloudFile> file,
                                                                 const ProfileRequest& request,
                                                                 std::uint64_t mostPixels,
                                                                 std::stop_token stop) {
    const std::uint64_t pixels =
        std::uint64_t(request.picture.width) * std::uint64_t(request.picture.height.value_or(1));
    if (pixels > mostPixels)
        return fail(ErrorCode::ResourceLimit,
                    "A profile's picture may have " + std::to_string(mostPixels) + " pixels here.",
                    "picture.width");
    auto corridor = Corridor::create(request.line, request.width);
    if (!corridor) return passOn(corridor);
    auto colors = PointColors::create(cloud, request.picture.style);
    if (!colors) return passOn(colors);
    std::unique_ptr<ProfileDrawing> made(new ProfileDrawing(std::move(*colors)));
    made->file_ = std::move(file);
    made->corridor_ = std::make_shared<const Corridor>(std::move(*corridor));
    made->what_.corridor = made->corridor_;
    if (!request.region.isEverything()) made->what_.region = std::make_shared<RegionTest>(request.region);
    made->what_.columns = false;
    made->what_.stop = std::move(stop);
    made->what_.estimatedNormals = made->colors_.needsNormals();
    made->picture_ = request.picture;
    made->background_ = request.picture.style.background;
    made->mostPixels_ = mostPixels;
    made->spacing_ = cloud.spacing;
    made->heights_ = {std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
    return made;
}

Expected<bool> ProfileDrawing::step() {
    if (done_) return false;
    if (!source_) source_ = cloudPoints(file_, what_);
    const auto more = source_->read(batch_);
    if (!more) return passOn(more);
    if (*more && drawing_) draw(batch_);
    if (*more && !drawing_) {
        points_ += batch_.size();
        batch_.position.forEach([&](const glm::dvec3& p) {
            heights_ = {std::min(heights_[0], p.z), std::max(heights_[1], p.z)};
        });
    }
    if (*more) return true;
    source_.reset();
    done_ = drawing_;
    if (done_) {
        if (!picture_.pointSize)
            growDots(pixels_, scale_.width,
                     mostDotSide(spacing_, std::max(scale_.perStation, scale_.perHeight)));
        return false;
    }
    if (auto ok = beginDrawing(); !ok) return passOn(ok);
    return true;
}

Expected<void> ProfileDrawing::beginDrawing() {
    if (points_ == 0) return fail(ErrorCode::Empty, "No point lies in this corridor.", "line");
    scale_ = profileScale(picture_, length(), heights_, mostPixels_);
    pixels_.assign(std::size_t(scale_.width) * std::size_t(scale_.height), 0);
    drawing_ = true;
    return {};
}

void ProfileDrawing::draw(const PointBatch& batch) {
    const std::size_t stride = rowBytes(source_->header().columns);
    const int side = picture_.pointSize.value_or(1), before = (side - 1) / 2, behind = side / 2;
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const std::byte* row = batch.rows.data() + i * stride;
        const double station = loadLe<double>(row), offset = loadLe<double>(row + sizeof(double));
        const double across = station * scale_.perStation,
                     up = (batch.position[i].z - scale_.low) * scale_.perHeight;
        const int x = std::clamp(int(across), 0, scale_.width - 1);
        const int y = scale_.height - 1 - std::clamp(int(up), 0, scale_.height - 1);
        const std::uint64_t key = keyOf(offset, corridor_->width(), colors_.of(batch, i));
        for (int py = std::max(0, y - before); py <= std::min(scale_.height - 1, y + behind); ++py)
            for (int px = std::max(0, x - before); px <= std::min(scale_.width - 1, x + behind); ++px) {
                auto& pixel = pixels_[std::size_t(py) * std::size_t(scale_.width) + std::size_t(px)];
                pixel = std::max(pixel, key);
            }
    }
}

Frame ProfileDrawing::frame() const {
    Frame frame{.width = scale_.width, .height = scale_.height, .rgba = {}, .depth = {}, .stats = {}};
    std::vector<std::uint8_t> rgba(pixels_.size() * 4);
    for (int y = 0; y < scale_.height; ++y) {
        const double share = (y + 0.5) / scale_.height;
        std::array<std::uint8_t, 4> empty{0, 0, 0, 0};
        for (std::size_t c = 0; c < 3 && !isTransparent(); ++c) {
            const bool gradient = background_.kind == Background::Kind::Gradient;
            empty[c] =
                gradient ? between(background_.top[c], background_.bottom[c], share) : background_.top[c];
            empty[3] = 255;
        }
        for (int x = 0; x < scale_.width; ++x) {
            const std::size_t at = std::size_t(y) * std::size_t(scale_.width) + std::size_t(x);
            const std::uint64_t key = pixels_[at];
            const std::array<std::uint8_t, 4> there{std::uint8_t(key >> 16), std::uint8_t(key >> 8),
                                                    std::uint8_t(key), 255};
            std::ranges::copy(key == 0 ? empty : there, rgba.begin() + std::ptrdiff_t(4 * at));
        }
    }
    frame.rgba = Pixels<std::uint8_t>(std::move(rgba));
    return frame;
}

}  // namespace scancast
