// Colours of a scan's points as pictures have them: by a colour rule, from values of points instead of samples. Pure; any thread.
// Pipeline: style → colour rule → **point colours** → profile's picture.
#pragma once

#include <cstddef>

#include "renderer/cloud/cloud.hpp"
#include "renderer/device/device.hpp"

namespace scancast {

class PointColors {
  public:
    /// Errors: colorRule()'s; Unsupported for colours that only a view has, or only samples.
    static Expected<PointColors> create(const Cloud& cloud, const Style& style);

    /// Points need their normals, estimated ones too.
    bool needsNormals() const { return rule_.source == ColorSource::Normal; }
    Rgb8 of(const PointBatch& batch, std::size_t i) const;

  private:
    PointColors() = default;
    Rgb8 plain(const PointBatch& batch, std::size_t i) const;
    const Rgb8& onRamp(double value) const;

    ColorRule rule_;
    double originZ_ = 0;
};

}  // namespace scancast
