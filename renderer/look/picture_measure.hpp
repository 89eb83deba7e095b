// What can be said of a small picture without knowing what it shows: how much of it is filled and where, how
// bright, how much there is to see. Pipeline: candidate's frame → **measure** → look.
#pragma once

#include <array>

#include "renderer/image/frame.hpp"

namespace scancast {

struct PictureMeasure {
    double covered = 0;                       ///< share of all pixels that show the scan
    double border = 0;                        ///< the same of the outermost ones
    std::array<double, 2> fill{}, middle{};   ///< of the 1-99 % box of covered pixels: size and offset from
                                              ///< the picture's middle, in shares of width and height
    double dark = 0, median = 0, bright = 0;  ///< luminance of covered pixels: 5, 50, 95 %; 0-1
    double commonest = 0;                     ///< share of the commonest colour of 4 bits a channel
    double edges = 0;                         ///< share of covered pixels on an edge or texture
    double near = 0;                          ///< share of covered pixels much nearer than the median
    double noise = 0;  ///< median distance of a pixel's luminance from the median of the nine around it

    double spread() const { return bright - dark; }
    /// Whether there is something to see: contrast, neither black nor white, not one colour.
    bool hasContrast() const;
    /// Whether a viewer can read it: that, and enough edges or texture.
    bool isReadable() const;
    /// The same as a number, so that the least bad can be found: 1 = readable.
    double readability() const;
};

/// Of a frame with depth. Edges are steps of luminance between neighbouring pixels, so they say most where the
/// frame is as large as the picture that people get.
PictureMeasure measure(const Frame& frame);

}  // namespace scancast
