#include "ranks/mpi/session.hpp"

#include <cstdio>
#include <cstdlib>

#include "protocol/text/plain_text.hpp"

namespace scancast {

namespace {

/// Open MPI looks for fast networks between machines, which takes it a quarter of a second; ranks of one machine have no use for them.
/// Whoever says what is to be used is heard.
void startFastOnOneMachine() {
    const char* const all = std::getenv("OMPI_COMM_WORLD_SIZE");
    const char* const here = std::getenv("OMPI_COMM_WORLD_LOCAL_SIZE");
    if (all && here && std::string_view(all) == here) ::setenv("OMPI_MCA_pml", "ob1", 0);
}

}  // namespace

Expected<std::unique_ptr<MpiSession>> MpiSession::start(std::stop_token interrupted) {
    int started = 0;
    MPI_Initialized(&started);
    if (started) return fail(ErrorCode::Internal, "MPI was started twice.");
    startFastOnOneMachine();
    int given = 0;
    if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_MULTIPLE, &given) != MPI_SUCCESS)
        return fail(ErrorCode::Io,
                    "MPI did not start; is this program started by mpirun of the MPI it was built with?");
    std::unique_ptr<MpiSession> session(new MpiSession);
    session->world_ = std::make_unique<Communicator>(MPI_COMM_WORLD, std::move(interrupted));
    if (given < MPI_THREAD_MULTIPLE)
        return fail(ErrorCode::Unsupported,
                    "This MPI lets only one thread call it (MPI_THREAD_MULTIPLE is needed); use another, "
                    "such as Debian's Open MPI.");
    MPI_Comm near = MPI_COMM_NULL;
    if (MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &near) == MPI_SUCCESS) {
        MPI_Comm_size(near, &session->onThisMachine_);
        MPI_Comm_free(&near);
    }
    return session;
}

MpiSession::~MpiSession() {
    const bool sound = !world_ || !world_->isLost();
    world_.reset();
    if (sound) MPI_Finalize();
}

void MpiSession::abortAll(std::string_view sentence) {
    const std::string line = plainText(sentence) + "\n";
    std::fwrite(line.data(), 1, line.size(), stderr);
    std::fflush(stderr);
    MPI_Abort(MPI_COMM_WORLD, 1);
    std::abort();  // it does not return
}

bool isFirstOfMany() {
    // What Open MPI, and starters that speak PMI, tell each process.
    for (const char* const name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"})
        if (const char* const rank = std::getenv(name)) return std::string_view(rank) == "0";
    return true;
}

}  // namespace scancast
