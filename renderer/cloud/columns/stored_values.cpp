#include "renderer/cloud/columns/stored_values.hpp"

#include "files/bytes.hpp"

namespace scancast {
namespace {

template <class T>
void takeAll(std::span<const std::byte> stored, const Column& column, std::vector<double>& values) {
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] =
            column.offset + column.scale * static_cast<double>(loadLe<T>(stored.data() + i * sizeof(T)));
}

}  // namespace

std::vector<double> valuesOf(std::span<const std::byte> stored, const Column& column) {
    std::vector<double> values(stored.size() / bytesOf(column.type));
    switch (column.type) {
        case ColumnType::Int8:
            takeAll<std::int8_t>(stored, column, values);
            break;
        case ColumnType::Uint8:
            takeAll<std::uint8_t>(stored, column, values);
            break;
        case ColumnType::Int16:
            takeAll<std::int16_t>(stored, column, values);
            break;
        case ColumnType::Uint16:
            takeAll<std::uint16_t>(stored, column, values);
            break;
        case ColumnType::Int32:
            takeAll<std::int32_t>(stored, column, values);
            break;
        case ColumnType::Uint32:
            takeAll<std::uint32_t>(stored, column, values);
            break;
        case ColumnType::Int64:
            takeAll<std::int64_t>(stored, column, values);
            break;
        case ColumnType::Uint64:
            takeAll<std::uint64_t>(stored, column, values);
            break;
        case ColumnType::Float32:
            takeAll<float>(stored, column, values);
            break;
        case ColumnType::Float64:
            takeAll<double>(stored, column, values);
            break;
    }
    return values;
}

}  // namespace scancast
