"""Cameras, as a cloud's look tells them, on the command line."""


def camera_flags(camera, factor=1):
    """Flags of a camera at `factor` of its distance to its target."""
    eye = [t + (e - t) * factor for e, t in zip(camera["eye"], camera["target"])]
    flags = [f"--{word}=" + ",".join(map(repr, value))
             for word, value in (("eye", eye), ("target", camera["target"]), ("up", camera["up"]))]
    flags.append(f"--projection={camera['type']}")
    if camera["type"] == "orthographic":
        return flags + [f"--view-height={camera['viewHeight'] * factor!r}"]
    return flags + [f"--fov={camera['fov']!r}"]
