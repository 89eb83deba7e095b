#include "threads/monitor.hpp"

namespace scancast {

template class BasicMonitor<std::mutex, std::condition_variable>;

}  // namespace scancast
