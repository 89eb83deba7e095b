#include "simulator/write/ply_writer.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "simulator/write/little_endian.hpp"

namespace scancast {
namespace {

class PlyWriter final : public PointWriter {
  public:
    PlyWriter(OutputFile output, bool wide) : output_(std::move(output)), wide_(wide) {}

    Expected<void> begin(const ScanHeader& header) {
        const char* const real = wide_ ? "double" : "float";
        std::string text =
            fmt::format("ply\nformat binary_little_endian 1.0\ncomment {}\nelement vertex {}\n",
                        header.format, *header.points);
        for (const char* axis : {"x", "y", "z"}) text += fmt::format("property {} {}\n", real, axis);
        text +=
            "property float nx\nproperty float ny\nproperty float nz\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\n"
            "property uchar classification\nproperty ushort intensity\nend_header\n";
        return output_.write(std::as_bytes(std::span(text)));
    }

    Expected<void> write(const PointBatch& batch) override {
        const std::size_t bytes = (wide_ ? 24 : 12) + 12 + 3 + 1 + 2;
        rows_.resize(batch.size() * bytes);
        std::byte* at = rows_.data();
        for (std::size_t i = 0; i < batch.size(); ++i) {
            for (int axis = 0; axis < 3; ++axis)
                at = wide_ ? put(at, batch.position[i][axis]) : put(at, float(batch.position[i][axis]));
            for (int axis = 0; axis < 3; ++axis) at = put(at, batch.normal[i][axis]);
            at = put(at, batch.color[i]);
            at = put(at, batch.classification[i]);
            at = put(at, batch.intensity[i]);
        }
        return output_.write(rows_);
    }

    Expected<void> finish() override { return output_.finish(); }
    std::uint64_t bytesWritten() const override { return output_.bytesWritten(); }

  private:
    OutputFile output_;
    bool wide_;
    std::vector<std::byte> rows_;
};

}  // namespace

Expected<std::unique_ptr<PointWriter>> createPlyWriter(OutputFile output, const ScanHeader& header) {
    // A float holds a tenth of a millimetre up to about a kilometre; surveyed coordinates need doubles.
    constexpr double floatReach = 1000;
    double reach = 0;
    for (const glm::dvec3& corner : *header.bounds)
        for (int axis = 0; axis < 3; ++axis) reach = std::max(reach, std::abs(corner[axis]));
    auto writer = std::make_unique<PlyWriter>(std::move(output), reach > floatReach);
    if (auto ok = writer->begin(header); !ok) return passOn(ok);
    return writer;
}

}  // namespace scancast
