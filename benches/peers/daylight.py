"""Daylight by luxfer and by Radiance: illuminances of free planes, and of a room with a window.

    LUXFER_LIBRARY=target/release/libluxfer.so target/peers/exchange/bin/python benches/peers/daylight.py

The skies come from gendaylit (Perez) and gensky (CIE), with the same irradiances and the same position of the sun.
The first table has the illuminances, by the sky alone, of a level plane and of vertical planes to the north, east,
south and west. The second table has the points of a grid in a room of 5 by 4 m with a window of 3 by 1.5 m, by sky and
sun, and the processor time of both programs.
"""

import math
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pyradiance

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bindings" / "python"))

import luxfer  # noqa: E402

CONTEXT = luxfer.Context()
BIN = Path(pyradiance.__file__).parent / "bin"
ENVIRONMENT = {**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}", "RAYPATH": f".:{BIN.parent / 'lib'}"}
#: Weights of Radiance's channels, and its lumens per watt.
BRIGHTNESS = 179.0 * np.array([0.265, 0.670, 0.065])
#: The dew point for which gendaylit has 2 cm of water, and its place: latitude, longitude and meridian to the west.
DEW_POINT, PLACE = 10.97353115, "-a 48.0 -o -11.0 -m -15".split()
DOME = "skyfunc glow dome 0 0 4 1 1 1 0\ndome source sky 0 0 4 0 0 1 180\n"
GROUND = "skyfunc glow floor 0 0 4 1 1 1 0\nfloor source ground 0 0 4 0 0 -1 180\n"
#: Month, day, hour in the zone, direct normal and diffuse horizontal irradiance.
WEATHER = {
    "overcast": (12, 10, 12.0, 0, 60),
    "dull": (3, 5, 10.0, 40, 160),
    "intermediate": (9, 12, 14.0, 250, 230),
    "bright": (4, 20, 11.0, 520, 180),
    "clear": (6, 21, 16.0, 830, 95),
    "low sun": (2, 1, 9.0, 450, 50),
}
#: Directions of planes in coordinates with y up and north at -z.
PLANES = {"level": (0, 1, 0), "north": (0, 0, -1), "east": (1, 0, 0), "south": (0, 0, 1), "west": (-1, 0, 0)}


def run(*words: object, text: str = "", folder: str) -> str:
    command = [BIN / str(words[0]), *map(str, words[1:])]
    ran = subprocess.run(command, input=text, capture_output=True, text=True, cwd=folder, env=ENVIRONMENT)
    if ran.returncode:
        raise SystemExit(f"{words}: {ran.stderr}")
    return ran.stdout


def sun_of(sky: str) -> tuple[float, float]:
    """Altitude and azimuth of the source `sun` in a sky of Radiance, whose x points east and y north."""
    x, y, z = map(float, sky.split("solar source sun")[1].split()[3:6])
    return math.asin(z), math.atan2(x, y) % (2 * math.pi)


def distance(month: int, day: int) -> float:
    """The distance of the sun by gendaylit's formula for the day."""
    angle = 2 * math.pi * (sum((31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30)[: month - 1]) + day - 1) / 365
    e0 = 1.00011 + 0.034221 * math.cos(angle) + 0.00128 * math.sin(angle)
    return (e0 + 0.000719 * math.cos(2 * angle) + 0.000077 * math.sin(2 * angle)) ** -0.5


def skies(folder: str) -> dict[str, tuple[str, dict[str, object]]]:
    """Each sky as text for Radiance, and as settings of Scene.set_sky."""
    out = {}
    for name, (month, day, hour, direct, diffuse) in WEATHER.items():
        sky = run("gendaylit", month, day, hour, *PLACE, "-W", direct, diffuse, folder=folder)
        altitude, azimuth = sun_of(sky)
        position = {"sun_altitude": altitude, "sun_azimuth": azimuth, "sun_distance": distance(month, day)}
        light = {"direct_normal": direct, "diffuse_horizontal": diffuse, "dew_point": DEW_POINT}
        out[name] = (sky, {"model": "perez", "unit": "watts", **position, **light})
    for name, flag, number in (("CIE overcast", "-c", 16), ("CIE uniform", "-u", 5), ("CIE clear", "+s", 12)):
        strength = ("-b", 20) if flag == "+s" else ("-B", 10_000 / 179)
        sky = run("gensky", 5, 15, 10.0, *PLACE, flag, *strength, folder=folder)
        settings: dict[str, object] = {"cie_type": number}
        if flag == "+s":
            altitude, azimuth = sun_of(sky)
            settings |= {"sun_altitude": altitude, "sun_azimuth": azimuth, "zenith_luminance": 20 * 179.0}
        else:
            settings["diffuse_horizontal"] = 10_000.0
        out[name] = (sky, settings)
    return out


def without_sun(sky: str) -> str:
    """A sky of Radiance without its sun."""
    kept = sky.split("\nvoid light solar")
    return kept[0] if len(kept) == 1 else kept[0] + "\nvoid brightfunc" + kept[1].split("\nvoid brightfunc")[1]


def radiance(scene: str, points: np.ndarray, settings: str, folder: str) -> tuple[np.ndarray, float]:
    """Illuminances of points (n, 6) by rtrace, and its processor time."""
    Path(folder, "scene.rad").write_text(scene)
    with open(Path(folder, "scene.oct"), "wb") as out:
        subprocess.run([BIN / "oconv", "scene.rad"], check=True, cwd=folder, env=ENVIRONMENT, stdout=out)
    # Radiance has z up and y to the north.
    turned = points[:, [0, 2, 1, 3, 5, 4]] * [1, -1, 1, 1, -1, 1]
    text = "\n".join(" ".join(map(str, row)) for row in turned) + "\n"
    before = sum(os.times()[2:4])
    lines = run("rtrace", "-h", "-I", *settings.split(), "scene.oct", text=text, folder=folder)
    spent = sum(os.times()[2:4]) - before
    return np.array([list(map(float, line.split())) for line in lines.splitlines()]) @ BRIGHTNESS, spent


def luxes(scene: luxfer.Scene, samples: int, columns: int = 1, rows: int = 1, **grid: object) -> np.ndarray:
    stage = luxfer.Illuminance(CONTEXT, scene)
    stage.run_grid(grid, columns=columns, rows=rows, samples=samples)
    return stage.image().numpy().reshape(rows, columns)


def free_planes(all_skies: dict[str, tuple[str, dict[str, object]]], folder: str) -> None:
    print("illuminance by the sky alone, lx: luxfer / Radiance (difference)")
    print(f"{'sky':14}" + "".join(f"{name:>26}" for name in PLANES))
    worst = 0.0
    points = np.array([(0, 0, 0, *normal) for normal in PLANES.values()], float)
    for name, (sky, settings) in all_skies.items():
        theirs, _ = radiance(without_sun(sky) + DOME, points, "-ab 1 -ad 65536 -as 0 -aa 0 -lr 8 -lw 1e-9", folder)
        scene = luxfer.Scene(CONTEXT)
        scene.add_material()
        scene.add_mesh([[0, -9, 0], [1, -9, 0], [0, -9, 1]], [[0, 1, 2]])
        report = scene.set_sky(**{**settings, "ground_reflectance": 0})
        row = f"{name:14}"
        for normal, their in zip(PLANES.values(), theirs):
            # Without the sun, whose illuminance of the plane is known.
            x, y, z = normal
            altitude, azimuth = (settings.get(k, 0.0) for k in ("sun_altitude", "sun_azimuth"))
            level = math.cos(altitude)
            towards = np.array([level * math.sin(azimuth), math.sin(altitude), -level * math.cos(azimuth)])
            across, down = ((1, 0, 0), (0, 0, 1)) if y else ((0, 1, 0), (z, 0, x))
            tiny = [tuple(1e-3 * v for v in edge) for edge in (across, down)]
            ours = luxes(scene, 1 << 20, origin=(0, 0, 0), across=tiny[0], down=tiny[1], normal=normal)[0, 0]
            ours -= report.direct_normal * max(0.0, float(towards @ np.array(normal, float)))
            worst = max(worst, abs(ours / their - 1))
            row += f"{ours:9.0f} /{their:7.0f} ({100 * (ours / their - 1):+5.2f} %)"
        print(row)
    print(f"largest difference {100 * worst:.2f} %")


def room() -> list[tuple[tuple[float, ...], tuple[float, ...], tuple[float, ...], float]]:
    """The rectangles of the room: a corner, two edges and the reflectance. The south wall, at z = 4, has a window."""
    x, y, z = 5.0, 2.8, 4.0
    low, high, left, right = 0.9, 2.4, 1.0, 4.0
    rectangles = [
        ((0, 0, 0), (0, 0, z), (x, 0, 0), 0.2),
        ((0, y, 0), (x, 0, 0), (0, 0, z), 0.7),
        ((0, 0, 0), (x, 0, 0), (0, y, 0), 0.5),
        ((0, 0, 0), (0, y, 0), (0, 0, z), 0.5),
        ((x, 0, 0), (0, 0, z), (0, y, 0), 0.5),
    ]
    for a, b, c, d in ((0, x, 0, low), (0, x, high, y), (0, left, low, high), (right, x, low, high)):
        rectangles.append(((a, c, z), (b - a, 0, 0), (0, d - c, 0), 0.5))
    return rectangles


def window(all_skies: dict[str, tuple[str, dict[str, object]]], folder: str) -> None:
    print("\nroom with a window to the south, grid of 8 x 6 points 0.85 m above the floor, by sky and sun")
    heads = ("mean of luxfer", 16), ("Radiance", 10), ("difference", 13), ("rms of points", 15), ("CPU-s", 9), ("Radiance", 10)
    print(f"{'sky':14}" + "".join(f"{head:>{width}}" for head, width in heads))
    scene, text = luxfer.Scene(CONTEXT), ""
    for number, (corner, first, second, value) in enumerate(room()):
        a, b, c = (np.array(v, float) for v in (corner, first, second))
        corners = np.array([a, a + b, a + b + c, a + c])
        paint = scene.add_material(base_color=(value,) * 3, metallic=0, ior=1, double_sided=True)
        scene.add_mesh(corners, [[0, 1, 2], [0, 2, 3]], material=paint)
        places = " ".join(f"{px} {-pz} {py}" for px, py, pz in corners)
        text += f"void plastic m{number} 0 0 5 {value} {value} {value} 0 0\n"
        text += f"m{number} polygon p{number} 0 0 12 {places}\n"
    grid = {"origin": (0.5, 0.85, 0.5), "across": (4, 0, 0), "down": (0, 0, 3), "normal": (0, 1, 0)}
    xs, zs = 0.5 + 4 * (np.arange(8) + 0.5) / 8, 0.5 + 3 * (np.arange(6) + 0.5) / 6
    points = np.array([(x, 0.85, z, 0, 1, 0) for z in zs for x in xs])
    for name, (sky, settings) in all_skies.items():
        report = scene.set_sky(**settings)
        if "solar source" in sky and "direct_normal" not in settings:
            continue  # gensky's sun has another illuminance
        # The ground of gendaylit follows another formula: state the same luminance.
        grey = " ".join([f"{report.ground_luminance / 179:.6g}"] * 3)
        ground = f"void glow earth 0 0 4 {grey} 0\nearth source ground 0 0 4 0 0 -1 180\n"
        begun = time.process_time()
        ours = luxes(scene, 4096, 8, 6, **grid).reshape(-1)
        spent = time.process_time() - begun
        quality = "-ab 30 -ad 512 -as 0 -aa 0 -lr -30 -lw 1e-3 -dj 0.7 -dt 0 -dc 1"
        theirs, seconds = radiance(sky + DOME + ground + text, points, quality, folder)
        rms = math.sqrt(np.mean((ours / theirs - 1) ** 2))
        print(
            f"{name:14}{ours.mean():16.1f}{theirs.mean():10.1f}{100 * (ours.mean() / theirs.mean() - 1):+11.2f} %"
            f"{100 * rms:13.2f} %{spent:9.2f}{seconds:10.2f}"
        )


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        found = skies(place)
        free_planes(found, place)
        window(found, place)
