#include "renderer/cloud/import/text/ptx_source.hpp"

#include <fmt/format.h>

#include <cmath>
#include <glm/matrix.hpp>
#include <limits>

#include "renderer/cloud/import/lost_points.hpp"
#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/text/text_head.hpp"

namespace scancast {

namespace {

constexpr int headLines = 10;

/// The first line that is not empty, behind the head of the first scan.
std::string_view firstPoint(std::string_view text, char lineEnd) {
    for (int lines = 0; !text.empty();) {
        const auto line = takeLine(text, lineEnd);
        if (line.find_first_not_of(" \t") != line.npos && lines++ == headLines) return line;
    }
    return {};
}

Expected<TextLayout> layoutOf(std::string_view point, const std::string& name) {
    TextLayout layout;
    std::vector<std::string_view> fields;
    splitFields(point, layout.separator, fields);
    layout.columns = fields.size();
    layout.position = {0, 1, 2};
    switch (fields.size()) {
        case 3:
            return layout;
        case 4:
            layout.intensity = 3;
            return layout;
        case 6:
            layout.color = {3, 4, 5};
            return layout;
        case 7:
            layout.intensity = 3;
            layout.color = {4, 5, 6};
            return layout;
        default:
            break;
    }
    return fail(ErrorCode::Malformed,
                name + ": the first point has " + grouped(fields.size()) +
                    " columns; in PTX it is x y z, intensity and red green blue: 3, 4, 6 "
                    "or 7");
}

/// Of PTX, intensities are 0-1. Other programs' are told by their range.
IntensityScale ptxIntensity(std::span<const std::string_view> lines, const TextLayout& layout) {
    SeenValues seen;
    std::vector<std::string_view> fields;
    for (const auto line : lines) {
        splitFields(line, layout.separator, fields);
        if (fields.size() != layout.columns) continue;
        if (const auto number = numberIn(fields[3])) seen.see(*number, true);
    }
    return seen.least > seen.most ? IntensityScale::Unit : intensityScale(seen, false);
}

/// Does the text go on behind the first scan's points? A short one is counted; of a long one, lines from all
/// over it tell how many there must be. Never sure of a pipe.
bool seemsToGoOn(const TextLines& lines, std::span<const std::string> elsewhere, std::uint64_t points) {
    auto text = lines.start();
    const auto size = static_cast<double>(lines.bytesTotal());
    double there = 0;
    if (lines.bytesTotal() <= TextLines::peekBytes) {
        while (!text.empty()) there += takeLine(text, lines.lineEnd()).find_first_not_of(" \t") != text.npos;
        return lines.bytesTotal() > 0 && there > static_cast<double>(points) + headLines;
    }
    double bytes = 0;
    for (const auto& line : elsewhere) bytes += static_cast<double>(line.size() + 1);
    return bytes > 0 &&
           size / bytes * static_cast<double>(elsewhere.size()) > 1.2 * static_cast<double>(points);
}

}  // namespace

Expected<std::unique_ptr<PtxSource>> PtxSource::create(std::unique_ptr<ByteSource> bytes, std::string name,
                                                       bool recover) {
    TextLines lines(std::move(bytes), name);
    if (auto ok = lines.open(); !ok) return passOn(ok);
    auto text = lines.start();
    const auto point = firstPoint(text, lines.lineEnd());
    auto layout = point.empty() ? TextLayout{} : layoutOf(point, name);
    if (!layout) return passOn(layout);
    const auto elsewhere = lines.samples(lookedAtPlaces, lookedAtBytes);
    if (!elsewhere) return passOn(elsewhere);
    auto head = text;
    std::uint64_t points = 1;
    for (int i = 0; i < 2; ++i) points *= countIn(takeLine(head, lines.lineEnd())).value_or(0);
    const bool several = seemsToGoOn(lines, *elsewhere, points);
    if (layout->intensity != TextLayout::none) {
        std::vector<std::string_view> looked(elsewhere->begin(), elsewhere->end());
        text.remove_prefix(static_cast<std::size_t>(point.data() - text.data()));
        for (std::size_t i = 0; i < lookedAtLines && !text.empty(); ++i)
            looked.push_back(takeLine(text, lines.lineEnd()));
        layout->intensityScale = ptxIntensity(looked, *layout);
    }
    std::unique_ptr<PtxSource> source(
        new PtxSource(std::move(lines), std::move(name), TextRow(*layout, false)));
    source->recover_ = recover;
    if (auto ok = source->startScan(); !ok) return passOn(ok);
    if (source->promised_ > 0 && point.empty())
        return fail(ErrorCode::Truncated, fmt::format("{}the scan promises {} points, there are none",
                                                      source->lines_.place(), grouped(source->promised_)));
    source->scan_.format = "PTX: " + layout->describe();
    source->scan_.attributes = layout->attributes();
    if (!several) source->scan_.scannerOrigin = source->transform_[3];
    return source;
}

/// The next line that is not empty; it is part of a scan's head.
Expected<std::string_view> PtxSource::headLine(const char* what) {
    std::string_view line;
    for (;;) {
        const auto more = lines_.next(line);
        if (!more) return passOn(more);
        if (!*more)
            return fail(ErrorCode::Truncated,
                        lines_.place() + "the file ends where " + what + " of a scan should follow");
        if (line.find_first_not_of(" \t") != line.npos) return line;
    }
}

Expected<std::uint64_t> PtxSource::headCount(const char* what) {
    const auto line = headLine(what);
    if (!line) return passOn(line);
    const auto count = countIn(*line);
    if (count && *count <= std::numeric_limits<std::uint32_t>::max()) return *count;
    return fail(ErrorCode::Malformed,
                fmt::format("{}{} should be {} of a scan, one whole number; the scan before it may have more "
                            "points than its columns and rows promise",
                            lines_.place(), quotedText(*line), what));
}

Expected<void> PtxSource::headNumbers(const char* what, std::span<double> numbers) {
    const auto line = headLine(what);
    if (!line) return passOn(line);
    std::vector<std::string_view> fields;
    splitFields(*line, {}, fields);
    bool good = fields.size() == numbers.size();
    for (std::size_t i = 0; good && i < numbers.size(); ++i) {
        const auto number = numberIn(fields[i]);
        good = number && std::isfinite(*number);
        numbers[i] = number.value_or(0);
    }
    if (good) return {};
    return fail(ErrorCode::Malformed, fmt::format("{}{} should be {}: {} numbers", lines_.place(),
                                                  quotedText(*line), what, numbers.size()));
}

/// Reads the head of a scan. False at the end of the file.
Expected<bool> PtxSource::startScan() {
    const auto columns = headCount("the number of columns");
    // Behind the last scan there may be empty lines.
    if (!columns && columns.error().code == ErrorCode::Truncated && scans_ > 0) return false;
    if (!columns) return passOn(columns);
    const auto rows = headCount("the number of rows");
    if (!rows) return passOn(rows);
    promised_ = *columns * *rows;
    inScan_ = 0;
    std::array<double, 4> row{};
    for (const char* what :
         {"the scanner's position", "the scanner's x axis", "the scanner's y axis", "the scanner's z axis"})
        if (auto ok = headNumbers(what, std::span(row).first(3)); !ok) return passOn(ok);
    for (int i = 0; i < 4; ++i) {
        if (auto ok = headNumbers("a row of the matrix", row); !ok) return passOn(ok);
        if (std::abs(row[3] - (i == 3 ? 1 : 0)) > 1e-9)
            return fail(ErrorCode::Malformed,
                        fmt::format("{}the fourth number of the matrix's row {} must be {}", lines_.place(),
                                    i + 1, i == 3 ? 1 : 0));
        transform_[i] = {row[0], row[1], row[2]};
    }
    if (glm::determinant(glm::dmat3(transform_)) == 0)
        return fail(ErrorCode::Malformed, lines_.place() + "the scan's matrix flattens all points");
    if (++scans_ > 1) scan_.scannerOrigin.reset();
    stations_.push_back({.position = transform_[3], .forwards = unitVector(transform_[0])});
    return true;
}

/// The head of another scan may be what was cut: then those before it are all.
Expected<bool> PtxSource::startNextScan() {
    auto more = startScan();
    if (more || !recover_ || points_ == 0) return more;
    if (more.error().code != ErrorCode::Truncated && !lines_.lineIsOpen()) return more;
    notes_.push_back(noteOf(name_, "it ends too early, within the head of its scan " + grouped(scans_ + 1) +
                                       ", which is lost; how many points that has is not known"));
    promised_ = inScan_ = 0;  // and that is the end
    return false;
}

/// Without the one that was cut, where that is to be recovered from.
Expected<bool> PtxSource::nextLine(std::string_view& line) {
    auto more = lines_.next(line);
    if (more && *more && recover_ && lines_.lineIsOpen()) return false;
    return more;
}

Expected<bool> PtxSource::read(PointBatch& batch) {
    batch.clear();
    batch.scanner = transform_[3];
    std::string_view line;
    while (batch.size() < batchPoints) {
        if (inScan_ == promised_) {
            if (batch.size() > 0) return true;
            const auto more = startNextScan();
            if (!more) return passOn(more);
            if (*more) {
                batch.scanner = transform_[3];
                continue;
            }
            if (points_ == dropped_)
                return fail(ErrorCode::Empty,
                            fmt::format("{}: none of the {} directions of its scans has a point", name_,
                                        grouped(points_)));
            batch.scanner.reset();
            ended_ = true;
            return false;
        }
        const auto more = nextLine(line);
        if (!more) return passOn(more);
        if (!*more && recover_ && points_ > 0) {
            notes_.push_back(noteOf(name_, lostPoints("its scan " + grouped(scans_), promised_, inScan_)));
            promised_ = inScan_;  // and there is no next one
            continue;
        }
        if (!*more)
            return fail(ErrorCode::Truncated,
                        fmt::format("{}the file ends: its scan {} promises {} points, there are {}",
                                    lines_.place(), grouped(scans_), grouped(promised_), grouped(inScan_)));
        if (line.find_first_not_of(" \t") == line.npos) continue;
        const auto* why = row_.parse(line);
        if (why == nullptr) {
            const auto position = row_.position();
            const auto there = transform_ * glm::dvec4(position, 1);
            const bool point = position != glm::dvec3(0) && std::isfinite(there.x) &&
                               std::isfinite(there.y) && std::isfinite(there.z);
            if (point) why = row_.appendTo(batch, there);
            stations_.back().points += point && why == nullptr;
            dropped_ += !point;
        }
        if (why != nullptr) return fail(ErrorCode::Malformed, lines_.place() + *why);
        ++inScan_;
        ++points_;
    }
    return true;
}

}  // namespace scancast
