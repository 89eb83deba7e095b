#include "ranks/mpi/alarm.hpp"

#include <chrono>
#include <utility>

namespace scancast {

namespace {

constexpr auto listensEvery = std::chrono::milliseconds(50);

}  // namespace

Alarm::Alarm(const Communicator& of, std::stop_source work) : of_(of), work_(std::move(work)) {
    MPI_Comm_dup(of.handle(), &comm_);
    MPI_Comm_set_errhandler(comm_, MPI_ERRORS_RETURN);
    if (of.size() > 1) listener_ = std::jthread([this](const std::stop_token& done) { listen(done); });
}

Alarm::~Alarm() {
    listener_ = {};
    if (!of_.isLost()) MPI_Comm_free(&comm_);
}

void Alarm::ring() {
    if (std::exchange(hasRung_, true) || of_.isLost()) return;
    for (int r = 0; r < of_.size(); ++r) {
        if (r == of_.rank()) continue;
        // Nothing is in it: it has left as soon as it is begun.
        MPI_Request request;
        if (MPI_Isend(nullptr, 0, MPI_BYTE, r, 0, comm_, &request) == MPI_SUCCESS) MPI_Request_free(&request);
    }
}

void Alarm::listen(const std::stop_token& done) {
    while (!done.stop_requested() && !of_.isLost()) {
        int isThere = 0;
        MPI_Status status;
        if (MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, comm_, &isThere, &status) != MPI_SUCCESS) return;
        if (isThere) {
            MPI_Recv(nullptr, 0, MPI_BYTE, status.MPI_SOURCE, status.MPI_TAG, comm_, MPI_STATUS_IGNORE);
            work_.request_stop();
            continue;
        }
        std::this_thread::sleep_for(listensEvery);
    }
}

}  // namespace scancast
