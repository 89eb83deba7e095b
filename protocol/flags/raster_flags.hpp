// A raster's words as flags of a program: its own, and those of a view that say something of it; the same in both programs, and over HTTP.
//
// Owned by whoever builds the command line; stays where it is, and outlives its parsing. One thread.
#pragma once

#include <CLI/CLI.hpp>

#include "protocol/flags/view_flags.hpp"
#include "protocol/raster/raster_request.hpp"

namespace scancast {

class RasterFlags {
  public:
    explicit RasterFlags(RasterKind kind) : kind_(kind) {}

    void addTo(CLI::App& app);
    /// Errors: rasterRequestOf()'s.
    Expected<RasterRequest> request() const;

  private:
    const RasterKind kind_;
    WordValues own_;
    ViewFlags view_;
};

}  // namespace scancast
