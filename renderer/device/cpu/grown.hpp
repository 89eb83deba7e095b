// Buffers that live as long as the device: they grow to the largest picture and stay.
#pragma once

#include <cstddef>
#include <vector>

namespace scancast::cpu {

/// At least `size` elements; what they hold is anybody's.
template <class T>
T* grown(std::vector<T>& buffer, std::size_t size) {
    if (buffer.size() < size) buffer.resize(size);
    return buffer.data();
}

}  // namespace scancast::cpu
