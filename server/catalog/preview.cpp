#include "server/catalog/preview.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "renderer/cloud/build/build_cloud.hpp"
#include "server/base/faults.hpp"

namespace scancast {
namespace {

/// Points in memory as a scan.
class MemorySource final : public PointSource {
  public:
    MemorySource(ScanHeader header, PointBatch points)
        : header_(std::move(header)), points_(std::move(points)) {
        header_.points = points_.size();
        header_.columns.clear();
    }
    const ScanHeader& header() const override { return header_; }
    std::uint64_t droppedPoints() const override { return 0; }
    Expected<bool> read(PointBatch& batch) override {
        batch.clear();
        const std::size_t end = std::min(points_.size(), next_ + batchPoints);
        forColumns(batch, points_, [&](auto& to, const auto& from) {
            if (!from.empty())
                to.assign(from.begin() + std::ptrdiff_t(next_), from.begin() + std::ptrdiff_t(end));
        });
        next_ = end;
        return batch.size() > 0;
    }

  private:
    ScanHeader header_;
    PointBatch points_;
    std::size_t next_ = 0;
};

/// The cloud as large as the scan says it will be, so that the camera need not jump when more has been read.
std::shared_ptr<const Cloud> withDeclaredBounds(std::shared_ptr<const Cloud> cloud,
                                                const ScanHeader& header) {
    if (!header.bounds) return cloud;
    const auto& [low, high] = *header.bounds;
    for (int a = 0; a < 3; ++a)
        if (!(low[a] <= cloud->bounds[0][a] && cloud->bounds[1][a] <= high[a])) return cloud;
    auto wider = std::make_shared<Cloud>(*cloud);
    wider->bounds = {low, high};
    return wider;
}

}  // namespace

void StrideSample::add(const PointBatch& batch) {
    for (; next_ < seen_ + batch.size(); next_ += stride_) {
        forColumns(points_, batch, [&](auto& to, const auto& from) {
            if (!from.empty()) to.push_back(from[std::size_t(next_ - seen_)]);
        });
        if (points_.size() < most_) continue;
        forColumns(points_, points_, [](auto& to, const auto&) {
            for (std::size_t k = 0; 2 * k < to.size(); ++k) to[k] = to[2 * k];
            to.resize((to.size() + 1) / 2);
        });
        stride_ *= 2;
        next_ = (points_.size() - 1) * stride_;  // of the last that stayed
    }
    seen_ += batch.size();
}

PreviewSource::PreviewSource(std::unique_ptr<PointSource> source, PreviewOptions options)
    : ForwardingSource(std::move(source)),
      options_(std::move(options)),
      sample_(options_.mostPoints),
      next_(options_.first) {}

PreviewSource::~PreviewSource() {
    if (builder_.joinable()) builder_.join();
}

Expected<bool> PreviewSource::read(PointBatch& batch) {
    if (!began_) {
        began_ = Clock::now();
        showGlance();
    }
    auto more = source().read(batch);
    if (!more) return more;
    if (*more) sample_.add(batch);
    const auto elapsed = Clock::now() - *began_;
    const bool atEnd = !*more && elapsed >= options_.second;
    if ((elapsed < next_ && !atEnd) || sample_.points().size() == 0) return more;
    if (building_ && !atEnd) return more;
    next_ = std::max<Clock::duration>(2 * elapsed, options_.second);
    StrideSample chosen(isFirst_ && !atEnd ? options_.mostOfFirst : options_.mostPoints);
    chosen.add(sample_.points());
    PointBatch points = chosen.points();
    if (!atEnd) append(points, glance_);  // of what is not read yet
    build(std::move(points));
    return more;
}

/// What goes wrong here is told of by read().
void PreviewSource::showGlance() {
    auto points = source().glance();
    if (!points || points->size() == 0) return;
    next_ = options_.second;
    glance_ = std::move(*points);
    build(glance_);
}

// A preview that cannot be made is left out: the scan goes on being read.
void PreviewSource::build(PointBatch points) {
    if (builder_.joinable()) builder_.join();
    isFirst_ = false;
    building_ = true;
    const auto begun = contained("Starting a preview", [&] {
        builder_ = std::thread([this, header = source().header(), points = std::move(points)]() mutable {
            std::ignore = contained("A preview", [&] { show(header, std::move(points)); });
            building_ = false;
        });
    });
    if (!begun) building_ = false;
}

void PreviewSource::show(const ScanHeader& header, PointBatch points) const {
    BuildOptions build;
    build.title = options_.title;
    build.threads = options_.threads;
    MemorySource source(header, std::move(points));
    // What goes wrong here goes wrong again, and is told of, when the whole scan is built.
    if (auto cloud = buildCloud(source, build)) options_.show(withDeclaredBounds(std::move(*cloud), header));
}

}  // namespace scancast
