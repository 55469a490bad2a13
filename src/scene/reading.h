/// \file reading.h
/// What the readers of both kinds of scene files share: the head of a file, the texts of a claim.
#ifndef SPHVERIFY_SCENE_READING_H
#define SPHVERIFY_SCENE_READING_H

#include "core/yaml_file.h"
#include "sphverify/kernel.h"

enum { SPHV_OPTIONAL = CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL };

/// A field of 1 to `longest` characters.
#define SPHV_TEXT(key, flags, structure, member, longest)                                          \
    CYAML_FIELD_STRING_PTR(key, flags, structure, member, 1, longest)

/// The head of a file as libcyaml fills it: member `head` of the struct.
struct sphv_file_head {
    char *name, *title, *source, *notes;
};

#define SPHV_HEAD_FIELDS(structure)                                                                \
    SPHV_TEXT("name", CYAML_FLAG_POINTER, structure, head.name, 64),                               \
        SPHV_TEXT("title", CYAML_FLAG_POINTER, structure, head.title, 200),                        \
        SPHV_TEXT("source", CYAML_FLAG_POINTER, structure, head.source, 400),                      \
        SPHV_TEXT("notes", SPHV_OPTIONAL, structure, head.notes, 4000)

/// What every claim states, as libcyaml fills it: member `stated` of the struct.
struct sphv_file_stated {
    char *id, *statement, *expected, *tolerance, *reason, *refuted;
};

#define SPHV_STATED_FIRST(structure)                                                               \
    SPHV_TEXT("id", CYAML_FLAG_POINTER, structure, stated.id, 60),                                 \
        SPHV_TEXT("statement", CYAML_FLAG_POINTER, structure, stated.statement, 600)
#define SPHV_STATED_LAST(structure)                                                                \
    SPHV_TEXT("expected", CYAML_FLAG_POINTER, structure, stated.expected, 80),                     \
        SPHV_TEXT("tolerance", CYAML_FLAG_POINTER, structure, stated.tolerance, 80),               \
        SPHV_TEXT("reason", CYAML_FLAG_POINTER, structure, stated.reason, 600),                    \
        SPHV_TEXT("refuted", SPHV_OPTIONAL, structure, stated.refuted, 900)

/// Where the texts of a scene's head, or of a claim, belong, whatever kind it is of.
struct sphv_head_texts {
    char **path, **name, **title, **source, **notes;
};
struct sphv_claim_texts {
    char **id, **statement, **reason, **refuted;
};
#define SPHV_HEAD_OF(scene)                                                                        \
    ((struct sphv_head_texts){&(scene)->path, &(scene)->name, &(scene)->title, &(scene)->source,   \
                              &(scene)->notes})
#define SPHV_TEXTS_OF(claim)                                                                       \
    ((struct sphv_claim_texts){&(claim)->id, &(claim)->statement, &(claim)->reason,                \
                               &(claim)->refuted})

/// Copies a text; NULL becomes "".
sphv_status sphv_copy_text(const char *from, char **to, sphv_error *error) SPHV_MUST_CHECK;

/// Copies the head; the name must be one that a file can have.
sphv_status sphv_read_head(const sphv_yaml *yaml, const char *path,
                           const struct sphv_file_head *file, struct sphv_head_texts to,
                           sphv_error *error) SPHV_MUST_CHECK;
void sphv_free_head(struct sphv_head_texts of);

/// Copies the texts of a claim; `refuted` stays NULL where the file has none.
sphv_status sphv_read_claim_texts(const struct sphv_file_stated *file, struct sphv_claim_texts to,
                                  sphv_error *error) SPHV_MUST_CHECK;
void sphv_free_claim_texts(struct sphv_claim_texts of);

/// Loads a kernel, or fails with the line of `place`.
sphv_status sphv_read_kernel(const sphv_yaml *yaml, const char *place, const char *data_directory,
                             const char *name, sphv_kernel **out,
                             sphv_error *error) SPHV_MUST_CHECK;

#endif
