// A method's list of passes as devices run it: what is splatted, and what is done to the whole picture
// afterwards. Pure function. Pipeline: passes → **pass plan** → device.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/device/pass.hpp"

namespace scancast {

struct PassPlan {
    std::optional<SilhouettePass> silhouette;
    NearestPass nearest;
    std::optional<SumPass> sum;
    std::optional<CellPass> cell;
    ResolvePass resolve;
    std::vector<Pass> screen;

    /// Colours come from samples looked up by their ordinals.
    bool bySample() const { return cell.has_value() || nearest.payload == Payload::Sample; }
    /// Normals are needed by a later pass.
    bool normals() const { return resolve.normals || makesNormals(); }
    /// Pixels around the window that screen passes look at, as far as there is a picture …
    int reach() const;
    /// … and those that are drawn beyond its border, for passes that judge a pixel by what surrounds it.
    int guardBand() const;

  private:
    bool makesNormals() const;
};

/// Unsupported for a list that pass.hpp does not describe, with the reason.
Expected<PassPlan> planPasses(std::span<const Pass> passes);

}  // namespace scancast
