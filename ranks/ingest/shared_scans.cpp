#include "ranks/ingest/shared_scans.hpp"

#include <algorithm>
#include <glm/common.hpp>
#include <optional>

#include "ranks/ingest/archive.hpp"
#include "renderer/cloud/exact_scan.hpp"
#include "renderer/cloud/forwarding_source.hpp"
#include "renderer/cloud/import/las/las_reader.hpp"
#include "server/server.hpp"

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
        : ForwardingSource(std::move(source)),
          share_(share),
          header_(this->source().header()),
          hasParts_(this->source().hasParts()) {
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
    /// Several ranks may have read it, and what is an error of the whole is none of a part's.
    Expected<void> checkWhole(const std::string& name) const {
        const std::uint64_t points = header_.points.value_or(0);
        if (share_.all || !hasParts_ || points == 0 || droppedPoints() < points) return {};
        return tl::unexpected(noFinitePoint(name, points));
    }
    void hear(ToldByScan told) {
        header_.scannerOrigin = told.scanner;
        told_ = std::move(told);
    }

  private:
    const ReadingShare share_;
    ScanHeader header_;
    const bool hasParts_;
    std::optional<ToldByScan> told_;  ///< by all who read of it
};

namespace {

constexpr const char* otherFiles =
    "The ranks do not see the same scans: each needs all files, the same ones, under the same names.";
constexpr const char* otherOptions =
    "The ranks were not started alike: each needs the same version of the program, and the same options.";

template <class T>
void pack(const std::optional<T>& value, BytesOut& out) {
    out(value.has_value());
    if (value) out(*value);
}

/// Everything that is known of the scans before they are read: shares, merging and the shape of rows depend on it, and other files of the
/// same names differ in it.
RankBytes signatureOf(const std::vector<std::unique_ptr<PointSource>>& sources) {
    BytesOut out;
    for (const auto& source : sources) {
        const ScanHeader& h = source->header();
        out(h.format);
        pack(h.points, out);
        for (const bool has : {h.attributes.color, h.attributes.intensity, h.attributes.classification,
                               h.attributes.normal, h.attributes.nearInfrared})
            out(has);
        out(h.gridStep);
        out(h.gridOrigin);
        pack(h.bounds, out);
        out(h.crsWkt);
        pack(h.crsEpsg, out);
        pack(h.scannerOrigin, out);
        for (const Column& column : h.columns) {
            out(column.name);
            out(column.type);
            out(column.scale);
            out(column.offset);
        }
        out(source->hasParts());
        out(source->wantsToBeSeen());
        out(std::uint64_t(source->photos().size()));
    }
    return out.take();
}

/// Everything of the options that decides what is built.
RankBytes signatureOf(const IngestOptions& options) {
    BytesOut out;
    out(std::string(scancastVersion()));
    const OctreeShape& shape = options.shape;
    for (const bool is : {shape.surfels, shape.curvature, shape.exact, options.photos}) out(is);
    out(shape.leafPoints);
    out(shape.chunkPoints);
    out(shape.neighbours);
    out(shape.orientation);
    return out.take();
}

/// What only all points of a file tell: each rank looks at its part.
Expected<void> seeTogether(std::span<const std::unique_ptr<PointSource>> sources, const Communicator& ranks) {
    std::vector<std::uint64_t> highest;
    Expected<void> done;
    for (const auto& source : sources) {
        if (!source->wantsToBeSeen() || !done) continue;
        const ReadableScan scan{.points = source->header().points, .hasParts = source->hasParts()};
        const ReadingShare share = shareReading(std::span(&scan, 1), ranks.rank(), ranks.size()).front();
        const auto seen = source->lookAt(share.first, share.count);
        if (seen)
            highest.push_back(*seen);
        else
            done = passOn(seen);
    }
    if (auto ok = ranks.agree(done); !ok) return ok;
    if (highest.empty()) return {};  // the same on all ranks
    if (auto ok = ranks.max(highest); !ok) return ok;
    std::size_t next = 0;
    for (const auto& source : sources)
        if (source->wantsToBeSeen()) source->hasSeen(std::uint16_t(highest[next++]));
    return {};
}

Expected<void> checkSame(const RankBytes& mine, const char* otherwise, const Communicator& ranks) {
    RankBytes first = mine;
    if (auto ok = ranks.broadcast(first); !ok) return ok;
    return ranks.agree(first == mine ? Expected<void>() : fail(ErrorCode::InvalidArgument, otherwise));
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
    if (auto ok = checkSame(signatureOf(options), otherOptions, ranks); !ok) return passOn(ok);
    if (auto ok = checkSame(signatureOf(sources), otherFiles, ranks); !ok) return passOn(ok);
    if (auto ok = seeTogether(sources, ranks); !ok) return passOn(ok);
    const bool onOneGrid = shareOneGrid(sources);
    std::vector<ReadableScan> readable;
    for (const auto& source : sources)
        readable.push_back(
            {source->header().points, source->hasParts(), options.photos && !source->photos().empty()});
    const auto shares = shareReading(readable, ranks.rank(), ranks.size());
    SharedScans shared;
    shared.names_ = options.names;
    for (std::size_t i = 0; i < sources.size(); ++i) {
        shared.pointsToRead_ += shares[i].all ? sources[i]->header().points.value_or(0) : shares[i].count;
        auto share = std::make_unique<ShareOfScan>(std::move(sources[i]), shares[i]);
        shared.shares_.push_back(share.get());
        sources[i] = std::move(share);
    }
    auto many = ranks.agree(manyScansInPart(std::move(sources), options.names));
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
        const auto notes = scan.notes();
        out(std::uint64_t(notes.size()));
        for (const std::string& note : notes) out(note);
        out(scan.share().tells());
        if (!scan.share().tells()) continue;
        out(scan.header().scannerOrigin.has_value());
        out(scan.header().scannerOrigin.value_or(glm::dvec3(0)));
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
        // What a scan says as a whole all who read of it say alike; what one of them met alone is told, too.
        for (auto n = in.get<std::uint64_t>(); in.isSound() && n > 0; --n)
            if (auto note = in.get<std::string>(); std::ranges::find(scan.notes, note) == scan.notes.end())
                scan.notes.push_back(std::move(note));
        if (!in.get<bool>()) continue;
        const bool hasScanner = in.get<bool>();
        const auto scanner = in.get<glm::dvec3>();
        if (hasScanner) scan.scanner = scanner;
        for (auto n = in.get<std::uint64_t>(); in.isSound() && n > 0; --n)
            scan.stations.push_back(unpackStation(in));
    }
    if (auto ok = in.finish(); !ok) return ok;
    for (std::size_t i = 0; i < shares_.size(); ++i) {
        many_->seen()[i] = told[i].seen;
        shares_[i]->hear(std::move(told[i]));
        if (auto ok = shares_[i]->checkWhole(i < names_.size() ? names_[i] : std::string()); !ok) return ok;
    }
    return many_->judge();
}

}  // namespace scancast
