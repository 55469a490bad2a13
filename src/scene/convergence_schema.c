#include "convergence_reader.h"

enum { OPTIONAL = CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL };

#define TEXT(key, flags, structure, member, longest)                                               \
    CYAML_FIELD_STRING_PTR(key, flags, structure, member, 1, longest)
#define TEXTS(key, flags, structure, member, most)                                                 \
    CYAML_FIELD_SEQUENCE(key, flags, structure, member, &text_entry, 1, most)
#define LIST(key, flags, structure, member, entry, least, most)                                    \
    CYAML_FIELD_SEQUENCE(key, flags, structure, member, &(entry), least, most)

static const cyaml_schema_value_t text_entry = {
    CYAML_VALUE_STRING(CYAML_FLAG_POINTER, char, 1, 100)};

static const cyaml_schema_field_t box_fields[] = {
    TEXT("id", CYAML_FLAG_POINTER, struct sphv_rates_box, id, 60),
    TEXT("layout", CYAML_FLAG_POINTER, struct sphv_rates_box, layout, 40),
    TEXT("placement", OPTIONAL, struct sphv_rates_box, placement, 40),
    TEXT("jitter", OPTIONAL, struct sphv_rates_box, jitter, 40),
    TEXT("amplitude", OPTIONAL, struct sphv_rates_box, amplitude, 80),
    CYAML_FIELD_BOOL_PTR("reflected", OPTIONAL, struct sphv_rates_box, reflected),
    TEXT("volume", CYAML_FLAG_POINTER, struct sphv_rates_box, volume, 40),
    CYAML_FIELD_UINT_PTR("seed", OPTIONAL, struct sphv_rates_box, seed),
    CYAML_FIELD_END};

static const cyaml_schema_field_t field_fields[] = {
    TEXT("id", CYAML_FLAG_POINTER, struct sphv_rates_field, id, 40),
    TEXT("field", CYAML_FLAG_POINTER, struct sphv_rates_field, field, 90), CYAML_FIELD_END};

static const cyaml_schema_field_t h_fields[] = {
    TEXT("factor", OPTIONAL, struct sphv_rates_h, factor, 100),
    TEXT("of", CYAML_FLAG_POINTER, struct sphv_rates_h, of, 40),
    TEXT("exponent", OPTIONAL, struct sphv_rates_h, exponent, 80), CYAML_FIELD_END};

static const cyaml_schema_field_t scheme_fields[] = {
    TEXT("id", CYAML_FLAG_POINTER, struct sphv_rates_scheme, id, 60),
    TEXT("label", CYAML_FLAG_POINTER, struct sphv_rates_scheme, label, 100),
    TEXT("kernel", CYAML_FLAG_POINTER, struct sphv_rates_scheme, kernel, 400),
    TEXT("method", OPTIONAL, struct sphv_rates_scheme, method, 40),
    TEXT("box", OPTIONAL, struct sphv_rates_scheme, box, 60),
    CYAML_FIELD_MAPPING("h", CYAML_FLAG_DEFAULT, struct sphv_rates_scheme, h, h_fields),
    CYAML_FIELD_END};

static const cyaml_schema_field_t term_fields[] = {
    TEXT("coefficient", CYAML_FLAG_POINTER, struct sphv_rates_term, coefficient, 80),
    TEXTS("powers", CYAML_FLAG_POINTER, struct sphv_rates_term, powers, SPHV_DIMENSIONS),
    CYAML_FIELD_END};

static const cyaml_schema_value_t term_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct sphv_rates_term, term_fields)};

static const cyaml_schema_field_t evidence_fields[] = {
    TEXT("statement", CYAML_FLAG_POINTER, struct sphv_rates_evidence, statement, 600),
    TEXT("scheme", OPTIONAL, struct sphv_rates_evidence, scheme, 60),
    TEXT("metric", OPTIONAL, struct sphv_rates_evidence, metric, 40),
    CYAML_FIELD_BOOL_PTR("per_neighbour", OPTIONAL, struct sphv_rates_evidence, per_neighbour),
    CYAML_FIELD_BOOL_PTR("interior", OPTIONAL, struct sphv_rates_evidence, interior),
    CYAML_FIELD_BOOL_PTR("matches", OPTIONAL, struct sphv_rates_evidence, matches),
    CYAML_FIELD_UINT_PTR("first", OPTIONAL, struct sphv_rates_evidence, first),
    CYAML_FIELD_UINT_PTR("last", OPTIONAL, struct sphv_rates_evidence, last),
    LIST("without", OPTIONAL, struct sphv_rates_evidence, without, term_entry, 1, 16),
    CYAML_FIELD_END};

static const cyaml_schema_value_t evidence_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct sphv_rates_evidence, evidence_fields)};

static const cyaml_schema_field_t exception_fields[] = {
    TEXT("quantity", CYAML_FLAG_POINTER, struct sphv_rates_exception, quantity, 60),
    TEXT("scheme", CYAML_FLAG_POINTER, struct sphv_rates_exception, scheme, 60),
    TEXT("why", CYAML_FLAG_POINTER, struct sphv_rates_exception, why, 900),
    LIST("evidence", OPTIONAL, struct sphv_rates_exception, evidence, evidence_entry, 0, 16),
    CYAML_FIELD_END};

static const cyaml_schema_field_t group_fields[] = {
    TEXT("label", CYAML_FLAG_POINTER, struct sphv_rates_group, label, 100),
    TEXTS("columns", CYAML_FLAG_POINTER, struct sphv_rates_group, columns, 40),
    CYAML_FIELD_BOOL_PTR("per_neighbour", OPTIONAL, struct sphv_rates_group, per_neighbour),
    TEXT("tolerance", CYAML_FLAG_POINTER, struct sphv_rates_group, tolerance, 80),
    TEXT("rms", OPTIONAL, struct sphv_rates_group, rms, 80),
    TEXT("reason", CYAML_FLAG_POINTER, struct sphv_rates_group, reason, 600),
    CYAML_FIELD_END};

static const cyaml_schema_field_t row_fields[] = {
    TEXT("quantity", CYAML_FLAG_POINTER, struct sphv_rates_row, quantity, 60),
    TEXTS("printed", CYAML_FLAG_POINTER, struct sphv_rates_row, printed, 40),
    TEXTS("limits", OPTIONAL, struct sphv_rates_row, limits, 40), CYAML_FIELD_END};

static const cyaml_schema_value_t group_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct sphv_rates_group, group_fields)};
static const cyaml_schema_value_t row_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct sphv_rates_row, row_fields)};
static const cyaml_schema_value_t exception_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct sphv_rates_exception, exception_fields)};

static const cyaml_schema_field_t table_fields[] = {
    TEXTS("columns", CYAML_FLAG_POINTER, struct sphv_rates_table, columns, 40),
    LIST("groups", CYAML_FLAG_POINTER, struct sphv_rates_table, groups, group_entry, 1, 10),
    LIST("rows", CYAML_FLAG_POINTER, struct sphv_rates_table, rows, row_entry, 1, 60),
    LIST("exceptions", OPTIONAL, struct sphv_rates_table, exceptions, exception_entry, 0, 100),
    CYAML_FIELD_END};

static const cyaml_schema_field_t listed_fields[] = {
    TEXT("scheme", CYAML_FLAG_POINTER, struct sphv_rates_listed, scheme, 60),
    TEXTS("neighbours", CYAML_FLAG_POINTER, struct sphv_rates_listed, neighbours, 64),
    TEXTS("h", CYAML_FLAG_POINTER, struct sphv_rates_listed, h, 64), CYAML_FIELD_END};

#define SERIES(structure)                                                                          \
    TEXT("scheme", OPTIONAL, structure, series.scheme, 60),                                        \
        TEXT("quantity", OPTIONAL, structure, series.quantity, 60),                                \
        TEXT("metric", OPTIONAL, structure, series.metric, 40),                                    \
        TEXT("against", OPTIONAL, structure, series.against, 40),                                  \
        CYAML_FIELD_BOOL_PTR("per_neighbour", OPTIONAL, structure, series.per_neighbour),          \
        CYAML_FIELD_BOOL_PTR("interior", OPTIONAL, structure, series.interior),                    \
        CYAML_FIELD_BOOL_PTR("alone", OPTIONAL, structure, series.alone),                          \
        CYAML_FIELD_UINT_PTR("first", OPTIONAL, structure, series.first),                          \
        CYAML_FIELD_UINT_PTR("last", OPTIONAL, structure, series.last)

static const cyaml_schema_field_t claim_fields[] = {
    TEXT("id", CYAML_FLAG_POINTER, struct sphv_rates_claim, id, 60),
    TEXT("statement", CYAML_FLAG_POINTER, struct sphv_rates_claim, statement, 600),
    TEXT("measure", CYAML_FLAG_POINTER, struct sphv_rates_claim, measure, 40),
    SERIES(struct sphv_rates_claim),
    TEXT("expected", CYAML_FLAG_POINTER, struct sphv_rates_claim, expected, 80),
    TEXT("tolerance", CYAML_FLAG_POINTER, struct sphv_rates_claim, tolerance, 80),
    TEXT("reason", CYAML_FLAG_POINTER, struct sphv_rates_claim, reason, 600),
    TEXT("refuted", OPTIONAL, struct sphv_rates_claim, refuted, 900),
    CYAML_FIELD_END};

static const cyaml_schema_field_t plot_fields[] = {
    TEXT("id", CYAML_FLAG_POINTER, struct sphv_rates_plot, id, 60),
    TEXT("title", CYAML_FLAG_POINTER, struct sphv_rates_plot, title, 200),
    SERIES(struct sphv_rates_plot),
    CYAML_FIELD_BOOL_PTR("picture", OPTIONAL, struct sphv_rates_plot, picture),
    TEXTS("schemes", OPTIONAL, struct sphv_rates_plot, schemes, 40),
    TEXTS("trends", OPTIONAL, struct sphv_rates_plot, trends, SPHV_TRENDS_MAX),
    CYAML_FIELD_END};

static const cyaml_schema_field_t measure_fields[] = {
    TEXT("quantity", CYAML_FLAG_POINTER, struct sphv_rates_measure, quantity, 60),
    TEXT("measure", CYAML_FLAG_POINTER, struct sphv_rates_measure, measure, 40), CYAML_FIELD_END};

static const cyaml_schema_value_t measure_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct sphv_rates_measure, measure_fields)};
static const cyaml_schema_value_t box_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct sphv_rates_box, box_fields)};
static const cyaml_schema_value_t field_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct sphv_rates_field, field_fields)};
static const cyaml_schema_value_t scheme_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct sphv_rates_scheme, scheme_fields)};
static const cyaml_schema_value_t claim_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct sphv_rates_claim, claim_fields)};
static const cyaml_schema_value_t plot_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct sphv_rates_plot, plot_fields)};

static const cyaml_schema_field_t file_fields[] = {
    TEXT("kind", CYAML_FLAG_POINTER, struct sphv_rates_file, kind, 40),
    TEXT("name", CYAML_FLAG_POINTER, struct sphv_rates_file, name, 64),
    TEXT("title", CYAML_FLAG_POINTER, struct sphv_rates_file, title, 200),
    TEXT("source", CYAML_FLAG_POINTER, struct sphv_rates_file, source, 400),
    TEXT("notes", OPTIONAL, struct sphv_rates_file, notes, 4000),
    CYAML_FIELD_INT("dimension", CYAML_FLAG_DEFAULT, struct sphv_rates_file, dimension),
    TEXTS("particles", CYAML_FLAG_POINTER, struct sphv_rates_file, particles, 64),
    TEXTS("ratios", OPTIONAL, struct sphv_rates_file, ratios, 64),
    LIST("boxes", CYAML_FLAG_POINTER, struct sphv_rates_file, boxes, box_entry, 1, 16),
    LIST("fields", OPTIONAL, struct sphv_rates_file, fields, field_entry, 0, 8),
    LIST("schemes", CYAML_FLAG_POINTER, struct sphv_rates_file, schemes, scheme_entry, 1, 40),
    CYAML_FIELD_MAPPING_PTR("table", OPTIONAL, struct sphv_rates_file, table, table_fields),
    CYAML_FIELD_MAPPING_PTR("printed_levels", OPTIONAL, struct sphv_rates_file, listed,
                            listed_fields),
    LIST("consistency", OPTIONAL, struct sphv_rates_file, measures, measure_entry, 0, 10),
    LIST("claims", OPTIONAL, struct sphv_rates_file, claims, claim_entry, 0, 100),
    LIST("plots", OPTIONAL, struct sphv_rates_file, plots, plot_entry, 0, 40),
    CYAML_FIELD_END};

const cyaml_schema_value_t sphv_rates_schema = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_POINTER, struct sphv_rates_file, file_fields)};
