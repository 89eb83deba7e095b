#include "server/scheduler/picture.hpp"

namespace scancast {

Expected<Bytes> encodePicture(const Frame& frame, const View& view, PictureFormat format) {
    if (format == PictureFormat::Png) {
        return encodePng(frame, view.style.background.kind == Background::Kind::Transparent);
    }
    return encodeJpeg(frame, view.quality.jpegQuality, view.quality.subsampling);
}

}  // namespace scancast
