// Looks at a server's first cloud, waits for the sharp picture, and writes it as a PPM.
//
//     look http://127.0.0.1:8080/ picture.ppm
#include <cstdio>
#include <fstream>
#include <future>
#include <scancast/client.hpp>

using namespace scancast;

namespace {

int complain(const Error& error) {
    std::fprintf(stderr, "look: %s\n", error.message.c_str());
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) return complain({ErrorCode::InvalidArgument, "usage: look URL FILE.ppm", {}});
    const auto url = client::parseServerUrl(argv[1]);
    if (!url) return complain(url.error());
    const auto clouds = client::Server(*url).clouds();
    if (!clouds) return complain(clouds.error());
    if (clouds->empty()) return complain({ErrorCode::NotFound, "there are no clouds", {}});

    std::promise<Expected<client::Pixels>> promise;
    auto future = promise.get_future();
    bool done = false;  // of the stream's thread
    client::LiveListener listener;
    listener.frame = [&](client::ReceivedFrame frame) {
        if (!frame.header.final || frame.header.seq == 0 || done) return;
        done = true;
        promise.set_value(client::decodeJpeg(frame.jpeg));
    };
    listener.ended = [&](const Error& error) {
        if (!done) promise.set_value(tl::unexpected(error));
        done = true;
    };
    messages::Hello hello;
    hello.cloud = clouds->front().id;
    client::LiveStream stream(*url, hello, listener);

    auto view = clouds->front().view;
    view.width = 320;
    view.height = 240;
    view.camera = client::orbitedCamera(view.camera, view.camera.target, view.camera.up, 30);
    stream.show(view);
    const auto pixels = future.get();
    if (!pixels) return complain(pixels.error());
    std::ofstream file(argv[2], std::ios::binary);
    file << "P6\n" << pixels->width << ' ' << pixels->height << "\n255\n";
    file.write(reinterpret_cast<const char*>(pixels->rgb.data()), std::streamsize(pixels->rgb.size()));
    file.close();
    std::printf("%s, %dx%d\n", plainText(hello.cloud).c_str(), pixels->width, pixels->height);
    return file ? 0 : complain({ErrorCode::Io, "cannot write the picture", {}});
}
