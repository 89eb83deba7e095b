// A cloud being served: octree plus what people want to know about it. Immutable; shared between threads.
//
// Positions in the octree are relative to `origin` (float64, a round number near the cloud's minimum corner),
// so that UTM coordinates do not jitter: file coordinate = origin + relative.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/look.hpp"
#include "protocol/view/view.hpp"
#include "renderer/cloud/octree.hpp"
#include "renderer/cloud/point_batch.hpp"
#include "renderer/cloud/progress.hpp"
#include "renderer/cloud/stations/photo.hpp"

namespace scancast {

/// A plane that mirrors the scene (docs/spec/mirrors.md §2); carried by the cloud, drawn by
/// renderer/mirrors.hpp.
struct Mirror {
    glm::dvec3 center{0}, normal{0}, up{0};  ///< file coordinates; unit vectors
    double width = 0, height = 0;
    Rgb8 tint{255, 255, 255};
};

/// How many values lie in each of equal parts of a range. Those beyond it are in none.
struct ValueHistogram {
    double low = 0, high = 0;           ///< ends of the first and of the last part; low < high
    std::vector<std::uint64_t> counts;  ///< 1 to mostBins
    static constexpr std::size_t mostBins = 64;
    bool operator==(const ValueHistogram&) const = default;
};

/// A kept column and the range of its values (scaled).
struct KeptColumn {
    Column column;
    std::array<double, 2> range{0, 0};
    std::optional<std::array<double, 2>> usual{};  ///< 1st and 99th percentile; nullopt: not known
    /// Over `usual`, or `range` where that is a point; of whole numbers of which there are at most 64, one part each, in the
    /// middle of which the number lies. nullopt: not known.
    std::optional<ValueHistogram> histogram{};
    bool operator==(const KeptColumn&) const = default;
};

/// Values beside a cloud file's samples, in a list for each node (CLOUD_FILE.md, "Planes").
struct ValuePlane {
    /// Whose values: the points', so that leaves alone have them, or the samples' of every node.
    enum class Of : std::uint8_t { Points, Samples };

    std::string name;
    ColumnType type = ColumnType::Uint8;
    Of of = Of::Points;
    bool operator==(const ValuePlane&) const = default;
};

/// The scan's own grid: file coordinate = origin + step * whole number, on each axis.
struct ScanGrid {
    glm::dvec3 origin{0}, step{1};
    bool operator==(const ScanGrid&) const = default;
};

/// What a scan's points have, but all of them the same: no information, so that the cloud does not count it
/// among its attributes. Still there, and drawn when asked for by name.
struct ConstantValues {
    std::optional<Rgb8> color;
    std::optional<std::uint16_t> intensity;
    bool operator==(const ConstantValues&) const = default;
};

/// Where most of the points' values lie, so that one stray value spoils no colours: 1st and 99th percentile.
struct UsualRanges {
    std::array<glm::dvec3, 2> position{};       ///< file coordinates, each axis for itself
    std::array<double, 2> intensity{0, 0};      ///< 0, 0 without
    std::array<double, 3> brightness{0, 0, 0};  ///< of the colours (Rec. 709, sRGB, 0-1): 5, 50, 95 %
    std::array<double, 2> curvature{0,
                                    0};  ///< mean curvature of inner nodes' samples, 1 / cloud units: 5, 95 %
    bool operator==(const UsualRanges&) const = default;
};

/// How the side was found that normals point to, and how sure that is.
struct KnownSides {
    enum class By : std::uint8_t {
        File,       ///< the scan's own normals
        Scanner,    ///< towards the place that each point was recorded from
        Up,         ///< upwards, as was asked for
        Neighbours  ///< decided by all of them together (docs/spec/surfels.md §9)
    };
    By by = By::File;
    double sure = 1;  ///< share of the points that are drawn as oriented
    bool operator==(const KnownSides&) const = default;
};

/// Hundreds of scans can have something strange each; a cloud tells of so many.
inline constexpr std::size_t mostCloudNotes = 100;

/// Bytes that an attribution may have: a line under a picture.
inline constexpr std::size_t longestAttribution = 512;
/// InvalidArgument, with what would be right: an attribution that is longer, or a date that is none.
Expected<void> checkAttribution(std::string_view attribution);
Expected<void> checkRecorded(std::string_view date);

/// Everything about a cloud but its octree: what `info` tells and what the cloud file keeps beside its
/// blocks.
struct CloudFacts {
    std::string title;  ///< for people; the file's name by default
    std::string
        attribution;       ///< whom to name beside its pictures, and the licence: "City of Graz, CC BY 4.0"
    std::string recorded;  ///< when it was scanned: "2024", "2024-05" or "2024-05-13"; empty = not known
    std::string format;    ///< where it came from: "LAS 1.2, point format 3"
    glm::dvec3 origin{0};
    std::array<glm::dvec3, 2> bounds{};  ///< min, max in file coordinates, of the points really read
    std::uint64_t points = 0;            ///< points of the scan that are in the octree
    std::uint64_t droppedPoints = 0;     ///< left out: NaN or infinite coordinates
    Attributes attributes;               ///< those that tell points apart
    ConstantValues constant;
    std::array<std::uint16_t, 2> intensityRange{0, 65535};
    std::optional<ValueHistogram> intensityHistogram;  ///< as a kept column's; nullopt: not known
    std::array<std::uint64_t, 256> classCounts{};
    std::string crsWkt;
    std::optional<int> crsEpsg;
    std::optional<ScanGrid>
        grid;              ///< that all points lie on, in 32 bits; nullopt: there is none, or none is known
    bool exact = false;    ///< everything that samples round is kept beside them (exact_columns.hpp)
    double spacing = 0;    ///< s0, typical distance of neighbouring points, cloud units
    bool surfels = false;  ///< samples carry radius, ellipse and a normal
    bool oriented =
        false;  ///< all normals point to the side that was scanned; else their nodes say how sure that is
    std::optional<KnownSides> sides;  ///< nullopt: nothing is known of them
    std::vector<KeptColumn> columns;
    std::vector<ValuePlane> companions;  ///< what the cloud file has beside its samples and columns
    std::vector<Mirror> mirrors;
    std::optional<UsualRanges> usual;  ///< nullopt: not known, of a cloud file of version 1
    /// Where the scanner stood, file coordinates, if the scan says so and it stood at one place.
    std::optional<glm::dvec3> scanner;
    std::vector<Station> stations;   ///< all places that it stood at, if the scan says so
    std::vector<Photo> photos;       ///< that the scan brought along
    std::optional<Look> look;        ///< nullopt: not decided yet (renderer/look)
    std::vector<std::string> notes;  ///< what was strange about the scan, one sentence each without an end
    std::string revision;            ///< hex digest of everything that pictures depend on but the look
};

/// The companion that keeps samples' curvatures (curvature.hpp).
inline constexpr std::string_view curvaturePlaneName = "curvature";
ValuePlane curvaturePlane();
/// Whether samples carry curvatures: there is that companion, as it has to be.
bool hasCurvature(const CloudFacts& facts);

/// The companion that keeps samples' near infrared, 0-255.
inline constexpr std::string_view nearInfraredPlaneName = "near_infrared";
ValuePlane nearInfraredPlane();
/// Whether samples carry that; Attributes::nearInfrared says the same.
bool hasNearInfrared(const CloudFacts& facts);

/// The companion with inner nodes' values of a kept column: of each sample, the value of the scan's point that is nearest.
/// Leaves have none of it: theirs is the column itself.
ValuePlane innerPlane(const Column& column);

/// All values beside the samples: each column's, in their order, then the companions.
std::vector<ValuePlane> planesOf(const CloudFacts& facts);

/// What somebody who reads or opens the cloud should be told once, as whole sentences: points left out,
/// attributes that are none because they are the same everywhere, notes.
std::vector<std::string> remarksOn(const CloudFacts& facts);

/// Changes whenever a picture of the cloud could, with its look: that decides what views leave open.
std::string pictureRevision(const CloudFacts& facts);

struct Together;

struct Cloud : CloudFacts {
    Octree octree;
    /// Of several clouds in one view: which, and whose nodes are whose (renderer/together/together.hpp); else empty.
    std::shared_ptr<const Together> together{};

    /// Looks at the whole cloud from the south-east, 30° down. Z is up, but for models that plainly stand on
    /// y = 0.
    Camera defaultCamera(double aspect) const;
};

}  // namespace scancast
