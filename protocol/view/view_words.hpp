// The words of a view: one table (view_table.cpp) from which a query, the JSON view, the flags of both
// programs with their help, and validate() are made; tests hold PROTOCOL.md and openapi.json against it.
//
// Pure functions and one constant table; any thread. Pipeline: URL or command line → **applyWords** → the
// view.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string_view>

#include "protocol/view/query.hpp"
#include "protocol/view/view.hpp"

namespace scancast {

class FieldReader;

/// What a number may be, both ends included.
struct ViewRange {
    double least, most;
    std::string_view must;  ///< the sentence after the word and "must": "lie between 1 and 64"
    ErrorCode code = ErrorCode::InvalidArgument;
};

/// How a word's value gets into a view and out of it.
struct ViewValue {
    /// Leaves the view alone when the text is none; `word` tells the parameters of a method apart.
    std::function<tl::expected<void, std::string>(View&, std::string_view word, std::string_view text)> parse;
    /// Records what is wrong as an error of `key`; whether there was a value.
    std::function<bool(View&, FieldReader&, std::string_view key)> read;
    std::function<nlohmann::json(const View&)> print;
    /// Of this value alone; what several words say together is validate()'s.
    std::function<Expected<void>(const View&, std::string_view word)> check;
    std::optional<ViewRange> range{};
    /// Whether the value has a part in the picture: the field of view has none in an orthographic camera.
    std::function<bool(const View&)> matters = [](const View&) { return true; };
};

/// One word of the vocabulary.
struct ViewWord {
    std::string_view
        word;  ///< "viewHeight", "light.ambient"; "param.NAME" stands for every parameter of a method
    std::string_view path;     ///< in the JSON view: "camera.viewHeight", "param"
    std::string_view shape;    ///< of the value: "X,Y,Z"
    std::string_view meaning;  ///< one sentence
    std::string_view example;  ///< a legal value: "12.5,-3,1.7" ("sizePx=5" for param.NAME)
    ViewValue value;

    /// Of a word with a dot, what stands before it: "param", "light"; else empty.
    std::string_view group() const;
    /// The word in kebab case, "--view-height"; of a group one for all, "--light", which takes NAME=VALUE and may be
    /// repeated.
    std::string flag() const;
    /// Meaning and range in sentences, as help, PROTOCOL.md and openapi.json have them.
    std::string description() const;
};

/// All of them, in the order in which help should show them.
std::span<const ViewWord> viewWords();

/// Sets one word, without checking the view as a whole (validate() does). On error `view` is as it was.
/// Errors: InvalidArgument with the word as field; unknown words name the nearest known one.
Expected<void> applyWord(View& view, std::string_view word, std::string_view value);

/// What can be judged of one word by itself: whether there is such a word, its value's form and range. Errors: those of
/// applyWord() and validate().
Expected<void> checkWord(std::string_view word, std::string_view value);

/// `base` with the given words changed, checked as a whole by validate(). Words that are not given keep the
/// base's value, so `eye` alone moves the eye and goes on looking at the base's target. The order of words is
/// of no importance; a word given twice is an error, and so is viewMatrix beside eye, target or up.
Expected<View> applyWords(const View& base, const WordValues& words);

}  // namespace scancast
