#include "renderer/cloud/build/lazy_scan.hpp"

#include <optional>
#include <utility>

#include "renderer/cloud/forwarding_source.hpp"

namespace scancast {

namespace {

class LazyScan final : public ForwardingSource {
  public:
    /// `seen`: what the scan told when it was opened for its header.
    LazyScan(OpenScan open, std::unique_ptr<PointSource> seen)
        : ForwardingSource(std::move(seen)), open_(std::move(open)), header_(source().header()) {}

    /// One object all the time, whatever is open; a scanner's place may be forgotten while the scan is read.
    const ScanHeader& header() const override { return header_; }

    void readPart(std::uint64_t first, std::uint64_t count) override { part_ = {first, count}; }

    /// Opened for that alone.
    Expected<std::uint16_t> lookAt(std::uint64_t first, std::uint64_t count) override {
        if (count == 0) return std::uint16_t(0);
        auto opened = open_();
        if (!opened) return passOn(opened);
        return (*opened)->lookAt(first, count);
    }
    void hasSeen(std::uint16_t highest) override { seen_ = highest; }

    Expected<bool> read(PointBatch& batch) override {
        if (open_) {
            batch.clear();
            auto opened = open_();
            if (!opened) return passOn(opened);
            open_ = nullptr;
            wrap(std::move(*opened));
            if (part_) source().readPart(part_->first, part_->second);
            if (seen_) source().hasSeen(*seen_);
        }
        const auto more = source().read(batch);
        header_.scannerOrigin = source().header().scannerOrigin;
        if (!more || !*more) wrap(std::make_unique<ClosedSource>(source()));
        return more;
    }

  private:
    OpenScan open_;  ///< until it is open
    ScanHeader header_;
    std::optional<std::pair<std::uint64_t, std::uint64_t>> part_;  ///< first point, and how many
    std::optional<std::uint16_t> seen_;
};

}  // namespace

Expected<std::unique_ptr<PointSource>> lazyScan(OpenScan open) {
    auto first = open();
    if (!first) return first;
    return std::make_unique<LazyScan>(std::move(open), std::make_unique<ClosedSource>(**first));
}

}  // namespace scancast
