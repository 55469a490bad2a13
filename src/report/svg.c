#include "svg.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "svg_path.h"
#include "text.h"

/// A name="value" of a tag; neither ends in '\0'.
typedef struct attribute {
    const char *name, *name_end, *value, *value_end;
} attribute;

/// Groups and spans of the picture that are open, and whether their tags were left out.
enum { DEPTH = 64 };
typedef struct nesting {
    bool dropped[DEPTH];
    int depth, definitions;
} nesting;

static bool starts(const char *text, const char *with)
{
    return strncmp(text, with, strlen(with)) == 0;
}

static bool is(const char *from, const char *to, const char *text)
{
    size_t length = strlen(text);
    return (size_t)(to - from) == length && memcmp(from, text, length) == 0;
}

/// What every tag begins with: '<', its name.
static bool is_tag(const char *tag, const char *name)
{
    size_t length = strlen(name);
    return starts(tag + 1, name) && strchr(" \n\t/>", tag[1 + length]);
}

static const char blanks[] = " \n\t\r";

/// \param at advances behind the attribute
static bool next_attribute(const char **at, const char *end, attribute *out)
{
    const char *c = *at + strspn(*at, blanks);
    out->name = c;
    c += strcspn(c, "= \n\t\r/>");
    out->name_end = c;
    if (c >= end || c == out->name || *c != '=' || (c[1] != '\'' && c[1] != '"')) return false;
    out->value = c + 2;
    out->value_end = strchr(out->value, c[1]);
    if (!out->value_end || out->value_end >= end) return false;
    *at = out->value_end + 1;
    return true;
}

/// What the root of the picture says once for all, and what nothing refers to. gnuplot's groups are
/// not nested, so that all of them inherit from the root.
static bool is_repetition(const char *tag, const attribute *of, bool in_definitions)
{
    static const struct {
        const char *name, *value; ///< NULL: any
        bool drawing;             ///< only where it applies to what is drawn at once
    } dropped[] = {
        {"class", NULL, false},           {"stroke-linecap", "butt", false},
        {"font-size", "17.00", false},    {"stroke-linejoin", "miter", false},
        {"stroke-width", "1.00", true},   {"font-family", "sans-serif", false},
        {"stroke", "currentColor", true}, {"stroke", "black", true},
        {"color", "black", true},         {"color", "gray", true},
        {"fill", "none", true},
    };
    bool drawing = !in_definitions && (is_tag(tag, "g") || is_tag(tag, "path"));
    if (is_tag(tag, "g") && is(of->name, of->name_end, "id")) return true;
    for (size_t i = 0; i < sizeof dropped / sizeof *dropped; i++)
        if (is(of->name, of->name_end, dropped[i].name) &&
            (!dropped[i].value || is(of->value, of->value_end, dropped[i].value)) &&
            (drawing || !dropped[i].drawing))
            return true;
    return false;
}

/// \param drawn the tag is drawn where it stands; a symbol of the definitions is scaled first and
///        keeps its digits
static void put_value(FILE *out, const attribute *of, const char *id, bool drawn)
{
    const char *value = of->value;
    if (is(of->name, of->name_end, "d") && drawn) {
        sphv_svg_put_path(out, value, of->value_end);
    } else if (is(of->name, of->name_end, "id")) {
        fputs(id, out);
        fwrite(value, 1, (size_t)(of->value_end - value), out);
    } else if (is(value, of->value_end, "black") ||
               is(value, of->value_end, "rgb(  0,   0,   0)")) {
        fputs("currentColor", out);
    } else if (*value == '#' && is(of->name_end - 4, of->name_end, "href")) {
        fprintf(out, "#%s", id);
        fwrite(value + 1, 1, (size_t)(of->value_end - value - 1), out);
    } else if (starts(value, "url(#")) {
        fprintf(out, "url(#%s", id);
        fwrite(value + 5, 1, (size_t)(of->value_end - value - 5), out);
    } else if (!drawn) {
        fwrite(value, 1, (size_t)(of->value_end - value), out);
    } else {
        bool place = is(of->name, of->name_end, "transform") && starts(value, "translate(");
        sphv_svg_put_value(out, value, of->value_end, place ? 1 : 2);
    }
}

/// Writes one tag, from `<` to `>`, or leaves it out: a group or a span that says nothing new.
static void put_tag(FILE *out, const char *tag, const char *end, const char *id, nesting *open)
{
    bool group = is_tag(tag, "g") || is_tag(tag, "tspan"), empty = end[-1] == '/', written = false;
    open->definitions += is_tag(tag, "defs") - is_tag(tag, "/defs");
    if (is_tag(tag, "/g") || is_tag(tag, "/tspan")) {
        if (open->depth > 0) open->depth--;
        if (open->depth >= DEPTH || !open->dropped[open->depth])
            fwrite(tag, 1, (size_t)(end - tag) + 1, out);
        return;
    }
    const char *name_end = tag + 1 + strcspn(tag + 1, " \n\t\r/>");
    if (*name_end == '/' && name_end + 1 < end) name_end = end; // </name>
    if (!group) fwrite(tag, 1, (size_t)(name_end - tag), out);
    attribute found;
    for (const char *at = name_end; next_attribute(&at, end, &found);) {
        if (is_repetition(tag, &found, open->definitions > 0)) continue;
        if (group && !written) fwrite(tag, 1, (size_t)(name_end - tag), out);
        written = true;
        fputc(' ', out);
        fwrite(found.name, 1, (size_t)(found.value - found.name), out);
        put_value(out, &found, id, open->definitions == 0);
        fputc(*found.value_end, out);
    }
    if (group && !empty) {
        if (open->depth < DEPTH) open->dropped[open->depth] = !written;
        // Deeper than is kept count of, every tag stays.
        else if (!written)
            fwrite(tag, 1, (size_t)(name_end - tag), out);
        open->depth++;
        if (!written && open->depth <= DEPTH) return;
    } else if (group && !written) {
        return;
    }
    fputs(empty ? "/>" : ">", out);
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

/// Where an element ends that is of no use here, or NULL: gnuplot's own titles, which would show as
/// tooltips, its filters, the empty background, groups without content, spans that only prepare for
/// what does not follow.
static const char *after_useless(const char *tag)
{
    static const char *const dropped[][2] = {
        {"<title>", "</title>"}, {"<desc>", "</desc>"}, {"<filter", "</filter>"}};
    for (int i = 0; i < 3; i++)
        if (starts(tag, dropped[i][0])) {
            const char *after = strstr(tag, dropped[i][1]);
            return after ? after + strlen(dropped[i][1]) : NULL;
        }
    const char *end = strchr(tag, '>');
    if (!end) return NULL;
    static const char empty[] = " fill=\"none\"/";
    if (starts(tag, "<rect ") && end - tag > (long)sizeof empty &&
        starts(end - (sizeof empty - 1), empty))
        return end + 1;
    if (!starts(tag, "<g ") && !starts(tag, "<tspan ")) return NULL;
    end += 1 + strspn(end + 1, blanks);
    if (starts(tag, "<g ")) return starts(end, "</g>") ? end + 4 : NULL;
    return starts(end, "</tspan></text>") ? end + 8 : NULL;
}

/// Where a point symbol ends that the picture never refers to, or NULL.
static const char *after_unused(const char *document, const char *tag)
{
    const char *end = strchr(tag, '>'), *id = strstr(tag, " id='");
    if (!end || !id || id > end || end[-1] != '/') return NULL;
    size_t length = strcspn(id += 5, "'");
    char reference[64];
    if (length + 3 > sizeof reference) return NULL;
    snprintf(reference, sizeof reference, "#%.*s'", (int)length, id);
    return strstr(document, reference) ? NULL : end + 1;
}

static void put_content(FILE *out, const char *document, const char *content, const char *id)
{
    nesting open = {{false}, 0, 0};
    for (const char *c = content; *c;) {
        if (*c != '<') {
            bool blank = *c == '\n' || *c == '\t' || *c == '\r';
            if (!blank) fputc(*c, out);
            c++;
            continue;
        }
        const char *after = after_useless(c);
        if (!after && open.definitions > 0) after = after_unused(document, c);
        if (!after) {
            after = strchr(c, '>');
            if (!after) break;
            put_tag(out, c, after++, id, &open);
        }
        c = after;
    }
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
            "fill=\"none\" stroke=\"currentColor\" font-family=\"sans-serif\" font-size=\"17\" "
            "aria-labelledby=\"%s-title\"><title id=\"%s-title\">",
            box[0], box[1], box[2], box[3], id, id);
    sphv_put_html(out, title);
    fputs("</title>", out);
    char prefix[64];
    snprintf(prefix, sizeof prefix, "%.60s-", id);
    put_content(out, document, end + 1, prefix);
    if (fclose(out) != 0) {
        free(*svg);
        *svg = NULL;
        return sphv_fail(error, SPHV_RESOURCE_FAILURE, "out of memory");
    }
    return SPHV_OK;
}
