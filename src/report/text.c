#include "text.h"

#include <math.h>
#include <string.h>

/// Length of the valid UTF-8 sequence at the beginning of a text; 0 when there is none.
static int sequence_length(const unsigned char *text)
{
    if (text[0] < 0x80) return 1;
    int length = text[0] >= 0xF0 ? 4 : text[0] >= 0xE0 ? 3 : 2;
    if (text[0] < 0xC2 || text[0] > 0xF4) return 0;
    for (int i = 1; i < length; i++)
        if ((text[i] & 0xC0) != 0x80) return 0;
    // Overlong forms, surrogates, and beyond U+10FFFF.
    if ((text[0] == 0xE0 && text[1] < 0xA0) || (text[0] == 0xED && text[1] > 0x9F) ||
        (text[0] == 0xF0 && text[1] < 0x90) || (text[0] == 0xF4 && text[1] > 0x8F))
        return 0;
    return length;
}

/// C0, DEL, C1, the line separators U+2028–9, and U+FFFE–F, which XML refuses.
static bool is_control(const char *c, int length)
{
    const unsigned char *u = (const unsigned char *)c;
    if (length == 1) return u[0] < 0x20 || u[0] == 0x7F;
    if (length == 2) return u[0] == 0xC2 && u[1] < 0xA0;
    return length == 3 && (memcmp(c, "\xE2\x80\xA8", 3) == 0 || memcmp(c, "\xE2\x80\xA9", 3) == 0 ||
                           memcmp(c, "\xEF\xBF\xBE", 3) == 0 || memcmp(c, "\xEF\xBF\xBF", 3) == 0);
}

bool sphv_text_next(const char **text, char out[5])
{
    if (!**text) return false;
    int length = sequence_length((const unsigned char *)*text);
    if (length == 0) {
        memcpy(out, "\xEF\xBF\xBD", 4);
        (*text)++;
        return true;
    }
    memcpy(out, *text, (size_t)length);
    out[length] = '\0';
    if (is_control(out, length)) memcpy(out, " ", 2);
    *text += length;
    return true;
}

int sphv_text_length(const char *text)
{
    char c[5];
    int length = 0;
    while (sphv_text_next(&text, c)) length++;
    return length;
}

/// What stands for a character that would be taken for code.
struct escape {
    char character;
    const char *written;
};

static const struct escape html_escapes[] = {{'&', "&amp;"},  {'<', "&lt;"},   {'>', "&gt;"},
                                             {'"', "&quot;"}, {'\'', "&#39;"}, {0, NULL}};

/// Entities work where Markdown or a table around it would not honour a backslash.
static const struct escape markdown_escapes[] = {{'&', "&amp;"},  {'<', "&lt;"},  {'>', "&gt;"},
                                                 {'|', "&#124;"}, {'@', "&#64;"}, {0, NULL}};

static const char *escaped(const struct escape *escapes, const char *c)
{
    for (; escapes->written; escapes++)
        if (escapes->character == c[0]) return escapes->written;
    return NULL;
}

void sphv_put_html(FILE *stream, const char *text)
{
    char c[5];
    while (sphv_text_next(&text, c)) {
        const char *written = escaped(html_escapes, c);
        fputs(written ? written : c, stream);
    }
}

void sphv_put_markdown(FILE *stream, const char *text)
{
    char c[5];
    while (sphv_text_next(&text, c)) {
        const char *written = escaped(markdown_escapes, c);
        // Parentheses and braces mean nothing once the square brackets are escaped.
        if (strchr("\\`*_[]#~$", c[0])) fputc('\\', stream);
        // No automatic links.
        if (c[0] == ':' && text[0] == '/') written = "&#58;";
        fputs(written ? written : c, stream);
    }
}

void sphv_put_csv(FILE *stream, const char *text)
{
    char c[5];
    bool quoted = strpbrk(text, ",\"\r\n;\t") || *text == ' ';
    // A spreadsheet runs a field that begins like a formula.
    if (*text && strchr("=+-@", *text)) {
        quoted = true;
        fputs("\"'", stream);
    } else if (quoted) {
        fputc('"', stream);
    }
    while (sphv_text_next(&text, c)) {
        if (c[0] == '"') fputc('"', stream);
        fputs(c, stream);
    }
    if (quoted) fputc('"', stream);
}

void sphv_put_gnuplot(FILE *stream, const char *text, int limit)
{
    char c[5];
    int written = 0, length = sphv_text_length(text);
    fputc('"', stream);
    while (sphv_text_next(&text, c)) {
        if (++written >= limit && length > limit) {
            fputs("…", stream);
            break;
        }
        // As octal codes, which gnuplot reads after it has looked for anything to substitute. A
        // digit after one would be taken for a part of it, so the string ends and goes on.
        if (strchr("\"\\`@'#${}!", c[0]))
            fprintf(stream, "\\%03o\" . \"", (unsigned)c[0]);
        else
            fputs(c, stream);
    }
    fputc('"', stream);
}

const char *sphv_number_text(char text[SPHV_NUMBER_TEXT], double value, int digits)
{
    if (!isfinite(value)) {
        memcpy(text, "–", sizeof "–");
        return text;
    }
    char plain[SPHV_NUMBER_TEXT - 4];
    snprintf(plain, sizeof plain, "%.*g", digits, value == 0 ? 0 : value); // no minus zero
    // A true minus sign, and exponents without padding.
    char *to = text;
    for (const char *from = plain; *from; from++) {
        if (*from == '-') {
            memcpy(to, "−", sizeof "−" - 1);
            to += sizeof "−" - 1;
        } else if (*from == '+' || (*from == '0' && from > plain + 1 && strchr("+-", from[-1]))) {
            continue;
        } else {
            *to++ = *from;
        }
    }
    *to = '\0';
    return text;
}

const char *sphv_plural(size_t count, const char *one, const char *many)
{
    return count == 1 ? one : many;
}
