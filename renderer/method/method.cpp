#include "renderer/method/method.hpp"

#include <algorithm>

#include "renderer/method/automatic.hpp"
#include "renderer/method/hqs.hpp"
#include "renderer/method/light.hpp"
#include "renderer/method/pyramid.hpp"
#include "renderer/method/sprites.hpp"
#include "renderer/method/surfels.hpp"
#include "renderer/method/voronoi.hpp"

namespace scancast {

std::span<const Method> methods() {
    static const std::vector<Method> all = [] {
        std::vector<Method> list = spriteMethods();
        list.push_back(hqsMethod());
        list.push_back(discMethod());
        list.push_back(ewaMethod());
        list.push_back(voronoiMethod());
        list.push_back(pyramidMethod());
        list.push_back(automaticMethod());
        return list;
    }();
    return all;
}

const Method* findMethod(std::string_view name) {
    const auto all = methods();
    const auto found = std::ranges::find(all, name, &Method::name);
    return found == all.end() ? nullptr : &*found;
}

void addShading(const PassRequest& request, PassList& list) {
    if (castsShadows(request.light)) list.push_back(shadowPass(request.light, request.shading));
    if (request.shading == Shading::Phong) list.push_back(phongPass(request.light, request.cloud.up));
    if (request.shading == Shading::EyeDome) list.push_back(EyeDomePass{});
    if (request.light.occlusion.value_or(0) > 0) list.push_back(occlusionPass(request.light, request.height));
}

}  // namespace scancast
