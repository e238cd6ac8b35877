/* [start mix] */

/* The emissive texture of the lit room, its lit regions, and how the surface maps to it. */
typedef struct texture {
    float *values;
    int *labels, count, width, height;
    luxfer_surface surface;
    double map[2][3]; /* u and v in metres, and 1, to shares of width and height */
} texture;

static double factor_of(const placement *on, uint32_t kind) {
    size_t i;
    for (i = on->first_dimmer; i < on->first_dimmer + on->dimmer_count; i++)
        if (dimmers[i].kind == kind) return dimmers[i].factor;
    return 1;
}

/* Whether all lamps of a surface are as the transfer has made them. */
static int is_plain(const placement *on) {
    size_t i;
    for (i = on->first_dimmer; i < on->first_dimmer + on->dimmer_count; i++)
        if (dimmers[i].factor != 1) return 0;
    return on->added_count == 0;
}

/* Returns u and v in metres of a position on a surface. */
static void on_surface(const luxfer_surface *surface, const double position[3], double uv[2]) {
    int k;
    uv[0] = uv[1] = 0;
    for (k = 0; k < 3; k++) {
        uv[0] += (position[k] - surface->origin[k]) * surface->u_axis[k];
        uv[1] += (position[k] - surface->origin[k]) * surface->v_axis[k];
    }
}

/* Returns the largest distance in metres of the bounds of a mesh from those of a surface. */
static double misfit(luxfer_scene *lit, uint32_t mesh, const luxfer_surface *surface) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, out = 0;
    luxfer_mesh_info info;
    float *positions;
    size_t i;
    int k;
    check(luxfer_scene_get_mesh(lit, mesh, &info, sizeof info), "mesh");
    positions = (float *)allocate(3 * (size_t)info.vertex_count, sizeof(float));
    check(luxfer_scene_read_vertices(lit, mesh, LUXFER_VERTEX_POSITION, positions, (size_t)info.vertex_count), "mesh");
    for (i = 0; i < (size_t)info.vertex_count; i++) {
        const double position[3] = {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
        double uv[2], away = 0;
        on_surface(surface, position, uv);
        for (k = 0; k < 3; k++) away += (position[k] - surface->origin[k]) * surface->normal[k];
        for (k = 0; k < 2; k++) low[k] = fmin(low[k], uv[k]), high[k] = fmax(high[k], uv[k]);
        out = fmax(out, fabs(away));
    }
    for (k = 0; k < 2; k++) out = fmax(out, fmax(fabs(low[k]), fabs(high[k] - surface->size[k])));
    free(positions);
    return out;
}

/* Returns the mesh with the lamps of a surface. A transfer adds the meshes of its surfaces last; that of a surface
 * fills its rectangle best. */
static uint32_t mesh_of(luxfer_scene *lit, const luxfer_surface *surface) {
    luxfer_scene_counts counts;
    uint32_t mesh, best = 0;
    double smallest = INFINITY;
    check(luxfer_scene_get_counts(lit, &counts, sizeof counts), "room");
    for (mesh = counts.meshes - placement_count; mesh < counts.meshes; mesh++) {
        const double distance = misfit(lit, mesh, surface);
        if (distance >= smallest) continue;
        smallest = distance;
        best = mesh;
    }
    return best;
}

/* Fits the map from the surface to the texture to the vertices of the mesh that the transfer has added. */
static void fit_map(luxfer_scene *lit, uint32_t mesh, uint32_t uv_set, texture *t) {
    luxfer_mesh_info info;
    double m[3][5] = {{0}};
    float *positions, *uvs;
    size_t i, vertices;
    int r, c, k;
    check(luxfer_scene_get_mesh(lit, mesh, &info, sizeof info), "mesh");
    vertices = (size_t)info.vertex_count;
    positions = (float *)allocate(3 * vertices, sizeof(float));
    uvs = (float *)allocate(2 * vertices, sizeof(float));
    check(luxfer_scene_read_vertices(lit, mesh, LUXFER_VERTEX_POSITION, positions, vertices), "mesh");
    check(luxfer_scene_read_vertices(lit, mesh, uv_set ? LUXFER_VERTEX_UV_1 : LUXFER_VERTEX_UV_0, uvs,
                                     vertices), "mesh");
    for (i = 0; i < vertices; i++) { /* sum up the normal equations */
        const double position[3] = {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
        double known[3] = {0, 0, 1};
        on_surface(&t->surface, position, known);
        for (r = 0; r < 3; r++) {
            for (c = 0; c < 3; c++) m[r][c] += known[r] * known[c];
            for (c = 0; c < 2; c++) m[r][3 + c] += known[r] * uvs[2 * i + (size_t)c];
        }
    }
    for (k = 0; k < 3; k++) /* eliminate; the matrix is symmetric and positive definite */
        for (r = 0; r < 3; r++) {
            const double share = m[r][k] / m[k][k];
            if (r != k)
                for (c = 0; c < 5; c++) m[r][c] -= share * m[k][c];
        }
    for (r = 0; r < 3; r++)
        for (c = 0; c < 2; c++) t->map[c][r] = m[r][3 + c] / m[r][r];
    free(uvs), free(positions);
}

/* Marks with 1 the regions that a lamp covers. */
static void regions_of(const luxfer_fixture *lamp, const texture *t, unsigned char *is_of_lamp) {
    double across[3], position[3], uv[2];
    int i, j, k;
    memset(is_of_lamp, 0, (size_t)t->count + 1);
    for (k = 0; k < 3; k++) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        across[k] = (double)lamp->normal[a] * lamp->axis[b] - (double)lamp->normal[b] * lamp->axis[a];
    }
    for (i = 0; i < 5; i++)
        for (j = 0; j < 5; j++) {
            int x, y;
            for (k = 0; k < 3; k++)
                position[k] = lamp->position[k] + ((i + 0.5) / 5 - 0.5) * lamp->size[0] * lamp->axis[k] +
                              ((j + 0.5) / 5 - 0.5) * lamp->size[1] * across[k];
            on_surface(&t->surface, position, uv);
            x = (int)((t->map[0][0] * uv[0] + t->map[0][1] * uv[1] + t->map[0][2]) * t->width);
            y = (int)((t->map[1][0] * uv[0] + t->map[1][1] * uv[1] + t->map[1][2]) * t->height);
            x = x < 0 ? 0 : x >= t->width ? t->width - 1 : x;
            y = y < 0 ? 0 : y >= t->height ? t->height - 1 : y;
            is_of_lamp[t->labels[y * t->width + x]] = 1;
        }
    is_of_lamp[0] = 0;
}

/* Returns the largest lamp of a kind; NULL if the room has none. */
static const luxfer_fixture *model_of(const luxfer_fixture *lamps, size_t count, uint32_t kind) {
    const luxfer_fixture *out = NULL;
    size_t i;
    for (i = 0; i < count; i++)
        if (lamps[i].kind == kind && (!out || lamps[i].area > out->area)) out = &lamps[i];
    return out;
}

/* Returns the step in metres along u and v from a lamp to the place of an added lamp. */
static void step_to(const luxfer_fixture *lamp, const luxfer_surface *surface, const double place[3], double step[2]) {
    const double position[3] = {lamp->position[0], lamp->position[1], lamp->position[2]};
    double uv[2];
    on_surface(surface, position, uv);
    step[0] = place[1] - uv[0];
    step[1] = place[2] - uv[1];
}

/* Copies the texels of a lamp to another place; what lies beyond the texture is cut. */
static void copy_lamp(const luxfer_fixture *lamp, texture *t, const double place[3], unsigned char *is_of_lamp) {
    const size_t size = 3 * sizeof(float) * (size_t)t->width * (size_t)t->height;
    float *before = (float *)allocate(size, 1);
    double step[2];
    int x, y, dx, dy;
    step_to(lamp, &t->surface, place, step);
    dx = (int)rint((t->map[0][0] * step[0] + t->map[0][1] * step[1]) * t->width);
    dy = (int)rint((t->map[1][0] * step[0] + t->map[1][1] * step[1]) * t->height);
    regions_of(lamp, t, is_of_lamp);
    memcpy(before, t->values, size);
    for (y = 0; y < t->height; y++)
        for (x = 0; x < t->width; x++) {
            const int from = y * t->width + x, to = (y + dy) * t->width + x + dx;
            if (!is_of_lamp[t->labels[from]] || x + dx < 0 || x + dx >= t->width || y + dy < 0 || y + dy >= t->height)
                continue;
            memcpy(t->values + 3 * to, before + 3 * from, 3 * sizeof(float));
        }
    free(before);
}

/* Gives each kind of lamp its share of the light in the texture, and adds lamps to it. */
static void mix_texture(texture *t, const placement *on, const luxfer_fixture *lamps, size_t lamp_count) {
    const int pixels = t->width * t->height;
    unsigned char *is_lit = (unsigned char *)allocate((size_t)pixels, 1), *is_of_lamp;
    float *factors;
    size_t k;
    int i, c;
    for (i = 0; i < pixels; i++)
        is_lit[i] = t->values[3 * i] > 0 || t->values[3 * i + 1] > 0 || t->values[3 * i + 2] > 0;
    for (i = 0; i < pixels; i++)
        if (is_lit[i] && !t->labels[i]) fill(is_lit, t->labels, t->width, t->height, i, ++t->count);
    factors = (float *)allocate((size_t)t->count + 1, sizeof(float));
    is_of_lamp = (unsigned char *)allocate((size_t)t->count + 1, 1);
    for (i = 0; i <= t->count; i++) factors[i] = 1;
    for (k = 0; k < lamp_count; k++) {
        regions_of(&lamps[k], t, is_of_lamp);
        for (i = 1; i <= t->count; i++)
            if (is_of_lamp[i]) factors[i] = (float)factor_of(on, lamps[k].kind);
    }
    for (i = 0; i < pixels; i++)
        for (c = 0; c < 3; c++) t->values[3 * i + c] *= factors[t->labels[i]];
    for (k = on->first_added; k < on->first_added + on->added_count; k++) {
        const luxfer_fixture *model = model_of(lamps, lamp_count, (uint32_t)added_lamps[k][0]);
        if (model) copy_lamp(model, t, added_lamps[k], is_of_lamp);
    }
    free(factors), free(is_of_lamp), free(is_lit);
}

/* Changes the lamps of a surface in the lit room. */
static void mix_lamps(luxfer_scene *room, luxfer_scene *lit, const placement *on, const luxfer_fixture *lamps,
                      size_t lamp_count) {
    luxfer_mesh_info info;
    luxfer_texture_use use;
    luxfer_image *image = NULL, *changed;
    uint32_t width, height, channels, index, mesh;
    texture t;
    if (is_plain(on)) return;
    memset(&t, 0, sizeof t);
    check(luxfer_scene_find_surface(room, on->surface, &t.surface, sizeof t.surface), "surface");
    mesh = mesh_of(lit, &t.surface);
    check(luxfer_scene_get_mesh(lit, mesh, &info, sizeof info), "lamps");
    check(luxfer_scene_get_material_texture(lit, info.material, LUXFER_TEXTURE_EMISSION, &use, sizeof use), "lamps");
    check(luxfer_scene_get_texture(lit, use.texture, &image), "lamps");
    t.values = pixels_of(image, &width, &height, &channels);
    t.width = (int)width;
    t.height = (int)height;
    t.labels = (int *)allocate((size_t)width * height, sizeof(int));
    fit_map(lit, mesh, use.uv_set, &t);
    mix_texture(&t, on, lamps, lamp_count);
    changed = image_of(t.values, width, height, channels);
    check(luxfer_scene_add_texture(lit, changed, use.wrap_u, use.wrap_v, &index), "lamps");
    check(luxfer_scene_set_material_texture(lit, info.material, LUXFER_TEXTURE_EMISSION, index, use.uv_set,
                                            use.transform), "lamps");
    free(t.labels), free(t.values);
    luxfer_release(changed), luxfer_release(image);
}

/* Appends the added lamps to the list of lamps, and gives each lamp its share of the light. */
static size_t mix_list(luxfer_scene *room, const placement *on, luxfer_fixture *lamps, size_t count) {
    luxfer_surface surface;
    size_t all = count, i;
    int k;
    check(luxfer_scene_find_surface(room, on->surface, &surface, sizeof surface), "surface");
    for (i = on->first_added; i < on->first_added + on->added_count; i++) {
        const luxfer_fixture *model = model_of(lamps, count, (uint32_t)added_lamps[i][0]);
        double step[2];
        if (!model) continue;
        step_to(model, &surface, added_lamps[i], step);
        lamps[all] = *model;
        for (k = 0; k < 3; k++)
            lamps[all].position[k] += (float)(step[0] * surface.u_axis[k] + step[1] * surface.v_axis[k]);
        all++;
    }
    for (i = 0; i < all; i++) {
        const double factor = factor_of(on, lamps[i].kind);
        lamps[i].flux *= factor;
        for (k = 0; k < 3; k++) lamps[i].radiance[k] = (float)(factor * lamps[i].radiance[k]);
    }
    return all;
}

/* Begins a schedule with the columns of luxfer_transfer_save_fixtures and, if there are several, the surface. */
static FILE *begin_schedule(const char *path) {
    FILE *file = fopen(path, "w");
    if (!file) {
        perror(path);
        exit(1);
    }
    fprintf(file, "x_m,y_m,z_m,normal_x,normal_y,normal_z,axis_x,axis_y,axis_z,length_m,width_m,area_m2,"
                  "red_cd_m2,green_cd_m2,blue_cd_m2,flux_lm,cct_k,duv,kind%s\n", placement_count > 1 ? ",surface" : "");
    return file;
}

/* Writes the name of a surface as the last column of a schedule. */
static void write_surface(FILE *file, const char *name) {
    fputs(",\"", file);
    for (; *name; name++) fprintf(file, *name == '"' ? "\"%c" : "%c", *name);
    fputs("\"", file);
}

/* Writes the lamps of a surface. */
static void write_lamps(FILE *file, const placement *on, const luxfer_fixture *lamps, size_t count) {
    size_t i;
    for (i = 0; i < count; i++) {
        const luxfer_fixture *l = &lamps[i];
        fprintf(file, "%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,", l->position[0], l->position[1], l->position[2],
                l->normal[0], l->normal[1], l->normal[2], l->axis[0], l->axis[1], l->axis[2]);
        fprintf(file, "%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%u", l->size[0], l->size[1], l->area,
                l->radiance[0], l->radiance[1], l->radiance[2], l->flux, l->cct, l->duv, (unsigned)l->kind);
        if (placement_count > 1) write_surface(file, on->surface);
        fputc('\n', file);
    }
}
/* [end mix] */
