"""Input and output files. A file that cannot be read ends the run with exit code 3; no output may replace an input."""

from __future__ import annotations

import argparse
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import values
from .console import described, doubt
from .exits import failed, unreadable, usage

if TYPE_CHECKING:
    from ..context import Context
    from ..image import Image
    from ..scene import Scene
    from ..strokes import Strokes

DEMO = "demo:"
DEMO_SCENES = ("target-room", "exemplar-room", "sphere-on-table", "still-life")
DEMO_IMAGES = ("photo", "strokes")
USD = (".usd", ".usda", ".usdc", ".usdz")
GLTF = (".glb", ".gltf")

#: Size of the demonstration photo.
DEMO_PHOTO: Any = {"width": 600, "height": 400}


def context_of(args: argparse.Namespace) -> Context:
    """Creates the context of a run."""
    from ..context import Context

    return Context(num_threads=getattr(args, "threads", 0))


def is_scene(name: str) -> bool:
    """Whether a name is the path of a scene file or names a generated scene."""
    return name.removeprefix(DEMO) in DEMO_SCENES if name.startswith(DEMO) else name.lower().endswith(USD + GLTF)


def load_scene(context: Context, name: str, units: str | None = None, luminaires: str = "faces") -> Scene:
    """Loads a scene file, or generates the scene that demo:NAME names."""
    from ..errors import Error
    from ..scene import Scene

    if name.startswith(DEMO):
        return Scene.demo(context, _demo(name, DEMO_SCENES))
    if name.lower().endswith(USD):
        return _load_usd(context, name, units)
    try:
        return Scene.load(context, name, unit=values.UNITS[units or "m"], luminaire_shape=luminaires)
    except Error as error:
        raise unreadable(name, error) from None


def _load_usd(context: Context, name: str, units: str | None) -> Scene:
    if units is not None:
        raise usage(f"--units is {units}, but {name} states its own unit, as every USD file; leave --units out")
    try:
        from .. import usd

        return usd.load(context, name)
    except ImportError:
        raise unreadable(name, "USD files need Pixar's library: pip install 'luxfer[usd]'") from None
    except Exception as error:
        raise unreadable(name, error) from None


def scene_warnings(scene: Scene) -> list[dict[str, Any]]:
    """Returns the warnings of a scene that was loaded."""
    return described(scene.warnings)


#: The demonstration photo and its strokes once they have been generated. They are arrays, so any context can use them.
_demo_photo: dict[str, Any] = {}


def load_image(context: Context, name: str, colour_space: str = "srgb") -> Image:
    """Loads an image file, or generates the image that demo:NAME names."""
    from ..demo import DemoPhoto
    from ..errors import Error
    from ..image import Image

    if name.startswith(DEMO):
        which = _demo(name, DEMO_IMAGES)
        if not _demo_photo:
            demo = DemoPhoto(context).run(**DEMO_PHOTO)
            _demo_photo.update(photo=demo.image("picture").numpy(), strokes=demo.image("strokes").numpy())
        return Image(context, _demo_photo[which])
    try:
        return Image.load(context, name, colour_space)
    except Error as error:
        raise unreadable(name, error) from None


def _demo(name: str, known: tuple[str, ...]) -> str:
    which = name.removeprefix(DEMO)
    if which not in known:
        raise usage(f"{name} is not generated input: there are {', '.join(DEMO + k for k in known)}")
    return which


def load_strokes(context: Context, name: str, photo: Image) -> Strokes:
    """Loads strokes for a photo, from a drawing of its size or from a text file."""
    from ..errors import Error
    from ..strokes import Strokes

    width, height, _ = photo.size
    strokes = Strokes(context, width, height)
    try:
        if name.lower().endswith(".txt"):
            strokes.add_text(Path(name).read_text())
        else:
            strokes.add_image(load_image(context, name))
    except (Error, OSError, UnicodeDecodeError) as error:
        raise unreadable(name, error) from None
    return strokes


def check_surface(scene: Scene, name: str) -> None:
    """Fails if a scene has no planar surface of this name; the message lists the existing names."""
    from ..errors import Error

    try:
        scene.find_surface(name)
    except Error as error:
        raise usage(f"--surface: {error}") from None


def shared_input(*names: str | None) -> list[Path]:
    """Returns the paths of the input files among `names`; leaves out options that were not given, and demo:NAME."""
    return [Path(n) for n in names if n and not n.startswith(DEMO)]


def check_file(option: str, name: str, inputs: list[Path], kinds: tuple[str, ...]) -> Path:
    """Checks an output file: its type must be known, its folder must exist, and it must not be an input."""
    path = Path(name)
    if path.suffix.lower() not in kinds:
        raise usage(f"{option}: {name} ends in none of {', '.join(kinds)}")
    if path.is_dir():
        raise usage(f"{option}: {name} is a folder, not a file")
    if not path.parent.is_dir():
        raise usage(f"{option}: there is no folder {path.parent}")
    if not os.access(path.parent, os.W_OK):
        raise failed(f"{option}: {path.parent} is not writable")
    for other in inputs:
        if path.exists() and other.exists() and path.samefile(other):
            raise usage(f"{option}: {name} is an input, and would be overwritten")
    return path


def check_folder(option: str, name: str, inputs: list[Path], files: tuple[str, ...]) -> Path:
    """Checks an output folder, which need not exist yet: no file in it may be an input."""
    folder = Path(name)
    if folder.exists() and not folder.is_dir():
        raise usage(f"{option}: {name} is a file, not a folder")
    for other in inputs:
        if other.exists() and any((folder / f).exists() and (folder / f).samefile(other) for f in files):
            raise usage(f"{option}: {other} is an input, and would be overwritten")
    there = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.exists())
    if not there.is_dir():
        raise usage(f"{option}: {there} is a file, not a folder")
    if not os.access(there, os.W_OK):
        raise failed(f"{option}: {there} is not writable")
    return folder


def write_text(path: Path, text: str) -> None:
    """Writes a text file; if this fails, an earlier file stays as it was."""
    part = path.with_name(f".{path.name}.part")
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(path)
    except OSError as error:
        raise failed(f"{path} cannot be written: {error.strerror}") from None
    finally:
        part.unlink(missing_ok=True)


def likeliest_surface(scene: Scene, name: str | None) -> tuple[str, list[dict[str, Any]]]:
    """Returns the named surface, or else the likeliest ceiling, with a warning if the choice is doubtful."""
    if name is not None:
        check_surface(scene, name)
        return name, []
    candidates = scene.candidates
    if not candidates:
        raise usage("--surface: the scene has no surface with an area")
    best = candidates[0]
    if best.score >= 0.5:
        return best.name, []
    others = ", ".join(c.name for c in candidates[1:4])
    message = f'"{best.name}" was taken for the ceiling, which it hardly resembles ({best.reason})'
    return best.name, [
        doubt("scene", "surface-guessed", message, f"try --surface NAME ({others}); `luxfer surfaces` lists all")
    ]
