// A view as words, key=value: the query of a snapshot's URL and the flags of both programs.
//
// Pure functions and one constant table; any thread. Pipeline: URL or command line → **applyWords** → the
// view.
#pragma once

#include <span>
#include <string_view>

#include "protocol/query.hpp"
#include "protocol/view.hpp"

namespace scancast {

/// One word of the vocabulary, for whoever registers flags, prints help or writes documentation.
struct ViewWord {
    std::string_view word;     ///< "viewHeight"; "param.NAME" stands for every parameter of a method
    std::string_view flag;     ///< "--view-height"; "--param", which takes NAME=VALUE and may be repeated
    std::string_view value;    ///< shape of the value: "X,Y,Z"
    std::string_view meaning;  ///< one sentence
    std::string_view example;  ///< a legal value: "12.5,-3,1.7" ("sizePx=5" for param.NAME)
};

/// All of them, in the order in which help should show them.
std::span<const ViewWord> viewWords();

/// Sets one word, without checking the view as a whole (validate() does). On error `view` is as it was.
/// Errors: InvalidArgument with the word as field; unknown words name the nearest known one.
Expected<void> applyWord(View& view, std::string_view word, std::string_view value);

/// `base` with the given words changed, checked as a whole by validate(). Words that are not given keep the
/// base's value, so `eye` alone moves the eye and goes on looking at the base's target. The order of words is
/// of no importance; a word given twice is an error, and so is viewMatrix beside eye, target or up.
Expected<View> applyWords(const View& base, const WordValues& words);

}  // namespace scancast
