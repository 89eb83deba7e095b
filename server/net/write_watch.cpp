#include "server/net/write_watch.hpp"

#include "transport/bytes_taken.hpp"

namespace scancast {

bool WriteWatch::begin(int socket, std::weak_ptr<void> owner, std::function<void()> tooSlow) {
    end();
    const auto now = bytesTaken(socket);
    if (!now) return false;
    socket_ = socket;
    taken_ = now->taken;
    owner_ = std::move(owner);
    tooSlow_ = std::move(tooSlow);
    wait();
    return true;
}

void WriteWatch::end() {
    ++number_;
    timer_.cancel();
    tooSlow_ = nullptr;
}

void WriteWatch::wait() {
    timer_.expires_after(rate_.window);
    timer_.async_wait([this, owner = owner_, number = number_](boost::system::error_code ec) {
        const auto alive = owner.lock();
        if (alive && !ec && number == number_) look();
    });
}

void WriteWatch::look() {
    const auto now = bytesTaken(socket_);
    if (!now) return;  // the connection has ended, and with it the writing
    const double seconds = std::chrono::duration<double>(rate_.window).count();
    const auto taken = double(now->taken - std::exchange(taken_, now->taken));
    if (!now->waiting || taken >= seconds * double(rate_.bytesPerSecond)) return wait();
    const auto tooSlow = std::move(tooSlow_);
    end();
    tooSlow();
}

}  // namespace scancast
