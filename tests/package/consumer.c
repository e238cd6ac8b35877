/* A C program that uses an installed luxfer. */
#include <luxfer.h>

#include <stdio.h>

int main(void) {
    luxfer_context *context = NULL;
    luxfer_scene *scene = NULL;
    luxfer_scene_counts counts;
    if (luxfer_get_version() / 100 != LUXFER_VERSION / 100) return 1;
    if (luxfer_context_create(NULL, &context) != LUXFER_OK) return 1;
    if (luxfer_demo_create_scene(context, LUXFER_DEMO_TARGET_ROOM, &scene) != LUXFER_OK) return 1;
    if (luxfer_scene_get_counts(scene, &counts, sizeof counts) != LUXFER_OK || counts.meshes == 0) return 1;
    luxfer_release(scene);
    luxfer_release(context);
    printf("C: luxfer %s\n", luxfer_get_version_string());
    return 0;
}
