// Points of a cloud file on their way out, step by step: counted where a head says how many there are, read, written into parts
// of bytes. Knows neither threads nor sockets: who calls step() decides when, and may stop between two.
//
// Owned by the answer that it is for. Pipeline: cloud file → points → writer → **job** → points answers.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "renderer/cloud/export/export_points.hpp"
#include "renderer/cloud/export/survey_ahead.hpp"

namespace scancast {

class PointsJob {
  public:
    /// `stop`: nobody waits for it any more; a step that is under way is then Cancelled before its next leaf.
    PointsJob(std::shared_ptr<const CloudFile> file, ExportOptions options, std::stop_token stop = {});

    /// Some of the work: a batch of points, or a few leaves that are counted. Errors: Empty where no point is wanted; the
    /// file's; the writer's. After the last step, and after an error, there is nothing more to do.
    Expected<void> step();

    /// The first points are there: everything that can be said before them is known.
    bool hasBegun() const { return writer_ != nullptr; }
    bool isDone() const { return done_; }
    /// What there are of them, where that is known before they have been read.
    std::optional<std::uint64_t> points() const { return points_; }
    /// Against the scan as it was: what is known when it has begun.
    std::vector<std::string> losses() const;
    /// Those that showed while it was written.
    std::vector<std::string> lateLosses() const;

    /// What has been written and not been taken yet.
    std::size_t waiting() const { return bytes_->size(); }
    std::vector<std::byte> take() { return std::exchange(*bytes_, {}); }

  private:
    Expected<void> count();
    Expected<void> begin();
    Expected<void> write();
    Expected<void> finish();

    std::shared_ptr<const CloudFile> file_;
    ExportOptions options_;
    CloudPointsOptions what_;
    std::shared_ptr<std::vector<std::byte>> bytes_ = std::make_shared<std::vector<std::byte>>();
    std::unique_ptr<SurveyAhead> survey_;  ///< while it is counted
    PointSurvey ahead_;
    std::unique_ptr<PointSource> source_;
    std::unique_ptr<ExportWriter> writer_;
    PointBatch batch_;
    PointSurvey written_;
    std::optional<std::uint64_t> points_;
    std::vector<std::string> early_;  ///< the writer's, when it was made
    bool done_ = false;
};

}  // namespace scancast
