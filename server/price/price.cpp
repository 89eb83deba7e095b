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
            return "depth";
        case PictureFormat::Jpeg:
            break;
    }
    return "jpeg";
}

double pixelsOf(const View& view) {
    return double(view.width) * view.height;
}

double price(const Rates& rates, const PlannedView& planned, PictureFormat format, double samples) {
    const View& view = planned.view;
    const auto method = rates.methods.find(planned.method);
    const Rates::Method rate = method == rates.methods.end() ? Rates::Method{} : method->second;
    double pixel = rate.pixel;
    for (const Pass& pass : planned.passes) pixel += rateIn(rates.passes, std::string(nameOf(pass)));
    // Depth is that of the pixels' centres, whatever is asked for.
    const double frames = format == PictureFormat::Depth ? 1 : view.quality.samples.value_or(defaultSamples);
    const double ns = frames * (pixelsOf(view) * pixel + samples * rate.sample) +
                      pixelsOf(view) * rateIn(rates.encoders, encoderOf(format));
    return ns * 1e-6;
}

/// Samples of a surface of so many pixels, for each layer of it that is seen or hidden, and for as many layers as
/// pictures hardly ever have.
constexpr double mostLayers = 8;

}  // namespace

double priceOf(const Rates& rates, const Cloud& cloud, const PlannedView& planned, PictureFormat format) {
    return price(rates, planned, format, double(samplesWanted(cloud, planned)));
}

double mostPriceOf(const Rates& rates, const Cloud& cloud, const PlannedView& planned, PictureFormat format) {
    double samples = double(cloud.points) * 2;  // levels above the leaves have less than as many again
    if (planned.selection.budget) samples = std::min(samples, double(*planned.selection.budget));
    const double detail = std::max(planned.view.quality.detail.value_or(planned.selection.detail), 1e-3);
    samples = std::min(samples, mostLayers * pixelsOf(planned.view) / (detail * detail));
    return price(rates, planned, format, samples);
}

std::map<std::string, double> nearestWithin(double limit, const Rates& rates, const Cloud& cloud,
                                            const View& view, PictureFormat format) {
    const auto costs = [&](const View& candidate) {
        const auto planned = plan(cloud, candidate);
        return planned ? priceOf(rates, cloud, **planned, format) : 0;
    };
    std::map<std::string, double> words;
    View nearest = view;
    if (costs(nearest) <= limit) return words;
    // Each frame costs the same, but for the encoder: found by halving.
    const int asked = view.quality.samples.value_or(defaultSamples);
    const auto withSamples = [&](int samples) {
        nearest.quality.samples = samples;
        return costs(nearest);
    };
    int fits = 0, exceeds = asked;
    while (exceeds - fits > 1) {
        const int middle = (fits + exceeds) / 2;
        (withSamples(middle) <= limit ? fits : exceeds) = middle;
    }
    nearest.quality.samples = std::max(fits, 1);
    if (asked != *nearest.quality.samples) words["samples"] = *nearest.quality.samples;
    if (fits >= 1) return words;
    // One frame is too much. Detail, as far as it helps: to where the picture's samples are as many as its pixels.
    const auto planned = plan(cloud, nearest);
    const double own = planned ? (*planned)->selection.detail : 1;
    for (double detail = std::max(own, 0.01) * 2; detail <= 2 && costs(nearest) > limit; detail *= 2)
        words["detail"] = *(nearest.quality.detail = detail);
    for (double side = 1; costs(nearest) > limit && side > 1e-3; side *= 0.9) {
        nearest.width = std::max(1, int(view.width * side));
        nearest.height = std::max(1, int(view.height * side));
        words["width"] = nearest.width;
        words["height"] = nearest.height;
    }
    return words;
}

}  // namespace scancast
