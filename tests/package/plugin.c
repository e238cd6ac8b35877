/* A plug-in that contains the static library and exports one function to its host. */
#include <luxfer.h>

int plugin_start(void);

int plugin_start(void) {
    luxfer_context *context = NULL;
    luxfer_status status = luxfer_context_create(NULL, &context);
    luxfer_release(context);
    return (int)status;
}
