#include "renderer/together/painted_file.hpp"

#include <utility>

namespace scancast {
namespace {

class PaintedFile final : public CloudFile {
  public:
    PaintedFile(std::shared_ptr<const CloudFile> file, const Paint& paint)
        : file_(std::move(file)), paint_(paint) {}

    const std::filesystem::path& path() const override { return file_->path(); }
    std::uint64_t bytes() const override { return file_->bytes(); }
    bool isRemote() const override { return file_->isRemote(); }
    bool isNative() const override { return file_->isNative(); }
    bool countsVary() const override { return file_->countsVary(); }
    bool isAway() const override { return file_->isAway(); }
    const CloudFacts& facts() const override { return file_->facts(); }
    std::span<const BlockPlace> photoPlaces() const override { return file_->photoPlaces(); }
    std::string_view writtenBy() const override { return file_->writtenBy(); }
    std::span<const StoredNode> nodes() const override { return file_->nodes(); }
    Expected<std::vector<Sample>> samples(std::uint32_t node) const override {
        auto samples = file_->samples(node);
        if (samples)
            for (Sample& sample : *samples) sample = painted(sample, paint_);
        return samples;
    }
    std::span<const ValuePlane> planes() const override { return file_->planes(); }
    Expected<std::vector<std::byte>> plane(std::uint32_t node, std::size_t index) const override {
        return file_->plane(node, index);
    }
    BlockPlace planePlace(std::uint32_t node, std::size_t index) const override {
        return file_->planePlace(node, index);
    }
    Expected<std::vector<std::byte>> rows(std::uint32_t node) const override { return file_->rows(node); }
    Expected<KeptPoint> point(std::uint32_t leaf, std::span<const Sample> samples,
                              std::size_t index) const override {
        return file_->point(leaf, samples, index);
    }

  private:
    const std::shared_ptr<const CloudFile> file_;
    const Paint paint_;
};

std::uint8_t product(std::uint8_t a, std::uint8_t b) {
    return std::uint8_t((unsigned(a) * b * 2 + 255) / 510);
}

}  // namespace

Sample painted(Sample sample, const Paint& paint) {
    const auto& [r, g, b] = paint.color;
    if (paint.covers) {
        sample.r = r, sample.g = g, sample.b = b;
    } else {
        sample.r = product(sample.r, r), sample.g = product(sample.g, g), sample.b = product(sample.b, b);
    }
    return sample;
}

std::shared_ptr<const CloudFile> paintedFile(std::shared_ptr<const CloudFile> file, const Paint& paint) {
    return std::make_shared<PaintedFile>(std::move(file), paint);
}

}  // namespace scancast
