"""Output of the command line: results on stdout; progress, warnings and errors on stderr."""

from __future__ import annotations

import argparse
import json
import math
import os
import sys
import time
from collections.abc import Callable, Iterable
from enum import IntEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .exits import Exit

if TYPE_CHECKING:
    from ..warning import StageWarning

#: Width of the progress bar in characters.
BAR = 30

#: For some warnings, the option that helps; it is shown in place of the library's general advice.
ADVICE = {
    "PROPOSED": "try --preview-masks masks.png to see the masks, and --strokes FILE to correct them",
    "IMPLAUSIBLE_SIZE": "try --units with the unit of the file",
    "FOCAL_ASSUMED": "try a photo that shows two walls",
    "VIEW_UNCERTAIN": "try a photo with more straight edges along the room",
    "UNSEEN": "try one more stroke there; --preview-masks masks.png shows the place",
    "UNCERTAIN_MASK": "try a stroke on the part taken for another surface; --preview-masks masks.png shows it",
    "MISSED_STROKES": "the classes look alike: try more strokes on both; --preview-masks masks.png shows the mask",
    "MAGNIFIED": "try a photo of more pixels, or one that looks more towards the plane",
    "OFF_PLANE": "use a photo whose lamps lie on the ceiling, or one with more straight edges along the room",
    "NO_LATTICE": "try strokes on the lamps that the mask leaves out, if the lamps are regular",
    "UNREACHABLE": "try --white with a higher luminance, or a scene with less other light",
}


class Console:
    """Writes to the two streams of a run, and remembers the files that the run has written."""

    def __init__(self) -> None:
        self.name = "luxfer"
        self.is_json = False
        self.is_strict = False
        self.shows_progress = sys.stderr.isatty()
        self.files: list[str] = []
        self.began = time.monotonic()
        self._is_open = False

    def configure(self, args: argparse.Namespace) -> None:
        """Reads the options that every subcommand has."""
        self.is_json = getattr(args, "json", False)
        self.is_strict = getattr(args, "strict", False)
        if getattr(args, "progress", None) is not None:
            self.shows_progress = args.progress

    # -- progress

    def step(self, title: str) -> Callable[[float], None] | None:
        """Returns a progress function for a job, which shows the progress with the time left; None if progress is not
        shown."""
        if not self.shows_progress:
            return None
        began, last_shown = time.monotonic(), [-math.inf, -1.0]

        def show(share: float) -> None:
            now = time.monotonic()
            is_last = share >= 1
            interval = 0.1 if sys.stderr.isatty() else 1.0
            if share == last_shown[1] or (not is_last and now - last_shown[0] < interval):
                return
            last_shown[:] = now, share
            passed = now - began
            left = f"{clock(passed * (1 - share) / share)} left" if share > 0.02 and passed > 0.5 else ""
            self._progress_line(title, share, f"in {clock(passed)}" if is_last else left, is_last)

        return show

    def _progress_line(self, title: str, share: float, rest: str, is_last: bool) -> None:
        if sys.stderr.isatty():
            filled = int(share * BAR)
            line = f"\r{title:<22} [{'#' * filled}{'.' * (BAR - filled)}] {int(100 * share):3d} %  {rest:<14}"
            self._is_open = not is_last
            print(line, end="\n" if is_last else "", file=sys.stderr, flush=True)
        else:
            print(f"{title}: {int(100 * share)} % {rest}".rstrip(), file=sys.stderr, flush=True)

    def close_line(self) -> None:
        """Ends a progress line that is still open."""
        if self._is_open:
            print(file=sys.stderr)
            self._is_open = False

    # -- results

    def wrote(self, path: str | os.PathLike[str]) -> None:
        """Remembers a file that has been written completely."""
        self.files.append(os.fspath(path))

    def kept(self) -> str:
        """Lists the complete files, for the message of a cancelled run."""
        return f"; kept {', '.join(self.files)}" if self.files else "; no file was written"

    def print_result(self, result: dict[str, Any], lines: Iterable[str], warnings: Iterable[dict[str, Any]] = ()) -> Exit:
        """Prints a result, as JSON or as lines, then the warnings on stderr; returns the exit code."""
        doubts = list(warnings)
        self.close_line()
        if self.is_json:
            print(as_json({**result, "files": self.files, "warnings": doubts}), flush=True)
        else:
            for line in lines:
                print(line)
            for path in self.files:
                print(f"wrote {path}")
            sys.stdout.flush()
        for warning in doubts:
            print(f"warning: {in_words(warning)}", file=sys.stderr)
        return Exit.DOUBTFUL if doubts and self.is_strict else Exit.FINE

    def fail(self, code: Exit, message: str) -> int:
        """Prints in one line why the run has failed; returns the exit code."""
        self.close_line()
        line = " ".join(message.split())
        print(f"{self.name}: {line}", file=sys.stderr)
        if self.is_json:
            print(as_json({"error": {"exit": int(code), "message": line}, "files": self.files}), flush=True)
        return int(code)


def clock(seconds: float) -> str:
    """Formats a duration: 4 s, 1:05, 2:00:00."""
    whole = max(0, round(seconds))
    if whole < 60:
        return f"{whole} s"
    hours, rest = divmod(whole, 3600)
    return f"{hours}:{rest // 60:02d}:{rest % 60:02d}" if hours else f"{rest // 60}:{rest % 60:02d}"


def percent(share: float) -> str:
    """Formats a share in per cent with two digits; `unknown` for NaN."""
    return f"{100 * share:.2g} %" if math.isfinite(share) else "unknown"


def described_stages(warnings: Iterable[StageWarning]) -> list[dict[str, Any]]:
    """Converts the warnings of a transfer for JSON, except its scene's, which `files.scene_warnings` lists."""
    return described(w for w in warnings if w.stage.name != "SCENE")


def described(warnings: Iterable[StageWarning]) -> list[dict[str, Any]]:
    """Converts warnings of the library to the form in which JSON shows them."""
    return [
        {
            "stage": w.stage.name.lower(),
            "code": w.code.name.lower().replace("_", "-"),
            "severity": w.severity,
            "limit": w.limit,
            "place": w.place,
            "message": w.message,
            "advice": ADVICE.get(w.code.name) or w.advice,
        }
        for w in warnings
    ]


def doubt(stage: str, code: str, message: str, advice: str) -> dict[str, Any]:
    """Creates a warning of the command line itself."""
    return {"stage": stage, "code": code, "message": message, "advice": advice}


def in_words(warning: dict[str, Any]) -> str:
    """Formats a warning in one line."""
    place = warning.get("place")
    at = f" (pixel {int(place[0])}, {int(place[1])})" if place else ""
    return f"{warning['stage']}: {warning['message']}{at}: {warning['advice']}"


def as_json(value: Any) -> str:
    """Formats a value as JSON; infinite numbers and NaN become null."""
    return json.dumps(plain(value), ensure_ascii=False, indent=2, allow_nan=False)


def plain(value: Any) -> Any:
    """Converts a value to types that JSON has: enumerations to their names, arrays to lists."""
    if isinstance(value, IntEnum):
        return value.name.lower().replace("_", "-")
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, Path):
        return str(value)
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value
