#include "renderer/cloud/export/export_points.hpp"
#include "renderer/cloud/columns/pictured_file.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <future>
#include <new>

#include "renderer/cloud/export/cloud_points.hpp"
#include "renderer/cloud/export/losses.hpp"
#include "renderer/cloud/export/survey_ahead.hpp"

namespace scancast {

namespace {

tl::unexpected<Error> interrupted() {
    return fail(ErrorCode::Cancelled, "The export was abandoned.");
}

/// Every batch of a source; the next one is read while this one is used.
template <class Use>
Expected<void> forBatches(PointSource& source, const std::stop_token& stop, Use use) {
    PointBatch current, next;
    const auto readNext = [&] { return source.read(next); };
    Expected<bool> more = readNext();
    while (more && *more) {
        std::swap(current, next);
        auto reading = std::async(std::launch::async, readNext);
        Expected<void> used = use(current);
        more = reading.get();
        if (!used) return used;
        if (stop.stop_requested()) return interrupted();
    }
    if (!more) return passOn(more);
    return {};
}

/// Where there is a quicker way than reading everything.
using CountAhead = std::function<Expected<PointSurvey>()>;

class Exporter {
  public:
    Exporter(const OpenPoints& open, const ExportOptions& options, std::optional<PointSurvey> known,
             const CountAhead& count, const ProgressSink& progress, const std::stop_token& stop)
        : open_(open),
          options_(options),
          known_(std::move(known)),
          count_(count),
          progress_(progress),
          stop_(stop) {}

    Expected<ExportReport> run() {
        const auto start = std::chrono::steady_clock::now();
        auto output = OutputFile::create(options_.output);
        if (!output) return passOn(output);
        auto source = open_();
        if (!source) return passOn(source);
        auto ahead = surveyAhead(*source, output->seekable());
        if (!ahead) return passOn(ahead);
        if (!*source) source = open_();
        if (!source) return passOn(source);
        const ScanHeader header = (*source)->header();
        auto writer = createExport(options_.format, std::move(*output), header, *ahead);
        if (!writer) return passOn(writer);

        PointSurvey survey;
        const std::uint64_t total = header.points.value_or(known_ ? known_->points : 0);
        auto done = forBatches(**source, stop_, [&](const PointBatch& batch) -> Expected<void> {
            if (auto ok = (*writer)->write(batch); !ok) return ok;
            survey.add(batch, header);
            if (progress_) progress_({"exporting", survey.points, total, "points"});
            return {};
        });
        if (!done) return passOn(done);
        if (survey.points == 0) return fail(ErrorCode::Empty, "No point lies there; nothing was written.");
        if (auto ok = (*writer)->finish(survey); !ok) return passOn(ok);
        ExportReport report;
        report.points = survey.points;
        report.bytes = (*writer)->bytesWritten();
        report.losses = (*writer)->losses();
        if (const std::uint64_t dropped = (*source)->droppedPoints(); dropped > 0)
            report.losses.push_back(
                fmt::format("{} points without finite coordinates were left out", dropped));
        report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        return report;
    }

  private:
    /// What heads of files need to know before the points come. Counting uses the source up; it is null then.
    Expected<PointSurvey> surveyAhead(std::unique_ptr<PointSource>& source, bool seekable) {
        const ScanHeader& header = source->header();
        PointSurvey ahead = known_.value_or(PointSurvey{});
        if (header.points) ahead.points = *header.points;
        const bool hasHead = options_.format == ExportFormat::Las || options_.format == ExportFormat::Ply;
        const bool needsBounds = options_.format == ExportFormat::Las && !(header.gridStep.x > 0) && !known_;
        if (!(hasHead && !seekable) && !needsBounds) return ahead;
        if (count_) {
            auto survey = count_();
            if (survey && survey->points == 0)
                return fail(ErrorCode::Empty, "No point lies there; nothing was written.");
            return survey;
        }
        PointSurvey counted;
        counted.highestClass = ahead.highestClass;
        auto done = forBatches(*source, stop_, [&](const PointBatch& batch) -> Expected<void> {
            counted.add(batch, header);
            if (progress_) progress_({"counting", counted.points, header.points.value_or(0), "points"});
            return {};
        });
        source.reset();
        if (!done) return passOn(done);
        if (counted.points == 0) return fail(ErrorCode::Empty, "No point lies there; nothing was written.");
        return counted;
    }

    const OpenPoints& open_;
    const ExportOptions& options_;
    std::optional<PointSurvey> known_;
    const CountAhead& count_;
    const ProgressSink& progress_;
    const std::stop_token& stop_;
};

Expected<ExportReport> guardedExport(const OpenPoints& open, const ExportOptions& options,
                                     std::optional<PointSurvey> known, const CountAhead& count,
                                     const ProgressSink& progress, const std::stop_token& stop) {
    try {
        return Exporter(open, options, std::move(known), count, progress, stop).run();
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::ResourceLimit, "The machine has not enough memory for the export.");
    } catch (const std::exception& e) {
        return fail(ErrorCode::Internal, fmt::format("The export failed: {}.", e.what()));
    }
}

PointSurvey surveyOf(const CloudFacts& facts) {
    PointSurvey survey;
    survey.points = facts.points;
    survey.low = facts.bounds[0];
    survey.high = facts.bounds[1];
    survey.highestClass = 0;
    for (unsigned c = 0; c < facts.classCounts.size(); ++c)
        if (facts.classCounts[c] > 0) survey.highestClass = std::uint8_t(c);
    return survey;
}

struct NamedFormat {
    std::string_view end;
    ExportFormat format;
};
constexpr std::array formats{NamedFormat{".las", ExportFormat::Las}, NamedFormat{".ply", ExportFormat::Ply},
                             NamedFormat{".csv", ExportFormat::Csv}, NamedFormat{".txt", ExportFormat::Text},
                             NamedFormat{".xyz", ExportFormat::Text}};

struct ForeignFormat {
    std::string_view end, wayOut;
};
constexpr std::array foreignFormats{
    ForeignFormat{
        ".laz",
        "LAZ is not written here: write LAS, and compress it with \"pdal translate out.las out.laz\" "
        "or \"las2las -i out.las -o out.laz\""},
    ForeignFormat{
        ".e57",
        "E57 is not written here: write PLY or LAS, which what writes E57 reads, CloudCompare for one"},
    ForeignFormat{".pcd",
                  "PCD is not written here: write PLY, and turn that with \"pcl_ply2pcd out.ply out.pcd\""},
    ForeignFormat{
        ".copc",
        "COPC is not written here: write LAS, and \"untwine -i out.las -o out.copc.laz\" makes COPC of it"}};

}  // namespace

Expected<ExportFormat> exportFormatOf(const std::string& name) {
    std::string end = std::filesystem::path(name).extension().string();
    for (char& c : end)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    for (const NamedFormat& known : formats)
        if (known.end == end) return known.format;
    for (const ForeignFormat& foreign : foreignFormats)
        if (foreign.end == end)
            return fail(ErrorCode::Unsupported, name + ": " + std::string(foreign.wayOut) + ".", "output");
    return fail(ErrorCode::InvalidArgument,
                "The name '" + name +
                    "' does not tell the format; end it in .las, .ply, .csv, .txt or .xyz, or give --format.",
                "format");
}

CloudPointsOptions cloudPointsOptions(const ExportOptions& options, std::stop_token stop) {
    CloudPointsOptions what{
        .corridor = options.corridor, .estimatedNormals = options.estimatedNormals, .stop = std::move(stop)};
    if (!options.region.isEverything()) what.region = std::make_shared<RegionTest>(options.region);
    return what;
}

Expected<ExportReport> exportCloud(std::shared_ptr<const CloudFile> all, const ExportOptions& options,
                                   const ProgressSink& progress, std::stop_token stop) {
    const auto pictured = picturedLeaves(std::move(all), options.region.filter);
    if (!pictured) return passOn(pictured);
    const auto& file = *pictured;
    const CloudPointsOptions what = cloudPointsOptions(options, stop);
    const OpenPoints open = [&]() -> Expected<std::unique_ptr<PointSource>> {
        return cloudPoints(file, what);
    };
    const CountAhead count = [&]() -> Expected<PointSurvey> {
        SurveyAhead survey(file, what, options.format);
        for (;;) {
            auto more = survey.step();
            if (!more) return passOn(more);
            if (!*more) return survey.survey();
            if (stop.stop_requested()) return interrupted();
            if (progress) progress({"counting", survey.survey().points, file->facts().points, "points"});
        }
    };
    auto report = guardedExport(open, options, surveyOf(file->facts()), count, progress, stop);
    if (!report) return report;
    auto losses = lossesOf(*file, options);
    report->losses.insert(report->losses.begin(), losses.begin(), losses.end());
    return report;
}

Expected<ExportReport> exportScan(const OpenPoints& open, const ExportOptions& options,
                                  const ProgressSink& progress, std::stop_token stop) {
    if (!options.region.filter.empty())
        return fail(ErrorCode::Unsupported,
                    "filter: is for cloud files; ingest the scan with --keep-attributes, and export that.",
                    "filter");
    std::string format;
    const OpenPoints remembered = [&]() -> Expected<std::unique_ptr<PointSource>> {
        auto source = open();
        if (!source) return source;
        format = (*source)->header().format;
        return within(options.region, std::move(*source));
    };
    auto report = guardedExport(remembered, options, std::nullopt, {}, progress, stop);
    if (!report) return report;
    auto losses = lossesOfFormat(format);
    report->losses.insert(report->losses.begin(), losses.begin(), losses.end());
    return report;
}

}  // namespace scancast
