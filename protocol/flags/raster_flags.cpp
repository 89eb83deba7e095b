#include "protocol/flags/raster_flags.hpp"

#include "protocol/view/view_words.hpp"

namespace scancast {

void RasterFlags::addTo(CLI::App& app) {
    for (const RasterWord& word : rasterWords()) {
        if (word.elevationOnly && kind_ != RasterKind::Elevation) continue;
        const std::string flag = "--" + std::string(word.word);
        app.add_option_function<std::string>(
               flag,
               [this, name = std::string(word.word)](const std::string& text) {
                   if (auto ok = rasterRequestOf(kind_, {{name, text}}); !ok)
                       throw CLI::ValidationError(ok.error().message);
                   own_.emplace_back(name, text);
               },
               std::string(word.meaning) + " Example: " + flag + " " + std::string(word.example))
            ->type_name(std::string(word.shape));
    }
    view_.addTo(app, [kind = kind_](const ViewWord& word) { return isWordOf(kind, word.word); });
}

Expected<RasterRequest> RasterFlags::request() const {
    WordValues words = own_;
    const auto view = view_.words();
    if (!view) return passOn(view);
    words.insert(words.end(), view->begin(), view->end());
    return rasterRequestOf(kind_, words);
}

}  // namespace scancast
