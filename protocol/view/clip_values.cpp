// The word `clips` as text and as JSON.
#include <algorithm>

#include "protocol/nearest_name.hpp"
#include "protocol/view/view_values.hpp"

namespace scancast::values {
namespace {

using nlohmann::json;

constexpr std::string_view boxWord = "box:", planeWord = "plane:";
const char* const boxText = "CX,CY,CZ,SX,SY,SZ, and maybe YAW or YAW,PITCH,ROLL behind them";

tl::unexpected<std::string> tooMany() {
    return tl::unexpected("there are more than " + std::to_string(mostClipShapes) + " shapes");
}

Parsed<ClipShape> parseBox(std::string_view text, bool outside) {
    std::array<double, 9> n{};
    const auto commas = static_cast<std::size_t>(std::ranges::count(text, ','));
    if (commas != 5 && commas != 6 && commas != 8)
        return tl::unexpected("a box has 6, 7 or 9 numbers, " + std::string(boxText) + "; got " +
                              std::to_string(commas + 1));
    if (const auto ok = parseNumbers(text, std::span(n).first(commas + 1)); !ok) return passOn(ok);
    return TurnedBox{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}, outside};
}

Parsed<ClipShape> parsePlane(std::string_view text) {
    std::array<double, 6> n{};
    if (const auto ok = parseNumbers(text, n); !ok)
        return tl::unexpected("a plane is PX,PY,PZ,NX,NY,NZ: " + ok.error());
    return HalfSpace{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
}

Parsed<ClipShape> parseShape(std::string_view text) {
    const bool outside = text.starts_with('-');
    const auto shape = text.substr(outside ? 1 : 0);
    if (shape.starts_with(boxWord)) return parseBox(shape.substr(boxWord.size()), outside);
    if (shape.starts_with(planeWord) && outside)
        return tl::unexpected(
            std::string("the other side of a plane is kept by turning its normal round, without a -"));
    if (shape.starts_with(planeWord)) return parsePlane(shape.substr(planeWord.size()));
    return tl::unexpected(quoteText(text) + " is no shape: write box:" + boxText +
                          ", -box: for what is outside of it, or plane:PX,PY,PZ,NX,NY,NZ, with ; between "
                          "shapes");
}

bool readBox(FieldReader& parent, const json& object, TurnedBox& out) {
    FieldReader fields(object, parent.path("box"));
    if (fields.require("center")) fields.vector("center", out.center);
    if (fields.require("size")) fields.vector("size", out.size);
    if (fields.findValue("turn")) fields.vector("turn", out.turn);
    const auto done = fields.finishStrict();
    if (!done) parent.error(done.error());
    return done.has_value();
}

bool readPlane(FieldReader& parent, const json& object, HalfSpace& out) {
    FieldReader fields(object, parent.path("plane"));
    if (fields.require("point")) fields.vector("point", out.point);
    if (fields.require("normal")) fields.vector("normal", out.normal);
    const auto done = fields.finishStrict();
    if (!done) parent.error(done.error());
    return done.has_value();
}

/// The field that says which side of a box is kept.
void readKeep(FieldReader& fields, TurnedBox& box) {
    std::string keep;
    if (!fields.findValue("keep") || !fields.text("keep", keep)) return;
    if (keep != "inside" && keep != "outside")
        fields.error("keep", quoteText(keep) + " is none of inside, outside");
    box.outside = keep == "outside";
}

bool readShape(FieldReader& fields, ClipShape& out) {
    const auto *const box = fields.findValue("box"), *const plane = fields.findValue("plane");
    if ((box == nullptr) == (plane == nullptr)) {
        fields.error(box ? "plane" : "box", "a shape is a box or a plane, and one of them");
        return false;
    }
    if (box) {
        TurnedBox made;
        if (readBox(fields, *box, made)) readKeep(fields, made);
        out = made;
    } else {
        HalfSpace made;
        readPlane(fields, *plane, made);
        out = made;
        if (fields.findValue("keep"))
            fields.error("keep", "belongs to boxes; a plane keeps the side that its normal points to");
    }
    return !fields.failed();
}

}  // namespace

Parsed<ClipShapes> parse(As<ClipShapes>, std::string_view text) {
    ClipShapes shapes;
    if (text == "auto") return shapes;
    for (std::string_view rest = text;;) {
        if (shapes.size() == mostClipShapes) return tooMany();
        const auto end = rest.find(';');
        auto shape = parseShape(rest.substr(0, end));
        if (!shape) return passOn(shape);
        shapes.push_back(*shape);
        if (end == std::string_view::npos) return shapes;
        rest.remove_prefix(end + 1);
    }
}

bool read(FieldReader& parent, std::string_view key, ClipShapes& out) {
    const auto* const list = parent.find(key);
    if (!list) return false;
    ClipShapes shapes;
    if (!list->is_array() && !list->is_null()) {
        parent.error(key,
                     R"(expected null or an array of shapes, such as {"box": {"center": …, "size": …}})");
        return false;
    }
    if (list->size() > mostClipShapes) {
        parent.error(key, tooMany().value());
        return false;
    }
    for (const json& item : *list) {
        FieldReader fields(item, parent.path(key) + "[" + std::to_string(shapes.size()) + "]");
        readShape(fields, shapes.emplace_back());
        if (auto done = fields.finishStrict(); !done) {
            parent.error(done.error());
            return false;
        }
    }
    out = std::move(shapes);
    return true;
}

json print(const ClipShapes& shapes) {
    if (shapes.empty()) return {};
    json list = json::array();
    for (const ClipShape& shape : shapes) {
        if (const auto* const half = std::get_if<HalfSpace>(&shape)) {
            list.push_back({{"plane", {{"point", print(half->point)}, {"normal", print(half->normal)}}}});
        } else {
            const TurnedBox& box = std::get<TurnedBox>(shape);
            list.push_back(
                {{"box",
                  {{"center", print(box.center)}, {"size", print(box.size)}, {"turn", print(box.turn)}}},
                 {"keep", box.outside ? "outside" : "inside"}});
        }
    }
    return list;
}

}  // namespace scancast::values
