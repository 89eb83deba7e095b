// A cloud file whose samples have other colours: what a cloud's tint is. Everything else is the file's own, so decorators of this
// kind can be put into each other. Pipeline: cloud file → **painted file** → block cache.
//
// *Thread safety*: as the file that it paints.
#pragma once

#include <memory>

#include "protocol/view/viewed_clouds.hpp"
#include "renderer/cloud/file/cloud_file.hpp"

namespace scancast {

struct Paint {
    Rgb8 color{255, 255, 255};
    bool covers = false;  ///< it is the colour; else it multiplies the samples' own
    bool operator==(const Paint&) const = default;
};

/// Of the samples' own: each channel by the paint's, 255 leaving it as it is; halves are rounded up.
Sample painted(Sample sample, const Paint& paint);

std::shared_ptr<const CloudFile> paintedFile(std::shared_ptr<const CloudFile> file, const Paint& paint);

}  // namespace scancast
