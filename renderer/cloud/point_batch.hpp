// Points as they come out of a scan: what every reader produces and the octree builder consumes.
// Pipeline: file → **import** → octree. Column-wise; columns that the scan lacks stay empty.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/cloud/positions.hpp"
#include "renderer/cloud/stations/photo.hpp"
#include "renderer/cloud/stations/station.hpp"

namespace scancast {

/// Which columns a scan has, besides position.
struct Attributes {
    bool color = false;
    bool intensity = false;
    bool classification = false;
    bool normal = false;
    bool nearInfrared = false;
    bool operator==(const Attributes&) const = default;
};

enum class ColumnType : std::uint8_t {
    Int8,
    Uint8,
    Int16,
    Uint16,
    Int32,
    Uint32,
    Int64,
    Uint64,
    Float32,
    Float64
};
/// 1, 2, 4 or 8.
constexpr std::size_t bytesOf(ColumnType type) {
    switch (type) {
        case ColumnType::Int8:
        case ColumnType::Uint8:
            return 1;
        case ColumnType::Int16:
        case ColumnType::Uint16:
            return 2;
        case ColumnType::Int32:
        case ColumnType::Uint32:
        case ColumnType::Float32:
            return 4;
        case ColumnType::Int64:
        case ColumnType::Uint64:
        case ColumnType::Float64:
            return 8;
    }
    return 0;
}
/// "int8" … "float64".
constexpr std::string_view name(ColumnType type) {
    switch (type) {
        case ColumnType::Int8:
            return "int8";
        case ColumnType::Uint8:
            return "uint8";
        case ColumnType::Int16:
            return "int16";
        case ColumnType::Uint16:
            return "uint16";
        case ColumnType::Int32:
            return "int32";
        case ColumnType::Uint32:
            return "uint32";
        case ColumnType::Int64:
            return "int64";
        case ColumnType::Uint64:
            return "uint64";
        case ColumnType::Float32:
            return "float32";
        case ColumnType::Float64:
            return "float64";
    }
    return "unknown";
}

/// What a scan knows of its points beyond the sample: GPS time, returns, a file's extra bytes. Kept beside
/// the samples on request; a view may be coloured and filtered by it (renderer/cloud/columns). Value = offset + scale · stored number.
struct Column {
    std::string name;  ///< "gps_time", "return_number" …, or the file's own word
    ColumnType type = ColumnType::Float64;
    double scale = 1, offset = 0;
    std::string description;  ///< for people; may be empty
    bool operator==(const Column&) const = default;
};
/// Of one row: the columns packed one behind the other, little-endian, in the order given.
inline std::size_t rowBytes(std::span<const Column> columns) {
    std::size_t bytes = 0;
    for (const Column& column : columns) bytes += bytesOf(column.type);
    return bytes;
}

/// What is known of a scan before its first point is read.
struct ScanHeader {
    std::string format;                   ///< for people: "LAS 1.2, point format 3"
    std::optional<std::uint64_t> points;  ///< as declared; nullopt = not known until read
    Attributes attributes;
    /// The file's own grid: position = gridOrigin + integer * gridStep. 0 = floating point, no grid.
    glm::dvec3 gridStep{0};
    glm::dvec3 gridOrigin{0};
    std::optional<std::array<glm::dvec3, 2>> bounds;  ///< declared min, max; a hint, not to be trusted
    std::string crsWkt;                               ///< empty = unknown
    std::optional<int> crsEpsg;
    std::vector<Column> columns;  ///< what `rows` holds; empty unless asked for (ImportOptions)
    /// File coordinates, where the file says that all points were recorded from there; orients normals.
    std::optional<glm::dvec3> scannerOrigin;
};

struct PointBatch {
    Positions position;  ///< file coordinates; finite (readers drop and count others)
    std::vector<std::array<std::uint8_t, 3>> color;  ///< sRGB
    std::vector<std::uint16_t> intensity;            ///< full range of the file, 0–65535
    std::vector<std::uint8_t> classification;        ///< ASPRS class
    std::vector<glm::vec3> normal;                   ///< unit length, or 0 where the scan has none
    std::vector<std::uint16_t> nearInfrared;         ///< as the file has it: 0–65535, or of 8 bits
    std::vector<std::byte> rows;                     ///< size() rows of rowBytes(header.columns)
    /// Where all of these were recorded from, file coordinates; nullopt: not known.
    std::optional<glm::dvec3> scanner;

    std::size_t size() const { return position.size(); }
    void clear() {
        position.clear();
        color.clear();
        intensity.clear();
        classification.clear();
        normal.clear();
        nearInfrared.clear();
        rows.clear();
        scanner.reset();
    }
};

/// Calls `f` with every column of `to` that has one value a point - all but rows - and its like in `from`. Positions of
/// `to` become float64: what is put together need not have one grid.
template <class F>
void forColumns(PointBatch& to, const PointBatch& from, F f) {
    f(to.position.doubles(), from.position);
    f(to.color, from.color);
    f(to.intensity, from.intensity);
    f(to.classification, from.classification);
    f(to.normal, from.normal);
    f(to.nearInfrared, from.nearInfrared);
}

/// Points of the same scan behind one another.
inline void append(PointBatch& to, const PointBatch& more) {
    forColumns(to, more,
               [](auto& all, const auto& some) { all.insert(all.end(), some.begin(), some.end()); });
    to.rows.insert(to.rows.end(), more.rows.begin(), more.rows.end());
}

/// A whole scan in memory: what a live source sends again and again.
struct PointFrame {
    ScanHeader header;
    PointBatch points;
    std::uint64_t droppedPoints = 0;  ///< left out by who sent it: NaN or infinite coordinates
    std::vector<std::string> notes;
};

/// A scan being read, front to back, once. Owned and used by one thread. Sources around another one: forwarding_source.hpp,
/// which has a line for each of these questions.
class PointSource {
  public:
    static constexpr std::size_t batchPoints = 65536;

    virtual ~PointSource() = default;
    virtual const ScanHeader& header() const = 0;
    /// Before the first read(): some points from all over the scan, to look at while it is read; read() gives them
    /// once more. None where they cost as much as reading would. An error is one that read() will meet, too.
    virtual Expected<PointBatch> glance() { return PointBatch(); }
    /// Whether readPart() is possible: any point of the header's can be gone to at once.
    virtual bool hasParts() const { return false; }
    /// Before the first read(): of the header's points only so many from this one on are to be read, perhaps none. What a part says at
    /// its end is what the whole says, but for points left out; that it has none at all is no error of its. Only where there are parts.
    virtual void readPart(std::uint64_t /*first*/, std::uint64_t /*count*/) {}
    /// Before the first read(), of a scan whose points mean something that only all of them tell, and which was opened to be looked at in
    /// parts (ImportOptions::looksInParts): several processes share that pass over the file. lookAt() says what some points tell; hasSeen()
    /// hears the largest of all that was said. Without it, read() looks at everything first. Only where there are parts.
    virtual bool wantsToBeSeen() const { return false; }
    virtual Expected<std::uint16_t> lookAt(std::uint64_t /*first*/, std::uint64_t /*count*/) {
        return std::uint16_t(0);
    }
    virtual void hasSeen(std::uint16_t /*highest*/) {}
    /// Replaces the batch with the next points (at most batchPoints). False at the end: then the batch is
    /// empty and the whole scan was sound. A file that is damaged, truncated or empty ends with an error
    /// instead.
    virtual Expected<bool> read(PointBatch& batch) = 0;
    /// Points left out so far because a coordinate was NaN or infinite.
    virtual std::uint64_t droppedPoints() const = 0;
    /// What else its user should hear about the scan, one sentence each without an end; all of them at the
    /// end of it.
    virtual std::vector<std::string> notes() const { return {}; }
    /// Where the scanner stood, in the order of the scan; all of them at the end of it. None where nobody knows.
    virtual std::vector<Station> stations() const { return {}; }
    /// Photos that the scan brought along, in its order; their bytes at the end of it, if they were asked for (ImportOptions). What stations
    /// they were taken at counts in stations().
    virtual std::vector<Photo> photos() const { return {}; }
    /// How far the source is, for progress: bytes read of the total (0 = unknown).
    virtual std::array<std::uint64_t, 2> bytesRead() const { return {0, 0}; }
};

}  // namespace scancast
