"""Tests daylight: the sun's position, skies as light of a scene, and weather files."""

import math
import unittest
from datetime import datetime, timedelta, timezone
from pathlib import Path

from support import Case, context, luxfer, np


def open_floor(owner=None):
    """A scene with a small floor under the open sky."""
    scene = luxfer.Scene(owner or context())
    scene.add_material(base_color=(0, 0, 0), metallic=0, ior=1)
    scene.add_mesh([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]], [[0, 1, 2], [0, 2, 3]])
    return scene


def lux(scene):
    stage = luxfer.Illuminance(scene.context, scene)
    grid = {"origin": (-0.1, 0.01, -0.1), "across": (0.2, 0, 0), "down": (0, 0, 0.2), "normal": (0, 1, 0)}
    return stage.run_grid(grid, columns=1, rows=1, samples=1 << 16).report


def rows(day=1):
    return [f"2026,1,{day},{hour},60,-,1,2,50,95000,0,0,0,100,{10 * hour},50,0,0,0,0" for hour in range(1, 25)]


def weather_text(*days):
    head = ["LOCATION,Here,-,-,-,-,48.1,11.6,1,500"] + [f"{i}," for i in range(2, 8)]
    return "\n".join([*head, f"DATA PERIODS,1,1,Data,Sunday,1/1,1/{days[-1]}", *(row for day in days for row in rows(day))])


class Daylight(Case):
    def test_the_sun_of_a_local_time(self):
        """The example of Reda and Andreas (2004), without refraction."""
        time = datetime(2003, 10, 17, 12, 30, 30, tzinfo=timezone(timedelta(hours=-7)))
        sun = luxfer.sun_position(context(), time, 39.742476, -105.1786)
        self.assertAlmostEqual(math.degrees(sun.altitude), 39.87205, delta=0.01)
        self.assertAlmostEqual(math.degrees(sun.azimuth), 194.34024, delta=0.01)
        with self.assertRaisesRegex(ValueError, "has no time zone"):
            luxfer.sun_position(context(), datetime(2026, 1, 1), 0, 0)
        with self.assertRaisesRegex(luxfer.Error, r"latitude is 91; it must lie in \[-90, 90\]"):
            luxfer.sun_position(context(), time, 91, 0)

    def test_sky_and_sun_light_a_floor_by_their_report(self):
        scene = open_floor()
        for settings in (
            {"cie_type": 1},
            {"cie_type": 12, "sun_altitude": 0.6, "direct_normal": 50_000, "diffuse_horizontal": 12_000},
            {"model": "perez", "unit": "watts", "sun_altitude": 0.4, "direct_normal": 700, "diffuse_horizontal": 90},
            {"model": "perez", "sun_altitude": -0.1, "direct_normal": 700, "diffuse_horizontal": 90},
        ):
            sky = scene.set_sky(**settings)
            found = lux(scene)
            level = sky.direct_normal * math.sin(max(0.0, settings.get("sun_altitude", 0.0)))
            expected = sky.diffuse_horizontal + level
            self.assertAlmostEqual(found.mean, expected, delta=4 * found.mean_error + 1e-3 * expected)
        # All skies together have added one sun, which now is dark.
        self.assertEqual((scene.counts.lights, sky.sun, sky.direct_normal), (1, 0, 0))

    def test_many_skies_need_the_memory_of_one(self):
        scene = open_floor(luxfer.Context(num_threads=1, memory_budget_mib=8))
        for hour in range(40):
            scene.set_sky(sun_azimuth=hour / 10)
        self.assertEqual(scene.counts.lights, 0)

    def test_wrong_settings_are_named(self):
        for settings, message in (
            ({"cie_type": 17}, r"cie_type is 17; it must lie in \[1, 15\]"),
            ({"diffuse_horizontal": math.nan}, "diffuse_horizontal is NaN"),
            ({"sun_altitude": 60}, "sun_altitude is 60; it must lie in"),
            ({"north": (0, 1, 0)}, "north is"),
            ({"rows": 33}, "rows is 33; it must be even"),
            ({"model": "perez", "zenith_luminance": 4}, "zenith_luminance is 4"),
        ):
            with self.assertRaisesRegex(luxfer.Error, message):
                open_floor().set_sky(**settings)

    def test_a_disc_has_an_angle(self):
        scene = open_floor()
        scene.add_light(kind="directional", direction=(0, -1, 0), intensity=(900,) * 3, angular_diameter=0.5)
        self.assertAlmostEqual(lux(scene).mean, 900, delta=1)
        with self.assertRaisesRegex(luxfer.Error, "angular_diameter is 2; it must lie in"):
            scene.add_light(kind="directional", angular_diameter=2)

    def test_a_weather_file_gives_skies(self):
        path = Path(self.folder, "here.epw")
        path.write_text(weather_text(1, 2))
        weather = luxfer.Weather.read(context(), path)
        self.assertEqual((weather.place.latitude, weather.place.time_zone, len(weather.hours)), (48.1, 1.0, 48))
        noon = weather.hours[24 + 11]
        self.assertEqual((noon["day"], noon["hour"], noon["direct_normal"], noon["dew_point"]), (2, 10.5, 120, 2))
        sky = open_floor().set_sky(**weather.sky(context(), 24 + 11))
        self.assertGreater(sky.direct_normal, 5000)
        self.assertTrue(np.isnan(weather.hours["direct_normal_illuminance"]).sum() == 0)

    def test_wrong_weather_files_are_refused(self):
        path = Path(self.folder, "cut.epw")
        for text, message in (
            (weather_text(1)[:-40], "line 32: the row has"),
            (weather_text(1).replace(",120,50,", ",7000,50,"), "line 20: the direct normal irradiance is 7000"),
            (weather_text(1, 3).replace("1/3", "12/31"), "line 56: the file ends here, before hour 24 of 12/31"),
        ):
            path.write_text(text)
            with self.assertRaisesRegex(luxfer.Error, message):
                luxfer.Weather.read(context(), path)
        with self.assertRaises(luxfer.Error):
            luxfer.Weather.read(context(), Path(self.folder, "absent.epw"))


if __name__ == "__main__":
    unittest.main()
