"""Rooms in USD: the studio converts them to GLB once, and from then on the GLB is the room of the project."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import luxfer

from .files import Files, Known

GLTF = {".glb", ".gltf"}
USD = {".usd", ".usda", ".usdc", ".usdz"}
#: Endings of files that a room cannot do without: pictures and parts. Others, such as shaders of a program, are not
#: used.
NEEDED = USD | {".png", ".jpg", ".jpeg", ".exr", ".hdr", ".tif", ".tiff", ".tga", ".bmp", ".webp"}


def is_usd(name: str) -> bool:
    return Path(name).suffix.lower() in USD


def converted(context: luxfer.Context, path: Path) -> bytes:
    """Converts a USD file to GLB. All files that it refers to must lie in its folder or below."""
    try:
        from pxr import Tf, UsdUtils
    except ImportError:
        raise ValueError(
            "USD needs one more package: pip install 'luxfer[usd]', then start the studio again; or export the room as .glb"
        ) from None
    from .. import usd

    folder = path.resolve().parent
    try:
        layers, assets, missing = UsdUtils.ComputeAllDependencies(os.fspath(path))
    except Tf.ErrorException as error:
        raise ValueError(f"it is no USD file: {error}") from None
    for used in [layer.realPath for layer in layers] + list(assets):
        # A name inside a .usdz follows its path in brackets.
        if not Path(used.split("[")[0]).resolve().is_relative_to(folder):
            raise ValueError(f"it refers to {used}, which lies outside of its folder: save it as one .usdz")
    lost = [Path(name).name for name in missing if Path(name).suffix.lower() in NEEDED]
    if lost:
        raise ValueError(
            f"it refers to {lost[0]}, which is not there: save the room as one .usdz, or open it from its folder"
        )
    return usd.load(context, path).to_bytes()


def given(context: luxfer.Context, name: str, data: bytes) -> tuple[str, bytes]:
    """Returns name and content of a room that the user has given to the page, as GLB if it is USD."""
    if not is_usd(name):
        return name, data
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"room{Path(name).suffix.lower()}")
        path.write_bytes(data)
        return glb_name(name), converted(context, path)


def opened(context: luxfer.Context, files: Files, known: Known) -> Known:
    """Returns a file on disk as the server reads it: a room in USD is converted, and its GLB kept as an upload is."""
    if not is_usd(known.name):
        return known
    return files.upload(glb_name(known.name), converted(context, known.path))


def glb_name(name: str) -> str:
    return f"{Path(name).stem}.glb"
