// What heads of files say of points that have not been read yet: how many there are, between which bounds, by which return.
// Reads what it must and no more: of leaves that are wanted as a whole their number is known, and the few that may lie
// outermost say the bounds. Pipeline: cloud file → **survey** → writer. Owned and used by one thread, step by step.
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "renderer/cloud/export/cloud_points.hpp"
#include "renderer/cloud/export/export_writer.hpp"

namespace scancast {

class SurveyAhead {
  public:
    SurveyAhead(std::shared_ptr<const CloudFile> file, const CloudPointsOptions& options,
                ExportFormat format);

    /// Some of the work: a batch, or a few leaves. Whether there is more. Errors: the file's.
    Expected<bool> step();
    /// Once there is no more: the number of points; of LAS bounds and returns, too. The highest class is the cloud's.
    const PointSurvey& survey() const { return survey_; }

  private:
    Expected<bool> readPartly();
    Expected<bool> countReturns();
    Expected<bool> findBounds();
    void orderBySides();
    Expected<void> readBounds(const WantedLeaf& leaf);

    std::shared_ptr<const CloudFile> file_;
    CloudPointsOptions options_;
    bool isLas_;
    std::unique_ptr<PointSource> partly_;  ///< leaves of which points have to be looked at
    std::vector<WantedLeaf> whole_;        ///< the others
    std::size_t counted_ = 0;              ///< of whole_, by return
    struct Side {
        int axis = 0;
        bool upper = false;
        std::vector<std::pair<double, std::uint32_t>> reach;  ///< of whole_, which may lie outermost first
        std::size_t next = 0;
    };
    std::vector<Side> sides_;             ///< once their bounds are looked for
    std::vector<bool> read_;              ///< of whole_: their bounds are known
    std::optional<std::size_t> returns_;  ///< the plane that says them
    PointSurvey survey_;
};

}  // namespace scancast
