#include "renderer/cloud/import/text/text_source.hpp"

#include "renderer/cloud/import/lost_points.hpp"
#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/text/text_head.hpp"

namespace scancast {

namespace {

// The first lines, and a few from places all over a file.

}  // namespace

Expected<std::unique_ptr<TextSource>> TextSource::create(std::unique_ptr<ByteSource> bytes, std::string name,
                                                         const TextOptions& options) {
    TextLines lines(std::move(bytes), name);
    if (auto ok = lines.open(); !ok) return passOn(ok);
    const auto start = lines.start();
    const auto head = readTextHead(start, lines.lineEnd(), name);
    if (!head) return passOn(head);

    std::vector<std::string_view> looked;
    auto body = start.substr(head->bytes);
    // Of a text that was cut, the last line says nothing certain.
    if (options.recover && body.find(lines.lineEnd()) != body.npos)
        body = body.substr(0, body.rfind(lines.lineEnd()) + 1);
    for (auto text = body; !text.empty() && looked.size() < lookedAtLines;)
        looked.push_back(takeLine(text, lines.lineEnd()));
    const auto elsewhere = lines.samples(lookedAtPlaces, lookedAtBytes);
    if (!elsewhere) return passOn(elsewhere);
    for (const auto& line : *elsewhere) looked.push_back(line);
    // The next count of a file with several scans is no point.
    if (head->count) std::erase_if(looked, [](std::string_view line) { return countIn(line).has_value(); });
    const bool pts = options.pts || head->count.has_value();
    auto layout = understandColumns(*head, looked, pts, name);
    if (!layout) return passOn(layout);

    std::unique_ptr<TextSource> source(
        new TextSource(std::move(lines), std::move(name), TextRow(*layout, options.keepAttributes)));
    source->scan_.format = (pts ? "PTS: " : "text: ") + layout->describe();
    source->scan_.attributes = layout->attributes();
    if (options.keepAttributes) source->scan_.columns = keptTextColumns(*layout);
    std::string_view passed;
    for (std::uint64_t i = 0; i < head->lines; ++i)
        if (auto ok = source->lines_.next(passed); !ok) return passOn(ok);
    source->recover_ = options.recover;
    source->counted_ = head->count.has_value();
    source->promised_ = head->count.value_or(0);
    return source;
}

Expected<bool> TextSource::read(PointBatch& batch) {
    batch.clear();
    std::string_view line;
    while (batch.size() < batchPoints) {
        const auto more = lines_.next(line);
        if (!more) return passOn(more);
        if (!*more) {
            if (auto ok = finishScan(); !ok) return passOn(ok);
            if (batch.size() == 0 && points_ == dropped_)
                return fail(ErrorCode::Empty,
                            name_ + ": none of its " + grouped(points_) + " points has finite coordinates");
            return batch.size() > 0;
        }
        if (isComment(line)) continue;
        if (recover_ && lines_.lineIsOpen() && (counted_ || points_ > 0)) {
            if (!counted_)
                notes_.push_back(
                    noteOf(name_,
                           "its last line has no end, so that nobody knows whether it is whole, and is "
                           "left out; how many points are lost behind it is not known"));
            continue;
        }
        if (counted_) {
            if (const auto count = countIn(line)) {
                if (auto ok = startScan(*count); !ok) return passOn(ok);
                continue;
            }
        }
        const auto* why = row_.parse(line);
        if (why == nullptr && row_.finite()) {
            why = row_.appendTo(batch, row_.position());
        } else {
            dropped_ += why == nullptr;
        }
        if (why != nullptr) return fail(ErrorCode::Malformed, lines_.place() + *why);
        ++inScan_;
        ++points_;
    }
    return true;
}

Expected<void> TextSource::startScan(std::uint64_t points) {
    if (auto ok = finishScan(); !ok) return ok;
    promised_ = points;
    inScan_ = 0;
    return {};
}

/// Fewer points than promised: something is lost. More: the count is wrong and nothing is lost; real files
/// have it.
Expected<void> TextSource::finishScan() {
    if (!counted_ || inScan_ >= promised_) return {};
    if (recover_ && points_ > 0) {
        notes_.push_back(
            noteOf(name_, lostPoints(inScan_ == points_ ? "it" : "one of its scans", promised_, inScan_)));
        promised_ = inScan_;
        return {};
    }
    return fail(ErrorCode::Truncated, lines_.place() + "the count of points promises " + grouped(promised_) +
                                          ", there are " + grouped(inScan_));
}

}  // namespace scancast
