"""Pictures and depth as they come from a server, and as Pillow and NumPy have them."""
from __future__ import annotations

import contextlib
import io
import os
import secrets
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Iterator, Optional, Union

from . import errors

if TYPE_CHECKING:
    import numpy
    import PIL.Image

MEDIA_TYPES = {"png": "image/png", "jpg": "image/jpeg", "jpeg": "image/jpeg"}
Bytes = bytes  # where a class has a field of that name
Path = Union[str, "os.PathLike[str]"]


def numpy_for(why: str) -> Any:
    """NumPy, or a MissingLibrary that says how to get it."""
    try:
        import numpy
    except ImportError:
        raise errors.needed("NumPy", "numpy", why) from None
    return numpy


@contextlib.contextmanager
def whole_file(path: Path) -> Iterator[Any]:
    """A file to write that has its name once it is complete; what fails leaves nothing, and an older file as it was."""
    target = os.fspath(path)
    folder, name = os.path.split(os.path.abspath(target))
    temporary = os.path.join(folder, f".{name}.{secrets.token_hex(6)}")
    handle = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), 0o666)
    try:
        with os.fdopen(handle, "wb") as file:
            yield file
        os.replace(temporary, target)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        raise


@dataclass(frozen=True)
class Picture:
    """A PNG or JPEG. A notebook shows it."""

    bytes: bytes = field(repr=False)
    media_type: str
    method: str = ""
    """That drew it."""
    reason: str = ""
    """Why this one, where the view left it to ``auto``."""
    etag: str = ""
    """Names exactly these bytes; empty for a picture that is damaged."""
    damaged: int = 0
    """Blocks of the cloud that it lacks, because they cannot be read."""
    timing: str = ""
    """What selection, rendering and encoding took, as the server tells it."""
    price: Optional[float] = None
    """In milliseconds of a core, before it was drawn."""

    def image(self) -> "PIL.Image.Image":
        """For Pillow. MissingLibrary without it; BadAnswer where the bytes are no picture."""
        try:
            import PIL.Image
        except ImportError:
            raise errors.needed("Pillow", "pillow", "a picture as an image") from None
        try:
            image = PIL.Image.open(io.BytesIO(self.bytes), formats=["PNG", "JPEG"])
            image.load()
        except (OSError, SyntaxError, PIL.Image.DecompressionBombError) as error:
            raise errors.BadAnswer(f"the picture cannot be read: {error}") from None
        return image

    def array(self) -> "numpy.ndarray[Any, Any]":
        """uint8 of shape (height, width, 3), or 4 where it is transparent, rows from the top."""
        numpy = numpy_for("a picture as an array")
        image = self.image()
        return numpy.array(image if image.mode in ("RGB", "RGBA") else image.convert("RGB"))  # type: ignore[no-any-return]

    def save(self, path: Path) -> None:
        """Writes the bytes as they are; the file is complete or not there."""
        with whole_file(path) as file:
            file.write(self.bytes)

    def _repr_png_(self) -> Optional[Bytes]:
        return self.bytes if self.media_type == "image/png" else None

    def _repr_jpeg_(self) -> Optional[Bytes]:
        return self.bytes if self.media_type == "image/jpeg" else None


@dataclass(frozen=True)
class DepthPicture:
    """What lies in the middle of each pixel: its distance along the view direction, in the cloud's unit."""

    bytes: bytes = field(repr=False)
    """float32, little-endian, row by row from the top, +infinity where nothing is."""
    width: int
    height: int
    method: str = ""
    reason: str = ""
    etag: str = ""
    damaged: int = 0

    def array(self) -> "numpy.ndarray[Any, Any]":
        """float32 of shape (height, width)."""
        numpy = numpy_for("depth as an array")
        return numpy.frombuffer(self.bytes, "<f4").reshape(self.height, self.width)  # type: ignore[no-any-return]
