#include "importers/e57/import_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "importers/e57/import_notes.hpp"
#include "importers/e57/record_reader.hpp"
#include "renderer/cloud/import/crs_text.hpp"
#include "renderer/cloud/import/lost_points.hpp"
#include "renderer/cloud/import/printable_text.hpp"

namespace scancast::import_e57 {

namespace {

constexpr std::size_t mostKeptColumns = 500;
constexpr std::size_t mostLossesTold = 3;  ///< one by one; a stream has 32 notes at most
constexpr Role axes[] = {Role::X, Role::Y, Role::Z};
constexpr std::array channels{Role::Red, Role::Green, Role::Blue};

struct Renamed {
    Role role;
    const char* name;
    const char* meaning;
};
constexpr Renamed renamed[] = {
    {Role::Row, "row_index", "row of the scanner's grid"},
    {Role::Column, "column_index", "column of the scanner's grid"},
    {Role::ReturnIndex, "return_index", "which echo of the pulse, from 0"},
    {Role::ReturnCount, "return_count", "echoes of the pulse"},
    {Role::Time, "time_stamp", "seconds since the scan began"},
    {Role::TimeInvalid, "time_stamp_invalid", "1 = the time is not to be trusted"},
};

Column columnOf(const Field& field) {
    Column column{
        .name = field.name, .type = ColumnType::Float64, .scale = 1, .offset = 0, .description = {}};
    if (const auto role = roleOf(field.name))
        for (const auto& [known, name, meaning] : renamed)
            if (*role == known) {
                column.name = name;
                column.description = meaning;
            }
    constexpr std::int64_t least = std::numeric_limits<std::int32_t>::min();
    constexpr std::int64_t greatest = std::numeric_limits<std::int32_t>::max();
    if (field.encoding == Encoding::Integer && field.minimum >= least && field.maximum <= greatest)
        column.type = ColumnType::Int32;
    return column;
}

/// What no part of a sample is made of.
bool isFurther(const Field& field) {
    if (field.encoding == Encoding::Other) return false;
    const auto role = roleOf(field.name);
    return !role || *role >= Role::Row;
}

void addKeptColumns(const FileDescription& file, ImportPlan& plan) {
    if (file.scans.size() > 1)
        plan.kept.push_back({.column = {.name = "scan_number",
                                        .type = ColumnType::Int32,
                                        .scale = 1,
                                        .offset = 0,
                                        .description = "number of the scan in the file, from 1"},
                             .from = KeptColumn::From::ScanNumber,
                             .field = {}});
    std::size_t leftOut = 0;
    for (const auto& scan : file.scans)
        for (const auto& field : scan.fields) {
            if (!scan.hasCoordinates() || !isFurther(field)) continue;
            const auto column = columnOf(field);
            const auto same = std::find_if(plan.kept.begin(), plan.kept.end(),
                                           [&](const auto& kept) { return kept.column.name == column.name; });
            if (same != plan.kept.end()) {
                if (same->column.type != column.type) same->column.type = ColumnType::Float64;
            } else if (plan.kept.size() < mostKeptColumns) {
                plan.kept.push_back({.column = column, .from = KeptColumn::From::Field, .field = field.name});
            } else {
                ++leftOut;
            }
        }
    if (leftOut > 0)
        plan.notes.push_back(
            fmt::format("{} columns are left out: {} are kept at most", leftOut, mostKeptColumns));
    for (const auto& kept : plan.kept) plan.header.columns.push_back(kept.column);
}

/// Whether every number that its bits can say is one of 32 bits.
bool fitsSteps(const Field& field) {
    using Steps = std::numeric_limits<std::int32_t>;
    if (field.scale <= 0 || field.bits > 32 || field.minimum < Steps::min()) return false;
    return field.minimum + (std::int64_t(1) << field.bits) - 1 <= Steps::max();
}

/// One grid for all points, where all are integers of one scale that nobody turned.
void findGrid(const FileDescription& file, ImportPlan& plan) {
    StepGrid grid;
    bool first = true, fits = true;
    for (const auto& scan : file.scans) {
        if (scan.records == 0 || !scan.hasCoordinates()) continue;
        if (!scan.fieldOf.cartesian() || (scan.pose && scan.pose->rotates)) return;
        StepGrid own;
        for (int i = 0; i < 3; ++i) {
            const auto& field = scan.fields[static_cast<std::size_t>(scan.fieldOf[axes[i]])];
            if (!field.isInteger()) return;
            fits &= fitsSteps(field);
            own.step[i] = std::abs(field.scale);
            own.origin[i] = field.offset + (scan.pose ? scan.pose->translation[i] : 0.0);
        }
        if (!first && own != grid) return;
        grid = own;
        first = false;
    }
    if (first) return;
    plan.header.gridStep = grid.step;
    plan.header.gridOrigin = grid.origin;
    plan.asSteps = fits && std::isfinite(grid.reach());
}

/// A hint, from declared bounds turned into file coordinates; none unless every scan with points has them.
void findBounds(const FileDescription& file, ScanHeader& header) {
    std::optional<std::array<glm::dvec3, 2>> all;
    for (const auto& scan : file.scans) {
        if (scan.records == 0 || !scan.hasCoordinates()) continue;
        if (!scan.bounds) return;
        for (int corner = 0; corner < 8; ++corner) {
            glm::dvec3 p;
            for (int i = 0; i < 3; ++i) p[i] = (*scan.bounds)[static_cast<std::size_t>((corner >> i) & 1)][i];
            p = scan.inFile(p);
            if (!all) all = {p, p};
            (*all)[0] = glm::min((*all)[0], p);
            (*all)[1] = glm::max((*all)[1], p);
        }
    }
    header.bounds = all;
}

void findCrs(const std::string& coordinates, ScanHeader& header) {
    const auto text = printableText(coordinates, 65536);
    if (text.empty()) return;
    if (text.starts_with("EPSG:") && text.size() <= 11) {
        const auto code = std::atoi(text.c_str() + 5);
        if (code > 0) header.crsEpsg = code;
        return;
    }
    header.crsWkt = text;
    header.crsEpsg = epsgOfWkt(text);
}

/// All values whose scale no scan says.
Expected<void> measure(PagedFile& file, const FileDescription& description, ImportPlan& plan) {
    Measured intensity, color;
    for (std::size_t i = 0; i < description.scans.size(); ++i) {
        const auto& scan = description.scans[i];
        if (scan.records == 0 || !scan.hasCoordinates()) continue;
        std::vector<int> wanted;
        std::vector<Measured*> into;
        const auto want = [&](Role role, Measured& met) {
            wanted.push_back(scan.fieldOf[role]);
            into.push_back(&met);
            met.integers &=
                scan.fields[static_cast<std::size_t>(scan.fieldOf[role])].encoding == Encoding::Integer;
        };
        if (scan.fieldOf.has(Role::Intensity) && !intensityScale(scan)) want(Role::Intensity, intensity);
        if (scan.fieldOf.color())
            for (std::size_t channel = 0; channel < 3; ++channel)
                if (!colorScale(scan, channel)) want(channels[channel], color);
        if (wanted.empty()) continue;
        auto reader = RecordReader::open(file, scan, wanted, description.called(i));
        if (!reader) return passOn(reader);
        for (;;) {
            const auto records = reader->next();
            if (!records) return passOn(records);
            if (*records == 0) break;
            for (std::size_t k = 0; k < wanted.size(); ++k)
                for (const double value : reader->column(wanted[k])) into[k]->take(value);
        }
    }
    plan.measuredIntensity = intensityScale(intensity);
    plan.measuredColor = colorScale(color);
    return {};
}

/// What is whole of a file to be recovered: so many points the header has then, and notes say what is lost.
Expected<void> countWhole(PagedFile& file, const FileDescription& description, ImportPlan& plan) {
    std::uint64_t whole = 0, furtherPromised = 0, furtherWhole = 0;
    std::size_t losses = 0;
    std::vector<std::string> notes;
    std::optional<Error> nothing;
    for (std::size_t i = 0; i < description.scans.size(); ++i) {
        const auto& scan = description.scans[i];
        if (scan.records == 0 || !scan.hasCoordinates()) continue;
        auto reader = RecordReader::open(file, scan, wantedFields(scan, plan), description.called(i));
        if (!reader) return passOn(reader);
        const auto own = reader->countWhole();
        if (!own) return passOn(own);
        whole += *own;
        if (*own == scan.records) continue;
        if (++losses <= mostLossesTold) {
            notes.push_back(reader->loss() + ": " + lostShare(scan.records, *own));
        } else {
            furtherPromised += scan.records;
            furtherWhole += *own;
        }
        if (!nothing)
            nothing = Error{reader->isCut() ? ErrorCode::Truncated : ErrorCode::Malformed,
                            fmt::format("{}: of the {} points that it promises, not one is whole",
                                        reader->loss(), grouped(scan.records)),
                            {}};
    }
    if (losses > mostLossesTold)
        notes.push_back(fmt::format("{} more are damaged or end too early: {}",
                                    countedScans(losses - mostLossesTold),
                                    lostShare(furtherPromised, furtherWhole)));
    if (whole == 0 && nothing) return tl::unexpected(std::move(*nothing));
    plan.notes.insert(plan.notes.begin(), notes.begin(), notes.end());
    plan.header.points = whole;
    return {};
}

}  // namespace

ScanDescription asRead(const ScanDescription& scan, const ImportPlan& plan) {
    auto stored = scan;
    if (!plan.asSteps) return stored;
    for (const auto axis : axes)
        stored.fields[static_cast<std::size_t>(stored.fieldOf[axis])].encoding = Encoding::Integer;
    return stored;
}

std::vector<int> wantedFields(const ScanDescription& scan, const ImportPlan& plan) {
    std::vector<int> wanted;
    for (std::size_t i = 0; i < scan.fields.size(); ++i) {
        const auto& field = scan.fields[i];
        if (field.encoding == Encoding::Other) continue;
        const auto role = roleOf(field.name);
        bool needed = !isFurther(field);
        // Cartesian coordinates are as exact as the spherical ones beside them.
        const bool isSpherical = role && *role >= Role::Range && *role <= Role::SphericalState;
        const bool isCartesian = role && *role <= Role::CartesianState;
        if (isSpherical && scan.fieldOf.cartesian()) needed = false;
        if (isCartesian && !scan.fieldOf.cartesian()) needed = false;
        const bool isKept = std::any_of(plan.kept.begin(), plan.kept.end(),
                                        [&](const auto& kept) { return kept.field == field.name; });
        if (needed || isKept) wanted.push_back(static_cast<int>(i));
    }
    return wanted;
}

Expected<ImportPlan> planImport(PagedFile& file, const FileDescription& description, bool keepAttributes) {
    ImportPlan plan;
    auto& header = plan.header;
    std::uint64_t withCoordinates = 0;
    for (std::size_t i = 0; i < description.scans.size(); ++i) {
        const auto& scan = description.scans[i];
        if (!scan.hasCoordinates()) continue;
        ++withCoordinates;
        // Each is looked at before the first point is sent: a file that breaks off is told of at once. Of a scan without
        // points, only where no other has any.
        if (scan.records > 0 || (scan.section > 0 && description.points() == 0))
            if (const auto reader = RecordReader::open(file, scan, {}, description.called(i)); !reader)
                return passOn(reader);
        header.attributes.color |= scan.fieldOf.color();
        header.attributes.intensity |= scan.fieldOf.has(Role::Intensity);
        header.attributes.classification |= scan.fieldOf.has(Role::Class);
        header.attributes.normal |= scan.fieldOf.normal();
    }
    if (description.points() == 0) {
        if (description.scans.empty()) return fail(ErrorCode::Empty, "it is an E57 file without scans");
        if (withCoordinates == 0)
            return fail(ErrorCode::Unsupported,
                        "its points have no coordinates: neither cartesianX, cartesianY, cartesianZ nor "
                        "sphericalRange, "
                        "sphericalAzimuth, sphericalElevation");
        return fail(ErrorCode::Empty, "it is an E57 file without points: " +
                                          countedScans(description.scans.size()) + ", empty");
    }
    header.format = "E57 1.0";
    if (description.scans.size() > 1) header.format += ", " + countedScans(description.scans.size());
    header.points = description.points();
    findGrid(description, plan);
    findBounds(description, header);
    findCrs(description.coordinates, header);
    header.scannerOrigin = onlyScannerPosition(description);
    noteWhatIsInIt(file, description, plan.header.attributes, plan.notes);
    if (keepAttributes) addKeptColumns(description, plan);
    if (file.recovers())
        if (auto ok = countWhole(file, description, plan); !ok) return passOn(ok);
    if (auto ok = measure(file, description, plan); !ok) return passOn(ok);
    return plan;
}

}  // namespace scancast::import_e57
