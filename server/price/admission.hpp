// What a picture may cost, and how much may be asked for at a time: whoever wants more is told the price, the limit, and
// what would be drawn.
//
// Owned by the server. *Thread safety*: any thread. Place: price, work budget → **admission** → api, stream.
#pragma once

#include <optional>
#include <string>

#include "protocol/problem.hpp"
#include "server/base/transient_memory.hpp"
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
    Admission(Rates rates, const CostLimits& limits, const TransientMemory& memory = TransientMemory());

    const CostLimits& limits() const { return limits_; }
    /// ms; or 413, with the nearest that would do: it costs too much, or takes more memory than there is for one.
    tl::expected<double, Problem> price(const Cloud& cloud, const PlannedView& planned,
                                        PictureFormat format) const;
    /// Whether price() would say a number, for who asks often: selects nothing where that is clear. ResourceLimit.
    Expected<void> mayBeDrawn(const Cloud& cloud, const PlannedView& planned) const;
    /// Held while the picture is waited for; 429 when this client, 503 when all together ask for more than they may.
    tl::expected<WorkBudget::Ticket, Problem> take(const std::string& client, double price) const;
    /// Held as long as the picture's bytes are there, i.e. until it has been read (PictureOrder::kept); 429 when this
    /// client, 503 when all together leave more unread than there is memory for.
    tl::expected<WorkBudget::Ticket, Problem> keep(const std::string& client, std::uint64_t bytes) const;

  private:
    struct Size {
        int width = 0, height = 0;
    };
    std::optional<Size> nearestInMemory(const View& view, PictureFormat format) const;
    Error tooLarge(const View& view, PictureFormat format, const Size& nearest) const;
    Problem tooCostly(double price, const Cloud& cloud, const View& view, PictureFormat format) const;

    const Rates rates_;
    const CostLimits limits_;
    const TransientMemory memory_;
    const WorkBudget budget_;
    const WorkBudget unread_;  ///< in bytes
};

}  // namespace scancast
