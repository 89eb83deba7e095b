// What a record of an E57 file's points consists of, and what its numbers mean (ASTM E2807-11, data3D's `points`).
// Plain values. Pipeline: XML records → **scan descriptions** → points.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace scancast::import_e57 {

enum class Encoding : std::uint8_t {
    Integer,        ///< bits that hold maximum - minimum, added to the minimum
    ScaledInteger,  ///< the same, × scale + offset
    Float32,
    Float64,
    Other  ///< texts and what is not known: left out
};

struct Limits {
    double minimum = 0, maximum = 0;
    bool operator==(const Limits&) const = default;
};

struct Field {
    std::string name;
    Encoding encoding = Encoding::Float64;
    std::int64_t minimum = 0, maximum = 0;  ///< of the integers
    double scale = 1, offset = 0;
    unsigned bits = 64;            ///< of each value; 0 = all are the minimum
    std::optional<Limits> limits;  ///< of the values, where declared: finite, with a width

    bool isInteger() const { return encoding == Encoding::Integer || encoding == Encoding::ScaledInteger; }
};

enum class Role : std::uint8_t {
    X,
    Y,
    Z,
    CartesianState,  ///< 0 = valid, 1 = a direction alone, 2 = nothing
    Range,
    Azimuth,
    Elevation,
    SphericalState,
    Red,
    Green,
    Blue,
    ColorInvalid,
    Intensity,
    IntensityInvalid,
    NormalX,
    NormalY,
    NormalZ,
    Class,
    Row,
    Column,
    ReturnIndex,
    ReturnCount,
    Time,
    TimeInvalid,
};
inline constexpr std::size_t roles = 24;

/// nullopt = a field of an extension.
std::optional<Role> roleOf(std::string_view fieldName);

/// An index for each role, -1 = there is none.
class RoleIndices {
  public:
    RoleIndices() { at_.fill(-1); }
    int& operator[](Role role) { return at_[static_cast<std::size_t>(role)]; }
    int operator[](Role role) const { return at_[static_cast<std::size_t>(role)]; }
    bool has(Role role) const { return (*this)[role] >= 0; }
    bool cartesian() const { return has(Role::X) && has(Role::Y) && has(Role::Z); }
    bool spherical() const { return has(Role::Range) && has(Role::Azimuth) && has(Role::Elevation); }
    bool color() const { return has(Role::Red) && has(Role::Green) && has(Role::Blue); }
    bool normal() const { return has(Role::NormalX) && has(Role::NormalY) && has(Role::NormalZ); }

  private:
    std::array<int, roles> at_;
};

}  // namespace scancast::import_e57
