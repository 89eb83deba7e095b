// What a picture costs before any work is done on it: pixels x frames x what its method and passes need, samples of
// its cut x frames x what its method needs for one, and the encoder. In ms of a reference core (rates.hpp).
//
// Pure functions, any thread: the price depends on the view, the cloud and the table, on nothing else. Place: plan →
// **price** → api, stream → scheduler.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "renderer/plan.hpp"
#include "server/price/rates.hpp"
#include "server/scheduler/picture_order.hpp"

namespace scancast {

/// ms. What the cut has is selected for this, which takes about a millisecond; its samples are not touched.
double priceOf(const Rates& rates, const Cloud& cloud, const PlannedView& planned, PictureFormat format);

/// Hardly ever less, and known without selecting: by the cloud's size, the budget, and how many samples a surface of so
/// many pixels may have.
double mostPriceOf(const Rates& rates, const Cloud& cloud, const PlannedView& planned, PictureFormat format);

/// The nearest view that costs no more than `limit`, as words to change: first fewer anti-aliasing frames, then
/// coarser detail, then a smaller picture of the same shape. Empty: the view itself does.
std::map<std::string, double> nearestWithin(double limit, const Rates& rates, const Cloud& cloud,
                                            const View& view, PictureFormat format);

}  // namespace scancast
