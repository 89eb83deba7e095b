#include "renderer/method/method.hpp"

#include <algorithm>

#include "renderer/method/sprites.hpp"

namespace scancast {

std::span<const Method> methods() {
    static const std::vector<Method> all = spriteMethods();
    return all;
}

const Method* findMethod(std::string_view name) {
    const auto all = methods();
    const auto found = std::ranges::find(all, name, &Method::name);
    return found == all.end() ? nullptr : &*found;
}

}  // namespace scancast
