// What the values of a view may be, each by itself. Inside the protocol room only. Pure functions; any
// thread. Errors name the word: ImpossibleView for geometry that no picture can be made of, else
// InvalidArgument.
#pragma once

#include "protocol/view/view.hpp"
#include "protocol/view/view_words.hpp"

namespace scancast::checks {

/// Beyond it not even doubles tell neighbouring points apart, and squares come near their end.
inline constexpr double farthestCoordinate = 1e12;

Expected<void> coordinates(std::string_view word, const glm::dvec3& value);
/// A rotation and a move, column by column.
Expected<void> matrix(std::string_view word, const std::array<double, 16>& value);
Expected<void> clipBox(std::string_view word, const ClipBox& box);
/// Boxes with an inside, planes with a normal; no more than there may be.
Expected<void> clipShapes(std::string_view word, const ClipShapes& shapes);
/// Names that there can be, the view's own cloud once at most, and no more than there may be.
Expected<void> viewedClouds(std::string_view word, const ViewedClouds& clouds);
Expected<void> ends(std::string_view word, const std::array<double, 2>& range);
/// Azimuth and elevation.
Expected<void> sun(std::string_view word, const std::array<double, 2>& direction);
Expected<void> method(std::string_view word, const std::string& name);
Expected<void> color(std::string_view word, const Style& style);
Expected<void> columnRanges(std::string_view word, const ColumnRanges& ranges);
Expected<void> colormap(std::string_view word, const std::string& name);
Expected<void> parameters(const ParameterValues& parameters);
Expected<void> inRange(std::string_view word, double value, const ViewRange& range);

/// What its values, each of them sound, say together.
Expected<void> camera(const Camera& camera);

}  // namespace scancast::checks
