// What pictures cost, as a table: time of one core of a reference machine for each pixel, sample and byte's worth
// of work. The same table gives the same prices everywhere, whatever the machine and its load, so that who was
// refused once is refused again; `serve --rates FILE` puts another in its place.
//
// Plain values; any thread. Measured by tests/bench/prices/bench_prices.cpp. Place: **rates** → price → api, stream.
#pragma once

#include <map>
#include <string>

#include "protocol/error.hpp"

namespace scancast {

/// ns.
struct Rates {
    struct Method {
        double pixel = 0;   ///< for each pixel and anti-aliasing frame
        double sample = 0;  ///< for each sample of the cut and anti-aliasing frame
    };
    std::map<std::string, Method> methods;
    /// Screen passes by name, beside what a method needs anyway; for each pixel and frame.
    std::map<std::string, double> passes;
    /// "jpeg", "png", "depth"; for each pixel.
    std::map<std::string, double> encoders;
};

/// As measured on two cores of a server of 2024, x86-64-v4, and rounded.
const Rates& shippedRates();

/// The shipped ones with those of a JSON text in their place: {"methods": {"ewa": {"pixel": 40, "sample": 12}},
/// "passes": {"phong": 8}, "encoders": {"png": 90}}. Errors name the key: Malformed, InvalidArgument.
Expected<Rates> parseRates(const std::string& text);

}  // namespace scancast
