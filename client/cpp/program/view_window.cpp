#include "client/cpp/program/view_window.hpp"

#include <SDL.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string_view>
#include <utility>

#include "client/cpp/frame_decoder.hpp"
#include "client/cpp/live_stream.hpp"
#include "client/cpp/program/command.hpp"
#include "client/cpp/program/say.hpp"
#include "client/cpp/program/view_control.hpp"
#include "protocol/text/plain_text.hpp"

namespace scancast::client {
namespace {

/// More than any window shows; a JPEG of a few bytes can promise four times as many.
constexpr std::size_t mostPixels = std::size_t{64} << 20u;

template <auto Destroy>
struct Destroyer {
    template <class T>
    void operator()(T* thing) const {
        Destroy(thing);
    }
};
using WindowHandle = std::unique_ptr<SDL_Window, Destroyer<SDL_DestroyWindow>>;
using RendererHandle = std::unique_ptr<SDL_Renderer, Destroyer<SDL_DestroyRenderer>>;
using TextureHandle = std::unique_ptr<SDL_Texture, Destroyer<SDL_DestroyTexture>>;

Error sdlError(const std::string& what) {
    return {ErrorCode::DeviceUnavailable, what + ": " + SDL_GetError(), {}};
}

struct Sdl {
    ~Sdl() { SDL_Quit(); }
};

/// Without a display SDL opens windows that nobody sees, unless somebody asks for another driver by name.
bool drawsForNobody() {
    const char* const driver = SDL_GetCurrentVideoDriver();
    if (driver == nullptr || std::getenv("SDL_VIDEODRIVER") != nullptr) return false;
    constexpr std::array<std::string_view, 3> unseen{"offscreen", "dummy", "evdev"};
    return std::ranges::find(unseen, driver) != unseen.end();
}

Error noDisplay(const std::string& reason) {
    return {ErrorCode::DeviceUnavailable,
            "no window can be opened here" + reason +
                ". Run this on a desktop or over ssh -X, open the server's address in a browser, or fetch "
                "pictures with scancast-client snapshot",
            {}};
}

/// Whether anything could show a window: a desktop's display, a screen of the console's, or a driver that somebody asks for.
bool mayShowWindows() {
    for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER"})
        if (const char* value = std::getenv(name); value != nullptr && *value != '\0') return true;
    std::error_code error;
    return std::filesystem::exists("/dev/dri", error);
}

Expected<void> startVideo() {
    const char* const none = ": there is no display (DISPLAY and WAYLAND_DISPLAY name none)";
    if (!mayShowWindows()) return tl::unexpected(noDisplay(none));
    if (SDL_InitSubSystem(SDL_INIT_VIDEO) != 0)
        return tl::unexpected(noDisplay(std::string(" (") + SDL_GetError() + ")"));
    if (!drawsForNobody()) return {};
    SDL_QuitSubSystem(SDL_INIT_VIDEO);
    return tl::unexpected(noDisplay(none));
}

struct Shown {
    FrameHeader header;
    Pixels pixels;
};

/// What the stream's thread leaves for the window's: the newest of everything.
struct Mailbox {
    std::mutex mutex;
    std::optional<Shown> frame;
    std::optional<Error> ended;
    std::string status;  ///< of the connection; empty = well
};

constexpr std::array colors{
    ColorSource::Auto,           ColorSource::Rgb,    ColorSource::Elevation, ColorSource::Intensity,
    ColorSource::Classification, ColorSource::Normal, ColorSource::Curvature, ColorSource::Infrared};
constexpr const char* help =
    "drag turn | right drag move | wheel zoom | WASD QE fly | M N method | 1 2 3 quality | C colour | R "
    "reset | "
    "F full screen | H help | Esc end";

class Window {
  public:
    Window(const Server& server, WindowOptions options)
        : server_(server), options_(std::move(options)), view_(options_.view) {}

    Expected<void> open() {
        sdl_.emplace();
        if (auto ok = startVideo(); !ok) return ok;
        window_.reset(SDL_CreateWindow("Scancast", SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED,
                                       view_.width, view_.height, SDL_WINDOW_RESIZABLE));
        if (!window_) return tl::unexpected(sdlError("the window cannot be opened"));
        renderer_.reset(SDL_CreateRenderer(window_.get(), -1, 0));
        if (!renderer_) return tl::unexpected(sdlError("nothing can be drawn into the window"));
        wake_ = SDL_RegisterEvents(1);
        return {};
    }

    Expected<void> run() {
        connect();
        ask();
        title();
        for (bool open = true; open && !over();) {
            SDL_Event event;
            if (SDL_WaitEventTimeout(&event, flying() ? 15 : 500)) {
                open = handle(event);
                while (open && SDL_PollEvent(&event)) open = handle(event);
            }
            fly();
            if (changed_) ask();
            receive();
        }
        if (error_) return tl::unexpected(*error_);
        return {};
    }

  private:
    void connect() {
        messages::Hello hello;
        hello.cloud = options_.cloud.id;
        hello.width = view_.width;
        hello.height = view_.height;
        hello.codecs = options_.codecs;
        LiveListener listener;
        listener.frame = [this](ReceivedFrame frame) { arrived(frame); };
        listener.problem = [this](const messages::ProblemReport& report) { say(report.problem.detail); };
        listener.connected = [this](const messages::Welcome& welcome, bool) { connected(welcome); };
        listener.lost = [this](const Error& error, std::chrono::milliseconds) { say(error.message); };
        listener.ended = [this](const Error& error) {
            const std::lock_guard lock(mailbox_.mutex);
            mailbox_.ended = error;
            wake();
        };
        LiveOptions live;
        live.credentials = server_.credentials();
        live.timeouts.connect = server_.timeouts().connect;
        stream_.emplace(server_.url(), hello, std::move(listener), live);
    }

    // ---- on the stream's thread

    void connected(const messages::Welcome& welcome) {
        decoder_ = {};
        say({});
        if (options_.codecs.front() == Codec::Jpeg) return;
        trace("codec %s %s", plainText(welcome.movingCodec).c_str(), plainText(welcome.codecReason).c_str());
    }

    void arrived(const ReceivedFrame& frame) {
        auto pixels = decoder_.decode(frame, mostPixels);
        if (!pixels) return say(pixels.error().message);
        const std::lock_guard lock(mailbox_.mutex);
        mailbox_.frame = Shown{frame.header, std::move(*pixels)};
        wake();
    }

    void say(const std::string& status) {
        const std::lock_guard lock(mailbox_.mutex);
        mailbox_.status = status;
        wake();
    }

    void wake() {
        SDL_Event event{};
        event.type = wake_;
        SDL_PushEvent(&event);
    }

    // ---- on the window's

    void receive() {
        std::optional<Shown> frame;
        {
            const std::lock_guard lock(mailbox_.mutex);
            frame.swap(mailbox_.frame);
            error_ = mailbox_.ended;
            if (status_ != mailbox_.status) titleChanged_ = true;
            status_ = mailbox_.status;
        }
        if (frame) show(*frame);
        if (titleChanged_) title();
    }

    void show(const Shown& frame) {
        const auto& pixels = frame.pixels;
        if (!texture_ || textureWidth_ != pixels.width || textureHeight_ != pixels.height) {
            texture_.reset(SDL_CreateTexture(renderer_.get(), SDL_PIXELFORMAT_RGB24,
                                             SDL_TEXTUREACCESS_STREAMING, pixels.width, pixels.height));
            textureWidth_ = pixels.width;
            textureHeight_ = pixels.height;
        }
        if (texture_) SDL_UpdateTexture(texture_.get(), nullptr, pixels.rgb.data(), pixels.width * 3);
        draw();
        if (frame.header.final && frame.header.seq == seq_) ++finals_;
        warnings_.look(frame.header);
        if (std::exchange(away_, frame.header.away) != away_) titleChanged_ = true;
        trace("frame %llu %s %dx%d", static_cast<unsigned long long>(frame.header.seq),
              frame.header.final   ? "final"
              : frame.header.still ? "still"
                                   : "moving",
              pixels.width, pixels.height);
    }

    void draw() {
        SDL_RenderClear(renderer_.get());
        if (texture_) SDL_RenderCopy(renderer_.get(), texture_.get(), nullptr, nullptr);
        SDL_RenderPresent(renderer_.get());
    }

    void ask() {
        changed_ = false;
        seq_ = stream_->show(view_);
        const auto& eye = view_.camera.eye;
        trace("view %llu eye %.3f %.3f %.3f %s %dx%d", static_cast<unsigned long long>(seq_), eye.x, eye.y,
              eye.z, view_.style.method.c_str(), view_.width, view_.height);
    }

    void title() {
        titleChanged_ = false;
        std::string text = "Scancast - " + options_.cloud.title + " - " + view_.style.method;
        if (!status_.empty()) text += " - " + status_;
        if (away_) text += " - a part of the server is away: coarser until it is back";
        text += helpShown_ ? std::string(" - ") + help : std::string(" - H: help");
        SDL_SetWindowTitle(window_.get(), text.c_str());
    }

    bool handle(const SDL_Event& event) {
        switch (event.type) {
            case SDL_QUIT:
                return false;
            case SDL_MOUSEMOTION:
                drag(event.motion);
                return true;
            case SDL_MOUSEWHEEL:
                move(zoomed(view_.camera, std::pow(1.2, event.wheel.y)));
                return true;
            case SDL_WINDOWEVENT:
                windowChanged(event.window);
                return true;
            case SDL_KEYDOWN:
                return key(event.key.keysym.sym);
            default:
                return true;
        }
    }

    void drag(const SDL_MouseMotionEvent& motion) {
        const bool left = motion.state & SDL_BUTTON_LMASK;
        const bool other = motion.state & (SDL_BUTTON_RMASK | SDL_BUTTON_MMASK);
        if (!left && !other) return;
        const bool pan = other || (SDL_GetModState() & KMOD_SHIFT);
        move(pan ? panned(view_.camera, motion.xrel, motion.yrel, view_.height)
                 : orbited(view_.camera, upward(), motion.xrel, motion.yrel, view_.height));
    }

    glm::dvec3 upward() const {
        return options_.cloud.view.camera.viewMatrix ? glm::dvec3(0, 0, 1) : options_.cloud.view.camera.up;
    }

    void windowChanged(const SDL_WindowEvent& event) {
        if (event.event == SDL_WINDOWEVENT_EXPOSED) draw();
        if (event.event != SDL_WINDOWEVENT_SIZE_CHANGED) return;
        view_.width = std::clamp(event.data1, 1, maxPictureSide);
        view_.height = std::clamp(event.data2, 1, maxPictureSide);
        changed_ = true;
    }

    /// False: close.
    bool key(SDL_Keycode code) {
        switch (code) {
            case SDLK_ESCAPE:
                return false;
            case SDLK_m:
                nextMethod(1);
                break;
            case SDLK_n:
                nextMethod(-1);
                break;
            case SDLK_c:
                nextColor();
                break;
            case SDLK_r:
                move(options_.view.camera);
                break;
            case SDLK_f:
                fullScreen();
                break;
            case SDLK_h:
                helpShown_ = !helpShown_;
                break;
            case SDLK_1:
                quality(1, 1, 80, "sharp");
                break;
            case SDLK_2:
                quality(0.5, 2, 40, "even");
                break;
            case SDLK_3:
                quality(0.25, 8, 20, "fast");
                break;
            default:
                return true;
        }
        titleChanged_ = true;
        return true;
    }

    void nextMethod(int step) {
        const auto& names = options_.methods;
        if (names.empty()) return;
        const auto at = std::find(names.begin(), names.end(), view_.style.method) - names.begin();
        const auto count = static_cast<std::ptrdiff_t>(names.size());
        view_.style.method = names[static_cast<std::size_t>((at + step + count) % count)];
        view_.style.parameters.clear();
        changed_ = true;
    }

    void nextColor() {
        const auto at = std::find(colors.begin(), colors.end(), view_.style.color);
        view_.style.color = at == colors.end() || at + 1 == colors.end() ? colors.front() : *(at + 1);
        view_.style.byIntensity = false;
        view_.style.range.reset();
        changed_ = true;
    }

    void fullScreen() {
        const bool full = SDL_GetWindowFlags(window_.get()) & SDL_WINDOW_FULLSCREEN_DESKTOP;
        SDL_SetWindowFullscreen(window_.get(), full ? 0 : SDL_WINDOW_FULLSCREEN_DESKTOP);
    }

    void quality(double resolution, double detail, int jpeg, const char* name) {
        if (!stream_->send(messages::QualityLimits{std::nullopt, resolution, detail, jpeg})) return;
        trace("quality %s", name);
    }

    void move(const Camera& camera) {
        view_.camera = camera;
        changed_ = true;
    }

    /// The keys that are held, as forward, right and up.
    std::optional<glm::dvec3> flying() const {
        const auto* keys = SDL_GetKeyboardState(nullptr);
        const auto axis = [&](SDL_Scancode more, SDL_Scancode less) {
            return double(keys[more]) - keys[less];
        };
        const glm::dvec3 way(axis(SDL_SCANCODE_W, SDL_SCANCODE_S), axis(SDL_SCANCODE_D, SDL_SCANCODE_A),
                             axis(SDL_SCANCODE_E, SDL_SCANCODE_Q));
        return way == glm::dvec3(0) ? std::nullopt : std::optional(way);
    }

    /// Half the distance to the target in a second, however often this is called.
    void fly() {
        const auto now = SDL_GetTicks64();
        const double seconds = std::min<double>(double(now - lastTicks_) / 1000, 0.1);
        lastTicks_ = now;
        if (const auto way = flying()) {
            const auto by = *way * (0.5 * seconds);
            move(flown(view_.camera, by.x, by.y, by.z));
        }
    }

    bool over() const { return error_ || (options_.finals && finals_ >= *options_.finals); }

    template <class... Arguments>
    void trace(const char* format, Arguments... arguments) {
        if (!options_.trace) return;
        sayOn(stdout, format, arguments...);
        sayOn(stdout, "\n");
        std::fflush(stdout);
    }

    const Server& server_;
    const WindowOptions options_;
    View view_;
    std::optional<Sdl> sdl_;  // ends after what follows
    WindowHandle window_;
    RendererHandle renderer_;
    TextureHandle texture_;
    int textureWidth_ = 0, textureHeight_ = 0;
    Uint32 wake_ = 0;
    Uint64 lastTicks_ = 0;
    std::uint64_t seq_ = 0;
    int finals_ = 0;
    FrameWarnings warnings_;
    bool away_ = false;  // what is shown is coarser for it
    bool changed_ = false, titleChanged_ = false, helpShown_ = false;
    std::string status_;
    std::optional<Error> error_;
    Mailbox mailbox_;
    FrameDecoder decoder_;              // the stream's thread's
    std::optional<LiveStream> stream_;  // last: its thread uses the mailbox
};

}  // namespace

Expected<void> checkDisplay() {
    const Sdl sdl;
    return startVideo();
}

Expected<void> runWindow(const Server& server, WindowOptions options) {
    Window window(server, std::move(options));
    if (auto ok = window.open(); !ok) return ok;
    return window.run();
}

}  // namespace scancast::client
