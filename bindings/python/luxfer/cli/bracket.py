"""The option --exposures: further exposures of the photo, which show its lamps unclipped."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from .console import doubt, percent

if TYPE_CHECKING:
    from ..context import Context
    from ..image import Image
    from ..types import MergeReport

#: Parts of the pixels beyond which a warning names clipped and moved pixels.
MANY_CLIPPED, MANY_MOVED = 0.001, 0.1


def add(parser: argparse.ArgumentParser) -> None:
    """Adds --exposures."""
    parser.add_argument(
        "--exposures",
        nargs="+",
        metavar="FILE",
        help="further exposures of PHOTO's view, in any order: parts that PHOTO clips, such as lamps, come from the "
        "shorter exposures; give it after PHOTO and SCENE",
    )


def load(context: Context, photo: str, exposures: list[str] | None) -> tuple[Image, MergeReport | None]:
    """Loads the photo and merges it with its further exposures. The merged image has the photo's frame and white."""
    from ..image import merge_exposures
    from . import files

    first = files.load_image(context, photo)
    if not exposures:
        return first, None
    return merge_exposures(context, [first, *(files.load_image(context, name) for name in exposures)], reference=0)


def facts(report: MergeReport) -> dict[str, Any]:
    """Returns the findings of the merge in the form in which JSON shows them."""
    return {
        "exposures": list(report.exposures),
        "exposure_errors": list(report.errors),
        "shifts": [list(shift) for shift in zip(report.shift_x, report.shift_y)],
        "clipped": report.clipped,
        "moved": report.moved,
        "tone_curve": "recovered" if _is_recovered(report) else "srgb",
        "tone_curve_error": report.tone_curve_error,
        "contradicts_srgb": bool(report.contradicts_srgb),
    }


def words(report: MergeReport) -> str:
    """Describes the merge in a line."""
    others = ", ".join(f"{1 / e:.3g}" if e < 1 else f"1/{e:.3g}" for e in report.exposures[1:])
    curve = f"; tone curve recovered within {percent(report.tone_curve_error)}" if _is_recovered(report) else ""
    return (
        f"photo merged with exposures shorter by {others}; {percent(report.clipped)} of it still clipped, "
        f"{percent(report.moved)} moved{curve}"
    )


def _is_recovered(report: MergeReport) -> bool:
    from ..types import ToneCurve

    return report.tone_curve == ToneCurve.RECOVERED


def doubts(report: MergeReport) -> list[dict[str, Any]]:
    """Returns the warnings about a merge."""
    out = []
    if report.clipped > MANY_CLIPPED:
        message = f"{percent(report.clipped)} of the pixels are clipped in every exposure"
        out.append(doubt("exposures", "clipped", message, "add a shorter exposure"))
    if report.moved > MANY_MOVED:
        message = f"the exposures disagree on {percent(report.moved)} of the pixels"
        out.append(doubt("exposures", "moved", message, "use photos from a tripod, developed with the same settings"))
    if report.contradicts_srgb:
        message = "the exposures contradict the tone curve of sRGB, so the light of the lamps is off"
        out.append(doubt("exposures", "tone-curve", message, "use files that state their exposure times"))
    return out
