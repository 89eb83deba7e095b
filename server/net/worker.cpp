#include "server/net/worker.hpp"

#include <utility>

namespace scancast {

Worker::Worker(std::size_t room)
    : room_(room), thread_([this](const std::stop_token& token) { run(token); }) {}

Worker::~Worker() {
    stop();
}

bool Worker::post(Task task) {
    {
        const std::lock_guard lock(mutex_);
        if (thread_.get_stop_token().stop_requested() || tasks_.size() >= room_) return false;
        tasks_.push_back(std::move(task));
    }
    changed_.notify_one();
    return true;
}

void Worker::stop() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
    const std::lock_guard lock(mutex_);
    tasks_.clear();
}

void Worker::run(const std::stop_token& token) {
    while (true) {
        Task task;
        {
            std::unique_lock lock(mutex_);
            if (!changed_.wait(lock, token, [&] { return !tasks_.empty(); }) || token.stop_requested())
                return;
            task = std::move(tasks_.front());
            tasks_.pop_front();
        }
        task(token);
    }
}

}  // namespace scancast
