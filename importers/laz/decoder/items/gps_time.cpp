#include "importers/laz/decoder/items/gps_time.hpp"

#include "importers/laz/decoder/items/fields.hpp"

namespace scancast::laz {

namespace {

// An encoder goes to another sequence once for a point; a stream that does nothing else would never end.
constexpr int mostSwitches = 8;
// So often in turn has a step to be of no use before another takes its place.
constexpr int patience = 3;

void advance(std::uint64_t& time, std::int32_t difference) {
    time += static_cast<std::uint64_t>(static_cast<std::int64_t>(difference));
}

}  // namespace

template <bool mayStay>
void GpsTimeDecoder<mayStay>::start(std::uint64_t time) {
    sequences_ = {};
    sequences_[0].time = time;
    current_ = newest_ = 0;
    withoutStep_.reset();
    factors_.reset();
    steps_.reset();
}

template <bool mayStay>
std::uint64_t GpsTimeDecoder<mayStay>::decode(ArithmeticDecoder& decoder) {
    for (int switches = 0;; ++switches) {
        if (sequences_[current_].step == 0 ? decodeWithoutStep(decoder) : decodeSteps(decoder)) break;
        if (switches < mostSwitches) continue;
        decoder.spoil();
        break;
    }
    return sequences_[current_].time;
}

template <bool mayStay>
void GpsTimeDecoder<mayStay>::beginSequence(ArithmeticDecoder& decoder) {
    const auto prediction = static_cast<std::int32_t>(sequences_[current_].time >> 32);
    const auto high = static_cast<std::uint32_t>(steps_.decode(decoder, prediction, 8));
    newest_ = (newest_ + 1) % sequences_.size();
    current_ = newest_;
    sequences_[current_] = {static_cast<std::uint64_t>(high) << 32 | decoder.number32(), 0, 0};
}

template <bool mayStay>
bool GpsTimeDecoder<mayStay>::decodeWithoutStep(ArithmeticDecoder& decoder) {
    std::uint32_t symbol = decoder.symbol(withoutStep_);
    if (mayStay && symbol == 0) return true;
    symbol -= stay;
    if (symbol > 1) {
        current_ = (current_ + symbol - 1) % sequences_.size();
        return false;
    }
    if (symbol == 1) {
        beginSequence(decoder);
        return true;
    }
    Sequence& sequence = sequences_[current_];
    sequence.step = steps_.decode(decoder, 0, 0);
    advance(sequence.time, sequence.step);
    sequence.extremes = 0;
    return true;
}

template <bool mayStay>
bool GpsTimeDecoder<mayStay>::decodeSteps(ArithmeticDecoder& decoder) {
    const std::uint32_t symbol = decoder.symbol(factors_);
    if (symbol > elsewhere) {
        current_ = (current_ + symbol - elsewhere) % sequences_.size();
        return false;
    }
    if (symbol == elsewhere) {
        beginSequence(decoder);
        return true;
    }
    if (mayStay && symbol == elsewhere - stay) return true;
    Sequence& sequence = sequences_[current_];
    const int factor = static_cast<int>(symbol);
    advance(sequence.time,
            decodeFactor(decoder, sequence, factor > greatestFactor ? greatestFactor - factor : factor));
    return true;
}

/// The difference in time where about `factor` steps have passed.
template <bool mayStay>
std::int32_t GpsTimeDecoder<mayStay>::decodeFactor(ArithmeticDecoder& decoder, Sequence& sequence,
                                                   int factor) {
    if (factor == 1) {
        sequence.extremes = 0;
        return steps_.decode(decoder, sequence.step, 1);
    }
    const std::size_t context = factor == 0                ? 7
                                : factor <= leastFactor    ? 6
                                : factor < 0               ? 5
                                : factor == greatestFactor ? 4
                                : factor < 10              ? 2
                                                           : 3;
    const std::int32_t difference = steps_.decode(decoder, product(factor, sequence.step), context);
    if (factor == 0 || factor == greatestFactor || factor <= leastFactor) {
        if (++sequence.extremes > patience) {
            sequence.step = difference;
            sequence.extremes = 0;
        }
    }
    return difference;
}

template class GpsTimeDecoder<false>;
template class GpsTimeDecoder<true>;

// --- GPSTIME11 ---

void GpsTime11V1::start(const std::byte* item) {
    time_ = loadLe<std::uint64_t>(item);
    step_ = extremes_ = 0;
    factors_.reset();
    withoutStep_.reset();
    steps_.reset();
}

void GpsTime11V1::decode(std::byte* item) {
    if (step_ == 0)
        decodeWithoutStep();
    else
        decodeSteps();
    storeLe(item, time_);
}

void GpsTime11V1::decodeWithoutStep() {
    const std::uint32_t symbol = decoder_.symbol(withoutStep_);
    if (symbol == 1) advance(time_, step_ = steps_.decode(decoder_, 0, 0));
    if (symbol == 2) time_ = decoder_.number64();
}

void GpsTime11V1::countExtreme(std::int32_t difference) {
    if (++extremes_ <= patience) return;
    step_ = difference;
    extremes_ = 0;
}

void GpsTime11V1::decodeSteps() {
    constexpr int mostFactor = 509, anew = 510;  // 511: as it was
    const int factor = static_cast<int>(decoder_.symbol(factors_));
    if (factor == anew) time_ = decoder_.number64();
    if (factor >= anew) return;
    if (factor == 1) {
        advance(time_, step_ = steps_.decode(decoder_, step_, 1));
        extremes_ = 0;
        return;
    }
    const std::size_t context = factor == 0 ? 2 : factor < 10 ? 3 : factor < 50 ? 4 : 5;
    const std::int32_t prediction = factor == 0 ? step_ / 4 : product(factor, step_);
    const std::int32_t difference = steps_.decode(decoder_, prediction, context);
    if (factor == 0 || factor == mostFactor) countExtreme(difference);
    advance(time_, difference);
}

void GpsTime11V2::start(const std::byte* item) {
    times_.start(loadLe<std::uint64_t>(item));
}

void GpsTime11V2::decode(std::byte* item) {
    storeLe(item, times_.decode(decoder_));
}

}  // namespace scancast::laz
