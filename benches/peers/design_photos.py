"""Ten photos and five rooms: designs that keep a photo's look and meet the requirements, recomputed by Radiance.

    LUXFER_LIBRARY=... LUXFER_TEST_DATA=... target/peers/exchange/bin/python benches/peers/design_photos.py \
        [--photos N,N] [--rooms R,R] [--record FILE] [--minutes M] [--pictures FOLDER] [--summary FILE]

The photos are the first ten by name that `make bench ONLY=photos:real` judges right and that show a pattern on a plane
(without TRAPS and WITHOUT_PLANE of benches/photos/corpus.rs). For each photo and room: the light is copied to the
ceiling, then luxfer.design.arrange finds the design closest to this copy that meets all requirements. Its luminaires
are made to measure: openings of the photo's lamps, scaled with the pattern, with five distributions of intensity.
Radiance then recomputes the illuminance from the exported files.

Prints a line for each design, and what it misses. --record appends the results to a file of JSON lines and leaves out
designs that the file has, and --minutes begins no design after that time, so that the table can be made in pieces;
--summary prints the table and the totals of such a file.
"""

import argparse
import itertools
import json
import math
import os
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bindings" / "python"))

import luxfer  # noqa: E402
from design_radiance import CONTEXT  # noqa: E402
from design_rooms import ROOMS  # noqa: E402
from luxfer import design  # noqa: E402
from luxfer.design import likeness, motif, pictures, radiance  # noqa: E402

PHOTOS = (
    "alma_corridor_far atg_lines_a atg_lines_b gutsy_classroom_lowres junda_auditorium_m2 junda_classroom_c1 "
    "junda_classroom_c3 junda_theatre_l4 museum_tracks_a museum_tracks_b"
).split()
#: Powers of the cosine with which the intensity falls.
OPTICS = {"diffuser": 1, "satin": 1.4, "prisms": 2, "louvre": 4, "reflector": 8}
#: Lumens per m² of the opening at full power: of small spots, of panels, and lumens that are added to the latter.
SPOT, PANEL, ADDED = 2e5, 25e3, 2000
#: Lumens per watt of the luminaires. Share by which limits of illuminance are exceeded (Wishes.reserve).
LUMENS_PER_WATT, RESERVE = 120, 0.02
#: Rays of Radiance from all points of an area together at the first reflection, of task areas and of others, and their
#: limits for each point. An area with a requirement that Radiance misses is computed again with RETRY times the rays.
RAYS, OTHER_RAYS, LEAST_RAYS, MOST_RAYS, RETRY = 8192, 4096, 2, 512, 8
#: Size of the parts of a luminaire over their distance.
PARTS = ("-ds", "0.1")
#: Largest change of the pattern's statistics, and colour difference of the surfaces, with which a look is kept.
PATTERN, DELTA_E = likeness.SMALL_PATTERN, likeness.SMALL_DELTA_E


def product(optics: str, length: float, width: float) -> design.Product:
    """A luminaire with an opening of that size in metres."""
    power, flux = OPTICS[optics], min(SPOT * length * width, ADDED + PANEL * length * width)
    angles = np.arange(0, 181, 5.0)
    share = np.where(angles < 90, np.cos(np.radians(np.minimum(angles, 90))), 0.0) ** power
    candela = flux * (power + 1) / (2 * math.pi) * share
    text = (
        f"IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 {len(angles)} 1 1 2 {width:.6g} {length:.6g} 0\n"
        f"1 1 {flux / LUMENS_PER_WATT:.6g}\n{' '.join(f'{a:g}' for a in angles)}\n0\n"
        f"{' '.join(f'{c:.6g}' for c in candela)}\n"
    )
    name = f"{optics} {length:.2f} x {width:.2f} m"
    return design.Product.from_bytes(CONTEXT, text.encode(), "ies", name, rendering=80)


def copied(photo: str, room: design.Room) -> list:
    """The lamps of a photo's copy on the ceiling of a room."""
    data, own = Path(os.environ["LUXFER_TEST_DATA"]), Path(__file__).resolve().parents[2] / "tests" / "strokes"
    files = ((data / "corpus", data / "corpus", ".strokes.txt"), (data / "photos", own, ".txt"))
    found = ((p / f"{photo}.jpg", s / f"{photo}{e}") for p, s, e in files)
    picture, strokes = next((p, s) for p, s in found if p.exists())
    image = luxfer.Image.load(CONTEXT, picture)
    drawn = luxfer.Strokes(CONTEXT, *image.size[:2])
    drawn.add_text(strokes.read_text())
    transfer = luxfer.Transfer(CONTEXT, image, room.scene, room.ceiling)
    transfer.set_strokes(drawn)
    transfer.run(last="relight")
    return design.from_transfer(CONTEXT, transfer, efficacy=LUMENS_PER_WATT, rendering=80)


def designed(photo: str, empty: design.Project) -> design.Arrangement:
    """The design for a room."""
    lamps = copied(photo, empty.room)
    length, width = motif.find(empty.room, lamps).lamps.sizes.mean(axis=0)
    offers = [
        offer
        for optics in OPTICS
        for offer in design.Offer.to_measure(
            lambda scale: product(optics, scale * length, scale * width), design.Search().scales
        )
    ]
    wanted = replace(empty, luminaires=lamps)
    return wanted.arrange(offers, design.Wishes(reserve=RESERVE))


def recomputed(found: design.Arrangement) -> list:
    """All requirements that Radiance recomputes."""
    lit, checked, out = found.project, found.solution.checked, []
    with tempfile.TemporaryDirectory() as folder:
        radiance.export(lit, folder)
        for area in lit.areas:
            points = area.count * len(area.patches if area.kind == "cylindrical" else (area,))
            rays = min(max((RAYS if area.kind == "task" else OTHER_RAYS) // points, LEAST_RAYS), MOST_RAYS)
            mine = tuple(f for f in checked.findings if f.requirement.area == area.name)
            for number in (rays, RETRY * rays):
                settings = (*radiance.RTRACE, *PARTS, "-ad", str(number))
                second = radiance.recompute(lit, replace(checked, findings=mine), folder, settings)
                if all(s.confirms for s in second):
                    break
            out += second
    return out


def line(photo: str, name: str, empty: design.Project, given: argparse.Namespace) -> dict:
    """Makes a design, prints it, records it, and returns what a table needs."""
    begun, used = time.perf_counter(), time.process_time()
    found = designed(photo, empty)
    seconds, cpu = time.perf_counter() - begun, time.process_time() - used
    begun = time.perf_counter()
    second = recomputed(found)
    checked = found.solution.checked
    row = {
        "photo": photo,
        "room": name,
        "passes": checked.passes,
        "radiance": all(s.holds for s in second),
        "confirmed": sum(s.confirms for s in second),
        "recomputed": len(second),
        "means": max((abs(s.difference) for s in second if s.finding.requirement.quantity == "mean"), default=0.0),
        "pattern": found.look.pattern,
        "delta_e": found.look.delta_e,
        "ratios": found.look.brightness,
        "lamps": len(found.project.luminaires),
        "product": found.offer.product.name,
        "scale": found.scale,
        "exposure": found.look.exposure,
        "seconds": seconds,
        "cpu": cpu,
        "radiance_seconds": time.perf_counter() - begun,
        "explanation": "" if checked.passes else found.explanation(),
    }
    print(shown(row), flush=True)
    if not checked.passes:
        print(f"    {row['explanation']}", flush=True)
    for s in second:
        if not s.holds or not s.confirms:
            print(f"    {s}", flush=True)
    if given.record:
        with Path(given.record).open("a") as out:
            out.write(json.dumps(row) + "\n")
    if given.pictures:
        folder = Path(given.pictures)
        folder.mkdir(parents=True, exist_ok=True)
        views = pictures.views(found.project.room, found.project.lit(), 480, 320, 64)
        (folder / f"{photo}-{name}.png").write_bytes(next(iter(views.values())))
    return row


def kept(row: dict) -> bool:
    """Whether a design keeps the look."""
    return row["pattern"] <= PATTERN and row["delta_e"] <= DELTA_E


def shown(row: dict) -> str:
    """A design as a row of the table."""
    ours, theirs = ("passes" if row[key] else "fails" for key in ("passes", "radiance"))
    return (
        f"| {row['photo']} | {row['room']} | {ours} | {theirs}, {row['confirmed']}/{row['recomputed']} | "
        f"{100 * row['pattern']:.1f} % | {row['delta_e']:.1f} | {100 * row['ratios']:.0f} % | {row['lamps']} x "
        f"{row['product']} | {row['seconds']:.0f} | {row['cpu']:.0f} |"
    )


HEAD = (
    "| photo | room | luxfer | Radiance, confirmed | pattern | ΔE | lamps' ratios | design | s | CPU s |\n"
    "|---|---|---|---|---|---|---|---|---|---|"
)


def summary(rows: list[dict]) -> str:
    """The totals."""
    both = [r for r in rows if r["passes"] and r["radiance"]]
    lines = [
        f"{len(rows)} designs: {sum(r['passes'] for r in rows)} pass in luxfer, {len(both)} in Radiance too",
        f"{sum(r['confirmed'] for r in rows)} of {sum(r['recomputed'] for r in rows)} requirements are confirmed",
        f"look kept in {sum(map(kept, rows))} designs, and in {sum(map(kept, both))} of those that pass in both: "
        f"pattern {sum(r['pattern'] <= PATTERN for r in both)}, "
        f"colour difference {sum(r['delta_e'] <= DELTA_E for r in both)}",
        f"median of {np.median([r['seconds'] for r in rows]):.0f} s and {np.median([r['cpu'] for r in rows]):.0f} "
        f"processor seconds a design, at most {max(r['seconds'] for r in rows):.0f} and "
        f"{max(r['cpu'] for r in rows):.0f}; at most 30 s: {sum(r['seconds'] <= 30 for r in rows)}, at most 60 "
        f"processor seconds: {sum(r['cpu'] <= 60 for r in rows)}",
    ]
    return "\n".join(lines)


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--photos", default=",".join(PHOTOS))
    parser.add_argument("--rooms", default=",".join(ROOMS))
    parser.add_argument("--record")
    parser.add_argument("--minutes", type=float, default=math.inf)
    parser.add_argument("--pictures")
    parser.add_argument("--summary")
    given = parser.parse_args()
    if given.summary:
        rows = sorted(records(given.summary), key=lambda r: (list(ROOMS).index(r["room"]), PHOTOS.index(r["photo"])))
        print("\n".join([HEAD, *map(shown, rows), "", summary(rows)]))
        return
    print(HEAD, flush=True)
    begun, rows, empty = time.perf_counter(), [], {}
    for photo, name in itertools.product(given.photos.split(","), given.rooms.split(",")):
        known = {(r["room"], r["photo"]) for r in records(given.record)}
        if (name, photo) in known or time.perf_counter() - begun > 60 * given.minutes:
            continue
        if name not in empty:
            empty[name] = ROOMS[name]()
        rows.append(line(photo, name, empty[name], given))
    if rows:
        print(summary(rows))


def records(path: str | None) -> list[dict]:
    """The designs of a file of JSON lines."""
    return [json.loads(text) for text in Path(path).read_text().splitlines()] if path and Path(path).exists() else []


if __name__ == "__main__":
    main()
