#include "renderer/cloud/point_batch.hpp"

namespace scancast {

std::size_t bytesOf(ColumnType type) {
    switch (type) {
        case ColumnType::Int8:
        case ColumnType::Uint8:
            return 1;
        case ColumnType::Int16:
        case ColumnType::Uint16:
            return 2;
        case ColumnType::Int32:
        case ColumnType::Uint32:
        case ColumnType::Float32:
            return 4;
        case ColumnType::Int64:
        case ColumnType::Uint64:
        case ColumnType::Float64:
            return 8;
    }
    return 0;
}

std::string_view name(ColumnType type) {
    switch (type) {
        case ColumnType::Int8:
            return "int8";
        case ColumnType::Uint8:
            return "uint8";
        case ColumnType::Int16:
            return "int16";
        case ColumnType::Uint16:
            return "uint16";
        case ColumnType::Int32:
            return "int32";
        case ColumnType::Uint32:
            return "uint32";
        case ColumnType::Int64:
            return "int64";
        case ColumnType::Uint64:
            return "uint64";
        case ColumnType::Float32:
            return "float32";
        case ColumnType::Float64:
            return "float64";
    }
    return "unknown";
}

std::size_t rowBytes(std::span<const Column> columns) {
    std::size_t bytes = 0;
    for (const Column& column : columns) bytes += bytesOf(column.type);
    return bytes;
}

}  // namespace scancast
