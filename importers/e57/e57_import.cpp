#include "importers/e57/e57_import.hpp"

#include <fmt/format.h>

#include <optional>
#include <unordered_map>
#include <vector>

#include "importers/e57/import_plan.hpp"
#include "importers/e57/photos.hpp"
#include "importers/e57/scan_converter.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_e57 {

namespace {

/// Where scans were taken from, those of which it is known.
class Stations {
  public:
    explicit Stations(const FileDescription& description) {
        for (const auto& scan : description.scans) {
            std::optional<std::uint32_t> number;
            if (scan.records > 0 && scan.hasCoordinates() && scan.standsAtOrigin()) {
                number = static_cast<std::uint32_t>(all_.size());
                Station station{.name = scan.name, .position = scan.inFile(glm::dvec3(0))};
                if (scan.pose) station.forwards = unitVector(scan.pose->rotation * glm::dvec3(1, 0, 0));
                all_.push_back(std::move(station));
                if (!scan.guid.empty()) byGuid_.emplace(scan.guid, *number);
            }
            numbers_.push_back(number);
        }
    }

    bool empty() const { return all_.empty(); }
    /// Of the scan that a photo names.
    std::optional<std::uint32_t> of(const std::string& guid) const {
        const auto found = byGuid_.find(guid);
        return found != byGuid_.end() ? std::optional(found->second) : std::nullopt;
    }
    Expected<void> send(PointStreamWriter& writer) const {
        for (const auto& station : all_)
            if (auto ok = writer.writeStation(station); !ok) return ok;
        return {};
    }
    std::optional<std::uint32_t> of(std::size_t scan) const { return numbers_[scan]; }

  private:
    std::vector<Station> all_;
    std::vector<std::optional<std::uint32_t>> numbers_;  ///< by scan
    std::unordered_map<std::string, std::uint32_t> byGuid_;
};

Expected<void> sendScans(PagedFile& file, const FileDescription& description, const ImportPlan& plan,
                         const Stations& stations, PointStreamWriter& writer, Counts& counts) {
    PointBatch batch;
    for (std::size_t i = 0; i < description.scans.size(); ++i) {
        if (description.scans[i].records == 0 || !description.scans[i].hasCoordinates()) continue;
        const auto scan = asRead(description.scans[i], plan);
        auto reader = RecordReader::open(file, scan, wantedFields(scan, plan), description.called(i));
        if (!reader) return passOn(reader);
        if (!stations.empty()) {
            if (auto ok = writer.writeChunk(batch); !ok) return ok;
            batch.clear();
            if (auto ok = writer.writeFrom(stations.of(i)); !ok) return ok;
        }
        ScanConverter converter(scan, plan, i + 1, counts);
        for (;;) {
            const auto records = reader->next();
            if (!records) return passOn(records);
            if (*records == 0) break;
            converter.append(*reader, batch);
            if (batch.size() + RecordReader::blockRecords <= PointSource::batchPoints) continue;
            if (auto ok = writer.writeChunk(batch); !ok) return ok;
            batch.clear();
        }
    }
    return writer.writeChunk(batch);
}

Expected<void> noteCounts(const Counts& counts, PointStreamWriter& writer) {
    const std::pair<std::uint64_t, const char*> lines[] = {
        {counts.marked, "left out, marked as no points in the file"},
        {counts.colorless, "with a colour that is marked as invalid in the file, black here"},
        {counts.intensityless, "with an intensity that is marked as invalid in the file, 0 here"},
    };
    for (const auto& [count, text] : lines) {
        if (count == 0) continue;
        const auto note = fmt::format("{} {} {}", grouped(count), count == 1 ? "point" : "points", text);
        if (auto ok = writer.writeNote(note); !ok) return ok;
    }
    return {};
}

}  // namespace

Expected<void> importE57(std::unique_ptr<ByteSource> bytes, const Choices& choices,
                         PointStreamWriter& writer) {
    auto file = PagedFile::open(std::move(bytes), choices.recover);
    if (!file) return passOn(file);
    const auto description = describeFile(*file);
    if (!description) return passOn(description);
    const auto plan = planImport(*file, *description, choices.keepAttributes);
    if (!plan) return passOn(plan);
    const Stations stations(*description);
    Photos photos(*file, description->photos, description->morePhotos,
                  [&](const std::string& guid) { return stations.of(guid); });
    const auto begun = plan->asSteps ? writer.writeHeaderOfSteps(plan->header)
                                     : writer.writeHeader(plan->header, !stations.empty() || !photos.empty());
    if (!begun) return begun;
    if (auto ok = stations.send(writer); !ok) return ok;
    if (auto ok = photos.describe(writer); !ok) return ok;
    for (const auto& note : plan->notes)
        if (auto ok = writer.writeNote(note); !ok) return ok;
    Counts counts;
    if (auto ok = sendScans(*file, *description, *plan, stations, writer, counts); !ok) return ok;
    if (auto ok = photos.send(writer); !ok) return ok;
    if (auto ok = noteCounts(counts, writer); !ok) return ok;
    return writer.finish(counts.marked + counts.notFinite);
}

}  // namespace scancast::import_e57
