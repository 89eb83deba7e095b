#include "renderer/cloud/import/octree/record_decoder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>

#include "files/bytes.hpp"

namespace scancast::import_octree {

namespace {

/// Calls `use(i, number)` with one number of every record, in its own type.
template <class T, class Use>
void eachOf(const std::byte* at, std::size_t stride, std::size_t count, const Use& use) {
    for (std::size_t i = 0; i < count; ++i, at += stride) use(i, loadLe<T>(at));
}

template <class Use>
void eachNumber(const std::byte* records, std::size_t stride, std::size_t count, const Field& field,
                const Use& use) {
    const auto* at = records + field.at;
    switch (field.type) {
        case ColumnType::Int8:
            return eachOf<std::int8_t>(at, stride, count, use);
        case ColumnType::Uint8:
            return eachOf<std::uint8_t>(at, stride, count, use);
        case ColumnType::Int16:
            return eachOf<std::int16_t>(at, stride, count, use);
        case ColumnType::Uint16:
            return eachOf<std::uint16_t>(at, stride, count, use);
        case ColumnType::Int32:
            return eachOf<std::int32_t>(at, stride, count, use);
        case ColumnType::Uint32:
            return eachOf<std::uint32_t>(at, stride, count, use);
        case ColumnType::Int64:
            return eachOf<std::int64_t>(at, stride, count, use);
        case ColumnType::Uint64:
            return eachOf<std::uint64_t>(at, stride, count, use);
        case ColumnType::Float32:
            return eachOf<float>(at, stride, count, use);
        case ColumnType::Float64:
            return eachOf<double>(at, stride, count, use);
    }
}

/// Whole numbers from 0 to `greatest`; `put(i, number, fits)`.
template <class Put>
void eachWhole(const std::byte* records, std::size_t stride, std::size_t count, const Field& field,
               double greatest, const Put& put) {
    const double scale = field.scale, offset = field.offset;
    eachNumber(records, stride, count, field, [&](std::size_t i, auto number) {
        const double value = std::floor(offset + static_cast<double>(number) * scale + 0.5);
        const bool fits = value >= 0 && value <= greatest;  // not for NaN
        put(i, static_cast<std::uint32_t>(fits ? value : value > greatest ? greatest : 0), fits);
    });
}

bool isPlain(const Field& field, ColumnType type) {
    return field.type == type && field.scale == 1 && field.offset == 0;
}

constexpr Role colors[] = {Role::Red, Role::Green, Role::Blue};

double signedByte(std::byte byte) {
    return static_cast<double>(std::to_integer<unsigned>(byte)) / 255 * 2 - 1;
}

glm::dvec3 fromSphere(const std::byte* at) {
    const double x = signedByte(at[0]), y = signedByte(at[1]);
    const double l = std::max(0.0, 1 - x * x - y * y);
    const double s = 2 * std::sqrt(l);
    return {x * s, y * s, 2 * l - 1};
}

double signOf(double value) {
    return value < 0 ? -1 : value > 0 ? 1 : 0;
}

glm::dvec3 fromOctahedron(const std::byte* at) {
    const double u = signedByte(at[0]), v = signedByte(at[1]);
    const double z = 1 - std::abs(u) - std::abs(v);
    if (z >= 0) return {u, v, z};
    return {(1 - std::abs(v)) * signOf(u), (1 - std::abs(u)) * signOf(v), z};
}

/// Of unit length, or 0 for what is none; three roundings to 32 bits harm neither.
glm::vec3 unit(const glm::dvec3& n) {
    const double length = std::hypot(n.x, n.y, n.z);
    if (!(length > 1e-6) || !std::isfinite(length)) return glm::vec3(0);
    return glm::vec3(n * (1 / length));
}

}  // namespace

LasColorDepth FieldDecoder::colorDepth(std::span<const std::byte> records) const {
    if (!layout_.attributes().color) return LasColorDepth::Unknown;
    const auto count = records.size() / recordBytes();
    std::uint32_t all = 0;
    for (const Role role : colors) {
        const auto& field = *layout_.find(role);
        if (field.type == ColumnType::Uint8) continue;
        eachWhole(records.data(), recordBytes(), count, field, 65535,
                  [&](std::size_t, std::uint32_t value, bool) { all |= value; });
    }
    if (all > 255) return LasColorDepth::SixteenBits;
    return all > 0 ? LasColorDepth::EightBits : LasColorDepth::Unknown;
}

void FieldDecoder::decode(std::span<const std::byte> records, LasColorDepth depth, DecodedPoints& to) const {
    const auto count = records.size() / recordBytes();
    const auto* data = records.data();
    auto& batch = to.batch;
    batch.clear();
    if (layout_.attributes().color) decodeColors(data, count, depth, to);
    if (const auto* field = layout_.find(Role::Intensity)) {
        batch.intensity.resize(count);
        if (isPlain(*field, ColumnType::Uint16)) {
            eachOf<std::uint16_t>(data + field->at, recordBytes(), count,
                                  [&](std::size_t i, std::uint16_t value) { batch.intensity[i] = value; });
        } else {
            eachWhole(data, recordBytes(), count, *field, 65535,
                      [&](std::size_t i, std::uint32_t value, bool fits) {
                          batch.intensity[i] = static_cast<std::uint16_t>(value);
                          to.outside += !fits;
                      });
        }
    }
    if (const auto* field = layout_.find(Role::Classification)) {
        batch.classification.resize(count);
        eachWhole(data, recordBytes(), count, *field, 255,
                  [&](std::size_t i, std::uint32_t value, bool fits) {
                      batch.classification[i] = fits ? static_cast<std::uint8_t>(value) : std::uint8_t(0);
                      to.outside += !fits;
                  });
    }
    if (layout_.attributes().normal) decodeNormals(data, count, batch.normal);
    if (keep_) decodeRows(data, count, batch.rows);
    decodePositions(data, count, to);  // last: it may drop points
}

void FieldDecoder::decodePositions(const std::byte* records, std::size_t count, DecodedPoints& to) const {
    if (const auto steps = grid()) return decodeSteps(records, count, *steps, to.batch.position);
    auto& position = to.batch.position.doubles();
    position.resize(count);
    for (int axis = 0; axis < 3; ++axis) {
        const auto& field = *layout_.find(static_cast<Role>(axis));
        const double scale = grid_.scale[axis] * field.scale;
        const double offset = grid_.offset[axis] + field.offset;
        eachNumber(records, recordBytes(), count, field, [&](std::size_t i, auto number) {
            position[i][axis] = offset + static_cast<double>(number) * scale;
        });
    }
    to.dropped += dropNonFinite(to.batch);
}

void FieldDecoder::decodeSteps(const std::byte* records, std::size_t count, const StepGrid& grid,
                               Positions& to) const {
    auto& steps = to.steps(grid);
    steps.resize(count);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto* at = records + layout_.find(static_cast<Role>(axis))->at;
        eachOf<std::int32_t>(at, recordBytes(), count,
                             [&](std::size_t i, std::int32_t number) { steps[i][axis] = number; });
    }
}

std::optional<StepGrid> FieldDecoder::grid() const {
    StepGrid grid;
    for (int axis = 0; axis < 3; ++axis) {
        const auto& field = *layout_.find(static_cast<Role>(axis));
        if (field.type != ColumnType::Int32) return std::nullopt;
        grid.step[axis] = grid_.scale[axis] * field.scale;
        grid.origin[axis] = grid_.offset[axis] + field.offset;
        if (!(grid.step[axis] > 0)) return std::nullopt;
    }
    if (!std::isfinite(grid.reach())) return std::nullopt;
    return grid;
}

/// 16-bit colours keep their high byte, as in LAS.
void FieldDecoder::decodeColors(const std::byte* records, std::size_t count, LasColorDepth depth,
                                DecodedPoints& to) const {
    auto& color = to.batch.color;
    color.resize(count);
    for (std::size_t k = 0; k < 3; ++k) {
        const auto& field = *layout_.find(colors[k]);
        if (isPlain(field, ColumnType::Uint8)) {
            eachOf<std::uint8_t>(records + field.at, recordBytes(), count,
                                 [&](std::size_t i, std::uint8_t value) { color[i][k] = value; });
            continue;
        }
        const int shift = field.type != ColumnType::Uint8 && depth == LasColorDepth::SixteenBits ? 8 : 0;
        eachWhole(records, recordBytes(), count, field, 65535,
                  [&](std::size_t i, std::uint32_t value, bool fits) {
                      color[i][k] = static_cast<std::uint8_t>(value >> shift);
                      to.outside += !fits;
                  });
    }
}

void FieldDecoder::decodeNormals(const std::byte* records, std::size_t count,
                                 std::vector<glm::vec3>& to) const {
    to.resize(count);
    const auto* octahedron = layout_.find(Role::NormalOctahedron);
    const auto* sphere = layout_.find(Role::NormalSphere);
    if (octahedron || sphere) {
        const auto* at = records + (octahedron ? octahedron : sphere)->at;
        for (std::size_t i = 0; i < count; ++i, at += recordBytes())
            to[i] = unit(octahedron ? fromOctahedron(at) : fromSphere(at));
        return;
    }
    std::vector<glm::dvec3> whole(count);
    for (int axis = 0; axis < 3; ++axis) {
        const auto& field = *layout_.find(static_cast<Role>(static_cast<int>(Role::NormalX) + axis));
        eachNumber(records, recordBytes(), count, field, [&](std::size_t i, auto number) {
            whole[i][axis] = field.offset + static_cast<double>(number) * field.scale;
        });
    }
    std::transform(whole.begin(), whole.end(), to.begin(), unit);
}

void FieldDecoder::decodeRows(const std::byte* records, std::size_t count, std::vector<std::byte>& to) const {
    const auto kept = layout_.kept();
    const auto rowBytes =
        std::accumulate(kept.begin(), kept.end(), std::size_t(0),
                        [](std::size_t sum, const Field* f) { return sum + bytesOf(f->type); });
    to.resize(count * rowBytes);
    std::size_t place = 0;
    for (const auto* field : kept) {
        const auto bytes = bytesOf(field->type);
        const auto* from = records + field->at;
        auto* row = to.data() + place;
        for (std::size_t i = 0; i < count; ++i, from += recordBytes(), row += rowBytes)
            std::memcpy(row, from, bytes);
        place += bytes;
    }
}

LasColorDepth LasDecoder::colorDepth(std::span<const std::byte> records) const {
    if (lasRecordLayout(header_.pointFormat).color < 0) return LasColorDepth::Unknown;
    return scancast::colorDepth(records, header_);
}

void LasDecoder::decode(std::span<const std::byte> records, LasColorDepth depth, DecodedPoints& to) const {
    decodeLasRecords(records, header_, depth, to.batch);
    if (!columns_.empty()) decodeLasColumns(records, header_.recordBytes, columns_, to.batch.rows);
    to.dropped += dropNonFinite(to.batch);
}

}  // namespace scancast::import_octree
