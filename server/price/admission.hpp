// What a picture may cost, and how much may be asked for at a time: whoever wants more is told the price, the limit, and
// what would be drawn.
//
// Owned by the server. *Thread safety*: any thread. Place: price, work budget → **admission** → api, stream.
#pragma once

#include <string>

#include "protocol/problem.hpp"
#include "server/price/price.hpp"
#include "server/price/work_budget.hpp"

namespace scancast {

/// ms of a reference core.
struct CostLimits {
    /// Of a picture: what 3840 x 2160 with 16 samples a pixel needs of any method and most clouds.
    double picture = 20'000;
    double client = 0;  ///< of all that one client waits for; 0 = half of `total`
    double total = 0;   ///< of all that is waited for; 0 = what the cores of this machine do in 25 s
};

/// With numbers where there were zeros, and none less than what one picture may cost.
CostLimits completed(CostLimits limits);

class Admission {
  public:
    Admission(Rates rates, const CostLimits& limits);

    const CostLimits& limits() const { return limits_; }
    /// ms; or 413, with the nearest that would do.
    tl::expected<double, Problem> price(const Cloud& cloud, const PlannedView& planned,
                                        PictureFormat format) const;
    /// Whether price() would say a number, for who asks often: selects nothing where that is clear. ResourceLimit.
    Expected<void> mayBeDrawn(const Cloud& cloud, const PlannedView& planned) const;
    /// Held while the picture is waited for; 429 when this client, 503 when all together ask for more than they may.
    tl::expected<WorkBudget::Ticket, Problem> take(const std::string& client, double price) const;

  private:
    Problem tooCostly(double price, const Cloud& cloud, const View& view, PictureFormat format) const;

    const Rates rates_;
    const CostLimits limits_;
    const WorkBudget budget_;
};

}  // namespace scancast
