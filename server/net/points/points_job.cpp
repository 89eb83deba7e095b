#include "server/net/points/points_job.hpp"

#include <algorithm>
#include <utility>

#include "renderer/cloud/export/losses.hpp"

namespace scancast {
namespace {

tl::unexpected<Error> nothing() {
    return fail(ErrorCode::Empty, "No point lies there.", "region");
}

/// Formats whose head says how many points follow.
bool hasHead(ExportFormat format) {
    return format == ExportFormat::Las || format == ExportFormat::Ply;
}

}  // namespace

PointsJob::PointsJob(std::shared_ptr<const CloudFile> file, ExportOptions options, std::stop_token stop)
    : file_(std::move(file)),
      options_(std::move(options)),
      what_(cloudPointsOptions(options_, std::move(stop))) {}

Expected<void> PointsJob::step() {
    if (done_) return {};
    if (hasHead(options_.format) && !points_) return count();
    if (!source_) {
        source_ = cloudPoints(file_, what_);
        if (!points_) points_ = source_->header().points;
    }
    const auto more = source_->read(batch_);
    if (!more) return passOn(more);
    if (!*more) return finish();
    if (batch_.size() == 0) return {};
    if (!writer_)
        if (auto ok = begin(); !ok) return ok;
    return write();
}

Expected<void> PointsJob::count() {
    if (!survey_) survey_ = std::make_unique<SurveyAhead>(file_, what_, options_.format);
    const auto more = survey_->step();
    if (!more) return passOn(more);
    if (*more) return {};
    ahead_ = survey_->survey();
    survey_.reset();
    points_ = ahead_.points;
    return ahead_.points > 0 ? Expected<void>() : nothing();
}

Expected<void> PointsJob::begin() {
    auto output = OutputFile::to([to = bytes_](std::span<const std::byte> bytes) -> Expected<void> {
        to->insert(to->end(), bytes.begin(), bytes.end());
        return {};
    });
    auto writer = createExport(options_.format, std::move(output), source_->header(), ahead_);
    if (!writer) return passOn(writer);
    early_ = (*writer)->losses();
    writer_ = std::move(*writer);
    return {};
}

Expected<void> PointsJob::write() {
    written_.add(batch_, source_->header());
    return writer_->write(batch_);
}

Expected<void> PointsJob::finish() {
    if (!writer_) return nothing();
    // The head has gone out: who counted otherwise would have sent a file that lies.
    if (hasHead(options_.format) && written_.points != ahead_.points)
        return fail(ErrorCode::Internal, "An export found another number of points than it had counted.");
    if (auto ok = writer_->finish(written_); !ok) return ok;
    done_ = true;
    return {};
}

std::vector<std::string> PointsJob::losses() const {
    std::vector<std::string> all = lossesOf(*file_, options_);
    all.insert(all.end(), early_.begin(), early_.end());
    return all;
}

std::vector<std::string> PointsJob::lateLosses() const {
    std::vector<std::string> late = writer_ ? writer_->losses() : std::vector<std::string>();
    std::erase_if(late,
                  [&](const std::string& one) { return std::ranges::find(early_, one) != early_.end(); });
    return late;
}

}  // namespace scancast
