#include "renderer/cloud/build/plan/build_plan.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "renderer/cloud/build/nodes/spacing.hpp"
#include "renderer/cloud/exact_columns.hpp"

namespace scancast {

namespace {

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

KeptColumn keptColumn(const Column& column, const std::array<double, 2>& range, const ValueSketch& sketch) {
    KeptColumn kept{column, range, sketch.usual()};
    const bool whole = column.type != ColumnType::Float32 && column.type != ColumnType::Float64;
    if (sketch.count() > 0)
        kept.histogram =
            sketch.histogram(histogramParts(range, *kept.usual, whole ? std::abs(column.scale) : 0));
    return kept;
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
        facts.columns.push_back(
            keptColumn(header.columns[c], scan.columnRanges[c], scan.columnSketches[c]));
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

bool wantsSights(const ScanHeader& header, const OctreeShape& shape) {
    return shape.surfels && !header.attributes.normal && shape.orientation != Orientation::Up;
}

Expected<BuildPlan> planBuild(const StagedScan& scan, const ScanHeader& header, const OctreeShape& shape) {
    if (shape.exact && !scan.onOwnGrid && keepsGridPositions(header))
        return fail(
            ErrorCode::Malformed,
            "The scan has points that do not lie on the grid that it declares, so that they cannot be "
            "kept exactly; ingest it without --exact.");
    BuildPlan plan{.facts = factsOf(scan, header, shape), .input = {}, .box = {}};
    const Grid grid = chooseGrid(scan, header);
    plan.input = inputOf(plan.facts, scan, header, shape, grid);
    plan.box = boxOf(scan, grid);
    return plan;
}

void completeFacts(CloudFacts& facts, const OctreeInput& input, const BuiltOctree& octree) {
    facts.spacing = typicalSpacing(octree.nodes);
    if (facts.usual) facts.usual->curvature = octree.usualCurvature;
    if (input.findSides) facts.sides = KnownSides{KnownSides::By::Neighbours, octree.sure};
}

}  // namespace scancast
