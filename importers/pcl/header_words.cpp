#include "importers/pcl/header_words.hpp"

namespace scancast::import_pcl {

std::vector<std::string_view> words(std::string_view line) {
    std::vector<std::string_view> result;
    for (;;) {
        const auto begin = line.find_first_not_of(" \t\r");
        if (begin == std::string_view::npos) return result;
        line.remove_prefix(begin);
        result.push_back(line.substr(0, line.find_first_of(" \t\r")));
        line.remove_prefix(result.back().size());
    }
}

}  // namespace scancast::import_pcl
