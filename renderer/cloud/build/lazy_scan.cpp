#include "renderer/cloud/build/lazy_scan.hpp"

namespace scancast {

namespace {

class LazyScan final : public PointSource {
  public:
    LazyScan(OpenScan open, ScanHeader header) : open_(std::move(open)), header_(std::move(header)) {}

    const ScanHeader& header() const override { return header_; }

    Expected<bool> read(PointBatch& batch) override {
        batch.clear();
        if (ended_) return false;
        if (!source_) {
            auto opened = open_();
            if (!opened) return passOn(opened);
            source_ = std::move(*opened);
        }
        const auto more = source_->read(batch);
        dropped_ = source_->droppedPoints();
        bytes_ = source_->bytesRead();
        notes_ = source_->notes();
        stations_ = source_->stations();
        if (!more || !*more) {
            ended_ = true;
            photos_ = source_->photos();
            source_.reset();
        }
        return more;
    }

    std::uint64_t droppedPoints() const override { return dropped_; }
    std::vector<std::string> notes() const override { return notes_; }
    std::vector<Station> stations() const override { return stations_; }
    std::vector<Photo> photos() const override { return photos_; }
    std::array<std::uint64_t, 2> bytesRead() const override { return bytes_; }

  private:
    OpenScan open_;
    const ScanHeader header_;
    std::unique_ptr<PointSource> source_;
    std::uint64_t dropped_ = 0;
    std::vector<std::string> notes_;
    std::vector<Station> stations_;
    std::vector<Photo> photos_;
    std::array<std::uint64_t, 2> bytes_{};
    bool ended_ = false;
};

}  // namespace

Expected<std::unique_ptr<PointSource>> lazyScan(OpenScan open) {
    auto first = open();
    if (!first) return first;
    ScanHeader header = (*first)->header();
    first->reset();
    return std::make_unique<LazyScan>(std::move(open), std::move(header));
}

}  // namespace scancast
