#include "server/price/price.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "renderer/prepare.hpp"

namespace scancast {
namespace {

double rateIn(const std::map<std::string, double>& rates, const std::string& name) {
    const auto at = rates.find(name);
    return at == rates.end() ? 0 : at->second;
}

/// Those that a style asks for; a method's own are part of its rate.
std::string_view nameOf(const Pass& pass) {
    if (std::holds_alternative<PhongPass>(pass)) return "phong";
    if (std::holds_alternative<EyeDomePass>(pass)) return "eyedome";
    if (std::holds_alternative<OcclusionPass>(pass)) return "occlusion";
    if (std::holds_alternative<ShadowPass>(pass)) return "shadow";
    return "";
}

std::string encoderOf(PictureFormat format) {
    switch (format) {
        case PictureFormat::Png:
            return "png";
        case PictureFormat::Depth:
        case PictureFormat::Pixels:  // copied, too
            return "depth";
        case PictureFormat::Jpeg:
            break;
    }
    return "jpeg";
}

double pixelsOf(const View& view) {
    return double(view.width) * view.height;
}

/// ms: of each anti-aliasing frame, and once.
struct Parts {
    double frame = 0, once = 0;
    double of(int frames) const { return frames * frame + once; }
};

Parts partsOf(const Rates& rates, const PlannedView& planned, PictureFormat format, double samples) {
    const auto method = rates.methods.find(planned.method);
    const Rates::Method rate = method == rates.methods.end() ? Rates::Method{} : method->second;
    double pixel = rate.pixel;
    for (const Pass& pass : planned.passes) pixel += rateIn(rates.passes, std::string(nameOf(pass)));
    const double pixels = pixelsOf(planned.view);
    return {(pixels * pixel + samples * rate.sample) * 1e-6,
            pixels * rateIn(rates.encoders, encoderOf(format)) * 1e-6};
}

/// Depth is that of the pixels' centres, whatever is asked for.
int framesOf(const View& view, PictureFormat format) {
    return format == PictureFormat::Depth ? 1 : view.quality.samples.value_or(defaultSamples);
}

/// Samples of a surface of so many pixels, for each layer of it that is seen or hidden, and for as many layers as
/// pictures hardly ever have.
constexpr double mostLayers = 8;

}  // namespace

double priceOf(const Rates& rates, const Cloud& cloud, const PlannedView& planned, PictureFormat format) {
    const auto samples = double(samplesWanted(cloud, planned));
    return partsOf(rates, planned, format, samples).of(framesOf(planned.view, format));
}

double mostPriceOf(const Rates& rates, const Cloud& cloud, const PlannedView& planned, PictureFormat format) {
    double samples = double(cloud.points) * 2;  // levels above the leaves have less than as many again
    if (planned.selection.budget) samples = std::min(samples, double(*planned.selection.budget));
    const double detail = std::max(planned.selection.detail, 1e-3);
    samples = std::min(samples, mostLayers * pixelsOf(planned.view) / (detail * detail));
    return partsOf(rates, planned, format, samples).of(framesOf(planned.view, format));
}

std::map<std::string, double> nearestWithin(double limit, const Rates& rates, const Cloud& cloud,
                                            const View& view, PictureFormat format) {
    const auto partsWith = [&](const View& candidate) {
        const auto planned = plan(cloud, candidate);
        return planned ? partsOf(rates, **planned, format, double(samplesWanted(cloud, **planned))) : Parts{};
    };
    const int asked = framesOf(view, format);
    Parts parts = partsWith(view);
    if (parts.of(asked) <= limit) return {};
    std::map<std::string, double> words;
    View nearest = view;
    const int fits = int(std::clamp((limit - parts.once) / parts.frame, 1.0, double(asked)));
    if (fits < asked) words["samples"] = *(nearest.quality.samples = fits);
    if (parts.of(fits) <= limit) return words;
    // One frame is too much. Coarser detail, as far as it helps: to where there are no more samples than pixels.
    for (double detail = 0.02; detail <= 2 && parts.of(1) > limit; detail *= 2) {
        if (view.quality.detail.value_or(1) >= detail) continue;
        words["detail"] = *(nearest.quality.detail = detail);
        parts = partsWith(nearest);
    }
    for (double side = 1; parts.of(1) > limit && nearest.width * nearest.height > 1;) {
        side *= std::min(0.95, std::sqrt(limit / parts.of(1)));
        words["width"] = nearest.width = std::max(1, int(view.width * side));
        words["height"] = nearest.height = std::max(1, int(view.height * side));
        parts = partsWith(nearest);
    }
    return words;
}

}  // namespace scancast
