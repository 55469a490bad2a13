/// \file scene_reader.h
/// What the readers of a scene file share: the file as libcyaml fills it, and the scene it becomes.
#ifndef SPHVERIFY_SCENE_READER_H
#define SPHVERIFY_SCENE_READER_H

#include "internal.h"
#include "reading.h"

/// The file as libcyaml fills it.
struct sphv_file_abscissa {
    int quantity, scale;
    char *from, *to;
    int points;
    int *markers;
};

struct sphv_file_curve {
    char *id, *label, *kernel, *h, *spacing, *spacing_exponent;
    char *method, *layout, *volume, *sigma;
};

struct sphv_file_realisations {
    int least, most;
    char *width;
    int *seed;
};

struct sphv_file_claim {
    struct sphv_file_stated stated;
    char *measure, *curve, *reference, *from, *to;
    bool *special;
};

struct sphv_file_scene {
    struct sphv_file_head head;
    struct sphv_file_abscissa abscissa;
    struct sphv_file_realisations *realisations;
    struct sphv_file_curve *curves;
    struct sphv_file_claim *claims;
    unsigned curves_count, claims_count;
};

/// The schema of a scene of curves.
extern const cyaml_schema_value_t sphv_scene_schema;

/// Makes a scene of a file loaded against that schema.
sphv_status sphv_scene_read(const char *data_directory, const char *path, const sphv_yaml *yaml,
                            sphv_scene **out, sphv_error *error) SPHV_MUST_CHECK;

/// What the readers below share.
struct sphv_scene_reader {
    const char *data_directory;
    const sphv_yaml *yaml;
    const struct sphv_file_scene *file;
    sphv_scene *scene;
    sphv_error *error;
};

/// Reads a number, or fails with the line of `place`.
sphv_status sphv_scene_number(const struct sphv_scene_reader *of, const char *place,
                              const char *text, sphv_number *out) SPHV_MUST_CHECK;

/// Reads one curve: kernel, what it fixes, and its experiment.
sphv_status sphv_scene_read_curve(const struct sphv_scene_reader *of,
                                  unsigned index) SPHV_MUST_CHECK;

#endif
