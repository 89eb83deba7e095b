// What benchmarks share: medians, options, lists of words, and an end with a sentence where something fails.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "protocol/error.hpp"
#include "renderer/image/frame.hpp"

namespace scancast::bench {

template <class T>
T orExit(Expected<T> result) {
    if (result) return std::move(*result);
    std::fprintf(stderr, "%s\n", result.error().message.c_str());
    std::exit(1);
}

inline void orExit(const Expected<void>& result) {
    if (result) return;
    std::fprintf(stderr, "%s\n", result.error().message.c_str());
    std::exit(1);
}

/// "a,b" → a, b.
inline std::vector<std::string> words(const std::string& list) {
    std::vector<std::string> out;
    std::istringstream in(list);
    for (std::string word; std::getline(in, word, ',');) out.push_back(word);
    return out;
}

/// An option of the command line, and what it does with the word behind it; `alone`: there is none.
struct Option {
    std::string name;
    std::function<void(const std::string&)> take;
    bool alone = false;
};

inline Option wordsOption(const char* name, std::vector<std::string>& into) {
    return {name, [&into](const std::string& value) { into = words(value); }};
}
inline Option countOption(const char* name, int& into, int least) {
    return {name,
            [&into, least](const std::string& value) { into = std::max(least, std::atoi(value.c_str())); }};
}
inline Option flagOption(const char* name, bool& into, bool to = true) {
    return {name, [&into, to](const std::string&) { into = to; }, true};
}

/// Ends with `example`, a command line, at what is none of them.
inline void readOptions(int argc, char** argv, const std::vector<Option>& options,
                        const std::string& example) {
    for (int i = 1; i < argc; ++i) {
        const auto option = std::ranges::find(options, std::string(argv[i]), &Option::name);
        if (option == options.end()) {
            std::fprintf(stderr, "%s: unknown option %s; example: %s\n",
                         example.substr(0, example.find(' ')).c_str(), argv[i], example.c_str());
            std::exit(2);
        }
        option->take(!option->alone && i + 1 < argc ? argv[++i] : "");
    }
}

inline double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Milliseconds that some work takes.
template <class Work>
double timed(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// The stages of several frames, in the order in which they first came.
class StageTimes {
  public:
    void add(const std::vector<StageTime>& stages) {
        for (const StageTime& stage : stages) {
            if (!times_.contains(stage.name)) order_.push_back(stage.name);
            times_[stage.name].push_back(stage.milliseconds);
        }
    }
    std::vector<StageTime> medians() const {
        std::vector<StageTime> all;
        for (const std::string& name : order_) all.push_back({name, median(times_.at(name))});
        return all;
    }

  private:
    std::vector<std::string> order_;
    std::map<std::string, std::vector<double>> times_;
};

}  // namespace scancast::bench
