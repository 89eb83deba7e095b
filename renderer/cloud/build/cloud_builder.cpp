#include "renderer/cloud/build/cloud_builder.hpp"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "renderer/cloud/build/chunks/staging.hpp"
#include "renderer/cloud/exact_columns.hpp"

namespace scancast {

namespace {

/// Median of the leaves' spacings, each leaf counting as many times as it has points.
double typicalSpacing(const BuiltOctree& octree) {
    std::vector<std::pair<float, std::uint64_t>> leaves;
    std::uint64_t points = 0;
    for (const StoredNode& n : octree.nodes) {
        if (!n.node.isLeaf()) continue;
        leaves.emplace_back(n.node.meanSpacing, n.node.points);
        points += n.node.points;
    }
    std::sort(leaves.begin(), leaves.end());
    std::uint64_t below = 0;
    for (const auto& [spacing, count] : leaves) {
        below += count;
        if (2 * below >= points) return spacing;
    }
    return 0;
}

/// The staged batches as they stand on the grid.
class StagedPortions final : public PointPortions {
  public:
    StagedPortions(StagedScan& scan, const ScanHeader& header, const Grid& grid)
        : scan_(scan), header_(header), grid_(grid) {}

    std::size_t size() const override { return scan_.batches.size(); }
    Expected<void> read(std::size_t index, Portion& into) const override {
        thread_local std::vector<std::byte> space;
        const StagedBatch& batch = scan_.batches[index];
        const auto bytes = batch.bytes.view(space);
        if (!bytes) return passOn(bytes);
        into.points.resize(batch.points);
        placeOnGrid(batch, *bytes, scan_, header_, grid_, into.points);
        const auto rows = rowsOf(batch, *bytes);
        into.rows.assign(rows.begin(), rows.end());
        return {};
    }
    void release(std::size_t index) override { scan_.batches[index].bytes.clear(); }

  private:
    StagedScan& scan_;
    const ScanHeader& header_;
    const Grid& grid_;
};

/// The box of the scan on its grid: exact on its own grid, else a step larger at most.
GridBox boxOf(const StagedScan& scan, const Grid& grid) {
    GridBox box;
    for (const glm::dvec3& corner : scan.bounds) {
        GridPosition p;
        for (int a = 0; a < 3; ++a)
            p[a] = std::uint64_t(std::max(0.0, std::nearbyint((corner[a] - grid.corner[a]) / grid.step[a])));
        box.add(p);
    }
    return box;
}

std::vector<std::string> firstNotes(std::vector<std::string> notes) {
    if (notes.size() <= mostCloudNotes) return notes;
    const std::size_t more = notes.size() - (mostCloudNotes - 1);
    notes.resize(mostCloudNotes - 1);
    notes.push_back(fmt::format("there are {} notes more", more));
    return notes;
}

std::vector<std::string> notesOf(const StagedScan& scan) {
    auto notes = scan.notes;
    for (std::string& note : scan.values.notes(scan.points)) notes.push_back(std::move(note));
    if (scan.stations.size() > mostStations)
        notes.insert(notes.begin(),
                     fmt::format("the scanner stood at {} places, of which the first {} are listed",
                                 scan.stations.size(), mostStations));
    if (scan.photos.size() > mostPhotos)
        notes.insert(notes.begin(), fmt::format("there are {} photos, of which the first {} are kept",
                                                scan.photos.size(), mostPhotos));
    return notes;
}

std::vector<Station> firstStations(std::vector<Station> stations) {
    if (stations.size() > mostStations) stations.resize(mostStations);
    return stations;
}

/// Of the stations that are listed.
std::vector<Photo> firstPhotos(std::vector<Photo> photos) {
    if (photos.size() > mostPhotos) photos.resize(mostPhotos);
    for (Photo& photo : photos)
        if (photo.station && *photo.station >= mostStations) photo.station.reset();
    return photos;
}

/// Surveyors' z is up; of other files nobody knows.
bool saysWhatIsUp(const ScanHeader& header) {
    if (header.crsEpsg || !header.crsWkt.empty()) return true;
    constexpr std::array<std::string_view, 5> formats{"LAS", "LAZ", "COPC", "EPT", "Potree"};
    return std::ranges::any_of(formats, [&](std::string_view f) { return header.format.starts_with(f); });
}

/// Else they are among the columns.
bool keepsGridPositions(const ScanHeader& header) {
    return !findColumns(header.columns, exactPositionNames, ColumnType::Float64);
}

/// What is known before anybody looks at the points.
std::optional<KnownSides> knownSides(const StagedScan& scan, const ScanHeader& header,
                                     const OctreeShape& shape) {
    if (header.attributes.normal) return KnownSides{KnownSides::By::File, 1};
    if (!shape.surfels) return std::nullopt;
    if (shape.orientation == Orientation::Up) return KnownSides{KnownSides::By::Up, 1};
    // One point more that nobody knows it of, and neighbours decide of all: they agree with each other.
    if (header.scannerOrigin || scan.sighted == scan.points) return KnownSides{KnownSides::By::Scanner, 1};
    return std::nullopt;
}

/// Whether normals will be estimated that may have to be turned to where each point was recorded from.
bool wantsSights(const ScanHeader& header, const OctreeShape& shape) {
    return shape.surfels && !header.attributes.normal && shape.orientation != Orientation::Up;
}

CloudFacts factsOf(const StagedScan& scan, const ScanHeader& header, const OctreeShape& shape) {
    CloudFacts facts;
    facts.format = header.format;
    facts.bounds = scan.bounds;
    facts.origin = roundOrigin(scan.bounds);
    facts.points = scan.points;
    facts.droppedPoints = scan.droppedPoints;
    facts.attributes = header.attributes;
    facts.attributes.normal |= shape.surfels;
    scan.values.settle(facts);
    facts.notes = firstNotes(notesOf(scan));
    facts.classCounts = scan.classCounts;
    facts.crsWkt = header.crsWkt;
    facts.crsEpsg = header.crsEpsg;
    facts.surfels = shape.surfels;
    facts.sides = knownSides(scan, header, shape);
    facts.oriented = facts.sides.has_value();
    facts.scanner = header.scannerOrigin;
    facts.stations = firstStations(scan.stations);
    facts.photos = firstPhotos(scan.photos);
    for (std::size_t c = 0; c < header.columns.size(); ++c)
        facts.columns.push_back({header.columns[c], scan.columnRanges[c], scan.columnSketches[c].usual()});
    if (scan.onOwnGrid) facts.grid = ScanGrid{header.gridOrigin, header.gridStep};
    facts.exact = shape.exact;
    if (shape.exact && keepsGridPositions(header))
        for (ValuePlane& plane : gridPlanes()) facts.companions.push_back(std::move(plane));
    if (shape.curvatures()) facts.companions.push_back(curvaturePlane());
    if (facts.attributes.nearInfrared) facts.companions.push_back(nearInfraredPlane());
    return facts;
}

OctreeInput inputOf(const CloudFacts& facts, const StagedScan& scan, const ScanHeader& header,
                    const OctreeShape& shape, const Grid& grid) {
    OctreeInput input;
    input.grid = grid;
    input.gridPlanes = hasGridPlanes(facts);
    input.ownLow = scan.ownLow;
    input.origin = facts.origin;
    input.attributes = facts.attributes;
    input.ownNormals = header.attributes.normal;
    input.oriented = facts.oriented;
    input.upIsZ = saysWhatIsUp(header);
    input.findSides = shape.surfels && !facts.oriented && shape.orientation == Orientation::Auto;
    if (header.scannerOrigin) input.scanner = *header.scannerOrigin - facts.origin;
    input.sights = wantsSights(header, shape) && !header.scannerOrigin && !input.findSides;
    input.shape = shape;
    std::vector<ColumnType> types;
    for (const Column& column : header.columns) types.push_back(column.type);
    if (header.attributes.nearInfrared) types.push_back(ColumnType::Uint16);
    input.columns = placesInRow(types);
    input.rowBytes = stagedRowBytes(header);
    if (!header.attributes.nearInfrared) return input;
    if (facts.attributes.nearInfrared)
        input.nearInfrared = InfraredInRow{input.columns.back(), scan.values.nearInfraredShift()};
    input.columns.pop_back();
    return input;
}

}  // namespace

Expected<BuiltCloud> buildFrom(PointSource& source, const OctreeShape& shape, const BuildRoom& room,
                               const ProgressSink& progress, const std::stop_token& stop) {
    ScanHeader header = source.header();
    ProgressMeter reading(progress, "reading", header.points.value_or(0));
    auto scan = stage(source, room.workspace, reading, stop, wantsSights(header, shape));
    if (!scan) return passOn(scan);
    header.scannerOrigin =
        source.header().scannerOrigin;  // known for certain only now: a second scan may have come

    if (shape.exact && !scan->onOwnGrid && keepsGridPositions(header))
        return fail(
            ErrorCode::Malformed,
            "The scan has points that do not lie on the grid that it declares, so that they cannot be "
            "kept exactly; ingest it without --exact.");

    BuiltCloud cloud{.facts = factsOf(*scan, header, shape), .octree = {}};
    const Grid grid = chooseGrid(*scan, header);
    const OctreeInput input = inputOf(cloud.facts, *scan, header, shape, grid);
    BuildNode root;
    Expected<BuiltOctree> octree;
    tbb::task_arena arena(room.threads > 0 ? room.threads : tbb::task_arena::automatic);
    arena.execute([&] {
        StagedPortions portions(*scan, header, grid);
        ProgressMeter sorting(progress, "sorting", scan->points);
        const ChunkOptions chunking{
            .chunkPoints = shape.chunkPoints, .rowBytes = input.rowBytes, .halo = shape.surfels};
        auto chunks = divide(portions, scan->points, boxOf(*scan, grid), root, grid, chunking, room.workspace,
                             sorting, stop);
        if (!chunks) {
            octree = tl::unexpected(chunks.error());
            return;
        }
        sorting.finish();
        scan->batches.clear();
        octree = buildOctree(root, std::move(*chunks), input, room.lanes, room.workspace, room.file, progress,
                             stop);
    });
    if (!octree) return passOn(octree);
    cloud.octree = std::move(*octree);
    cloud.facts.spacing = typicalSpacing(cloud.octree);
    if (cloud.facts.usual) cloud.facts.usual->curvature = cloud.octree.usualCurvature;
    if (input.findSides) cloud.facts.sides = KnownSides{KnownSides::By::Neighbours, cloud.octree.sure};
    return cloud;
}

}  // namespace scancast
