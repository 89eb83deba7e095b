// A rendering method: name, parameters, and the short list of passes that draws it. One file pair per method
// of a paper. Methods know nothing of devices; the parameter list is the source of /methods, of the page's
// controls and of the documentation.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/view.hpp"
#include "renderer/device/pass.hpp"

namespace scancast {

struct Parameter {
    enum class Type : std::uint8_t { Number, Boolean, Choice };
    std::string name;  ///< as in `param.NAME=VALUE`
    Type type = Type::Number;
    ParameterValue defaultValue;
    double min = 0, max = 0;           ///< Number: inclusive
    std::vector<std::string> choices;  ///< Choice
    std::string unit;                  ///< "px", "" …
    std::string meaning;               ///< one sentence for people
};

struct Method {
    std::string name;
    std::string title;
    std::string summary;  ///< one or two sentences: what it shows well
    std::string source;   ///< the paper
    std::vector<Parameter> parameters;
    double defaultDetail = 1;  ///< τ, px
    Shading defaultShading = Shading::Unlit;
    /// `values` are complete and checked (resolveParameters). Ends with the shading's screen passes.
    PassList (*passes)(const Method& self, const ParameterValues& values, Shading shading) = nullptr;
};

/// Every method, in the order in which people should see them.
std::span<const Method> methods();
/// nullptr when there is none of that name.
const Method* findMethod(std::string_view name);
/// Fills in defaults and checks names, types and ranges. Errors: InvalidArgument with field "param.NAME",
/// naming the legal range or the nearest known name.
Expected<ParameterValues> resolveParameters(const Method& method, const ParameterValues& given);

}  // namespace scancast
