"""The UGR table of a luminaire, compared with hand-computed values, with plain loops, with path-traced rooms, and with
the package `eulumdat-ugr`, where it is installed."""

import contextlib
import importlib.util
import io
import itertools
import json
import math
import unittest
from unittest import mock

from support import Case, context, luxfer, np

from luxfer.cli.program import main
from luxfer.design import glare_table, ugr_table
from luxfer.design.glare_table import REFLECTANCES, ROOMS, VIEWS, flux_transfer
from luxfer.design.openings import projected_area

ANGLES = range(0, 91, 5)
HAS_PEER = importlib.util.find_spec("eulumdat_ugr") is not None


def ies(size: str, *planes, angles=ANGLES) -> bytes:
    """An IES file with these intensities of gamma, in radians, in planes from C = 0 to 90. size has the lengths along
    C = 90, along C = 0 and along the axis."""
    rows = "\n".join(" ".join(f"{1000 * max(0.0, plane(math.radians(a))):.7f}" for a in angles) for plane in planes)
    turns = " ".join(f"{90 * i / max(len(planes) - 1, 1):g}" for i in range(len(planes)))
    return (
        f"IESNA:LM-63-2002\n[LUMINAIRE] Lamp\nTILT=NONE\n1 -1 1 {len(angles)} {len(planes)} 1 2 {size}\n1 1 30\n"
        f"{' '.join(map(str, angles))}\n{turns}\n{rows}\n"
    ).encode()


def load(data: bytes) -> luxfer.Distribution:
    return luxfer.Distribution.load_memory(context(), data, "ies")


def panel() -> luxfer.Distribution:
    """A diffuse panel of 0.6 x 0.6 m."""
    return load(ies("0.6 0.6 0", math.cos, angles=range(0, 91)))


def batten() -> luxfer.Distribution:
    """A batten of 1.2 m along C = 90 that is darker endwise."""
    return load(ies("1.2 0.3 0.05", math.cos, lambda g: math.cos(g) ** 1.5, lambda g: math.cos(g) ** 2))


class Table(Case):
    def test_a_cell_by_hand(self):
        # Two of the four luminaires of the room 2H x 2H are in view, with side 1/3, rise 2/3, r² = 3.5 H², and Guth's
        # index 3.784. For 1000 lm, a diffuse panel has 318.3 cd straight down.
        first = (35.2 - 0.31889 * 26.5651 - 1.22 * math.exp(-2 * 26.5651 / 9)) * 1e-3 * 36.6992
        second = (21 + 0.26667 * 26.5651 - 0.002963 * 26.5651**2) * 1e-5 * 36.6992**2
        self.assertAlmostEqual(math.exp(first + second), 3.784, places=3)
        glare = 2 * 318.31**2 / math.sqrt(3.5) / (0.36 * 3.5) / 3.784**2

        def corner(a, b):  # share of a diffuse point's flux on a rectangle below, one of whose corners is below the point
            u, v = math.hypot(1, a), math.hypot(1, b)
            return (a / u * math.atan(b / u) + b / v * math.atan(a / v)) / (2 * math.pi)

        floor = sum(corner(a, b) for a in (0.5, 1.5) for b in (0.5, 1.5))
        # CIE 190 lists the transfer factors of this room, for the reflectances 70/50/20, as 0.220 and 0.422.
        walls = 4 * 1000 / 8 * (0.220 * floor + 0.422 * (1 - floor))
        expected = 8 * math.log10(0.25 / (walls / math.pi) * glare)
        table = ugr_table(panel(), spacing=1)
        self.assertAlmostEqual(table.uncorrected[0, 0, 0], expected, delta=0.02)
        self.assertAlmostEqual(table.value((2, 2)), expected + 8 * math.log10(math.pi), delta=0.02)
        self.assertEqual(table.uncorrected.shape, (len(ROOMS), len(REFLECTANCES), len(VIEWS)))
        np.testing.assert_allclose(table.uncorrected[..., 0], table.uncorrected[..., 1], atol=1e-9)

    def test_transfer_factors_are_those_of_cie_190(self):
        known = {
            ((2, 2), (0.7, 0.5, 0.2)): (0.220, 0.422, 0.646),
            ((2, 12), (0.5, 0.3, 0.2)): (0.128, 0.140, 0.276),
            ((4, 8), (0.7, 0.3, 0.2)): (0.106, 0.117, 0.283),
            ((8, 8), (0.5, 0.5, 0.2)): (0.071, 0.137, 0.147),
            ((12, 8), (0.3, 0.3, 0.2)): (0.049, 0.059, 0.069),
        }
        for (room, reflectances), (floor, walls, ceiling) in known.items():
            found = flux_transfer(room, reflectances)[1] - [0, 1, 0]
            np.testing.assert_allclose(found, (ceiling, walls, floor), atol=1e-3, err_msg=f"{room} {reflectances}")

    def test_all_rooms_by_loops(self):
        """Direct glare from the angles between vectors, for luminaires of both views; light in bounces."""
        lamp, spacing = batten(), 1.0
        table = ugr_table(lamp, spacing=spacing)
        flux = lamp.report.flux
        floors = {room: self.floor_share(lamp, room, spacing) for room in ((2, 2), (2, 3), (4, 4), (8, 6))}
        for index, room in enumerate(ROOMS):
            sums = [self.glare_sum(lamp, room, spacing, view) for view in VIEWS]
            for row, reflectances in enumerate(REFLECTANCES):
                floor = floors.get(room)
                if floor is None:
                    break
                walls = self.indirect_walls(room, reflectances, flux * floor, flux * (1 - floor))
                count = room[0] * room[1] / spacing**2
                for view, total in enumerate(sums):
                    expected = 8 * math.log10(0.25 * total / (count * walls / math.pi))
                    self.assertAlmostEqual(table.corrected[index, row, view], expected, delta=0.01)
            # Between the views only the direct part differs.
            difference = table.uncorrected[index, :, 1] - table.uncorrected[index, :, 0]
            np.testing.assert_allclose(difference, 8 * math.log10(sums[1] / sums[0]), atol=1e-6)

    def glare_sum(self, lamp, room, spacing, view):
        total = 0.0
        for i, j in itertools.product(range(round(room[0] / spacing)), range(round(room[1] / spacing))):
            x, z = (i + 0.5) * spacing - room[0] / 2, (j + 0.5) * spacing
            to_eye = np.array([-x, -1, -z]) / math.sqrt(x * x + 1 + z * z)
            if abs(x) > 3 * z or z < 1 / 1.9 or to_eye[1] > -math.cos(math.radians(85)):
                continue
            c0, c90 = ((0, 0, -1), (-1, 0, 0)) if view == "crosswise" else ((1, 0, 0), (0, 0, -1))
            u, v = float(to_eye @ c0), float(to_eye @ c90)
            candela = lamp.intensity(math.degrees(math.atan2(v, u)) % 360, math.degrees(math.acos(-to_eye[1])))
            area = 0.3 * 1.2 * -to_eye[1] + 0.05 * (1.2 * abs(u) + 0.3 * abs(v))
            sigma = math.degrees(math.acos(-to_eye[2]))
            tau = math.degrees(math.acos(-to_eye[1] / math.hypot(to_eye[0], to_eye[1])))
            p = math.exp(
                (35.2 - 0.31889 * tau - 1.22 * math.exp(-2 * tau / 9)) * 1e-3 * sigma
                + (21 + 0.26667 * tau - 0.002963 * tau * tau) * 1e-5 * sigma * sigma
            )
            omega = area / (x * x + 1 + z * z)
            total += (candela / area) ** 2 * omega / p**2
        return total

    def floor_share(self, lamp, room, spacing, cells=20):
        """By the illuminance of cells of the floor, for the mean intensity over C."""
        gammas = np.arange(0, 90.1, 0.5)
        means = np.array([np.mean([lamp.intensity(c, g) for c in range(0, 360, 5)]) for g in gammas])
        step = 1 / cells
        x, z = np.meshgrid(*((np.arange(side * cells) + 0.5) * step for side in room), indexing="ij")
        total, count = 0.0, 0
        for i, j in itertools.product(range(round(room[0] / spacing)), range(round(room[1] / spacing))):
            square = (x - (i + 0.5) * spacing) ** 2 + (z - (j + 0.5) * spacing) ** 2 + 1
            angle = np.degrees(np.arccos(1 / np.sqrt(square)))
            total += float((np.interp(angle, gammas, means) / square**1.5).sum()) * step * step
            count += 1
        return total / count / lamp.report.flux

    def indirect_walls(self, room, reflectances, floor, walls):
        """The mean indirect illuminance of the walls, summed over bounces; the form factor by integration."""
        n = 30
        x = (np.arange(n) + 0.5) / n
        offsets = [side * (x[:, None] - x).ravel() for side in room]
        square = offsets[0][:, None] ** 2 + offsets[1] ** 2 + 1
        across = room[0] * room[1] * float((1 / square**2).mean()) / math.pi
        plane, side = room[0] * room[1], 2 * (room[0] + room[1])
        to_plane = (1 - across) * plane / side
        light, total = [0.0, walls, floor], 0.0
        for _ in range(100):
            ceiling, wall, ground = (r * v for r, v in zip(reflectances, light))
            light = [
                ground * across + wall * to_plane,
                (ceiling + ground) * (1 - across) + wall * (1 - 2 * to_plane),
                ceiling * across + wall * to_plane,
            ]
            total += light[1]
        return total / side

    def test_the_length_decides_what_is_crosswise(self):
        narrow, wide = math.cos, lambda g: math.cos(g) ** 2
        along_90 = ugr_table(load(ies("1.2 0.3 0", narrow, wide)))
        along_0 = ugr_table(load(ies("0.3 1.2 0", wide, narrow)))
        self.assertEqual((along_90.length_along, along_0.length_along), (90, 0))
        np.testing.assert_allclose(along_90.uncorrected, along_0.uncorrected, atol=1e-9)
        self.assertGreater(along_90.value((4, 8)), along_90.value((4, 8), view="endwise") + 1)

    def test_openings_have_the_area_of_the_library(self):
        for size in ("0.6 1.2 0", "0.6 1.2 0.1", "-0.4 -0.4 0", "-0.4 -0.4 0.2", "-0.4 0 0", "-0.3 -0.3 -0.3", "0 1.2 -0.04"):
            lamp = load(ies(size, lambda g: 1, angles=range(0, 181, 5)))
            scene = luxfer.Scene(context())
            scene.add_luminaire(lamp, position=(0, 0, 0))
            for c, gamma in ((0, 0), (0, 60), (90, 60), (30, 40), (200, 85)):
                turn, tilt = math.radians(c), math.radians(gamma)
                # C grows anticlockwise as seen from above: from x towards -z.
                away = np.array([math.sin(tilt) * math.cos(turn), -math.cos(tilt), -math.sin(tilt) * math.sin(turn)])
                eye = 200 * away
                ahead = -eye if abs(away[1]) < 0.99 else (1, -eye[1], 0)
                if gamma == 0:
                    continue  # lines of sight must not be vertical
                found = scene.glare([eye], [ahead], samples=16)[0]["solid_angle"] * 200**2
                self.assertAlmostEqual(found / float(projected_area(lamp.report.size, c, gamma)), 1, delta=2e-3, msg=f"{size} {c} {gamma}")

    def test_light_upwards_brightens_the_background(self):
        down = load(ies("0.6 0.6 0", math.cos, angles=range(0, 181, 5)))
        both = load(ies("0.6 0.6 0", lambda g: math.cos(g) if g <= math.pi / 2 else -0.5 * math.cos(g), angles=range(0, 181, 5)))
        less = ugr_table(both).corrected - ugr_table(down).corrected
        self.assertTrue(((less < -0.5) & (less > -6)).all(), less)

    def test_the_flux_of_the_real_array_lowers_small_rooms(self):
        narrow = load(ies("0.6 0.6 0", lambda g: math.cos(g) ** 10))
        change = ugr_table(narrow, floor_spacing=0.25).corrected - ugr_table(narrow).corrected
        self.assertTrue((change < 0).all() and (change > -0.4).all() and change.min() < -0.3, change)

    def test_all_formats_have_the_table(self):
        lamp = batten()
        for ending in ("ldt", "xml", "gldf"):
            lamp.save(self.folder / f"lamp.{ending}")
            other = luxfer.Distribution.load(context(), self.folder / f"lamp.{ending}")
            np.testing.assert_allclose(ugr_table(other).corrected, ugr_table(lamp).corrected, atol=1e-6)

    def test_no_luminaire_in_view_is_minus_infinity(self):
        spot = load(ies("-0.1 -0.1 0", lambda g: 1.0 if g < 0.2 else 0.0))
        table = ugr_table(spot)
        self.assertTrue(np.isneginf(table.uncorrected).all())
        self.assertTrue(table.lines()[3].endswith(" -"), table.lines()[3])

    def test_bad_input_is_named(self):
        cosine = ies("0.6 0.6 0", math.cos)
        upwards = ies("0.6 0.6 0", lambda g: max(0.0, -math.cos(g)) if g > 1.6 else 0.0, angles=range(0, 181, 5))
        for data, settings, message in (
            (ies("0 0 0", math.cos), {}, r"size of 'Lamp' is 0 x 0 x 0 m, an opening without area; .* give size="),
            (ies("0.6 0.6 0", lambda g: 0), {}, "the flux of 'Lamp' is 0 lm; a UGR table needs a flux above 0"),
            (upwards, {}, "the flux of 'Lamp' below the horizontal is 0 lm of [0-9]+ lm"),
            (cosine, {"spacing": 0.3}, "spacing is 0.3; it must be 1/n"),
            (cosine, {"spacing": 0}, "spacing is 0; it must be 1/n"),
            (cosine, {"spacing": float("nan")}, "spacing is nan; it must be 1/n"),
            (cosine, {"floor_spacing": 2}, "floor_spacing is 2; it must be 1/n"),
            (cosine, {"size": (1, 2)}, r"size is \(1, 2\); it must be three finite lengths"),
            (cosine, {"size": (0, 0, 0)}, "size of 'Lamp' is 0 x 0 x 0 m"),
        ):
            with self.assertRaisesRegex(ValueError, message):
                ugr_table(load(data), **settings)
        sized = ugr_table(load(ies("0 0 0", math.cos)), size=(0.6, 0.6, 0))
        np.testing.assert_allclose(sized.uncorrected, ugr_table(load(cosine)).uncorrected, atol=1e-9)
        for arguments, message in (
            (((3, 3),), r"room is \(3, 3\); it must be one of \(2, 2\)"),
            (((2, 2), (0.8, 0.5, 0.2)), r"reflectances is \(0.8, 0.5, 0.2\)"),
            (((2, 2), (0.7, 0.5, 0.2), "above"), "view is 'above'; it must be one of crosswise, endwise"),
        ):
            with self.assertRaisesRegex(ValueError, message):
                sized.value(*arguments)


class InRooms(Case):
    """The table's method assumes a floor at the height of the eyes, evenly bright surfaces, and the mean indirect light
    of the walls as the background. Rooms with that floor are path-traced."""

    HEIGHT = 2.0

    def room(self, size, reflectances, lamp, spacing, view):
        h = self.HEIGHT
        x, z = size[0] * h, size[1] * h
        scene = luxfer.Scene(context())
        ceiling, walls, floor = (scene.add_material(base_color=(r,) * 3, ior=1.0) for r in reflectances)
        for corner, u, v, material in (
            ((-x / 2, h, 0), (x, 0, 0), (0, 0, z), ceiling),
            ((-x / 2, 0, 0), (x, 0, 0), (0, 0, z), floor),
            ((-x / 2, 0, 0), (x, 0, 0), (0, h, 0), walls),
            ((-x / 2, 0, z), (x, 0, 0), (0, h, 0), walls),
            ((-x / 2, 0, 0), (0, 0, z), (0, h, 0), walls),
            ((x / 2, 0, 0), (0, 0, z), (0, h, 0), walls),
        ):
            a, u, v = np.array(corner, float), np.array(u), np.array(v)
            scene.add_mesh(np.array([a, a + u, a + u + v, a + v]), [[0, 1, 2], [0, 2, 3]], material=material)
        c0 = (0, 0, -1) if view == "crosswise" else (1, 0, 0)
        for i, j in itertools.product(range(round(size[0] / spacing)), range(round(size[1] / spacing))):
            place = ((i + 0.5) * spacing * h - x / 2, h, (j + 0.5) * spacing * h)
            scene.add_luminaire(lamp, position=place, c0=c0)
        return scene

    def walls(self, scene, size, samples):
        """The mean illuminance of the four walls."""
        h = self.HEIGHT
        x, z, gap = size[0] * h, size[1] * h, 1e-4
        total = 0.0
        for origin, across, normal in (
            ((-x / 2, h, gap), (x, 0, 0), (0, 0, 1)),
            ((-x / 2, h, z - gap), (x, 0, 0), (0, 0, -1)),
            ((-x / 2 + gap, h, 0), (0, 0, z), (1, 0, 0)),
            ((x / 2 - gap, h, 0), (0, 0, z), (-1, 0, 0)),
        ):
            grid = {"origin": origin, "across": across, "down": (0, -h, 0), "normal": normal}
            report = luxfer.Illuminance(context(), scene).run_grid(grid, columns=12, rows=6, samples=samples).report
            total += report.mean * math.hypot(*across)
        return total / (2 * (x + z))

    def test_path_traced_rooms(self):
        lamp, spacing = load(ies("0.6 0.2 0", math.cos, lambda g: math.cos(g) ** 2)), 1.0
        for size, reflectances in (((2, 2), (0.7, 0.5, 0.2)), ((4, 4), (0.3, 0.3, 0.2)), ((4, 8), (0.7, 0.3, 0.2))):
            place = (ROOMS.index(size), REFLECTANCES.index(reflectances))
            table = ugr_table(lamp, spacing=spacing)
            # The scene's rating counts luminaires at every angle.
            with mock.patch.multiple(glare_table, MAX_SIDE=np.inf, MAX_RISE=np.inf, MAX_GAMMA=90):
                all_round = ugr_table(lamp, spacing=spacing)
            for view, name in enumerate(VIEWS):
                scene = self.room(size, reflectances, lamp, spacing, name)
                seen = scene.glare([[0, 1e-3, 1e-3]], [[0, 0, 1]], samples=4096)[0]
                direct = 10 ** (seen["ugr"] / 8) * seen["background"] / 0.25
                dark = self.room(size, (0, 0, 0), lamp, spacing, name)
                walls = (self.walls(scene, size, 128) - self.walls(dark, size, 64)) / math.pi
                # The direct part alone: the scene's direct glare with the table's background.
                background = 0.25 * 10 ** (-all_round.corrected[(*place, view)] / 8) * direct
                ideal = all_round.corrected[(*place, view)] + 8 * math.log10(background / walls)
                self.assertAlmostEqual(ideal, 8 * math.log10(0.25 * direct / walls), places=6)
                # The three surfaces are not evenly bright: the walls get up to 7 % less than the method says.
                self.assertTrue(0.99 < background / walls < 1.07, f"{size} {name} {background} {walls}")
                # The eye at the wall sees less indirect light than the walls get on average, and more luminaires.
                self.assertTrue(0 < seen["ugr"] - table.corrected[(*place, view)] < 1.6)


@unittest.skipUnless(HAS_PEER, "eulumdat-ugr is not installed (pip install eulumdat-ugr)")
class BesideEulumdatUgr(Case):
    def test_tables_agree(self):
        """Guth's formula differs from the rounded table of CIE 117, which the package interpolates; with the table,
        only the direct flux of the floor differs, for which the package has four zones."""
        from eulumdat_ugr import UgrCalculator
        from eulumdat_ugr.guth import GuthTable
        from pyldt import LdtReader

        def tabulated(side, rise):
            found = GuthTable.p_vec(rise, side)
            return np.where(np.isnan(found), np.inf, found)

        flat = load(ies("1.2 0.3 0", math.cos, lambda g: math.cos(g) ** 1.5, lambda g: math.cos(g) ** 2))
        for lamp, planes in ((panel(), None), (batten(), None), (flat, None)):
            path = self.folder / "lamp.ldt"
            lamp.save(path)
            file = LdtReader.read(str(path))
            file.header.num_lamps = [1]  # it takes the -1 of absolute photometry as a negative flux
            theirs = UgrCalculator.compute(file).values
            ours = ugr_table(lamp).corrected.transpose(0, 2, 1).reshape(19, 10)
            np.testing.assert_allclose(ours, theirs, atol=0.25)
            with mock.patch.object(glare_table, "position_index", tabulated):
                ours = ugr_table(lamp).corrected.transpose(0, 2, 1).reshape(19, 10)
            np.testing.assert_allclose(ours, theirs, atol=0.1)


class CommandLine(Case):
    def run_it(self, *arguments):
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = main(list(arguments))
        return code, out.getvalue(), err.getvalue()

    def test_inspect_prints_the_table(self):
        path = self.folder / "lamp.ies"
        path.write_bytes(ies("0.6 0.6 0", math.cos))
        code, out, _ = self.run_it("inspect", "--ugr-table", str(path))
        self.assertEqual(code, 0)
        table = ugr_table(luxfer.Distribution.load(context(), path))
        for line in (*table.lines(), *table.lines(corrected=False)):
            self.assertIn(line, out)
        code, out, _ = self.run_it("inspect", str(path), "--ugr-table", "--spacing", "1", "--json")
        found = json.loads(out)["ugr_table"]
        self.assertEqual((found["spacing"], found["rooms_h"][7], found["reflectances"][4]), (1, [4, 3], [0.3, 0.3, 0.2]))
        np.testing.assert_allclose(found["crosswise"], ugr_table(luxfer.Distribution.load(context(), path), spacing=1).corrected[..., 0])

    def test_errors_are_of_one_line(self):
        path = self.folder / "point.ies"
        path.write_bytes(ies("0 0 0", math.cos))
        code, _, err = self.run_it("inspect", "--ugr-table", str(path))
        self.assertEqual((code, err.count("\n")), (3, 1), err)
        self.assertIn("an opening without area", err)
        code, _, err = self.run_it("inspect", "--ugr-table", str(path), "--spacing", "0.3")
        self.assertEqual((code, err.count("\n")), (2, 1), err)
        self.assertIn("'0.3' is not", err)
        code, _, err = self.run_it("inspect", "--ugr-table", "demo:target-room")
        self.assertEqual(code, 2)
        self.assertIn("--ugr-table", err)


if __name__ == "__main__":
    unittest.main()
