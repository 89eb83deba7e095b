// The server as a stream session sees it: its catalog and its methods. Stateless; any thread.
#pragma once

#include "server/catalog/catalog.hpp"
#include "server/price/admission.hpp"
#include "server/stream/session.hpp"

namespace scancast {

class CatalogWorld final : public StreamWorld {
  public:
    /// Both outlive this.
    CatalogWorld(const Catalog& catalog, const Admission& admission)
        : catalog_(catalog), admission_(admission) {}
    std::string defaultCloud() const override { return catalog_.defaultId(); }
    tl::expected<std::shared_ptr<const Cloud>, Problem> cloud(std::string_view id) const override {
        return catalog_.cloud(id);
    }
    bool loading(std::string_view id) const override {
        const auto entry = catalog_.find(id);
        return entry && entry->state == CloudState::Loading;
    }
    bool live(std::string_view id) const override { return catalog_.isLive(id); }
    Expected<std::shared_ptr<const PlannedView>> plan(const Cloud& cloud, const View& view) const override;
    Expected<void> mayBeDrawn(const Cloud& cloud, const PlannedView& planned) const override {
        return admission_.mayBeDrawn(cloud, planned);
    }
    double ownDetail(const View& view) const override;
    std::vector<std::string> methodNames() const override;

  private:
    const Catalog& catalog_;
    const Admission& admission_;
};

}  // namespace scancast
