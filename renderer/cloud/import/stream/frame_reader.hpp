// Frames of a live source: point streams (POINT_STREAM.md) one behind the other, each read to its end and not a byte
// further. Believes nothing in them. Pipeline: pipe → **frames** → clouds. Owned and used by one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "renderer/cloud/import/byte_source.hpp"
#include "renderer/cloud/point_batch.hpp"

namespace scancast {

class FrameReader {
  public:
    /// `mostPoints`: a frame of more is an error, whatever it declares.
    FrameReader(std::unique_ptr<ByteSource> bytes, std::uint64_t mostPoints);
    ~FrameReader();

    /// The next frame, whole and sound; nothing where the bytes end behind one. Errors: those of PointStreamReader,
    /// ResourceLimit for too many points, Unsupported for further columns, and those of the bytes.
    Expected<std::optional<PointFrame>> next();
    /// After an error: whether another frame may follow, because its sender said itself that this one had failed, or it
    /// had no points. What breaks the rules or off ends everything: nobody knows where the next frame would begin.
    bool mayGoOn() const { return mayGoOn_; }
    /// Throws away what comes until the bytes end or fail: whoever writes them is not held up.
    void discardRest();

  private:
    class Bytes;
    Expected<PointFrame> read();

    const std::shared_ptr<Bytes> bytes_;
    const std::uint64_t mostPoints_;
    bool mayGoOn_ = true;
};

}  // namespace scancast
