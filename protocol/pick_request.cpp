#include "protocol/pick_request.hpp"

#include "protocol/json_fields.hpp"
#include "protocol/json_text.hpp"

namespace scancast {

Expected<PickRequest> parsePickRequest(std::string_view text) {
    const auto value = parseJson(text);
    if (!value) return passOn(value);
    PickRequest pick;
    FieldReader fields(*value);
    if (const auto* view = fields.findValue("view")) {
        if (view->is_object())
            pick.view = *view;
        else
            fields.error("view", "expected an object");
    }
    if (fields.require("x")) fields.number("x", pick.x);
    if (fields.require("y")) fields.number("y", pick.y);
    if (auto ok = fields.finishStrict(); !ok) return passOn(ok);
    return pick;
}

}  // namespace scancast
