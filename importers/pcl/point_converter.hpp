// Raw numbers of a point to the columns of the point stream, and the scaling that their range asks for.
// Owned and used by one thread. Pipeline: PLY or PCD → raw points → **columns** → point stream.
//
// PLY and PCD do not say what the full range of an intensity or a colour is; the values themselves have to:
//   intensity: 16-bit integers as they are, 8-bit ones × 257. Others as they are within 0-65535 if they are
//   integers;
//     floats within 0-1 × 65535, within 0-255 × 257, within 0-65535 as they are. Anything else is stretched
//     linearly so that its least value becomes 0 and its greatest 65535. NaN becomes 0.
//   colour: bytes as they are; wider integers as they are if none is above 255, else their high byte of 16;
//   floats
//     × 255 if none is above 1, as they are if none is above 255, else / 256.
//   classification: 0-255 as they are, anything else becomes 0 ("never classified").
//   normals are brought to unit length; those without a length become 0.
#pragma once

#include <cstdint>
#include <limits>

#include "importers/pcl/point_fields.hpp"
#include "renderer/cloud/import/stream/point_stream_writer.hpp"

namespace scancast::import_pcl {

/// The values met in a scan, where scaling depends on them.
struct ValueRanges {
    double leastIntensity = std::numeric_limits<double>::infinity();
    double greatestIntensity = -std::numeric_limits<double>::infinity();
    double greatestColor = 0;

    void take(const RawPoint& point, const PointFields& fields);
};

/// True when points cannot be converted before all of them were seen once.
bool needsRanges(const PointFields& fields);

class PointConverter {
  public:
    PointConverter(const PointFields& fields, const ValueRanges& ranges, PointStreamWriter& writer);

    /// Converts a point, or drops it if a coordinate is not finite. Sends a chunk when one is full.
    Expected<void> add(const RawPoint& point);
    /// Sends the rest and ends the stream.
    Expected<void> finish();

  private:
    void addColor(const RawPoint& point);
    void addNormal(const RawPoint& point);

    PointFields fields_;
    Attributes attributes_;
    double colorFactor_ = 1;
    double intensityShift_ = 0, intensityFactor_ = 1;
    PointStreamWriter& writer_;
    PointBatch batch_;
    std::uint64_t dropped_ = 0;
};

}  // namespace scancast::import_pcl
