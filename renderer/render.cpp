#include "renderer/render.hpp"

namespace scancast {

Expected<Frame> render(Device& device, const Cloud& cloud, const View& view, const RenderOptions& options,
                       std::stop_token stop) {
    auto planned = plan(cloud, view);
    if (!planned) return passOn(planned);
    RenderOptions here = options;
    if (!here.mostSamples) here.mostSamples = mostSamplesOn(device);
    const auto prepared = prepare(cloud, std::move(*planned), here, stop);
    if (!prepared) return passOn(prepared);
    return draw(device, **prepared, std::move(stop), options.wait ? Uploads::Everything : Uploads::ForAFrame);
}

}  // namespace scancast
