// The server as a stream session sees it: the clouds that its client may know of, and the methods. Stateless; any thread.
#pragma once

#include "server/catalog/visible_clouds.hpp"
#include "server/price/admission.hpp"
#include "server/stream/session.hpp"

namespace scancast {

class CatalogWorld final : public StreamWorld {
  public:
    /// The catalog that the clouds are of, and the other one, outlive this.
    CatalogWorld(VisibleClouds clouds, const Admission& admission)
        : clouds_(std::move(clouds)), admission_(admission) {}
    std::string defaultCloud() const override { return clouds_.defaultId(); }
    tl::expected<std::shared_ptr<const Cloud>, Problem> cloud(std::string_view id) const override {
        return clouds_.cloud(id);
    }
    Expected<std::shared_ptr<const Cloud>> viewed(std::string_view id, const View& view) const override {
        return clouds_.viewed(id, view);
    }
    bool loading(std::string_view id) const override {
        const auto entry = clouds_.find(id);
        return entry && entry->state == CloudState::Loading;
    }
    bool live(std::string_view id) const override { return clouds_.isLive(id); }
    Expected<std::shared_ptr<const PlannedView>> plan(const Cloud& cloud, const View& view) const override;
    Expected<void> mayBeDrawn(const Cloud& cloud, const PlannedView& planned) const override {
        return admission_.mayBeDrawn(cloud, planned);
    }
    double ownDetail(const View& view) const override;
    std::vector<std::string> methodNames() const override;

  private:
    const VisibleClouds clouds_;
    const Admission& admission_;
};

}  // namespace scancast
