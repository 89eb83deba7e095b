// A synthetic scan with columns: whole numbers with scale and offset, doubles of which some are no number, a few small ones. What a
// point has follows from its number, so a test knows all of it without reading.
#pragma once

#include <cmath>
#include <limits>

#include "files/bytes.hpp"
#include "tests/support/clouds/synthetic_source.hpp"

namespace scancast::test {

/// -100.00 … 400.00 in hundredths.
inline double amountOf(std::uint64_t i) {
    return -100 + 0.01 * std::floor(50'001 * uniform(i, 11));  // as offset and scale make it
}
/// 0 … 1000, and NaN for one in 50.
inline double shotOf(std::uint64_t i) {
    return uniform(i, 12) < 0.02 ? std::numeric_limits<double>::quiet_NaN() : 1000 * uniform(i, 13);
}
/// 1 … 5, few of the large ones.
inline std::uint8_t returnsOf(std::uint64_t i) {
    const double u = uniform(i, 14);
    return std::uint8_t(1 + 4.999 * u * u);
}
inline std::uint16_t intensityOf(std::uint64_t i) {
    return std::uint16_t(100 + 3000 * uniform(i, 15));
}
inline std::uint8_t classOf(std::uint64_t i) {
    return std::uint8_t(2 + 3 * uniform(i, 16));
}

/// `make`'s points with all of these; `named`: what the last column, the point's number, is called.
class ColumnSource final : public PointSource {
  public:
    ColumnSource(std::uint64_t count, SyntheticSource::Make make, std::string named = "number")
        : source_(
              count,
              [make = std::move(make)](std::uint64_t i, std::uint64_t n) {
                  ScanPoint p = make(i, n);
                  p.intensity = intensityOf(i);
                  p.classification = classOf(i);
                  return p;
              },
              {.color = true, .intensity = true, .classification = true}, 0.001),
          header_(source_.header()) {
        header_.columns = {{"amount", ColumnType::Int32, 0.01, -100, "so much"},
                           {"shot; time", ColumnType::Float64, 1, 0, ""},
                           {"returns", ColumnType::Uint8, 1, 0, ""},
                           {std::move(named), ColumnType::Uint32, 1, 0, ""}};
    }

    const ScanHeader& header() const override { return header_; }
    std::uint64_t droppedPoints() const override { return 0; }
    Expected<bool> read(PointBatch& batch) override {
        auto more = source_.read(batch);
        if (!more || !*more) return more;
        batch.rows.resize(batch.size() * 17);
        for (std::size_t k = 0; k < batch.size(); ++k, ++next_) {
            std::byte* row = batch.rows.data() + k * 17;
            storeLe(row, std::int32_t(std::lround((amountOf(next_) + 100) * 100)));
            storeLe(row + 4, shotOf(next_));
            storeLe(row + 12, returnsOf(next_));
            storeLe(row + 13, std::uint32_t(next_));
        }
        return more;
    }

  private:
    SyntheticSource source_;
    ScanHeader header_;
    std::uint64_t next_ = 0;
};

}  // namespace scancast::test
