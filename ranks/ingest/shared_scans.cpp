#include "ranks/ingest/shared_scans.hpp"

#include <algorithm>
#include <glm/common.hpp>
#include <optional>

#include "ranks/ingest/archive.hpp"
#include "renderer/cloud/exact_scan.hpp"
#include "renderer/cloud/forwarding_source.hpp"

namespace scancast {

/// What a scan says of itself at its end, in whatever parts it was read.
struct ToldByScan {
    std::uint64_t dropped = 0;
    std::vector<std::string> notes;
    std::vector<Station> stations;
    std::optional<glm::dvec3> scanner;
    SeenOfScan seen;
};

/// A scan of which this rank reads a share, perhaps nothing.
class ShareOfScan final : public ForwardingSource {
  public:
    ShareOfScan(std::unique_ptr<PointSource> source, const ReadingShare& share)
        : ForwardingSource(std::move(source)), share_(share), header_(this->source().header()) {
        if (share_.reads() && !share_.all) this->source().readPart(share_.first, share_.count);
    }

    const ScanHeader& header() const override { return header_; }
    Expected<bool> read(PointBatch& batch) override {
        if (!share_.reads()) {
            batch.clear();
            return false;
        }
        auto more = source().read(batch);
        header_.scannerOrigin = source().header().scannerOrigin;
        return more;
    }
    std::uint64_t droppedPoints() const override { return told_ ? told_->dropped : source().droppedPoints(); }
    std::vector<std::string> notes() const override { return told_ ? told_->notes : source().notes(); }
    std::vector<Station> stations() const override { return told_ ? told_->stations : source().stations(); }

    const ReadingShare& share() const { return share_; }
    void hear(ToldByScan told) {
        header_.scannerOrigin = told.scanner;
        told_ = std::move(told);
    }

  private:
    const ReadingShare share_;
    ScanHeader header_;
    std::optional<ToldByScan> told_;  ///< by all who read of it
};

namespace {

constexpr const char* otherFiles =
    "The ranks do not see the same scans: each needs all files, the same ones, under the same names.";

/// Everything that the shares depend on.
RankBytes signatureOf(const std::vector<std::unique_ptr<PointSource>>& sources) {
    BytesOut out;
    for (const auto& source : sources) {
        const ScanHeader& h = source->header();
        out(h.format);
        out(h.points.has_value());
        out(h.points.value_or(0));
        out(h.gridStep);
        out(h.gridOrigin);
        out(h.crsWkt);
        out(std::uint64_t(rowBytes(h.columns)));
        out(source->hasParts());
        out(std::uint64_t(source->photos().size()));
    }
    return out.take();
}

Expected<void> checkSameScans(const std::vector<std::unique_ptr<PointSource>>& sources,
                              const Communicator& ranks) {
    const RankBytes mine = signatureOf(sources);
    RankBytes first = mine;
    if (auto ok = ranks.broadcast(first); !ok) return ok;
    return ranks.agree(first == mine ? Expected<void>() : fail(ErrorCode::InvalidArgument, otherFiles));
}

void pack(const Station& station, BytesOut& out) {
    out(station.name);
    out(station.position);
    out(station.points);
    out(station.forwards.has_value());
    out(station.forwards.value_or(glm::dvec3(0)));
}

Station unpackStation(BytesIn& in) {
    Station station;
    in(station.name);
    in(station.position);
    in(station.points);
    const bool has = in.get<bool>();
    const auto forwards = in.get<glm::dvec3>();
    if (has) station.forwards = forwards;
    return station;
}

}  // namespace

Expected<SharedScans> SharedScans::create(std::vector<std::unique_ptr<PointSource>> sources,
                                          const IngestOptions& options, const Communicator& ranks) {
    if (auto ok = checkSameScans(sources, ranks); !ok) return passOn(ok);
    const bool onOneGrid = shareOneGrid(sources);
    std::vector<ReadableScan> readable;
    for (const auto& source : sources)
        readable.push_back(
            {source->header().points, source->hasParts(), options.photos && !source->photos().empty()});
    const auto shares = shareReading(readable, ranks.rank(), ranks.size());
    SharedScans shared;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        shared.pointsToRead_ += shares[i].all ? sources[i]->header().points.value_or(0) : shares[i].count;
        auto share = std::make_unique<ShareOfScan>(std::move(sources[i]), shares[i]);
        shared.shares_.push_back(share.get());
        sources[i] = std::move(share);
    }
    auto many = manyScansInPart(std::move(sources), options.names);
    if (!many) return passOn(many);
    shared.many_ = many->get();
    shared.source_ = std::move(*many);
    if (options.shape.exact) shared.source_ = exactScan(std::move(shared.source_), onOneGrid);
    return shared;
}

Expected<void> SharedScans::hearOthers(const Communicator& ranks) {
    BytesOut out;
    for (std::size_t i = 0; i < shares_.size(); ++i) {
        const ShareOfScan& scan = *shares_[i];
        if (!scan.share().reads()) continue;
        out(std::uint64_t(i));
        out(scan.droppedPoints());
        out(many_->seen()[i]);
        out(scan.share().tells());
        if (!scan.share().tells()) continue;
        out(scan.header().scannerOrigin.has_value());
        out(scan.header().scannerOrigin.value_or(glm::dvec3(0)));
        const auto notes = scan.notes();
        out(std::uint64_t(notes.size()));
        for (const std::string& note : notes) out(note);
        const auto stations = scan.stations();
        out(std::uint64_t(stations.size()));
        for (const Station& station : stations) pack(station, out);
    }
    const auto gathered = ranks.gather(out.take());
    if (!gathered) return passOn(gathered);
    RankBytes all;
    for (const RankBytes& one : *gathered) all.insert(all.end(), one.begin(), one.end());
    if (auto ok = ranks.broadcast(all); !ok) return ok;

    std::vector<ToldByScan> told(shares_.size());
    BytesIn in(all);
    while (in.isSound() && !in.isAtEnd()) {
        const auto i = in.get<std::uint64_t>();
        if (i >= told.size()) return fail(ErrorCode::Internal, otherFiles);
        ToldByScan& scan = told[i];
        scan.dropped += in.get<std::uint64_t>();
        const auto seen = in.get<SeenOfScan>();
        scan.seen.box[0] = glm::min(scan.seen.box[0], seen.box[0]);
        scan.seen.box[1] = glm::max(scan.seen.box[1], seen.box[1]);
        scan.seen.highestInfrared = std::max(scan.seen.highestInfrared, seen.highestInfrared);
        if (!in.get<bool>()) continue;
        const bool hasScanner = in.get<bool>();
        const auto scanner = in.get<glm::dvec3>();
        if (hasScanner) scan.scanner = scanner;
        for (auto n = in.get<std::uint64_t>(); in.isSound() && n > 0; --n)
            scan.notes.push_back(in.get<std::string>());
        for (auto n = in.get<std::uint64_t>(); in.isSound() && n > 0; --n)
            scan.stations.push_back(unpackStation(in));
    }
    if (auto ok = in.finish(); !ok) return ok;
    for (std::size_t i = 0; i < shares_.size(); ++i) {
        many_->seen()[i] = told[i].seen;
        shares_[i]->hear(std::move(told[i]));
    }
    return many_->judge();
}

}  // namespace scancast
