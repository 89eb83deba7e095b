#include "renderer/image/frame.hpp"

namespace scancast {

void FrameStats::add(std::string_view stage, double milliseconds) {
    for (auto& existing : stages) {
        if (existing.name == stage) {
            existing.milliseconds += milliseconds;
            return;
        }
    }
    stages.push_back({std::string(stage), milliseconds});
}

}  // namespace scancast
