#include "protocol/text/grouped.hpp"

#include <cstddef>

namespace scancast {

std::string grouped(unsigned long long number) {
    auto digits = std::to_string(number);
    for (auto at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3)
        digits.insert(static_cast<std::size_t>(at), 1, ',');
    return digits;
}

std::string counted(unsigned long long number, std::string_view noun) {
    std::string text = std::to_string(number) + ' ';
    text += noun;
    return number == 1 ? text : text + 's';
}

}  // namespace scancast
