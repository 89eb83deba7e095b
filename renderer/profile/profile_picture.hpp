// The picture of a profile: a corridor unfolded, station to the right, height upwards, as who stands to the right of the line
// sees it. Each point is a square of a few pixels, as asked, or as far as points lie apart (grow_dots.hpp); in front is the one with the
// largest offset, so the picture does not depend on the order of points, nor on threads. Pipeline: cloud file → points in the corridor → **picture** → PNG.
//
// Owned and used by one thread, step by step: once over the points for the heights between which they lie, and once to draw them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "protocol/points/points_request.hpp"
#include "renderer/cloud/export/cloud_points.hpp"
#include "renderer/image/frame.hpp"
#include "renderer/profile/point_colors.hpp"

namespace scancast {

/// What the pixels of a profile's picture mean: who knows it measures in the picture.
struct ProfileScale {
    int width = 0, height = 0;             ///< px
    double perStation = 1, perHeight = 1;  ///< px per file unit
    double low = 0;                        ///< height of the lower edge
    /// At the right edge; at the left it is 0.
    double lastStation() const { return width / perStation; }
    /// Height of the upper edge.
    double high() const { return low + height / perHeight; }
};
/// For points between these heights. Everything fits in. `mostPixels`: of the whole picture, where its height is free.
ProfileScale profileScale(const ProfilePicture& picture, double length, const std::array<double, 2>& heights,
                          std::uint64_t mostPixels);
/// As many pixels as the picture has at most, before it is known which points of a cloud between these heights it shows.
std::uint64_t mostProfilePixels(const ProfilePicture& picture, double length,
                                const std::array<double, 2>& heights, std::uint64_t mostPixels);

class ProfileDrawing {
  public:
    /// Errors: PointColors'; ResourceLimit for a picture of more pixels; InvalidArgument, Corridor's.
    static Expected<std::unique_ptr<ProfileDrawing>> create(const Cloud& cloud,
                                                            std::shared_ptr<const CloudFile> file,
                                                            const ProfileRequest& request,
                                                            std::uint64_t mostPixels,
                                                            std::stop_token stop = {});

    /// A batch of points. Whether there is more. Errors: the file's; Empty where no point lies in the corridor; Cancelled.
    Expected<bool> step();
    /// Once there is no more.
    const ProfileScale& scale() const { return scale_; }
    const std::array<double, 2>& heights() const { return heights_; }  ///< of the points, lowest and highest
    double length() const { return corridor_->length(); }
    std::uint64_t points() const { return points_; }
    Frame frame() const;
    bool isTransparent() const { return background_.kind == Background::Kind::Transparent; }

  private:
    explicit ProfileDrawing(PointColors colors) : colors_(std::move(colors)) {}
    Expected<void> beginDrawing();
    void draw(const PointBatch& batch);

    std::shared_ptr<const CloudFile> file_;
    std::shared_ptr<const Corridor> corridor_;
    CloudPointsOptions what_;
    PointColors colors_;
    ProfilePicture picture_;
    Background background_;
    std::uint64_t mostPixels_ = 0;
    std::unique_ptr<PointSource> source_;
    PointBatch batch_;
    std::array<double, 2> heights_{};
    std::uint64_t points_ = 0;
    bool drawing_ = false, done_ = false;
    ProfileScale scale_;
    double spacing_ = 0;                 ///< the cloud's
    std::vector<std::uint64_t> pixels_;  ///< offset above colour; 0: nothing there
};

}  // namespace scancast
