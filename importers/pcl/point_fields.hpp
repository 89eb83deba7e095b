// What the named numbers of a point mean, the same for PLY properties and PCD fields. Pure functions.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "renderer/cloud/point_batch.hpp"

namespace scancast::import_pcl {

inline bool isFloat(ColumnType type) {
    return type == ColumnType::Float32 || type == ColumnType::Float64;
}
inline bool isByte(ColumnType type) {
    return type == ColumnType::Int8 || type == ColumnType::Uint8;
}

enum class Meaning : std::uint8_t {
    X,
    Y,
    Z,
    Red,
    Green,
    Blue,
    PackedColor,  ///< 0x00RRGGBB in four bytes, as an integer or hidden in a float's bits
    Intensity,
    Class,
    NormalX,
    NormalY,
    NormalZ,
};
inline constexpr std::size_t meanings = 12;

/// By name, upper or lower case: "x", "scalar_Intensity", "normal_x" …; nullopt = nothing that is shown.
std::optional<Meaning> meaningOf(std::string_view name);

/// Of two names with one meaning, is this the plainer one? "blue" is, against "b".
bool isPlainer(std::string_view name, std::string_view other);

/// Which meanings a scan's points have, and in which number type.
struct PointFields {
    std::array<std::optional<ColumnType>, meanings> type;

    std::optional<ColumnType>& operator[](Meaning m) { return type[static_cast<std::size_t>(m)]; }
    const std::optional<ColumnType>& operator[](Meaning m) const { return type[static_cast<std::size_t>(m)]; }
    bool has(Meaning m) const { return (*this)[m].has_value(); }
    Attributes attributes() const;
};

/// One point's numbers, by meaning; packed colours as the value of their four bytes.
using RawPoint = std::array<double, meanings>;

}  // namespace scancast::import_pcl
