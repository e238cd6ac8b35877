/* Segmentation by strokes: finds the ceiling in a photo, and the lamps on the ceiling.
 *
 * A segmentation learns from a few strokes and estimates its error, so a painting program can show the mask while the
 * user paints. This program has fixed strokes. It writes custom_strokes.png: the photo; the ceiling after the first
 * strokes, and after more strokes; the lamps.
 */
#include "common.h"
#include "panels.h"

/* Runs the stages first to last, prints the error of the result, and shows it. The error is estimated from held-out
 * strokes, so it does not cover surfaces without strokes; LUXFER_SEGMENT_UNSEEN of a luxfer_segment shows these. */
static void run(luxfer_transfer *transfer, luxfer_stage first, luxfer_stage last, luxfer_transfer_image which, sheet *s,
                int column, int row) {
    luxfer_transfer_report report;
    luxfer_image *confidence = NULL;
    luxfer_job *job = NULL;
    check(luxfer_transfer_start(transfer, first, last, NULL, &job), "segmentation");
    wait_and_release(job, "segmenting");
    check(luxfer_transfer_get_report(transfer, &report, sizeof report), "report");
    if (last == LUXFER_STAGE_PLANE) printf("ceiling: %.1f %% wrong on strokes held out\n", 100 * report.plane_error);
    else printf("lamps:   %.1f %% wrong on strokes held out\n", 100 * report.lights_error);
    check(luxfer_transfer_get_image(transfer, which, &confidence), "confidence");
    panels_add(s, column, row, confidence, 1);
    luxfer_release(confidence);
}

int main(void) {
    /* Strokes as polylines: x and y of each point in pixels of the photo, whose top-left pixel has its centre at
     * (0.5, 0.5). */
    static const float ceiling[] = {50, 11, 90, 40, 128, 58}, beside_lamps[] = {214, 89, 253, 73};
    static const float far_wall[] = {50, 163, 167, 160}, cupboards[] = {190, 185, 292, 171};
    static const float left_wall[] = {5, 152, 7, 179};
    static const float lamp[] = {157, 84, 190, 85}, large_lamp[] = {230, 19, 245, 30}, small_lamp[] = {130, 115, 152, 116};
    static const float tiles[] = {73, 42, 112, 81}, far_tiles[] = {62, 112, 105, 105};
    const float radius = 1.5f;
    luxfer_strokes *strokes = NULL;
    luxfer_transfer *transfer = NULL;
    luxfer_warnings *warnings = NULL;
    luxfer_image *photo;
    sheet s = panels_begin(2, 2, 300, 200);

    check(luxfer_context_create(NULL, &context), "context");
    photo = take_photo(300, 200, 8);
    panels_add(&s, 0, 0, photo, 1);
    check(luxfer_transfer_create(context, &transfer), "transfer");
    check(luxfer_transfer_set_photo(transfer, photo), "photo");

    /* --8<-- [start:strokes] */
    check(luxfer_strokes_create(context, 300, 200, &strokes), "strokes"); /* the photo's size */

    /* The ceiling: 1 marks strokes on it, 0 strokes off it. Strokes on lamps count as strokes on the ceiling. */
    check(luxfer_strokes_add(strokes, LUXFER_PHASE_PLANE, ceiling, 3, radius, 1), "stroke");
    check(luxfer_strokes_add(strokes, LUXFER_PHASE_PLANE, far_wall, 2, radius, 0), "stroke");
    check(luxfer_transfer_set_strokes(transfer, strokes), "strokes");
    run(transfer, LUXFER_STAGE_VIEW, LUXFER_STAGE_PLANE, LUXFER_TRANSFER_PLANE_CONFIDENCE, &s, 1, 0);

    /* Add strokes where the mask was wrong and set them again; run only the stages that depend on them. */
    check(luxfer_strokes_add(strokes, LUXFER_PHASE_PLANE, beside_lamps, 2, radius, 1), "stroke");
    check(luxfer_strokes_add(strokes, LUXFER_PHASE_PLANE, cupboards, 2, radius, 0), "stroke");
    check(luxfer_strokes_add(strokes, LUXFER_PHASE_PLANE, left_wall, 2, radius, 0), "stroke");
    check(luxfer_strokes_add(strokes, LUXFER_PHASE_LIGHTS, lamp, 2, radius, 1), "stroke");
    check(luxfer_strokes_add(strokes, LUXFER_PHASE_LIGHTS, large_lamp, 2, radius, 1), "stroke");
    check(luxfer_strokes_add(strokes, LUXFER_PHASE_LIGHTS, small_lamp, 2, radius, 1), "stroke");
    check(luxfer_strokes_add(strokes, LUXFER_PHASE_LIGHTS, tiles, 2, radius, 0), "stroke");
    check(luxfer_strokes_add(strokes, LUXFER_PHASE_LIGHTS, far_tiles, 2, radius, 0), "stroke");
    check(luxfer_transfer_set_strokes(transfer, strokes), "strokes");
    run(transfer, LUXFER_STAGE_PLANE, LUXFER_STAGE_PLANE, LUXFER_TRANSFER_PLANE_CONFIDENCE, &s, 0, 1);
    run(transfer, LUXFER_STAGE_LIGHTS, LUXFER_STAGE_LIGHTS, LUXFER_TRANSFER_LIGHTS_CONFIDENCE, &s, 1, 1);
    /* --8<-- [end:strokes] */
    check(panels_save(&s, context, "custom_strokes.png"), "custom_strokes.png");

    /* The reasons to doubt the masks, and the places where one more stroke helps. */
    check(luxfer_get_warnings(transfer, &warnings), "warnings");
    print_warnings(warnings);

    luxfer_release(transfer);
    luxfer_release(strokes);
    luxfer_release(photo);
    luxfer_release(context);
    return 0;
}
