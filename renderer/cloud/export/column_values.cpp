#include "renderer/cloud/export/column_values.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "files/bytes.hpp"

namespace scancast {

namespace {

constexpr int mostDigits = 12;
constexpr std::int64_t mostColumnStep = 1'000'000'000;

std::optional<std::int64_t> nearlyWhole(double value) {
    const double whole = std::nearbyint(value);
    if (!(std::abs(whole) < 1e15) || std::abs(whole - value) > std::max(1e-6, std::abs(value) * 1e-15))
        return std::nullopt;
    return std::int64_t(whole);
}

template <class F>
auto withStored(const std::byte* at, ColumnType type, F f) {
    switch (type) {
        case ColumnType::Int8:
            return f(loadLe<std::int8_t>(at));
        case ColumnType::Uint8:
            return f(loadLe<std::uint8_t>(at));
        case ColumnType::Int16:
            return f(loadLe<std::int16_t>(at));
        case ColumnType::Uint16:
            return f(loadLe<std::uint16_t>(at));
        case ColumnType::Int32:
            return f(loadLe<std::int32_t>(at));
        case ColumnType::Uint32:
            return f(loadLe<std::uint32_t>(at));
        case ColumnType::Int64:
            return f(loadLe<std::int64_t>(at));
        case ColumnType::Uint64:
            return f(loadLe<std::uint64_t>(at));
        case ColumnType::Float32:
            return f(loadLe<float>(at));
        case ColumnType::Float64:
            break;
    }
    return f(loadLe<double>(at));
}

std::string plainName(std::string_view name) {
    std::string plain;
    for (const char c : name) {
        const bool good = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        plain += good ? c : '_';
    }
    return plain.empty() ? "column" : plain;
}

std::string lower(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return text;
}

}  // namespace

std::optional<DecimalGrid> decimalGrid(double origin, double step) {
    double unit = 1;
    for (int digits = 0; digits <= mostDigits; ++digits, unit *= 10) {
        const auto o = nearlyWhole(origin * unit), s = nearlyWhole(step * unit);
        // A step of next to nothing is nearly 0 in every unit.
        if (o && s && *s != 0 && std::abs(double(*s) / unit / step - 1) < 1e-12)
            return DecimalGrid{digits, *o, *s};
    }
    return std::nullopt;
}

bool isWhole(ColumnType type) {
    return type != ColumnType::Float32 && type != ColumnType::Float64;
}

std::vector<OutColumn> outColumns(const ScanHeader& header, std::span<const std::string_view> taken) {
    std::set<std::string> names;
    for (const std::string_view name : taken) names.insert(std::string(name));
    std::vector<OutColumn> columns;
    std::size_t at = 0;
    for (const Column& column : header.columns) {
        const std::string wanted = plainName(column.name);
        std::string name = wanted;
        for (int copy = 2; !names.insert(lower(name)).second; ++copy)
            name = wanted + "_" + std::to_string(copy);
        columns.push_back({name, column, at});
        if (isWhole(column.type) && columns.back().scaled() && bytesOf(column.type) <= 4)
            columns.back().decimals = decimalGrid(column.offset, column.scale);
        // 32 bits of them are to fit into 64.
        if (auto& decimals = columns.back().decimals; decimals && std::abs(decimals->step) > mostColumnStep)
            decimals.reset();
        at += bytesOf(column.type);
    }
    return columns;
}

double storedNumber(const std::byte* at, ColumnType type) {
    return withStored(at, type, [](auto number) { return double(number); });
}

std::int64_t storedWhole(const std::byte* at, ColumnType type) {
    return withStored(at, type, [](auto number) { return std::int64_t(number); });
}

double valueOf(const std::byte* row, const OutColumn& column) {
    return column.column.offset + column.column.scale * storedNumber(row + column.at, column.column.type);
}

}  // namespace scancast
