// What a row is held against: the marks of this project for a graphics card, and the figures of the papers.
// Pure; docs/performance.md has the same list.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/bench/gpu/measure.hpp"

namespace scancast::bench {

struct Mark {
    std::string what;         ///< "GPU", "frame", "view to JPEG": what of the row
    double measured = 0;      ///< ms
    double most = 0;          ///< ms; the slowest that is wanted, or that was published
    std::string published{};  ///< a paper's figure, for people, and whose; empty = a mark of this project

    bool met() const { return measured <= most; }
    /// "GPU 1.80 <= 2 ms: met"; "hidden points 0.31 ms (2.1-2.7 on a GTX 1080, published)".
    std::string text() const;
};

/// Of a row that was timed; most rows have one or none.
std::vector<Mark> marksOf(const Row& row);

}  // namespace scancast::bench
