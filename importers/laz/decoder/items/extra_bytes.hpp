// Bytes that a file's maker has added to its records, each on its own: BYTE. Owned by a chunk's decoder.
#pragma once

#include <vector>

#include "importers/laz/decoder/integer_decoder.hpp"
#include "importers/laz/decoder/items/item_decoder.hpp"

namespace scancast::laz {

class ExtraBytesV1 final : public ItemDecoder {
  public:
    ExtraBytesV1(ArithmeticDecoder& decoder, std::size_t bytes)
        : decoder_(decoder), last_(bytes), values_(bytes) {}
    void start(const std::byte* item) override;
    void decode(std::byte* item) override;

  private:
    ArithmeticDecoder& decoder_;
    std::vector<std::byte> last_;
    IntegerDecoder<8> values_;
};

class ExtraBytesV2 final : public ItemDecoder {
  public:
    ExtraBytesV2(ArithmeticDecoder& decoder, std::size_t bytes)
        : decoder_(decoder), last_(bytes), differences_(bytes) {}
    void start(const std::byte* item) override;
    void decode(std::byte* item) override;

  private:
    ArithmeticDecoder& decoder_;
    std::vector<std::byte> last_;
    std::vector<SymbolModel<256>> differences_;
};

}  // namespace scancast::laz
