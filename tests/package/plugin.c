/* A plug-in that has the static library inside: a host finds one function in it. */
#include <luxfer.h>

int plugin_start(void);

int plugin_start(void) {
    luxfer_context *context = NULL;
    luxfer_status status = luxfer_context_create(NULL, &context);
    luxfer_release(context);
    return (int)status;
}
