/// \file text.h
/// Text from users and numbers, written so that the target format cannot mistake them for code.
#ifndef SPHVERIFY_REPORT_TEXT_H
#define SPHVERIFY_REPORT_TEXT_H

#include <stdbool.h>
#include <stdio.h>

#include "sphverify/compare.h"

/// One character of UTF-8 text, at most 4 bytes. What is not valid UTF-8 becomes U+FFFD, control
/// characters become blanks, so that one line stays one line.
/// \param text advances to the next character
/// \param out  receives the character, ended by '\0'
/// \return false at the end of the text
bool sphv_text_next(const char **text, char out[5]);

/// Text as HTML or XML content or attribute value.
void sphv_put_html(FILE *stream, const char *text);

/// Text as Markdown that shows it literally, on one line.
void sphv_put_markdown(FILE *stream, const char *text);

/// Text as one field of CSV (RFC 4180), quoted where it has to be.
void sphv_put_csv(FILE *stream, const char *text);

/// Text as a gnuplot string that holds nothing for gnuplot to interpret.
/// \param limit longer texts end in an ellipsis after this many characters
void sphv_put_gnuplot(FILE *stream, const char *text, int limit);

/// Number of characters (not bytes) of a text.
int sphv_text_length(const char *text);

enum { SPHV_NUMBER_TEXT = 40 };

/// A number for people: `digits` significant digits, `–` where there is none.
/// \return text, which receives it
const char *sphv_number_text(char text[SPHV_NUMBER_TEXT], double value, int digits);

/// `1 point`, `2 points`.
const char *sphv_plural(size_t count, const char *one, const char *many);

#endif
