#include "importers/e57/e57_import.hpp"

#include <fmt/format.h>

#include "importers/e57/import_plan.hpp"
#include "importers/e57/scan_converter.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_e57 {

namespace {

Expected<void> sendScans(PagedFile& file, const FileDescription& description, const ImportPlan& plan,
                         PointStreamWriter& writer, Counts& counts) {
    PointBatch batch;
    for (std::size_t i = 0; i < description.scans.size(); ++i) {
        const auto& scan = description.scans[i];
        if (scan.records == 0 || !scan.hasCoordinates()) continue;
        auto reader = RecordReader::open(file, scan, wantedFields(scan, plan), description.called(i));
        if (!reader) return passOn(reader);
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

Expected<void> importE57(std::unique_ptr<ByteSource> bytes, bool keepAttributes, PointStreamWriter& writer) {
    auto file = PagedFile::open(std::move(bytes));
    if (!file) return passOn(file);
    const auto description = describeFile(*file);
    if (!description) return passOn(description);
    const auto plan = planImport(*file, *description, keepAttributes);
    if (!plan) return passOn(plan);
    if (auto ok = writer.writeHeader(plan->header); !ok) return ok;
    for (const auto& note : plan->notes)
        if (auto ok = writer.writeNote(note); !ok) return ok;
    Counts counts;
    if (auto ok = sendScans(*file, *description, *plan, writer, counts); !ok) return ok;
    if (auto ok = noteCounts(counts, writer); !ok) return ok;
    return writer.finish(counts.marked + counts.notFinite);
}

}  // namespace scancast::import_e57
