#include "renderer/cloud/import/assumed_crs.hpp"

#include <charconv>
#include <utility>

#include "renderer/cloud/forwarding_source.hpp"
#include "renderer/cloud/import/crs_meaning.hpp"
#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/cloud/import/lost_points.hpp"
#include "renderer/cloud/import/printable_text.hpp"
#include "renderer/cloud/import/wkt.hpp"

namespace scancast {

namespace {

constexpr std::size_t longestWkt = 65536;

std::optional<int> numberBehindEpsg(std::string_view text) {
    constexpr std::string_view prefix("EPSG:");
    for (std::size_t i = 0; i < prefix.size(); ++i)
        if (i >= text.size() || (text[i] & ~0x20) != (prefix[i] & ~0x20)) return std::nullopt;
    text.remove_prefix(prefix.size());
    int number = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool good =
        problem == std::errc() && end == text.data() + text.size() && number > 0 && number < 32767;
    return good ? std::optional(number) : std::nullopt;
}

bool isCrs(const WktNode& node) {
    if (node.keyword.starts_with("VERT") || node.keyword == "CS") return false;  // heights, axes
    return node.keyword.ends_with("CRS") || node.keyword.ends_with("CS") || node.keyword == "COMPD_CS";
}

class SourceWithCrs final : public ForwardingSource {
  public:
    SourceWithCrs(std::unique_ptr<PointSource> source, const AssumedCrs& crs, const std::string& name)
        : ForwardingSource(std::move(source)), header_(this->source().header()) {
        const auto own = crsMeaning(header_.crsWkt, header_.crsEpsg), taken = crsMeaning(crs.wkt, crs.epsg);
        if (own && taken && compare(*own, *taken) != CrsRelation::Same)
            note_ = noteOf(name, "it says that it is in " + nameOf(header_.crsWkt, header_.crsEpsg) + "; " +
                                     nameOf(crs.wkt, crs.epsg) + " is taken instead, as was asked for");
        header_.crsWkt = crs.wkt;
        header_.crsEpsg = crs.epsg;
    }

    /// A scanner's place may be forgotten while the scan is read.
    const ScanHeader& header() const override { return header_; }
    Expected<bool> read(PointBatch& batch) override {
        auto more = source().read(batch);
        header_.scannerOrigin = source().header().scannerOrigin;
        return more;
    }
    std::vector<std::string> notes() const override {
        auto notes = source().notes();
        if (!note_.empty()) notes.insert(notes.begin(), note_);
        return notes;
    }

  private:
    static std::string nameOf(const std::string& wkt, std::optional<int> epsg) {
        const auto name = crsName(wkt, epsg);
        return name.empty() ? "a CRS without a name" : name;
    }

    ScanHeader header_;
    std::string note_;
};

}  // namespace

Expected<AssumedCrs> parseCrs(std::string_view text) {
    if (const auto number = numberBehindEpsg(text)) return AssumedCrs{{}, number};
    if (text.size() <= longestWkt) {
        const auto wkt = printableText(text, longestWkt);
        if (const auto root = parseWkt(wkt); root && isCrs(*root)) return AssumedCrs{wkt, epsgOfWkt(wkt)};
    }
    return fail(ErrorCode::InvalidArgument,
                quotedText(text) +
                    " is no coordinate reference system: give its number, such as EPSG:25832, or a whole WKT",
                "assume-crs");
}

std::unique_ptr<PointSource> withCrs(std::unique_ptr<PointSource> source, const AssumedCrs& crs,
                                     const std::string& name) {
    return std::make_unique<SourceWithCrs>(std::move(source), crs, name);
}

}  // namespace scancast
