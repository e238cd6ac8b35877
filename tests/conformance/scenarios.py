"""Short programs that use the library correctly. Together they call every function of the header."""

from __future__ import annotations

import math
from pathlib import Path

from script import SETTINGS, Argument, Call, Script, array, handles, report, struct, view

ROOM = ["room", 0x5A]


def write_files(folder: str | Path) -> None:
    """Writes the files that the programs read: a weather file of one day."""
    head = ["LOCATION,Here,-,-,-,-,48,11,1,500"] + [f"{i}," for i in range(2, 8)] + ["DATA PERIODS,1,1,Data,Sunday,1/1,1/1"]
    rows = [f"2026,1,1,{hour},60,-,1,2,50,95000,0,0,0,100,200,50,0,0,0,0" for hour in range(1, 25)]
    Path(folder, "day.epw").write_text("\n".join(head + rows))


class Scenario(Script):
    """A program that begins by creating a context; its methods add calls to the program."""

    def __init__(self) -> None:
        super().__init__()
        self.context = self.make("context_create", struct("context_params", num_threads=2))

    def image(self, width: int = 12, height: int = 8, channels: int = 3, fill: float = 0.5) -> Argument:
        return self.make("image_create", self.context, view(width, height, channels, fill))

    def room(self) -> Argument:
        """Adds a scene with a floor, a ceiling that emits light, and a camera."""
        scene = self.make("scene_create", self.context)
        self.call("scene_add_material", scene, struct("material_params", name="Paint", base_color=array("float", 0.5, 0.4, 0.3)), ROOM)
        self.call("scene_add_material", scene, struct("material_params", name="Lamp", emission=array("float", 50, 40, 30)), None)
        for material, name, y, order in ((0, "Floor", 0.0, (0, 2, 1, 0, 3, 2)), (1, "Ceiling", 2.0, (0, 1, 2, 0, 2, 3))):
            corners = [c for x, z in ((-1, -1), (1, -1), (1, 1), (-1, 1)) for c in (x, y, z)]
            mesh = struct(
                "mesh_params", material=material, name=name, vertex_count=4, positions=array("float", *corners),
                uvs=array("float", 0, 0, 1, 0, 1, 1, 0, 1), triangle_count=2, indices=array("uint32_t", *order),
            )  # fmt: skip
            self.call("scene_add_mesh", scene, mesh, ROOM)
        self.call("scene_add_camera", scene, camera(), ROOM)
        return scene

    def photograph(self) -> tuple[Argument, Argument]:
        """Adds a photo of the generated office and an image with strokes for it."""
        stage = self.make("demo_photo_create", self.context)
        self.references(stage)
        self.run("demo_photo_start", stage, struct("demo_photo_params", width=180, height=120, samples=2))
        return self.make("demo_photo_get_image", stage, 0), self.make("demo_photo_get_image", stage, 1)

    def painted(self, drawing: Argument) -> Argument:
        """Adds the strokes of such an image."""
        strokes = self.make("strokes_create", self.context, 180, 120)
        self.call("strokes_add_image", strokes, drawing)
        return strokes

    def references(self, thing: Argument) -> None:
        self.call("retain", thing)
        self.call("release", thing)


def camera() -> Argument:
    return struct("camera_params", position=array("float", 0, 1, 4), target=array("float", 0, 1, 0))


def library() -> Scenario:
    s = Scenario()
    s.call("get_version")
    s.call("get_version_string")
    s.call("status_get_name", 3)
    s.call("context_get_last_error", s.context, ROOM, 100, ROOM)
    for number, name in enumerate(SETTINGS):
        s.call("init", number, struct(name.removeprefix("luxfer_"), "raw"), 200)
    s.references(s.context)
    return s


def images() -> Scenario:
    s = Scenario()
    image = s.image()
    s.references(image)
    s.call("image_get_size", image, ROOM, ROOM, ROOM)
    s.call("image_get_metadata", image, *report("photo_metadata"))
    s.call("image_read", image, 0, view(12, 8))
    s.call("image_save", image, "a.png", 1.0)
    s.call("image_save", image, "a.exr", 1.0)
    s.make("image_load", s.context, "a.png", 1)
    s.make("image_load", s.context, "a.exr", 0)
    s.make("image_load_memory", s.context, b"\x89PNG\r\n\x1a\n" + bytes(32), 40, 1)
    s.call("homography_from_corners", s.context, array("double", 0, 0, 1, 0, 1, 1, 0, 1), array("double", 0, 0, 9, 1, 8, 7, 1, 6), ROOM)
    place, _ = s.new()
    settings = struct("merge_params", exposures=array("double", 1, 2, *[0] * 14))
    s.call("image_merge_exposures", s.context, handles(image, s.image()), 2, settings, place, *report("merge_report"))
    s.make("image_warp", image, array("double", 1, 0, 0, 0, 1, 0, 0, 0, 1), 7, 5)
    return s


def scenes() -> Scenario:
    s = Scenario()
    scene, image = s.room(), s.image()
    s.references(scene)
    s.call("scene_export", scene, "a.glb")
    s.make("scene_load", s.context, "a.glb", None)
    s.make("scene_load_memory", s.context, b'{"asset":{"version":"2.0"}}', 27, None, None)
    scaled = s.make("scene_load", s.context, "a.glb", struct("scene_load_params", unit=100.0))
    warnings = s.make("get_warnings", scaled)  # it warns: 200 m is too high for a room
    s.call("warnings_get", warnings, 0, *report("warning"))
    candidates = s.make("scene_get_candidates", scaled)
    s.references(candidates)
    s.call("candidates_get_count", candidates, ROOM)
    s.call("candidates_get", candidates, 0, *report("candidate"))
    s.make("scene_load_memory", s.context, b'{"asset":{"version":"2.0"}}', 27, None, struct("scene_load_params", allow_external_files=1))
    s.call("scene_export_memory", scene, ["callback", "write"], None)
    s.call("scene_get_counts", scene, *report("scene_counts"))
    s.call("scene_get_origin", scene, ROOM, ROOM, ROOM)
    s.call("scene_set_environment", scene, None, array("float", 0.1, 0.2, 0.3))
    s.call("scene_set_environment", scene, image, array("float", 1, 1, 1))
    s.call("scene_find_surface", scene, "Ceiling", *report("surface"))
    s.call("scene_set_material", scene, 0, struct("material_params", roughness=0.5))
    s.call("scene_get_material", scene, 0, *report("material_params"))
    s.call("scene_add_texture", scene, image, 0, 1, ROOM)
    s.call("scene_set_material_texture", scene, 0, 0, 0, 0, array("float", 1, 0, 0, 0, 1, 0))
    s.call("scene_get_material_texture", scene, 0, 0, *report("texture_use"))
    s.make("scene_get_texture", scene, 0)
    s.call("scene_set_camera", scene, 0, camera())
    s.call("scene_get_camera", scene, 0, *report("camera_params"))
    s.call("scene_add_light", scene, struct("light_params", position=array("float", 0, 1, 0)), ROOM)
    rays = array("float", 0, 1, 0, 0, -1, 0, 9, 0, 1, 0, 0, 0, 0, 9)
    s.call("scene_intersect", scene, rays, 2, 0, ROOM, 0)
    s.call("scene_get_requirements", scene, 0.01, *report("requirements"))
    s.call("scene_get_requirements_text", scene, ROOM, 300, ROOM)
    s.call("scene_get_mesh", scene, 0, *report("mesh_info"))
    s.call("scene_get_mesh_name", scene, 0, ROOM, 20, ROOM)
    s.call("scene_read_vertices", scene, 0, 0, ROOM, 4)
    s.call("scene_read_triangles", scene, 0, ROOM, 2)
    coloured = struct(
        "mesh_params", name="Coloured", vertex_count=3, positions=array("float", 0, 0, 0, 1, 0, 0, 0, 1, 0), triangle_count=1,
        indices=array("uint32_t", 0, 1, 2), colours=array("float", *[0.5] * 12),
    )  # fmt: skip
    s.call("scene_add_mesh", scene, coloured, None)
    s.call("scene_read_vertices", scene, 2, 4, ROOM, 3)
    s.call("scene_place_emission", scene, "Ceiling", image, array("float", 9, 9, 9), ROOM, ROOM)
    s.make("demo_create_scene", s.context, 2)
    return s


def jobs() -> Scenario:
    s = Scenario()
    render = s.make("render_create", s.context)
    s.call("render_set_scene", render, s.room())
    for work in ("work", "fail"):
        job = s.make("job_start", s.context, ["callback", work], None)
        s.call("job_wait", job, 5000, ["callback", "go"], None, ROOM)
        s.finish(job)
    for progress in ("go", "cancel", "later", "again"):
        job = s.make("render_start", render, struct("render_params", width=64, height=48, samples=4 if progress == "go" else 100_000))
        s.call("job_get_progress", job, ROOM)
        s.call("job_wait", job, 5000 if progress == "go" else 30, ["callback", progress], None, ROOM)
        s.references(job)
        s.call("job_cancel", job)
        s.finish(job)
    return s


def photo() -> Scenario:
    """The stages that read a photo: rectification, features and segmentation."""
    s = Scenario()
    photo, strokes = s.photograph()
    even = s.image(180, 120, 1, 1.0)
    rectify = s.make("rectify_create", s.context)
    s.references(rectify)
    s.call("rectify_set_photo", rectify, photo)
    s.call("rectify_set_mask", rectify, even)
    s.run("rectify_start", rectify, struct("rectify_params"))
    s.make("rectify_get_image", rectify, 0)
    s.make("rectify_undistort", rectify, photo)
    s.call("rectify_get_report", rectify, *report("rectify_report"))
    s.make("get_warnings", rectify)
    features = s.make("features_create", s.context)
    s.references(features)
    s.call("features_set_photo", features, photo)
    s.call("features_set_depth", features, even, 0)
    s.call("features_set_network", features, None, 0)
    s.call("features_set_view", features, rectify)
    painted = s.painted(strokes)
    s.call("features_set_strokes", features, painted)
    s.run("features_start", features, struct("features_params"))
    channels = s.make("features_get_image", features, 0)
    s.call("features_get_report", features, *report("features_report"))
    s.make("get_warnings", features)
    segment = s.make("segment_create", s.context)
    s.references(segment)
    s.call("segment_set_features", segment, channels)
    s.call("segment_set_region", segment, even)
    s.call("strokes_add_text", painted, "plane 2 5 5 9 9\n")
    s.call("strokes_add", painted, 0, array("float", 2, 2, 9, 20), 2, 2.0, 1)
    s.call("strokes_add", painted, 0, array("float", 40, 2, 42, 20), 2, 2.0, 0)
    s.call("segment_set_strokes", segment, 0, painted)
    s.run("segment_start", segment, struct("segment_params"))
    s.make("segment_get_image", segment, 0)
    s.call("segment_get_report", segment, *report("segment_report"))
    s.make("get_warnings", segment)
    return s


def emission() -> Scenario:
    s = Scenario()
    unwarped, light, valid = s.image(40, 30), s.image(40, 30, 1, 1.0), s.image(40, 30, 1, 1.0)
    stage = s.make("emission_create", s.context)
    s.references(stage)
    s.call("emission_set_exemplar", stage, unwarped, light, valid)
    s.call("emission_set_photo", stage, unwarped, array("double", 1, 0, 0, 0, 1, 0, 0, 0, 1))
    s.run("emission_start", stage, struct("emission_params", width=48, height=40))
    s.make("emission_get_image", stage, 0)
    s.call("emission_get_report", stage, *report("emission_report"))
    warnings = s.make("get_warnings", stage)  # it warns that there are no whole lamps
    s.references(warnings)
    s.call("warnings_get_count", warnings, ROOM)
    s.call("warnings_get", warnings, 0, *report("warning"))
    s.call("warning_get_name", 6)
    s.call("emission_get_luminaire", stage, 0, *report("luminaire"))
    s.call("emission_get_corner", stage, 0, 0, ROOM, ROOM)
    s.call("emission_clear_styles", stage)
    s.call("emission_add_style", stage, unwarped, light, valid, unwarped, array("double", 1, 0, 0, 0, 1, 0, 0, 0, 1), 1.0, s.image(2, 2, 1, 0.5))
    s.run("emission_start_composition", stage, struct("emission_params", width=48, height=40))
    s.make("emission_render_tile", stage, 16, 8, 20, 30)
    return s


def rendering() -> Scenario:
    s = Scenario()
    scene, stage = s.room(), s.make("render_create", s.context)
    s.references(stage)
    s.call("render_set_scene", stage, scene)
    s.call("render_set_camera", stage, camera())
    s.call("render_set_camera", stage, None)
    s.call("render_clear_expressions", stage)
    s.call("render_add_expression", stage, "direct", "LDE")
    s.call("render_add_expression", stage, "all", "C.*<L.>")
    s.call("render_set_emitter_as", stage, 0)
    s.call("render_set_aovs", stage, 0x7F)
    s.run("render_start", stage, struct("render_params", width=16, height=12, samples=8, preview=1.0))
    s.make("render_get_image", stage, 0)
    s.call("render_get_report", stage, *report("render_report"))
    s.call("render_get_requirements_text", stage, ROOM, 300, ROOM)
    s.call("render_get_layer_count", stage, ROOM)
    s.call("render_get_layer_name", stage, 0, ROOM, 50, ROOM)
    s.make("render_get_layer", stage, "direct")
    s.call("render_write_exr", stage, "layers.exr")
    small = struct("render_params", width=16, height=12, samples=8)
    s.call("render_split", stage, small, 2, 1, 2, 3, *report("render_part"))
    for n, first in enumerate((0, 4)):
        s.run("render_start_part", stage, small, struct("render_part", first_sample=first, samples=4), f"part{n}.exr")
        s.call("render_add_part", stage, f"part{n}.exr")
    s.run("render_start_merge", stage, small)
    s.call("render_clear_parts", stage)
    return s


def light() -> Scenario:
    """Illuminance on grids and meshes, and relighting: the emission that meets a target."""
    s = Scenario()
    scene, stage = s.room(), s.make("illuminance_create", s.context)
    s.references(stage)
    s.call("illuminance_set_scene", stage, scene)
    grid = struct("illuminance_grid", origin=array("float", -1, 1, -1), across=array("float", 2, 0, 0), down=array("float", 0, 0, 2))
    small = struct("illuminance_params", columns=5, rows=4, samples=16)
    s.run("illuminance_start_grid", stage, grid, small)
    s.run("illuminance_start_mesh", stage, 0, 0, small)
    s.make("illuminance_get_image", stage, 0)
    s.call("illuminance_get_report", stage, *report("illuminance_report"))
    relight = s.make("relight_create", s.context)
    s.references(relight)
    s.call("relight_set_scene", relight, scene, 1, 0)
    s.call("relight_set_target", relight, array("float", 1, 1, 1))
    s.call("relight_set_constraint", relight, array("int32_t", 1, 0, 2))
    s.run("relight_start", relight, struct("relight_params", paths=2048))
    s.call("relight_get_report", relight, *report("relight_report"))
    s.make("get_warnings", relight)
    return s


def lamps() -> Scenario:
    """Powers of lamps that meet goals, and the importance of a surface for a goal."""
    s = Scenario()
    scene, stage = s.room(), s.make("lamps_create", s.context)
    s.references(stage)
    s.call("lamps_set_scene", stage, scene, 1)
    s.call("lamps_add_grid", stage, struct("illuminance_grid", across=array("float", 1, 0, 0), down=array("float", 0, 0, 1)), 500.0, 1.0)
    s.call("lamps_clear_goals", stage)
    s.call("lamps_add_mesh", stage, 0, 0, array("float", 2, 2, 2), 1.0)
    s.call("lamps_set_constraint", stage, 0, array("int32_t", 1, 2, 0))
    s.call("lamps_set_levels", stage, array("double", 0, 0.5, 1), 3)
    s.run("lamps_start", stage, struct("lamps_params", paths=2048))
    s.call("lamps_get_report", stage, *report("lamps_report"))
    s.call("lamps_get_lamp", stage, 0, *report("lamp"))
    s.call("lamps_get_goal", stage, 0, *report("lamps_goal"))
    s.call("lamps_get_response", stage, 0, 0, *report("lamps_response"))
    s.call("lamps_get_reason", stage, ROOM, 300, ROOM)
    s.make("lamps_get_texture", stage)
    importance = s.make("importance_create", s.context)
    s.references(importance)
    s.call("importance_set_scene", importance, scene, 1, 0)
    s.run("importance_start", importance, struct("importance_params", width=6, height=4, paths=2048))
    s.make("importance_get_image", importance)
    texture, placement = s.image(), array("double", 1, 0, 0, 0, 1, 0, 0, 0, 1)
    s.call("importance_respond", importance, texture, placement, *report("importance_report"))
    s.run("importance_start_placement", importance, texture, struct("placement_params", starts=4))
    s.call("importance_get_placement", importance, *report("placement"))
    s.call("importance_solve", importance, texture, placement, array("float", 1, 1, 1), *report("relight_report"))
    return s


def photometry() -> Scenario:
    s = Scenario()
    s.call("colour_to_temperature", s.context, array("double", 1, 0.9, 0.7), ROOM, ROOM)
    s.call("temperature_to_colour", s.context, 3000.0, 0.0, ROOM)
    s.call("image_get_glare", s.image(32, 24), 1.0, 0.0, *report("glare_report"))
    s.call("image_rate_glare", s.image(32, 24), struct("glare_params", projection=1, fov_y=3.0), *report("glare_report"))
    s.call("scene_get_glare", s.make("scene_create", s.context), array("float", 0, 0, 0, 0, 0, 1), 1, 0, 16, 1, ROOM, 0)
    s.make("image_false_colour", s.image(32, 24), struct("false_colour_params", maximum=2.0))
    led, white = array("double", 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0.8), array("double", 0.5, 0.4, 0.3)
    s.call("mix_primaries", s.context, led, 4, 1.0, white, ROOM, *report("mixture"))
    s.call("fit_temperature", s.context, white, white, array("double", 9, 8, 7), *report("temperature_fit"))
    s.call("preset_get_count", s.context, ROOM)
    s.call("preset_get", s.context, 0, *report("preset"))
    file = b"IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 3 1 1 2 0.5 0.5 0\n1 1 50\n0 45 90\n0\n100 80 0\n"
    s.call("sun_get_position", s.context, struct("sun_params", year=2026, month=6, day=21, latitude=48.0), *report("sun_position"))
    s.call("scene_set_sky", s.make("scene_create", s.context), struct("sky_params", cie_type=12, rows=16), *report("sky_report"))
    s.call("weather_read", s.context, "day.epw", 0, 24, ROOM, 0, *report("weather_report"))
    lamp = s.make("distribution_load_memory", s.context, file, len(file), 0)
    s.references(lamp)
    s.call("distribution_save", lamp, "a.ldt")
    s.make("distribution_load", s.context, "a.ldt")
    s.call("distribution_save", lamp, "a.gldf")
    s.make("distribution_load", s.context, "a.gldf#0")
    s.call("distribution_get_report", lamp, *report("distribution_report"))
    s.call("distribution_get_name", lamp, ROOM, 50, ROOM)
    s.call("distribution_get_intensity", lamp, 0.0, 30.0, ROOM)
    bodies, settings = array("uint32_t", 1), struct("gonio_params", planes=2, angles=3, samples=16)
    place, measured = s.new()
    s.call("scene_get_distribution", s.room(), bodies, 1, settings, place, *report("gonio_report"))
    s.call("distribution_get_report", measured, *report("distribution_report"))
    s.call("scene_add_luminaire", s.room(), lamp, struct("luminaire_params", flux=900.0), ROOM)
    s.call("scene_add_luminaire", s.room(), lamp, struct("luminaire_params", shape=1), ROOM)
    return s


def transfer() -> Scenario:
    s = Scenario()
    scene, (photo, strokes) = s.room(), s.photograph()
    stage = s.make("transfer_create", s.context)
    s.references(stage)
    s.call("transfer_set_photo", stage, photo)
    s.call("transfer_set_depth", stage, s.image(180, 120, 1, 1.0), 0)
    s.call("transfer_set_scene", stage, scene, "Ceiling")
    s.call("transfer_set_camera", stage, camera())
    painted = s.painted(strokes)
    s.references(painted)
    s.call("transfer_set_strokes", stage, painted)
    s.call("transfer_set_strokes", stage, None)
    s.call("transfer_set_strokes", stage, painted)
    s.call("transfer_set_zones", stage, array("double", 0, 0, 0.01, 0.01), 1)
    s.call("transfer_set_triangles", stage, array("uint32_t", 1, 0, 1, 1), 2)
    settings = struct(
        "transfer_params", max_texels=64, target=1, pattern=struct("pattern_params", scale=3),
        render=struct("render_params", width=16, height=12, samples=4), relight=struct("relight_params", paths=2048),
    )  # fmt: skip
    s.run("transfer_start", stage, 0, 7, settings)
    s.make("transfer_get_image", stage, 7)
    s.make("transfer_get_scene", stage, 0)
    s.call("transfer_get_report", stage, *report("transfer_report"))
    s.make("get_warnings", stage)
    s.call("transfer_get_view", stage, *report("rectify_report"))
    s.call("transfer_get_solution", stage, *report("relight_report"))
    s.call("transfer_get_fixture", stage, 0, *report("fixture"))
    s.call("transfer_save_fixtures", stage, "lamps.csv")
    # Replace intermediate results of the transfer by those of single stages.
    rectify = s.make("rectify_create", s.context)
    s.call("rectify_set_photo", rectify, photo)
    s.run("rectify_start", rectify, struct("rectify_params"))
    s.call("transfer_use_rectify", stage, rectify)
    features = s.make("features_create", s.context)
    s.call("features_set_photo", features, photo)
    s.run("features_start", features, struct("features_params"))
    s.call("transfer_use_features", stage, features)
    segment = s.make("segment_create", s.context)
    s.call("segment_set_features", segment, s.make("features_get_image", features, 0))
    s.call("segment_set_strokes", segment, 0, s.painted(strokes))
    s.run("segment_start", segment, struct("segment_params"))
    s.call("transfer_use_segment", stage, 0, segment)
    s.call("transfer_use_mask", stage, 1, s.make("transfer_get_image", stage, 1))
    s.call("transfer_set_texture", stage, s.image(16, 16))
    s.run("transfer_start", stage, 6, 7, settings)
    # Two planes of the photo in one job.
    second = s.make("transfer_create", s.context)
    s.call("transfer_set_photo", second, photo)
    s.call("transfer_set_scene", second, scene, "Floor")
    s.call("transfer_set_strokes", second, painted)
    s.call("transfer_set_texture", second, s.image(16, 16))
    s.run("transfer_start_all", s.context, handles(stage, second), 2, 0, 5, None)
    return s


def planning() -> Scenario:
    s = Scenario()
    scene, (photo, strokes) = s.room(), s.photograph()
    stage = s.make("plan_create", s.context)
    s.references(stage)
    render = s.make("render_create", s.context)
    s.call("render_set_scene", render, scene)
    small = struct("render_params", width=16, height=12)
    s.run("plan_start_render", stage, render, small, struct("plan_params", target_error=0.5))
    s.call("plan_get_render_params", stage, *report("render_params"))
    transfer = s.make("transfer_create", s.context)
    s.call("transfer_set_photo", transfer, photo)
    s.call("transfer_set_scene", transfer, scene, "Ceiling")
    s.call("transfer_set_strokes", transfer, s.painted(strokes))
    settings = struct("transfer_params", max_texels=64, target=1, pattern=struct("pattern_params", scale=3), render=small)
    s.run("transfer_start", transfer, 0, 5, settings)
    s.run("plan_start_transfer", stage, transfer, settings, struct("plan_params", time_budget_ms=50))
    s.call("plan_get_report", stage, *report("plan_report"))
    s.call("plan_get_relight_params", stage, *report("relight_params"))
    stylize = s.make("stylize_create", s.context)
    s.call("stylize_set_artwork", stylize, s.image(24, 20))
    s.call("stylize_add_guide", stylize, "light", s.image(24, 20), s.image(24, 20), 1.0, 0)
    s.run("plan_start_stylize", stage, stylize, struct("stylize_params"), struct("plan_params", target_error=0.5))
    s.call("plan_get_stylize_params", stage, *report("stylize_params"))
    return s


def stylisation() -> Scenario:
    s = Scenario()
    guides = []
    for which in (2, 3):
        stage = s.make("guides_create", s.context)
        s.call("guides_set_scene", stage, s.make("demo_create_scene", s.context, which))
        s.run("guides_start", stage, struct("guides_params", width=24, height=16, samples=2))
        guides.append(stage)
    s.references(guides[0])
    s.make("guides_get_image", guides[0], 0)
    s.make("guides_get_motion", guides[1], guides[1])
    s.make("get_warnings", guides[1])
    artwork = s.make("demo_create_artwork", guides[0], 0)
    stage = s.make("stylize_create", s.context)
    s.references(stage)
    s.call("stylize_set_artwork", stage, artwork)
    s.call("stylize_add_guide", stage, "own", s.image(24, 16), s.image(24, 16), 1.0, 0)
    s.call("stylize_clear_guides", stage)
    s.call("stylize_add_guides", stage, *guides, 0, 1.0)
    s.call("stylize_set_source_mask", stage, s.image(24, 16, 1, 2.0))
    s.call("stylize_set_target_mask", stage, s.image(24, 16, 1, 2.0), None)
    s.call("stylize_get_preset", 0, struct("stylize_params"), 104)
    s.run("stylize_start", stage, struct("stylize_params", keep_for_update=1))
    s.run("stylize_update", stage, artwork, s.image(24, 16, 1, 1.0))
    s.make("stylize_get_image", stage, 0)
    s.call("stylize_get_report", stage, *report("stylize_report"))
    s.make("get_warnings", stage)
    s.call("stylize_set_motion", stage, s.image(24, 16, 2, 0.0))
    s.call("stylize_set_painted", stage, s.image(24, 16, 1, 1.0))
    return s


def pendants() -> Scenario:
    s = Scenario()
    width, height, centre, radius = 64, 48, (32, 24), 14
    disc = [float(math.dist((x + 0.5, y + 0.5), centre) < radius) for y in range(height) for x in range(width)]
    pixels = array("float", *disc)
    globe = s.make("image_create", s.context, struct(
        "image_view", width=width, height=height, channels=1, byte_size=4 * len(disc), data=pixels
    ))  # fmt: skip
    settings = struct("pendants_params", focal=200.0, known=2, known_length=0.4)
    hook, found = array("double", 32, 2), struct("pendant", "raw")
    s.call("pendants_find", s.context, globe, globe, None, hook, 1, settings, found, 4096, 1, ROOM)
    drum = struct(
        "pendant", "raw", struct_size=4096, profile_count=2, diameter=array("double", 0.4, 0.3, 0.5),
        profile=array("float", 0.5, 0, 0.5, 1),
    )  # fmt: skip
    s.call("scene_add_pendants", s.room(), drum, array("double", 0, 1.8, 0, 0.5, 1.8, 0), 2, 0.0, 500.0, ROOM, ROOM)
    return s


def sheets() -> Scenario:
    s = Scenario()
    settings = struct("sheet_params", dpi=40.0)
    sheet = s.make("sheet_print", s.image(60, 40), settings)
    place, _ = s.new()
    s.call("sheet_align", sheet, 60, 40, settings, place, *report("sheet_report"))
    return s


ALL = [library, images, scenes, jobs, photo, emission, rendering, light, lamps, photometry, transfer, planning, stylisation, pendants, sheets]


def programs() -> dict[str, list[Call]]:
    return {scenario.__name__: scenario().calls for scenario in ALL}
