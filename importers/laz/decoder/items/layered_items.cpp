#include "importers/laz/decoder/items/layered_items.hpp"

#include <cstring>

namespace scancast::laz {

template <class Fields>
bool LayeredItem<Fields>::begin(std::size_t channel, const std::byte* item) {
    auto& state = channels_[channel];
    if (!state) state = std::make_unique<Channel>(bytes_);
    if (state->used) return false;
    state->used = true;
    std::memcpy(state->last.data(), item, bytes_);
    state->fields.reset();
    return true;
}

template <class Fields>
void LayeredItem<Fields>::start(const std::byte* item, std::span<ArithmeticDecoder> layers,
                                std::size_t& channel) {
    layers_ = layers;
    for (auto& other : channels_)
        if (other) other->used = false;
    current_ = channel;
    begin(current_, item);
}

template <class Fields>
void LayeredItem<Fields>::decode(std::byte* item, std::size_t& channel) {
    std::byte* last = channels_[current_]->last.data();
    if (channel != current_) {
        current_ = channel;
        if (begin(current_, last) || goesOnWithOwn_) last = channels_[current_]->last.data();
    }
    Fields& fields = channels_[current_]->fields;
    for (std::size_t i = 0; i < layers_.size(); ++i)
        if (layers_[i].feed.isOpen()) fields.decode(last, i, layers_[i]);
    std::memcpy(item, last, bytes_);
}

template class LayeredItem<ColorFields>;
template class LayeredItem<ColorInfraredFields>;
template class LayeredItem<WavePacketFields>;
template class LayeredItem<ExtraFields>;

}  // namespace scancast::laz
