#include "renderer/device/plan/splat_plan.hpp"

namespace scancast {

SplatShape splatShape(Footprint footprint, Profile profile) {
    if (footprint == Footprint::Disc) return SplatShape::Disc;
    if (footprint == Footprint::Ellipse) return SplatShape::Ellipse;
    const bool square = footprint != Footprint::Circle;
    switch (profile) {
        case Profile::Flat:
            return square ? SplatShape::FlatSquare : SplatShape::FlatCircle;
        case Profile::Paraboloid:
            return square ? SplatShape::ParaboloidSquare : SplatShape::ParaboloidCircle;
        case Profile::Cone:
            return square ? SplatShape::ConeSquare : SplatShape::ConeCircle;
        case Profile::Sphere:
            return SplatShape::SphereCircle;
    }
    return SplatShape::FlatSquare;
}

SplatColoring splatColoring(ColorSource source) {
    switch (source) {
        case ColorSource::Rgb:
            return SplatColoring::Rgb;
        case ColorSource::Intensity:
            return SplatColoring::Intensity;
        case ColorSource::Elevation:
            return SplatColoring::Elevation;
        case ColorSource::Classification:
            return SplatColoring::Classification;
        case ColorSource::Normal:
            return SplatColoring::Normal;
        case ColorSource::Depth:
            return SplatColoring::Depth;
        case ColorSource::Lod:
        case ColorSource::Flat:
            return SplatColoring::PerRun;
    }
    return SplatColoring::Rgb;
}

}  // namespace scancast
