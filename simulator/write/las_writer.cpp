#include "simulator/write/las_writer.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "simulator/write/little_endian.hpp"

namespace scancast {
namespace {

constexpr std::size_t headerBytes12 = 227, headerBytes14 = 375;
constexpr std::size_t recordBytes2 = 26, recordBytes7 = 36;

class LasWriter final : public PointWriter {
  public:
    LasWriter(bool version14, OutputFile output, const ScanHeader& header)
        : version14_(version14),
          output_(std::move(output)),
          points_(*header.points),
          bounds_(*header.bounds) {
        const glm::dvec3 extent = bounds_[1] - bounds_[0];
        const double widest = std::max({extent.x, extent.y, extent.z});
        // Millimetres, as surveyors do; finer for objects, coarser only where 32 bits would not reach.
        step_ = widest < 50 ? 0.0001 : 0.001;
        while (widest / step_ > 2e9) step_ *= 10;
        for (int axis = 0; axis < 3; ++axis)
            offset_[axis] = std::floor((bounds_[0][axis] + bounds_[1][axis]) / 2);
    }

    Expected<void> begin() { return output_.write(header(bounds_)); }

    Expected<void> write(const PointBatch& batch) override {
        rows_.resize(batch.size() * (version14_ ? recordBytes7 : recordBytes2));
        std::byte* at = rows_.data();
        for (std::size_t i = 0; i < batch.size(); ++i) at = record(at, batch, i);
        return output_.write(rows_);
    }

    Expected<void> finish() override {
        if (output_.seekable()) {
            std::array<glm::dvec3, 2> seen;
            for (int axis = 0; axis < 3; ++axis) {
                seen[0][axis] = offset_[axis] + low_[std::size_t(axis)] * step_;
                seen[1][axis] = offset_[axis] + high_[std::size_t(axis)] * step_;
            }
            if (auto ok = output_.overwrite(0, header(seen)); !ok) return ok;
        }
        return output_.finish();
    }

    std::uint64_t bytesWritten() const override { return output_.bytesWritten(); }

  private:
    std::byte* record(std::byte* at, const PointBatch& batch, std::size_t i) {
        for (int axis = 0; axis < 3; ++axis) {
            const auto grid = std::int32_t(std::llround((batch.position[i][axis] - offset_[axis]) / step_));
            low_[std::size_t(axis)] = std::min(low_[std::size_t(axis)], grid);
            high_[std::size_t(axis)] = std::max(high_[std::size_t(axis)], grid);
            at = put(at, grid);
        }
        at = put(at, batch.intensity[i]);
        if (version14_) {
            at = put(at, std::uint8_t(0x11));  // return 1 of 1
            at = put(at, std::uint8_t(0));     // no flags
            at = put(at, batch.classification[i]);
            at = put(at, std::uint8_t(0));   // user data
            at = put(at, std::int16_t(0));   // scan angle
            at = put(at, std::uint16_t(1));  // point source
            at = put(at, double(0));         // GPS time
        } else {
            at = put(at, std::uint8_t(0x09));  // return 1 of 1
            at = put(at, std::uint8_t(batch.classification[i] & 31));
            at = put(at, std::int8_t(0));    // scan angle
            at = put(at, std::uint8_t(0));   // user data
            at = put(at, std::uint16_t(1));  // point source
        }
        // 16 bits a channel, filled by × 257 as the specification asks.
        for (const std::uint8_t channel : batch.color[i]) at = put(at, std::uint16_t(channel * 257));
        return at;
    }

    static std::byte* putText(std::byte* at, std::string_view text, std::size_t width) {
        std::memcpy(at, text.data(), text.size());
        return at + width;
    }

    std::vector<std::byte> header(const std::array<glm::dvec3, 2>& bounds) const {
        const std::size_t size = version14_ ? headerBytes14 : headerBytes12;
        std::vector<std::byte> bytes(size);
        std::byte* at = putText(bytes.data(), "LASF", 4);
        at = put(at, std::uint16_t(0));                      // file source
        at = put(at, std::uint16_t(version14_ ? 0x10 : 0));  // global encoding; 1.4 demands the WKT bit
        at += 16;                                            // project id
        at = put(at, std::uint8_t(1));
        at = put(at, std::uint8_t(version14_ ? 4 : 2));
        at = putText(at, "SIMULATION", 32);
        at = putText(at, "scancast generate", 32);
        at += 4;  // day and year: left out, so that the same scan is the same bytes tomorrow
        at = put(at, std::uint16_t(size));
        at = put(at, std::uint32_t(size));
        at = put(at, std::uint32_t(0));  // variable length records
        at = put(at, std::uint8_t(version14_ ? 7 : 2));
        at = put(at, std::uint16_t(version14_ ? recordBytes7 : recordBytes2));
        // The 32-bit counts stay 0 in 1.4, as its point formats demand; the 64-bit ones follow at the end.
        at = put(at, std::uint32_t(version14_ ? 0 : points_));
        at = put(at, std::uint32_t(version14_ ? 0 : points_));
        at += 16;  // returns 2 to 5
        for (int axis = 0; axis < 3; ++axis) at = put(at, step_);
        for (int axis = 0; axis < 3; ++axis) at = put(at, offset_[axis]);
        for (int axis = 0; axis < 3; ++axis) {
            at = put(at, bounds[1][axis]);
            at = put(at, bounds[0][axis]);
        }
        if (version14_) {
            at += 8 + 8 + 4;  // no waveforms, no extended records
            at = put(at, points_);
            put(at, points_);
        }
        return bytes;
    }

    bool version14_;
    OutputFile output_;
    std::uint64_t points_;
    std::array<glm::dvec3, 2> bounds_;
    double step_ = 0.001;
    glm::dvec3 offset_{0};
    std::array<std::int32_t, 3> low_{INT32_MAX, INT32_MAX, INT32_MAX}, high_{INT32_MIN, INT32_MIN, INT32_MIN};
    std::vector<std::byte> rows_;
};

}  // namespace

Expected<std::unique_ptr<PointWriter>> createLasWriter(bool version14, OutputFile output,
                                                       const ScanHeader& header) {
    if (!version14 && *header.points > UINT32_MAX)
        return fail(ErrorCode::InvalidArgument,
                    "LAS 1.2 holds at most 4 294 967 295 points; write LAS 1.4 (--format las14) or PLY.",
                    "format");
    auto writer = std::make_unique<LasWriter>(version14, std::move(output), header);
    if (auto ok = writer->begin(); !ok) return passOn(ok);
    return writer;
}

}  // namespace scancast
