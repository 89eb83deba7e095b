// How a method's file declares its parameters and reads what a request gave for them. Plain functions.
#pragma once

#include <string>
#include <vector>

#include "renderer/method/method.hpp"

namespace scancast {

Parameter numberParameter(std::string name, double value, double min, double max, std::string unit,
                          std::string meaning);
Parameter booleanParameter(std::string name, bool value, std::string meaning);
/// The first choice is the default.
Parameter choiceParameter(std::string name, std::vector<std::string> choices, std::string meaning);

/// Of values that resolveParameters() completed.
double numberOf(const ParameterValues& values, const char* name);
bool booleanOf(const ParameterValues& values, const char* name);
const std::string& choiceOf(const ParameterValues& values, const char* name);

}  // namespace scancast
