#include "svg.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "text.h"

static bool starts(const char *text, const char *with)
{
    return strncmp(text, with, strlen(with)) == 0;
}

/// Copies one tag, from `<` to `>`, changing ids, references to them, and colours.
static void copy_tag(FILE *out, const char *tag, const char *end, const char *id)
{
    static const struct {
        const char *found, *put;
        bool prefix;
    } changes[] = {
        {" id='", " id='", true},
        {" id=\"", " id=\"", true},
        {"href='#", "href='#", true},
        {"href=\"#", "href=\"#", true},
        {"url(#", "url(#", true},
        {"='black'", "='currentColor'", false},
        {"='rgb(  0,   0,   0)'", "='currentColor'", false},
        {"=\"black\"", "=\"currentColor\"", false},
    };
    for (const char *c = tag; c <= end;) {
        size_t i = 0, count = sizeof changes / sizeof *changes;
        while (i < count && !starts(c, changes[i].found)) i++;
        if (i == count) {
            // Runs of white space (gnuplot breaks its paths into lines) become one blank.
            bool blank = *c == ' ' || *c == '\n' || *c == '\t';
            if (!blank || c == tag || !strchr(" \n\t", c[-1])) fputc(blank ? ' ' : *c, out);
            c++;
            continue;
        }
        fprintf(out, "%s%s", changes[i].put, changes[i].prefix ? id : "");
        c += strlen(changes[i].found);
    }
}

/// The four numbers of viewBox="…" of the outermost element.
static bool view_box(const char *tag, const char *end, double box[4])
{
    static const char name[] = "viewBox=\"";
    const char *at = strstr(tag, name);
    if (!at || at > end) return false;
    at += strlen(name);
    for (int i = 0; i < 4; i++) {
        char *after;
        box[i] = strtod(at, &after);
        if (after == at || !isfinite(box[i])) return false;
        at = after;
    }
    return *at == '"';
}

/// Where an empty group ends that begins here (gnuplot writes many), or NULL.
static const char *after_empty_group(const char *tag)
{
    const char *end = starts(tag, "<g ") ? strchr(tag, '>') : NULL;
    if (!end) return NULL;
    end += 1 + strspn(end + 1, " \n\t");
    return starts(end, "</g>") ? end + 4 : NULL;
}

sphv_status sphv_svg_embed(const char *document, const char *id, const char *title, char **svg,
                           sphv_error *error)
{
    *svg = NULL;
    double box[4];
    const char *tag = strstr(document, "<svg"), *end = tag ? strchr(tag, '>') : NULL;
    if (!end || !strstr(end, "</svg>") || !view_box(tag, end, box))
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "gnuplot drew no complete picture");
    size_t size;
    FILE *out = open_memstream(svg, &size);
    if (!out) return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" "
            "xmlns:xlink=\"http://www.w3.org/1999/xlink\" viewBox=\"%g %g %g %g\" role=\"img\" "
            "aria-labelledby=\"%s-title\"><title id=\"%s-title\">",
            box[0], box[1], box[2], box[3], id, id);
    sphv_put_html(out, title);
    fputs("</title>", out);
    char prefix[64];
    snprintf(prefix, sizeof prefix, "%.60s-", id);
    for (const char *c = end + 1; *c;) {
        if (*c != '<') {
            bool blank = *c == '\n' || *c == '\t';
            if (!blank) fputc(*c, out);
            c++;
            continue;
        }
        // gnuplot's own titles would show as tooltips; its filters are of no use here.
        static const char *const dropped[][2] = {
            {"<title>", "</title>"}, {"<desc>", "</desc>"}, {"<filter", "</filter>"}};
        const char *after = NULL;
        for (int i = 0; i < 3 && !after; i++)
            if (starts(c, dropped[i][0])) {
                after = strstr(c, dropped[i][1]);
                if (after) after += strlen(dropped[i][1]);
            }
        if (!after) after = after_empty_group(c);
        if (!after) {
            after = strchr(c, '>');
            if (!after) break;
            copy_tag(out, c, after++, prefix);
        }
        c = after;
    }
    if (fclose(out) != 0) {
        free(*svg);
        *svg = NULL;
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    }
    return SPHV_OK;
}
