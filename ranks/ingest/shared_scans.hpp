// The scans of an ingest as one rank reads them: its share, and at the end what all ranks heard. Owned by the ingest, on its thread.
// Pipeline: sources → **shared scans** → staging.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ranks/ingest/reading_shares.hpp"
#include "ranks/mpi/communicator.hpp"
#include "renderer/cloud/build/ingest.hpp"
#include "renderer/cloud/build/many_scans.hpp"

namespace scancast {

class ShareOfScan;

class SharedScans {
  public:
    /// All ranks call it, with the same sources, opened for their headers. Photos go with the points: scans that have some
    /// to be kept are rank 0's.
    /// Errors: manyScans()'s; InvalidArgument for ranks that see other files than others do, or were started with other options.
    static Expected<SharedScans> create(std::vector<std::unique_ptr<PointSource>> sources,
                                        const IngestOptions& options, const Communicator& ranks);

    /// This rank's points.
    PointSource& source() { return *source_; }
    /// Once the others are heard: where all points were recorded from, if that is one place.
    std::optional<glm::dvec3> scannerOrigin() const { return many_->header().scannerOrigin; }
    /// This rank's, by what headers say.
    std::uint64_t pointsToRead() const { return pointsToRead_; }

    /// All is read, and all ranks call it: source() then says what all of it says. Errors: manyScans()'s at the end of reading, and those
    /// of whole scans there.
    Expected<void> hearOthers(const Communicator& ranks);

  private:
    std::vector<std::string> names_;
    std::vector<ShareOfScan*> shares_;
    ManyScans* many_ = nullptr;
    std::unique_ptr<PointSource> source_;
    std::uint64_t pointsToRead_ = 0;
};

}  // namespace scancast
