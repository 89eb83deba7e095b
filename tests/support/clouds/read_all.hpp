// All points of a scan in one batch: sources cut them into batches as they like.
#pragma once

#include "renderer/cloud/point_batch.hpp"

namespace scancast::test {

/// What is left of the source. Errors: those of read().
inline Expected<PointBatch> readAll(PointSource& source) {
    PointBatch all, batch;
    for (;;) {
        const auto more = source.read(batch);
        if (!more) return passOn(more);
        if (!*more) return all;
        append(all, batch);
    }
}

}  // namespace scancast::test
