// What bench_gpu leaves behind: Markdown on standard output, row by row, and the same in a JSON file, which
// is whole after every row - whoever stops the program keeps what was measured.
#pragma once

#include <nlohmann/json.hpp>

#include "tests/bench/gpu/measure.hpp"

namespace scancast::bench {

class Report {
  public:
    Report(const DeviceInfo& device, const Settings& settings);

    void beginCloud(const Cloud& cloud, double seconds);
    void add(const Row& row);
    /// Says how many pictures were compared, and whether marks were missed; the JSON file then says
    /// "complete".
    void end();
    /// Of pictures further from the cpu device's than devices may be.
    int wrongPictures() const { return wrong_; }

  private:
    void save() const;

    std::filesystem::path file_;
    std::string scene_;
    nlohmann::ordered_json json_;
    int compared_ = 0, same_ = 0, wrong_ = 0, marks_ = 0, met_ = 0;
};

}  // namespace scancast::bench
