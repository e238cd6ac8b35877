/* Files and folders whose names have spaces and letters outside ASCII: luxfer takes names in UTF-8 everywhere, also on
 * Windows, whose own names are UTF-16. Also names with backslashes there, a folder that is missing, and text with
 * Windows' line ends.
 *
 *   paths    writes into the current folder
 */
#include "../../examples_c/common.h"

#include <string.h>
#ifdef _WIN32
#include <direct.h>
#include <wchar.h>
#define FOLDER L"caf\u00e9 \u7167\u660e"
#define FILE_NAME L"caf\u00e9 \u7167\u660e/na\u00efve light \u03bb.png"
#else
#include <sys/stat.h>
#include <sys/types.h>
#endif

/* "café 照明", and "naïve light λ.png" in it. */
#define FOLDER_UTF8 "caf\xc3\xa9 \xe7\x85\xa7\xe6\x98\x8e"
#define NAME_UTF8 "na\xc3\xafve light \xce\xbb.png"

static int failures;

static void expect(int ok, const char *what) {
    if (ok) return;
    fprintf(stderr, "failed: %s\n", what);
    failures++;
}

/* Creates the folder, and opens the file in it, by the functions of the system. */
static void make_folder(void) {
#ifdef _WIN32
    _wmkdir(FOLDER);
#else
    mkdir(FOLDER_UTF8, 0777);
#endif
}

static FILE *open_file(void) {
#ifdef _WIN32
    return _wfopen(FILE_NAME, L"rb");
#else
    return fopen(FOLDER_UTF8 "/" NAME_UTF8, "rb");
#endif
}

/* Saves a grey picture under a name, and loads it again. */
static void save_and_load(luxfer_image *image, const char *name) {
    luxfer_image *loaded = NULL;
    uint32_t width = 0, height = 0;
    expect(luxfer_image_save(image, name, 1) == LUXFER_OK, name);
    expect(luxfer_image_load(context, name, LUXFER_COLOUR_SRGB, &loaded) == LUXFER_OK, name);
    expect(luxfer_image_get_size(loaded, &width, &height, NULL) == LUXFER_OK && width == 2 && height == 1, name);
    luxfer_release(loaded);
}

int main(void) {
    float pixels[6] = {0.5f, 0.5f, 0.5f, 0.25f, 0.25f, 0.25f};
    luxfer_image_view view;
    luxfer_image *image = NULL;
    luxfer_strokes *strokes = NULL;
    FILE *file;
    check(luxfer_context_create(NULL, &context), "context");
    check(luxfer_image_view_init(&view, sizeof view), "image");
    view.width = 2, view.height = 1, view.data = pixels, view.byte_size = sizeof pixels;
    check(luxfer_image_create(context, &view, &image), "image");

    make_folder();
    save_and_load(image, FOLDER_UTF8 "/" NAME_UTF8);
    save_and_load(image, "with space.png");
    file = open_file();
    expect(file != NULL, "the system finds the file under its own form of the name");
    if (file) fclose(file);
#ifdef _WIN32
    save_and_load(image, FOLDER_UTF8 "\\" "back slash.png");
    save_and_load(image, "WITH SPACE.PNG");
#endif
    expect(luxfer_image_save(image, "no such folder/x.png", 1) == LUXFER_IO, "a folder that is missing");

    check(luxfer_strokes_create(context, 20, 10, &strokes), "strokes");
    expect(luxfer_strokes_add_text(strokes, "plane 2 1 1 9 1\r\nnot-plane 2 1 8 9 8\r\n") == LUXFER_OK, "strokes with Windows' line ends");
    luxfer_release(strokes);
    luxfer_release(image);
    luxfer_release(context);
    printf("paths: %s\n", failures ? "FAILED" : "all checks passed");
    return failures != 0;
}
