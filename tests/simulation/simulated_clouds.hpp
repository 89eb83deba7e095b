// The clouds of a simulated server: one, and what may happen to it.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "server/stream/scene.hpp"
#include "tests/support/serving/fake_painter.hpp"

namespace scancast::simulation {

/// Its blocks come and go, so that sessions try their stills (server/stream/still_schedule.hpp); which are there,
/// the simulated server decides.
class SimulatedClouds final : public StreamWorld {
  public:
    /// Another one takes its name.
    void replace() { cloud_ = test::coldCloud(); }
    void remove() { cloud_ = nullptr; }
    void setLoading(bool loading) { loading_ = loading; }
    void setLive(bool live) { live_ = live; }

    std::string defaultCloud() const override { return "cloud"; }
    tl::expected<std::shared_ptr<const Cloud>, Problem> cloud(std::string_view) const override {
        if (!cloud_) return tl::unexpected(problemOf(404, "There is no cloud any more."));
        return cloud_;
    }
    bool loading(std::string_view) const override { return loading_; }
    bool live(std::string_view) const override { return live_; }
    Expected<std::shared_ptr<const PlannedView>> plan(const Cloud&, const View&) const override {
        return nullptr;
    }
    double ownDetail(const View&) const override { return 1; }
    std::vector<std::string> methodNames() const override { return {"paraboloid"}; }

  private:
    std::shared_ptr<const Cloud> cloud_ = test::coldCloud();
    bool loading_ = false, live_ = false;
};

}  // namespace scancast::simulation
