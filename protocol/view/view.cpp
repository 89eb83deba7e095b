#include "protocol/view/view.hpp"

#include "protocol/view/view_checks.hpp"
#include "protocol/view/view_values.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast {

Expected<void> validate(const View& view) {
    for (const auto& word : viewWords())
        if (word.value.matters(view))
            if (auto ok = word.value.check(view, word.word); !ok) return ok;
    return checks::camera(view.camera);
}

std::string colorWord(const Style& style) {
    return values::print(values::Color{style.color, style.flatColor, style.byIntensity, style.column});
}

}  // namespace scancast
