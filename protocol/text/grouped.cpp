#include "protocol/text/grouped.hpp"

#include <cstddef>

namespace scancast {

std::string grouped(unsigned long long number) {
    auto digits = std::to_string(number);
    for (auto at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3)
        digits.insert(static_cast<std::size_t>(at), 1, ',');
    return digits;
}

}  // namespace scancast
