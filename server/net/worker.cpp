#include "server/net/worker.hpp"

#include <tuple>
#include <utility>

#include "server/base/faults.hpp"

namespace scancast {

Worker::Worker(std::size_t room) : room_(room), thread_([this] { run(); }) {}

Worker::~Worker() {
    stop();
}

bool Worker::post(Task task) {
    const Monitor::Lock lock(monitor_);
    if (stop_.stop_requested() || tasks_.size() >= room_) return false;
    tasks_.push_back(std::move(task));
    return true;
}

void Worker::stop() {
    {
        const Monitor::Lock lock(monitor_);
        stop_.request_stop();
    }
    if (thread_.joinable()) thread_.join();
    const Monitor::Lock lock(monitor_);
    tasks_.clear();
}

void Worker::run() {
    while (step()) {
    }
}

bool Worker::step() {
    Task task;
    {
        Monitor::Lock lock(monitor_);
        monitor_.wait(lock, [this] { return isDue(); });
        if (stop_.stop_requested()) return false;
        task = std::move(tasks_.front());
        tasks_.pop_front();
    }
    std::ignore = contained("The worker", [&] { task(stop_.get_token()); });
    return true;
}

}  // namespace scancast
