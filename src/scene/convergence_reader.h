/// \file convergence_reader.h
/// What the readers of a convergence scene share: the file as libcyaml fills it, and the scene.
#ifndef SPHVERIFY_CONVERGENCE_READER_H
#define SPHVERIFY_CONVERGENCE_READER_H

#include "reading.h"
#include "sphverify/convergence.h"

/// The file as libcyaml fills it.
struct sphv_rates_box {
    char *id, *layout, *placement, *jitter, *amplitude, *volume;
    bool *reflected;
    unsigned *seed;
};

struct sphv_rates_field {
    char *id, *field;
};

struct sphv_rates_h {
    char *factor, *of, *exponent;
};

struct sphv_rates_scheme {
    char *id, *label, *kernel, *method, *box;
    struct sphv_rates_h h;
};

struct sphv_rates_term {
    char *coefficient, **powers;
    unsigned powers_count;
};

struct sphv_rates_series {
    char *scheme, *quantity, *metric, *against;
    bool *per_neighbour, *interior, *alone;
    unsigned *first, *last;
};

struct sphv_rates_evidence {
    char *statement, *scheme, *metric;
    bool *per_neighbour, *interior, *matches;
    unsigned *first, *last;
    struct sphv_rates_term *without;
    unsigned without_count;
};

struct sphv_rates_exception {
    char *quantity, *scheme, *why;
    struct sphv_rates_evidence *evidence;
    unsigned evidence_count;
};

struct sphv_rates_group {
    char *label, *tolerance, *rms, *reason, **columns;
    bool *per_neighbour;
    unsigned columns_count;
};

struct sphv_rates_row {
    char *quantity, **printed, **limits;
    unsigned printed_count, limits_count;
};

struct sphv_rates_table {
    char **columns;
    struct sphv_rates_group *groups;
    struct sphv_rates_row *rows;
    struct sphv_rates_exception *exceptions;
    unsigned columns_count, groups_count, rows_count, exceptions_count;
};

struct sphv_rates_listed {
    char *scheme, **neighbours, **h;
    unsigned neighbours_count, h_count;
};

struct sphv_rates_claim {
    struct sphv_file_stated stated;
    char *measure;
    struct sphv_rates_series series;
};

struct sphv_rates_plot {
    char *id, *title, **schemes, **trends;
    bool *picture;
    struct sphv_rates_series series;
    unsigned schemes_count, trends_count;
};

struct sphv_rates_measure {
    char *quantity, *measure;
};

struct sphv_rates_file {
    char *kind;
    struct sphv_file_head head;
    int dimension;
    char **particles, **ratios;
    struct sphv_rates_box *boxes;
    struct sphv_rates_field *fields;
    struct sphv_rates_scheme *schemes;
    struct sphv_rates_table *table;
    struct sphv_rates_listed *listed;
    struct sphv_rates_claim *claims;
    struct sphv_rates_plot *plots;
    struct sphv_rates_measure *measures;
    unsigned measures_count, particles_count, ratios_count, boxes_count, fields_count,
        schemes_count, claims_count, plots_count;
};

extern const cyaml_schema_value_t sphv_rates_schema;

/// What the readers below share.
struct sphv_rates_reader {
    const char *data_directory;
    const sphv_yaml *yaml;
    const struct sphv_rates_file *file;
    sphv_convergence *scene;
    sphv_error *error;
};

/// Fails with the line of a place of the file.
#define SPHV_RATES_FAIL(of, place, ...)                                                            \
    sphv_yaml_fail((of)->yaml, (place), (of)->error, __VA_ARGS__)

/// Reads a number such as `-1/6`; `otherwise` where the text is NULL.
sphv_status sphv_rates_number(const struct sphv_rates_reader *of, const char *place,
                              const char *text, double otherwise, double *out) SPHV_MUST_CHECK;
/// Reads an expression such as `sqrt(13/4/pi)`.
sphv_status sphv_rates_constant(const struct sphv_rates_reader *of, const char *place,
                                const char *text, double otherwise, double *out) SPHV_MUST_CHECK;
/// Reads a name of a table of names; `otherwise` where the text is NULL.
sphv_status sphv_rates_name(const struct sphv_rates_reader *of, const char *place, const char *text,
                            const sphv_name_row *rows, int otherwise, int *out) SPHV_MUST_CHECK;
sphv_status sphv_rates_find_scheme(const struct sphv_rates_reader *of, const char *place,
                                   const char *id, size_t *out) SPHV_MUST_CHECK;
sphv_status sphv_rates_find_target(const struct sphv_rates_reader *of, const char *place,
                                   const char *name, size_t *out) SPHV_MUST_CHECK;
/// First and last level, counted from 1 in the file.
sphv_status sphv_rates_levels(const struct sphv_rates_reader *of, const char *place,
                              const unsigned *first, const unsigned *last,
                              sphv_series *series) SPHV_MUST_CHECK;
/// A whole series. \param plot where schemes come from a list, so that none has to be named
sphv_status sphv_rates_series(const struct sphv_rates_reader *of, const char *place,
                              const struct sphv_rates_series *file, bool plot,
                              sphv_series *series) SPHV_MUST_CHECK;
/// Adds a target without an exact value, or finds the one there is.
sphv_status sphv_rates_add_alone(const struct sphv_rates_reader *of, size_t target,
                                 size_t *out) SPHV_MUST_CHECK;
/// Adds a target with a wrong exact value.
sphv_status sphv_rates_add_altered(const struct sphv_rates_reader *of, const char *place,
                                   size_t target, const struct sphv_rates_evidence *file,
                                   size_t *out) SPHV_MUST_CHECK;

/// The parts of a file.
sphv_status sphv_rates_read_measures(const struct sphv_rates_reader *of) SPHV_MUST_CHECK;
sphv_status sphv_rates_read_particles(const struct sphv_rates_reader *of) SPHV_MUST_CHECK;
sphv_status sphv_rates_read_schemes(const struct sphv_rates_reader *of) SPHV_MUST_CHECK;
sphv_status sphv_rates_read_targets(const struct sphv_rates_reader *of) SPHV_MUST_CHECK;
sphv_status sphv_rates_read_table(const struct sphv_rates_reader *of) SPHV_MUST_CHECK;
sphv_status sphv_rates_read_claims(const struct sphv_rates_reader *of) SPHV_MUST_CHECK;
sphv_status sphv_rates_read_plots(const struct sphv_rates_reader *of) SPHV_MUST_CHECK;

#endif
