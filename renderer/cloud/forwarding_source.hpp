// A source around another one, and what stays of a source that is closed: whatever a source can be asked is asked of it here, once,
// so that no wrapper forgets a question. A virtual more in PointSource is a line more in both, and in their test.
// Pipeline: import → **wrappers** → octree. Owned and used by the thread that uses what is wrapped.
#pragma once

#include <memory>
#include <utility>

#include "renderer/cloud/point_batch.hpp"

namespace scancast {

/// Asks the source in it, unless its heirs answer themselves. Those that change points change the ones to glance at, too.
class ForwardingSource : public PointSource {
  public:
    const ScanHeader& header() const override { return source_->header(); }
    Expected<PointBatch> glance() override { return source_->glance(); }
    bool hasParts() const override { return source_->hasParts(); }
    void readPart(std::uint64_t first, std::uint64_t count) override { source_->readPart(first, count); }
    bool wantsToBeSeen() const override { return source_->wantsToBeSeen(); }
    Expected<std::uint16_t> lookAt(std::uint64_t first, std::uint64_t count) override {
        return source_->lookAt(first, count);
    }
    void hasSeen(std::uint16_t highest) override { source_->hasSeen(highest); }
    Expected<bool> read(PointBatch& batch) override { return source_->read(batch); }
    std::uint64_t droppedPoints() const override { return source_->droppedPoints(); }
    std::vector<std::string> notes() const override { return source_->notes(); }
    std::vector<Station> stations() const override { return source_->stations(); }
    std::vector<Photo> photos() const override { return source_->photos(); }
    std::array<std::uint64_t, 2> bytesRead() const override { return source_->bytesRead(); }

  protected:
    ForwardingSource() = default;  ///< wrap() something before anything is asked
    explicit ForwardingSource(std::unique_ptr<PointSource> source) : source_(std::move(source)) {}

    void wrap(std::unique_ptr<PointSource> source) { source_ = std::move(source); }
    PointSource& source() { return *source_; }
    const PointSource& source() const { return *source_; }

  private:
    std::unique_ptr<PointSource> source_;
};

/// All that `source` has told so far, without its points: it can be closed.
class ClosedSource final : public PointSource {
  public:
    explicit ClosedSource(const PointSource& source)
        : header_(source.header()),
          hasParts_(source.hasParts()),
          wantsToBeSeen_(source.wantsToBeSeen()),
          dropped_(source.droppedPoints()),
          notes_(source.notes()),
          stations_(source.stations()),
          photos_(source.photos()),
          bytes_(source.bytesRead()) {}

    const ScanHeader& header() const override { return header_; }
    /// Of what was closed.
    bool hasParts() const override { return hasParts_; }
    bool wantsToBeSeen() const override { return wantsToBeSeen_; }
    Expected<bool> read(PointBatch& batch) override {
        batch.clear();
        return false;
    }
    std::uint64_t droppedPoints() const override { return dropped_; }
    std::vector<std::string> notes() const override { return notes_; }
    std::vector<Station> stations() const override { return stations_; }
    std::vector<Photo> photos() const override { return photos_; }
    std::array<std::uint64_t, 2> bytesRead() const override { return bytes_; }

  private:
    ScanHeader header_;
    bool hasParts_ = false, wantsToBeSeen_ = false;
    std::uint64_t dropped_ = 0;
    std::vector<std::string> notes_;
    std::vector<Station> stations_;
    std::vector<Photo> photos_;
    std::array<std::uint64_t, 2> bytes_{};
};

}  // namespace scancast
