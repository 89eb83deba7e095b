// What a point's record is made of: numbers one behind the other, each with its meaning. Built from what an octree's JSON
// file says of it. Pure values. Pipeline: description → **layout** → records → points.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast::import_octree {

enum class Role : std::uint8_t {
    X,
    Y,
    Z,
    Red,
    Green,
    Blue,
    Intensity,
    Classification,
    NormalX,
    NormalY,
    NormalZ,
    NormalOctahedron,  ///< two bytes: the faces of an octahedron unfolded to a square
    NormalSphere,      ///< two bytes: the picture of a sphere in a mirror ball
    Further,           ///< a column of its own, where those are kept
    Filler,            ///< means nothing
};
inline constexpr std::size_t roles = 13;  ///< those that a sample has room for

struct Field {
    Role role = Role::Further;
    ColumnType type = ColumnType::Uint8;
    std::uint32_t at = 0;  ///< in a record
    double scale = 1, offset = 0;
    std::string name;  ///< of its column: "gps_time"
};

class PointLayout {
  public:
    /// Behind what is there. A role that is taken is a further column; X, Y, Z … are one number each, the packed normals
    /// one of type Uint16.
    void add(Role role, ColumnType type, std::string_view name, double scale = 1, double offset = 0);
    /// Bytes that nobody asks for.
    void skip(std::uint32_t bytes) { bytes_ += bytes; }
    /// Once all are there: colours and normals that lack a part become further columns. Error: Malformed without x, y, z.
    Expected<void> finish();

    std::uint32_t bytes() const { return bytes_; }  ///< of a record
    const std::vector<Field>& fields() const { return fields_; }
    /// nullptr = there is none.
    const Field* find(Role role) const;
    Attributes attributes() const;
    /// Whether a number of a colour can be above 255.
    bool hasWideColors() const;
    /// Those that become columns with --keep-attributes: all that have no room in a sample, or not whole - an intensity
    /// of 32 bits. At most as many as the point stream has; the others are left out.
    std::vector<const Field*> kept() const;

  private:
    std::uint32_t bytes_ = 0;
    std::vector<Field> fields_;
};

/// "GpsTime", "gps-time" and "GPS_TIME" are gps_time, as the columns of LAS are called; what LAS has under another name
/// gets that.
std::string columnName(std::string_view name);

/// Columns of these fields; names that were there before get a number.
std::vector<Column> columnsOf(const std::vector<const Field*>& fields);

}  // namespace scancast::import_octree
