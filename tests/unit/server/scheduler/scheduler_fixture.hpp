// What tests of the scheduler share: orders that tell themselves apart by their width, and their results.
#pragma once

#include <gtest/gtest.h>

#include "server/scheduler/scheduler.hpp"
#include "tests/support/serving/fake_painter.hpp"

namespace scancast::test {

/// Results as they come in, from whatever thread.
class Results {
  public:
    PictureDone collect(int label) {
        return [this, label](Expected<EncodedPicture> result) {
            const std::lock_guard lock(mutex_);
            labels_.push_back(label);
            codes_.push_back(result ? std::nullopt : std::optional(result.error().code));
            devices_.push_back(result ? result->device.identity : "");
            changed_.notify_all();
        };
    }
    bool waitFor(std::size_t count) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, FakePainter::patience, [&] { return labels_.size() >= count; });
    }
    std::vector<int> labels() const {
        const std::lock_guard lock(mutex_);
        return labels_;
    }
    /// How the order of that label ended: nullopt = with a picture.
    std::optional<ErrorCode> code(int label) const {
        const std::lock_guard lock(mutex_);
        for (std::size_t i = 0; i < labels_.size(); ++i) {
            if (labels_[i] == label) return codes_[i];
        }
        ADD_FAILURE() << "order " << label << " never ended";
        return ErrorCode::Internal;
    }

    /// Which device drew them, in the order in which they came.
    std::vector<std::string> devices() const {
        const std::lock_guard lock(mutex_);
        return devices_;
    }

  private:
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<int> labels_;
    std::vector<std::string> devices_;
    std::vector<std::optional<ErrorCode>> codes_;
};

class SchedulerTest : public ::testing::Test {
  protected:
    PictureOrder order(int width, bool interruptible = false) const {
        PictureOrder order;
        order.cloud = cloud;
        order.view.width = width;  // tells pictures apart
        order.view.height = 8;
        order.interruptible = interruptible;
        return order;
    }
    /// A frame while the camera moves: drawn with what is in memory.
    PictureOrder moving(int width) const {
        PictureOrder frame = order(width);
        frame.complete = false;
        return frame;
    }
    /// A still that is drawn with everything, if that is in memory.
    PictureOrder trial(int width) const {
        PictureOrder still = order(width, true);
        still.complete = false;
        still.onlyWhole = true;
        return still;
    }
    std::vector<int> begunWidths() const {
        std::vector<int> widths;
        for (const auto& painted : painter.begun()) widths.push_back(painted.view.width);
        return widths;
    }
    std::string metric(const std::string& line) const {
        const std::string text = metrics.text();
        const auto at = text.find('\n' + line);
        return at == std::string::npos ? "" : text.substr(at + 1, text.find('\n', at + 1) - at - 1);
    }

    std::shared_ptr<const Cloud> cloud = test::tinyCloud();
    FakePainter painter;
    Metrics metrics{"test"};
    Results results;
};

}  // namespace scancast::test
