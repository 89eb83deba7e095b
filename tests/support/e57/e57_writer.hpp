// Writes E57 files, for tests, seeds and measurements: known numbers in, so that what the importer makes of them can be
// compared. It shares nothing with the reader but the table's CRC. Owned and used by one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <iostream>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace scancast::test {

/// A field of a scan's points, and how its numbers are stored.
struct E57Field {
    enum class Kind : std::uint8_t { Integer, Scaled, Single, Double };
    std::string name;
    Kind kind = Kind::Double;
    std::int64_t minimum = 0, maximum = 0;
    double scale = 1, offset = 0;

    static E57Field integer(std::string name, std::int64_t minimum, std::int64_t maximum);
    static E57Field scaled(std::string name, std::int64_t minimum, std::int64_t maximum, double scale,
                           double offset = 0);
    static E57Field single(std::string name) { return {.name = std::move(name), .kind = Kind::Single}; }
    static E57Field real(std::string name) { return {.name = std::move(name), .kind = Kind::Double}; }
    unsigned bits() const;
};

struct E57Scan {
    std::vector<E57Field> fields;
    std::uint64_t records = 0;
    /// The stored number of a float field; of integers the one below.
    std::function<double(std::uint64_t record, std::size_t field)> real = [](auto, auto) { return 0.0; };
    std::function<std::int64_t(std::uint64_t record, std::size_t field)> raw = [](auto, auto) { return 0; };
    std::string xml;  ///< pose, limits and whatever else stands beside its points
    /// Packets of any size, each stream's share of its own, with index and ignored packets between them.
    bool oddPackets = false;
    bool streamByStream = false;  ///< all packets of the first field, then all of the second
};

class E57Writer {
  public:
    /// `out` is empty, and can be read and sought, too.
    explicit E57Writer(std::iostream& out);

    /// Its guid.
    std::string add(const E57Scan& scan);
    /// The section's physical offset, for photos' XML.
    std::uint64_t addBlob(std::string_view bytes);
    /// Ends the file. `root`: XML beside data3D.
    void finish(const std::string& root = {});
    /// The same, with any XML at all.
    void finishWith(const std::string& xml);

  private:
    void append(std::string_view bytes);
    void patch(std::uint64_t logical, std::string_view bytes);
    void writePage(std::uint64_t page, std::string content);
    void writePacket(std::vector<std::string>& pending, const E57Scan& scan);

    std::iostream& out_;
    std::string page_;  ///< content of the last page
    std::uint64_t pages_ = 0;
    std::string scans_;
    std::mt19937 random_{57};
};

/// "<pose>…" for E57Scan::xml.
std::string e57Pose(double w, double x, double y, double z, double tx, double ty, double tz);

/// A photo of images2D. `element`: "pinholeRepresentation"…; `inside`: XML beside its pixels; `beside`: beside the representation.
std::string e57Photo(const std::string& element, const std::string& blob, const std::string& inside,
                     const std::string& beside = {});
/// "<jpegImage …/>".
std::string e57Blob(const char* element, std::uint64_t offset, std::size_t bytes);

/// Bytes of a whole file.
std::string e57File(const std::vector<E57Scan>& scans, const std::string& root = {});

/// Sets the checksums of all whole pages, so that what was changed in them is read.
void sealPages(std::string& file);

}  // namespace scancast::test
