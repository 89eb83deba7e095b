// resolveParameters: what a request gave → what a method needs, or a sentence that says why not.
#include <algorithm>
#include <cstdio>

#include "protocol/nearest_name.hpp"
#include "renderer/method/parameters.hpp"

namespace scancast {
namespace {

std::string printed(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", value);
    return text;
}

std::string listed(const std::vector<std::string>& names) {
    std::string out;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (i > 0) out += i + 1 == names.size() ? " or " : ", ";
        out += names[i];
    }
    return out;
}

/// A name as it may stand in a field: outside bytes need not be text.
std::string printable(std::string_view name) {
    std::string out(name.substr(0, 60));
    std::ranges::replace_if(
        out, [](char c) { return c <= ' ' || c > '~'; }, '?');
    return out;
}

Error unknownParameter(const Method& method, const std::string& name) {
    std::vector<std::string_view> known;
    for (const Parameter& p : method.parameters) known.push_back(p.name);
    const std::string field = "param." + printable(name);
    const std::string where = "method '" + method.name + "', parameter " + quoteText(name);
    if (known.empty()) {
        return Error{ErrorCode::InvalidArgument, where + ": it takes no parameters", field};
    }
    return Error{ErrorCode::InvalidArgument, unknownName(where, name, known), field};
}

/// Empty where the value is legal, else what it must be.
std::string whatIsWrong(const Parameter& p, const ParameterValue& value) {
    switch (p.type) {
        case Parameter::Type::Number: {
            const double* number = std::get_if<double>(&value);
            if (number != nullptr && *number >= p.min && *number <= p.max) return {};
            std::string text = "must be a number from " + printed(p.min) + " to " + printed(p.max);
            if (!p.unit.empty()) text += " " + p.unit;
            return number == nullptr ? text : text + ", not " + printed(*number);
        }
        case Parameter::Type::Boolean:
            return std::holds_alternative<bool>(value) ? std::string() : "must be true or false";
        case Parameter::Type::Choice: {
            const std::string* choice = std::get_if<std::string>(&value);
            if (choice != nullptr && std::ranges::find(p.choices, *choice) != p.choices.end()) return {};
            const std::string text = "must be " + listed(p.choices);
            return choice == nullptr ? text : text + ", not " + quoteText(*choice);
        }
    }
    return "has a type that this program does not know";
}

}  // namespace

Parameter numberParameter(std::string name, double value, double min, double max, std::string unit,
                          std::string meaning) {
    Parameter p;
    p.name = std::move(name);
    p.defaultValue = value;
    p.min = min;
    p.max = max;
    p.unit = std::move(unit);
    p.meaning = std::move(meaning);
    return p;
}

Parameter booleanParameter(std::string name, bool value, std::string meaning) {
    Parameter p;
    p.name = std::move(name);
    p.type = Parameter::Type::Boolean;
    p.defaultValue = value;
    p.meaning = std::move(meaning);
    return p;
}

Parameter choiceParameter(std::string name, std::vector<std::string> choices, std::string meaning) {
    Parameter p;
    p.name = std::move(name);
    p.type = Parameter::Type::Choice;
    p.defaultValue = choices.front();
    p.choices = std::move(choices);
    p.meaning = std::move(meaning);
    return p;
}

double numberOf(const ParameterValues& values, const char* name) {
    return std::get<double>(values.at(name));
}

bool booleanOf(const ParameterValues& values, const char* name) {
    return std::get<bool>(values.at(name));
}

const std::string& choiceOf(const ParameterValues& values, const char* name) {
    return std::get<std::string>(values.at(name));
}

Expected<ParameterValues> resolveParameters(const Method& method, const ParameterValues& given) {
    for (const auto& [name, value] : given) {
        if (std::ranges::find(method.parameters, name, &Parameter::name) == method.parameters.end()) {
            return tl::unexpected<Error>(unknownParameter(method, name));
        }
    }
    ParameterValues values;
    for (const Parameter& p : method.parameters) {
        const auto found = given.find(p.name);
        const ParameterValue& value = found == given.end() ? p.defaultValue : found->second;
        if (const std::string wrong = whatIsWrong(p, value); !wrong.empty()) {
            return fail(ErrorCode::InvalidArgument,
                        "Parameter '" + p.name + "' of method '" + method.name + "' " + wrong + ".",
                        "param." + p.name);
        }
        values.emplace(p.name, value);
    }
    return values;
}

}  // namespace scancast
