#include "renderer/cloud/columns/color_sources.hpp"

namespace scancast {

bool canColorBy(const CloudFacts& cloud, ColorSource source) {
    switch (source) {
        case ColorSource::Rgb:
            return cloud.attributes.color || cloud.constant.color;
        case ColorSource::Infrared:
            return hasNearInfrared(cloud);
        case ColorSource::Intensity:
            return cloud.attributes.intensity || cloud.constant.intensity;
        case ColorSource::Classification:
            return cloud.attributes.classification;
        case ColorSource::Normal:
            return cloud.attributes.normal;
        case ColorSource::Curvature:
            return hasCurvature(cloud);
        case ColorSource::Column:  // which one, chooseColumns() judges
        case ColorSource::Auto:
        case ColorSource::Elevation:
        case ColorSource::Depth:
        case ColorSource::Lod:
        case ColorSource::Visibility:
        case ColorSource::Cloud:
        case ColorSource::Flat:
            return true;
    }
    return false;
}

}  // namespace scancast
