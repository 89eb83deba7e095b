"""Python client of Scancast servers: point clouds that a server draws, as pictures, arrays and live views.

    import scancast

    cloud = scancast.Server("http://127.0.0.1:8080/").cloud("town")
    cloud.save("town.png", eye=(389300, 5819600, 120), color="elevation")
    pixels = cloud.snapshot(width=640, height=360).array()      # uint8, (360, 640, 3); needs NumPy and Pillow
    metres = cloud.depth(width=640, height=360)                 # float32, (360, 640); needs NumPy
    point = cloud.pick(320, 180, width=640, height=360)         # coordinates as they are in the file

    with cloud.live(width=640, height=360) as live:
        live.view(eye=(389300, 5819600, 80))
        for frame in live:
            ...

It needs nothing but Python's own library; NumPy and Pillow make arrays and images, anywidget a view that a notebook moves by hand. The words
of a view are the protocol's (protocol/PROTOCOL.md) in snake_case. What goes wrong is a ScancastError.
"""
from ._exports import Measured, PointStream, ProfilePicture, Saved
from ._rasters import Raster
from .cloud import Cloud, Page
from .errors import (BadAnswer, Conflict, ConnectionFailed, DeadlineExceeded, FieldError, Forbidden, Impossible, InvalidArgument, MissingLibrary,
                     NotFound, Refused, ScancastError, ServerFault, TimedOut, TooLarge, TooManyRequests, Unauthorized, Unavailable)
from .facts import (Attribute, Bounds, CloudFacts, Column, Crs, Live, Look, LookView, Method, Methods, Mirror, NamedView, Parameter, PendingCloud,
                    Photo, PhotoAngles, PhotoStation, PickedPoint, Pose, Station)
from .frames import DepthCells, Frame
from .live import LiveView
from .picture import DepthPicture, Picture
from .server import Server

__version__ = "0.1.0"

__all__ = [
    "Attribute", "BadAnswer", "Bounds", "Cloud", "CloudFacts", "Column", "Conflict", "ConnectionFailed", "Crs", "DeadlineExceeded", "DepthCells", "DepthPicture",
    "FieldError", "Forbidden", "Frame", "Impossible", "InvalidArgument", "Live", "LiveView", "Look", "LookView", "Method", "Methods", "Measured", "Mirror",
    "MissingLibrary", "NamedView", "NotFound", "Page", "Parameter", "PendingCloud", "Photo", "PhotoAngles", "PhotoStation", "PickedPoint",
    "Picture", "PointStream", "Pose", "ProfilePicture", "Raster", "Refused", "Saved", "ScancastError", "Server", "ServerFault", "Station", "TimedOut", "TooLarge", "TooManyRequests",
    "Unauthorized", "Unavailable",
]
