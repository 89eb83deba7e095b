// What the named numbers of a point mean, the same for PLY properties and PCD fields. Pure functions.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "renderer/cloud/point_batch.hpp"

namespace scancast::import_pcl {

enum class ScalarType : std::uint8_t {
    Int8,
    UInt8,
    Int16,
    UInt16,
    Int32,
    UInt32,
    Int64,
    UInt64,
    Float32,
    Float64
};

/// Bytes of one value.
std::size_t bytesOf(ScalarType type);
inline bool isFloat(ScalarType type) {
    return type == ScalarType::Float32 || type == ScalarType::Float64;
}
inline bool isByte(ScalarType type) {
    return type == ScalarType::Int8 || type == ScalarType::UInt8;
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
    std::array<std::optional<ScalarType>, meanings> type;

    std::optional<ScalarType>& operator[](Meaning m) { return type[static_cast<std::size_t>(m)]; }
    const std::optional<ScalarType>& operator[](Meaning m) const { return type[static_cast<std::size_t>(m)]; }
    bool has(Meaning m) const { return (*this)[m].has_value(); }
    Attributes attributes() const;
};

/// One point's numbers, by meaning; packed colours as the value of their four bytes.
using RawPoint = std::array<double, meanings>;

}  // namespace scancast::import_pcl
