#include "importers/e57/scan_converter.hpp"

#include <cmath>
#include <glm/common.hpp>
#include <limits>

#include "files/bytes.hpp"

namespace scancast::import_e57 {

ScanConverter::ScanConverter(const ScanDescription& scan, const ImportPlan& plan, std::size_t number,
                             Counts& counts)
    : scan_(scan),
      plan_(plan),
      number_(number),
      counts_(counts),
      rowBytes_(rowBytes(plan.header.columns)),
      positions_(RecordReader::blockRecords) {
    if (scan.fieldOf.has(Role::Intensity)) intensity_ = intensityScale(scan).value_or(plan.measuredIntensity);
    if (scan.fieldOf.color())
        for (std::size_t i = 0; i < 3; ++i) color_[i] = colorScale(scan, i).value_or(plan.measuredColor);
    for (const auto& kept : plan.kept) {
        int field = -1;
        for (std::size_t i = 0; i < scan.fields.size(); ++i)
            if (kept.from == KeptColumn::From::Field && scan.fields[i].name == kept.field)
                field = static_cast<int>(i);
        keptField_.push_back(field);
    }
    kept_.reserve(RecordReader::blockRecords);
}

void ScanConverter::findPositions(const RecordReader& reader, std::size_t count) {
    if (scan_.fieldOf.cartesian()) {
        const auto x = of(reader, Role::X), y = of(reader, Role::Y), z = of(reader, Role::Z);
        for (std::size_t i = 0; i < count; ++i) positions_[i] = {x[i], y[i], z[i]};
    } else {
        const auto range = of(reader, Role::Range), azimuth = of(reader, Role::Azimuth),
                   elevation = of(reader, Role::Elevation);
        for (std::size_t i = 0; i < count; ++i) {
            const double flat = range[i] * std::cos(elevation[i]);
            positions_[i] = {flat * std::cos(azimuth[i]), flat * std::sin(azimuth[i]),
                             range[i] * std::sin(elevation[i])};
        }
    }
    if (!scan_.pose) return;
    const auto& pose = *scan_.pose;
    if (pose.rotates)
        for (std::size_t i = 0; i < count; ++i)
            positions_[i] = pose.rotation * positions_[i] + pose.translation;
    else
        for (std::size_t i = 0; i < count; ++i) positions_[i] += pose.translation;
}

void ScanConverter::append(const RecordReader& reader, PointBatch& batch) {
    const auto stateRole = scan_.fieldOf.cartesian() ? Role::CartesianState : Role::SphericalState;
    const auto coordinate = of(reader, scan_.fieldOf.cartesian() ? Role::X : Role::Range);
    const auto state = of(reader, stateRole);
    if (!plan_.asSteps) findPositions(reader, coordinate.size());
    kept_.clear();
    for (std::size_t i = 0; i < coordinate.size(); ++i) {
        const auto& p = positions_[i];
        if (!state.empty() && state[i] != 0)
            ++counts_.marked;
        else if (!plan_.asSteps && !(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)))
            ++counts_.notFinite;
        else
            kept_.push_back(static_cast<std::uint32_t>(i));
    }
    appendPositions(reader, batch);
    const auto& has = plan_.header.attributes;
    if (has.color) appendColors(reader, batch);
    if (has.intensity) {
        const auto value = of(reader, Role::Intensity), invalid = of(reader, Role::IntensityInvalid);
        for (const auto i : kept_) {
            const bool none = value.empty() || (!invalid.empty() && invalid[i] != 0);
            counts_.intensityless += none && !value.empty();
            batch.intensity.push_back(none ? std::uint16_t(0)
                                           : static_cast<std::uint16_t>(intensity_.of(value[i], 65535)));
        }
    }
    if (has.classification) {
        const auto value = of(reader, Role::Class);
        for (const auto i : kept_) {
            const bool fits = !value.empty() && value[i] >= 0 && value[i] <= 255;
            batch.classification.push_back(fits ? static_cast<std::uint8_t>(value[i]) : std::uint8_t(0));
        }
    }
    if (has.normal) appendNormals(reader, batch);
    if (rowBytes_ > 0) appendRows(reader, batch);
}

void ScanConverter::appendPositions(const RecordReader& reader, PointBatch& batch) const {
    if (!plan_.asSteps) {
        auto& positions = batch.position.doubles();
        for (const auto i : kept_) positions.push_back(positions_[i]);
        return;
    }
    auto& steps = batch.position.steps({plan_.header.gridOrigin, plan_.header.gridStep});
    const auto x = of(reader, Role::X), y = of(reader, Role::Y), z = of(reader, Role::Z);
    for (const auto i : kept_)
        steps.push_back({static_cast<std::int32_t>(x[i]), static_cast<std::int32_t>(y[i]),
                         static_cast<std::int32_t>(z[i])});
}

void ScanConverter::appendColors(const RecordReader& reader, PointBatch& batch) {
    const auto invalid = of(reader, Role::ColorInvalid);
    if (!scan_.fieldOf.color()) {
        batch.color.resize(batch.color.size() + kept_.size());
        return;
    }
    const auto red = of(reader, Role::Red), green = of(reader, Role::Green), blue = of(reader, Role::Blue);
    for (const auto i : kept_) {
        if (!invalid.empty() && invalid[i] != 0) {
            ++counts_.colorless;
            batch.color.push_back({});
            continue;
        }
        batch.color.push_back({static_cast<std::uint8_t>(color_[0].of(red[i], 255)),
                               static_cast<std::uint8_t>(color_[1].of(green[i], 255)),
                               static_cast<std::uint8_t>(color_[2].of(blue[i], 255))});
    }
}

void ScanConverter::appendNormals(const RecordReader& reader, PointBatch& batch) const {
    if (!scan_.fieldOf.normal()) {
        batch.normal.resize(batch.normal.size() + kept_.size());
        return;
    }
    const auto x = of(reader, Role::NormalX), y = of(reader, Role::NormalY), z = of(reader, Role::NormalZ);
    for (const auto i : kept_) {
        glm::dvec3 n(x[i], y[i], z[i]);
        if (scan_.pose && scan_.pose->rotates) n = scan_.pose->rotation * n;
        const auto length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
        const bool usable = std::isfinite(length) && length > 1e-30;
        batch.normal.push_back(usable ? glm::vec3(n / length) : glm::vec3(0));
    }
}

void ScanConverter::appendRows(const RecordReader& reader, PointBatch& batch) const {
    const auto begin = batch.rows.size();
    batch.rows.resize(begin + kept_.size() * rowBytes_);
    std::size_t at = 0;
    for (std::size_t k = 0; k < plan_.kept.size(); ++k) {
        const auto& kept = plan_.kept[k];
        const auto values = reader.column(keptField_[k]);
        auto* to = batch.rows.data() + begin + at;
        for (const auto i : kept_) {
            const bool isNumber = kept.from == KeptColumn::From::ScanNumber;
            const double value = isNumber          ? static_cast<double>(number_)
                                 : !values.empty() ? values[i]
                                                   : std::numeric_limits<double>::quiet_NaN();
            // A column that this scan lacks: -1, or NaN.
            if (kept.column.type == ColumnType::Int32)
                storeLe(to, std::isnan(value)
                                ? std::int32_t(-1)
                                : static_cast<std::int32_t>(glm::clamp(value, -2147483648.0, 2147483647.0)));
            else
                storeLe(to, value);
            to += rowBytes_;
        }
        at += bytesOf(kept.column.type);
    }
}

}  // namespace scancast::import_e57
