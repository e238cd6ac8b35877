/* Builds a scene from the arrays of a host: a small room with a lamp, which is rendered and saved as glTF.
 *
 * Writes scene_from_arrays.png and scene_from_arrays.glb.
 */
#include "common.h"

/* --8<-- [start:mesh] */
/* A vertex of a host, with interleaved attributes; the library does not need all of them. */
typedef struct vertex {
    float position[3], uv[2];
    int selected;
} vertex;

/* Adds a rectangle with a corner and the edges u and v; its front side faces in the direction cross(u, v). */
static void add_quad(luxfer_scene *scene, const char *name, uint32_t material, const float *corner, const float *u,
                     const float *v) {
    static const uint32_t triangles[2][3] = {{0, 1, 2}, {0, 2, 3}}; /* Counter-clockwise seen from the front. */
    luxfer_mesh_params mesh;
    vertex vertices[4] = {{{0}, {0}, 0}};
    int i, k;
    for (i = 0; i < 4; i++) {
        vertices[i].uv[0] = (float)(i == 1 || i == 2);
        vertices[i].uv[1] = (float)(i >= 2);
        for (k = 0; k < 3; k++)
            vertices[i].position[k] = corner[k] + vertices[i].uv[0] * u[k] + vertices[i].uv[1] * v[k];
    }
    check(luxfer_mesh_params_init(&mesh, sizeof mesh), name);
    mesh.name = name;
    mesh.material = material;
    mesh.vertex_count = 4;
    mesh.positions = vertices[0].position;
    mesh.position_stride = sizeof(vertex);
    mesh.uvs = vertices[0].uv;
    mesh.uv_stride = sizeof(vertex);
    mesh.triangle_count = 2;
    mesh.indices = triangles;
    check(luxfer_scene_add_mesh(scene, &mesh, NULL), name); /* The arrays have been copied. */
}
/* --8<-- [end:mesh] */

static uint32_t add_material(luxfer_scene *scene, const char *name, float r, float g, float b, float emission) {
    luxfer_material_params material;
    uint32_t index = 0;
    check(luxfer_material_params_init(&material, sizeof material), name);
    material.name = name;
    material.base_color[0] = r, material.base_color[1] = g, material.base_color[2] = b;
    material.emission[0] = material.emission[1] = material.emission[2] = emission; /* cd/m2 */
    material.double_sided = emission == 0; /* Lamps emit from their front side only. */
    check(luxfer_scene_add_material(scene, &material, &index), name);
    return index;
}

int main(void) {
    /* Metres, Y up: 4 m wide, 2.6 m high, 5 m deep, open towards the camera. */
    static const float left[3] = {0, 0, 0}, right[3] = {4, 0, 0};
    static const float up[3] = {0, 2.6f, 0}, near_[3] = {0, 0, 5}, far_[3] = {0, 0, -5};
    static const float front[3] = {0, 0, 5}, across[3] = {4, 0, 0}, top[3] = {0, 2.6f, 0};
    static const float lamp[3] = {1.4f, 2.59f, 1.6f}, lamp_u[3] = {1.2f, 0, 0}, lamp_v[3] = {0, 0, 0.6f};
    static const float table[3] = {1, 0.75f, 2.4f}, table_u[3] = {1.6f, 0, 0}, table_v[3] = {0, 0, -0.9f};
    luxfer_scene *scene = NULL;
    luxfer_scene_counts counts;
    luxfer_camera_params camera;
    luxfer_render *render = NULL;
    luxfer_render_params params;
    luxfer_render_report report;
    luxfer_image *picture = NULL;
    luxfer_job *job = NULL;
    uint32_t white, red, green, wood, glowing;

    /* Add materials, then the meshes that use them, then cameras. */
    check(luxfer_context_create(NULL, &context), "context");
    check(luxfer_scene_create(context, &scene), "scene");
    white = add_material(scene, "White paint", 0.75f, 0.75f, 0.72f, 0);
    red = add_material(scene, "Red paint", 0.6f, 0.1f, 0.08f, 0);
    green = add_material(scene, "Green paint", 0.12f, 0.45f, 0.15f, 0);
    wood = add_material(scene, "Wood", 0.45f, 0.28f, 0.14f, 0);
    glowing = add_material(scene, "Diffuser", 0.8f, 0.8f, 0.8f, 4000);
    add_quad(scene, "Floor", wood, front, across, far_);
    add_quad(scene, "Ceiling", white, top, across, near_);
    add_quad(scene, "Back wall", white, left, across, up);
    add_quad(scene, "Left wall", red, left, up, near_);
    add_quad(scene, "Right wall", green, right, near_, up);
    add_quad(scene, "Table", wood, table, table_u, table_v);
    add_quad(scene, "Lamp", glowing, lamp, lamp_u, lamp_v);
    check(luxfer_camera_params_init(&camera, sizeof camera), "camera");
    camera.position[0] = 2, camera.position[1] = 1.9f, camera.position[2] = 7.5f;
    camera.target[0] = 2, camera.target[1] = 1.1f, camera.target[2] = 0;
    camera.fov_y = 0.75f;
    check(luxfer_scene_add_camera(scene, &camera, NULL), "camera");
    check(luxfer_scene_get_counts(scene, &counts, sizeof counts), "scene");
    printf("%u meshes, %u triangles, %u materials\n", counts.meshes, (unsigned)counts.triangles, counts.materials);

    check(luxfer_render_create(context, &render), "render");
    check(luxfer_render_set_scene(render, scene), "render");
    check(luxfer_render_params_init(&params, sizeof params), "render");
    params.width = 300, params.height = 200, params.samples = 16;
    params.preview = 1; /* filter the noise */
    check(luxfer_render_start(render, &params, &job), "render");
    wait_and_release(job, "rendering");
    check(luxfer_render_get_image(render, LUXFER_RENDER_PREVIEW, &picture), "picture");
    check(luxfer_image_save(picture, "scene_from_arrays.png", 0.008f), "picture");
    check(luxfer_render_get_report(render, &report, sizeof report), "report");
    printf("look at scene_from_arrays.png; its root mean square error is %.1f %% of its mean\n", 100 * report.preview_error);
    check(luxfer_scene_export(scene, "scene_from_arrays.glb"), "glTF");

    luxfer_release(picture);
    luxfer_release(render);
    luxfer_release(scene);
    luxfer_release(context);
    return 0;
}
