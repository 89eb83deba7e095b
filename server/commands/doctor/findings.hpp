// What `scancast doctor` found: a line for each thing that it looked at, and for each problem its mend. Plain values.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scancast {

enum class Verdict : std::uint8_t {
    Ok,
    Warning,  ///< it serves all the same
    Fault,    ///< it does not start, or does not do what it was told to
};
std::string_view name(Verdict verdict);

struct Finding {
    Verdict verdict = Verdict::Ok;
    std::string topic;  ///< "memory": one or two words
    std::string text;
    std::string mend;  ///< what to do; of a problem alone
};

class Findings {
  public:
    void ok(std::string topic, std::string text) {
        all_.push_back({Verdict::Ok, std::move(topic), std::move(text), {}});
    }
    void warning(std::string topic, std::string text, std::string mend) {
        all_.push_back({Verdict::Warning, std::move(topic), std::move(text), std::move(mend)});
    }
    void fault(std::string topic, std::string text, std::string mend) {
        all_.push_back({Verdict::Fault, std::move(topic), std::move(text), std::move(mend)});
    }
    /// Nothing is a fault.
    bool sound() const;
    const std::vector<Finding>& all() const { return all_; }

    /// A line each, the mend in one of its own below it, and a sum.
    std::string text() const;
    /// {"sound": …, "findings": [{"verdict", "topic", "text", "mend"}, …]}
    std::string json() const;

  private:
    std::vector<Finding> all_;
};

}  // namespace scancast
