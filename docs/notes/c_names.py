"""Writes the tables of docs/notes/plain-words.md: what became of the C functions of an earlier commit, and
which functions are new.

    python3 docs/notes/c_names.py COMMIT

Fails if a function of that commit has neither kept its name nor a line in RENAMED or GONE.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NOTE = ROOT / "docs/notes/plain-words.md"
BEGIN, END = "<!-- functions: written by c_names.py -->\n", "<!-- end of functions -->"
KINDS = "context image job scene distribution rectify features segment emission render illuminance relight lamps importance"
KINDS += " transfer plan guides stylize demo_photo candidates warnings"
STAGES = "transfer rectify features segment emission relight scene"

#: Functions that have another name.
RENAMED = {
    "version": "get_version",
    "emission_start_plan": "emission_start_composition",
    "stylize_params_preset": "stylize_get_preset",
    "version_string": "get_version_string",
    "status_name": "status_get_name",
    "warning_name": "warning_get_name",
    "context_last_error": "context_get_last_error",
    "image_size": "image_get_size",
    "image_glare": "image_get_glare",
    "scene_requirements": "scene_get_requirements",
    "scene_requirements_text": "scene_get_requirements_text",
    "candidates_count": "candidates_get_count",
    "warnings_count": "warnings_get_count",
    "preset_count": "preset_get_count",
    "guides_motion": "guides_get_motion",
    "colour_temperature": "colour_to_temperature",
    "colour_of_temperature": "temperature_to_colour",
    "demo_scene": "demo_create_scene",
    "demo_artwork": "demo_create_artwork",
    "relight_set_sense": "relight_set_constraint",
    "lamps_set_sense": "lamps_set_constraint",
    "segment_set_within": "segment_set_region",
}
#: Functions that other functions have replaced: the functions of each group, and what replaces them.
GONE = [
    ([f"{kind}_retain" for kind in KINDS.split()], "`luxfer_retain` takes a handle of any kind"),
    ([f"{kind}_release" for kind in KINDS.split()], "`luxfer_release` takes a handle of any kind"),
    ([f"{stage}_get_warnings" for stage in STAGES.split()], "`luxfer_get_warnings` takes a transfer, a stage or a scene"),
    (["warnings_get_message", "warnings_get_advice"], "fields of `luxfer_warning`"),
    (["candidates_get_name", "candidates_get_reason"], "fields of `luxfer_candidate`"),
    (
        [f"{s}_{f}" for s in ("features", "segment", "transfer") for f in ("add_stroke", "add_strokes_image", "add_strokes_text", "clear_strokes")],
        "an object of its own, `luxfer_strokes`, which `set_strokes` copies",
    ),
    (["scene_load_with", "scene_load_memory_with"], "`luxfer_scene_load` and `luxfer_scene_load_memory` take settings"),
    (["scene_set_environment_image"], "`luxfer_scene_set_environment` takes an image"),
    (["scene_read_mesh", "scene_read_mesh_uvs", "scene_read_mesh_colours"], "`luxfer_scene_read_vertices`, `luxfer_scene_read_triangles`"),
    (["render_set_camera_index"], "`luxfer_scene_get_camera`, then `luxfer_render_set_camera`"),
    (["job_poll", "job_status"], "`luxfer_job_get_progress`, and the outcome that `luxfer_job_wait` writes"),
    (["scene_set_emission"], "`luxfer_scene_get_material`, then `luxfer_scene_set_material`"),
    (["rectify_warp"], "`luxfer_image_warp` with the homography of the report"),
    (["render_find_layer"], "`luxfer_render_get_layer` takes the name"),
    (["preset_name"], "a field of `luxfer_preset`"),
    (["stylize_get_level", "stylize_get_round", "stylize_get_pass"], "nothing: they served comparisons of methods"),
    (["power_density"], "a formula of one line: flux / efficacy / area"),
]


def functions(header: str) -> dict[str, list[str]]:
    """The functions that a header declares, without the prefix, each with its parameters."""
    code = re.sub(r"/\*.*?\*/", "", header, flags=re.S)
    found = re.findall(r"^(?:static inline )?[a-z_][\w ]*?\*? ?\*?luxfer_(\w+)\(([^)]*)\)", code, re.M)
    return {name: [" ".join(p.split()).replace("struct ", "") for p in parameters.split(",")] for name, parameters in found}


def kind(parameter: str) -> str:
    """The type of a parameter, without its name; an array counts as a pointer."""
    name = re.search(r"\w+(\[\d*\])?$", parameter)
    return parameter[: name.start()].strip() + (" *" if name[1] else "")


def changes(before: dict[str, list[str]], now: dict[str, list[str]]) -> list[str]:
    """The lines that name the kept functions whose types of parameters have changed."""
    sized, other = [], []
    for name in (f for f in before if f in now):
        old, new = ([kind(p) for p in parameters[name]] for parameters in (before, now))
        if old != new:
            (sized if new == [*old, "size_t"] and now[name][-1] == "size_t size" else other).append(name)
    out = [f"{len(sized)} kept functions have a new last parameter `size_t size`, the size of the struct that they fill:", ""]
    out += [", ".join(f"`luxfer_{f}`" for f in sized) + ".", ""]
    out += [f"{len(other)} kept functions have other parameters:", "", "| function | parameters before | parameters now |", "|---|---|---|"]
    return out + [f"| `luxfer_{f}` | `{', '.join(before[f])}` | `{', '.join(now[f])}` |" for f in other]


def main(commit: str) -> int:
    show = ["git", "-C", str(ROOT), "show", f"{commit}:include/luxfer.h"]
    before = functions(subprocess.run(show, check=True, capture_output=True, text=True).stdout)
    headers = {path.stem: functions(path.read_text()) for path in sorted((ROOT / "include/luxfer").glob("*.h"))}
    now = {f: header for header, declared in headers.items() for f in declared}
    reasons = {f: reason for group, reason in GONE for f in group}
    kept = Counter(now[f] for f in before if f in now)
    renamed = [f for f in before if f not in now and RENAMED.get(f) in now]
    gone = [f for f in before if f not in now and f not in renamed]
    if unknown := [f for f in gone if f not in reasons]:
        print("no reason is known for:", *unknown, file=sys.stderr)
        return 1
    out = [f"{len(before)} functions: {sum(kept.values())} kept, {len(renamed)} renamed, {len(gone)} gone; {len(now)} now."]
    out += ["", "| header of today | kept |", "|---|---|"]
    out += [f"| `{header}.h` | {count} |" for header, count in sorted(kept.items())]
    out += ["", "| before | now |", "|---|---|"]
    out += [f"| `luxfer_{f}` | `luxfer_{RENAMED[f]}` |" for f in renamed]
    out += ["", "| gone | number | in their place |", "|---|---|---|"]
    for group, reason in GONE:
        found = [f for f in group if f in gone]
        names = ", ".join(f"`luxfer_{f}`" for f in found)
        if len(found) > 12:
            names = f"`luxfer_KIND_{found[0].rsplit('_', 1)[1]}` of each kind of handle"
        if found:
            out.append(f"| {names} | {len(found)} | {reason} |")
    new = [f for f in now if f not in before and f not in {RENAMED[f] for f in renamed}]
    out += ["", f"{len(new)} functions are new:", "", "| header | new |", "|---|---|"]
    for header in headers:
        if names := ", ".join(f"`luxfer_{f}`" for f in new if now[f] == header):
            out.append(f"| `{header}.h` | {names} |")
    out += ["", "### Kept functions whose declaration changed", ""]
    out += ["Declarations count as equal if only names of parameters differ.", ""]
    out += changes(before, {f: p for declared in headers.values() for f, p in declared.items()})
    head, _, rest = NOTE.read_text().partition(BEGIN)
    NOTE.write_text("\n".join([head + BEGIN, *out, "", END + rest.partition(END)[2]]))
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
