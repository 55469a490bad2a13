#include "convergence_reader.h"

#define TEXTS(key, flags, structure, member, most)                                                 \
    CYAML_FIELD_SEQUENCE(key, flags, structure, member, &text_entry, 1, most)
#define LIST(key, flags, structure, member, entry, least, most)                                    \
    CYAML_FIELD_SEQUENCE(key, flags, structure, member, &(entry), least, most)

static const cyaml_schema_value_t text_entry = {
    CYAML_VALUE_STRING(CYAML_FLAG_POINTER, char, 1, 100)};

static const cyaml_schema_field_t box_fields[] = {
    SPHV_TEXT("id", CYAML_FLAG_POINTER, struct sphv_rates_box, id, 60),
    SPHV_TEXT("layout", CYAML_FLAG_POINTER, struct sphv_rates_box, layout, 40),
    SPHV_TEXT("placement", SPHV_OPTIONAL, struct sphv_rates_box, placement, 40),
    SPHV_TEXT("jitter", SPHV_OPTIONAL, struct sphv_rates_box, jitter, 40),
    SPHV_TEXT("amplitude", SPHV_OPTIONAL, struct sphv_rates_box, amplitude, 80),
    CYAML_FIELD_BOOL_PTR("reflected", SPHV_OPTIONAL, struct sphv_rates_box, reflected),
    SPHV_TEXT("volume", CYAML_FLAG_POINTER, struct sphv_rates_box, volume, 40),
    CYAML_FIELD_UINT_PTR("seed", SPHV_OPTIONAL, struct sphv_rates_box, seed),
    CYAML_FIELD_END};

static const cyaml_schema_field_t field_fields[] = {
    SPHV_TEXT("id", CYAML_FLAG_POINTER, struct sphv_rates_field, id, 40),
    SPHV_TEXT("field", CYAML_FLAG_POINTER, struct sphv_rates_field, field, 90), CYAML_FIELD_END};

static const cyaml_schema_field_t h_fields[] = {
    SPHV_TEXT("factor", SPHV_OPTIONAL, struct sphv_rates_h, factor, 100),
    SPHV_TEXT("of", CYAML_FLAG_POINTER, struct sphv_rates_h, of, 40),
    SPHV_TEXT("exponent", SPHV_OPTIONAL, struct sphv_rates_h, exponent, 80), CYAML_FIELD_END};

static const cyaml_schema_field_t scheme_fields[] = {
    SPHV_TEXT("id", CYAML_FLAG_POINTER, struct sphv_rates_scheme, id, 60),
    SPHV_TEXT("label", CYAML_FLAG_POINTER, struct sphv_rates_scheme, label, 100),
    SPHV_TEXT("kernel", CYAML_FLAG_POINTER, struct sphv_rates_scheme, kernel, 400),
    SPHV_TEXT("method", SPHV_OPTIONAL, struct sphv_rates_scheme, method, 40),
    SPHV_TEXT("box", SPHV_OPTIONAL, struct sphv_rates_scheme, box, 60),
    CYAML_FIELD_MAPPING("h", CYAML_FLAG_DEFAULT, struct sphv_rates_scheme, h, h_fields),
    CYAML_FIELD_END};

static const cyaml_schema_field_t term_fields[] = {
    SPHV_TEXT("coefficient", CYAML_FLAG_POINTER, struct sphv_rates_term, coefficient, 80),
    TEXTS("powers", CYAML_FLAG_POINTER, struct sphv_rates_term, powers, SPHV_DIMENSIONS),
    CYAML_FIELD_END};

static const cyaml_schema_value_t term_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct sphv_rates_term, term_fields)};

static const cyaml_schema_field_t evidence_fields[] = {
    SPHV_TEXT("statement", CYAML_FLAG_POINTER, struct sphv_rates_evidence, statement, 600),
    SPHV_TEXT("scheme", SPHV_OPTIONAL, struct sphv_rates_evidence, scheme, 60),
    SPHV_TEXT("metric", SPHV_OPTIONAL, struct sphv_rates_evidence, metric, 40),
    CYAML_FIELD_BOOL_PTR("per_neighbour", SPHV_OPTIONAL, struct sphv_rates_evidence, per_neighbour),
    CYAML_FIELD_BOOL_PTR("interior", SPHV_OPTIONAL, struct sphv_rates_evidence, interior),
    CYAML_FIELD_BOOL_PTR("matches", SPHV_OPTIONAL, struct sphv_rates_evidence, matches),
    CYAML_FIELD_UINT_PTR("first", SPHV_OPTIONAL, struct sphv_rates_evidence, first),
    CYAML_FIELD_UINT_PTR("last", SPHV_OPTIONAL, struct sphv_rates_evidence, last),
    LIST("without", SPHV_OPTIONAL, struct sphv_rates_evidence, without, term_entry, 1, 16),
    CYAML_FIELD_END};

static const cyaml_schema_value_t evidence_entry = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, struct sphv_rates_evidence, evidence_fields)};

static const cyaml_schema_field_t exception_fields[] = {
    SPHV_TEXT("quantity", CYAML_FLAG_POINTER, struct sphv_rates_exception, quantity, 60),
    SPHV_TEXT("scheme", CYAML_FLAG_POINTER, struct sphv_rates_exception, scheme, 60),
    SPHV_TEXT("why", CYAML_FLAG_POINTER, struct sphv_rates_exception, why, 900),
    LIST("evidence", SPHV_OPTIONAL, struct sphv_rates_exception, evidence, evidence_entry, 0, 16),
    CYAML_FIELD_END};

static const cyaml_schema_field_t group_fields[] = {
    SPHV_TEXT("label", CYAML_FLAG_POINTER, struct sphv_rates_group, label, 100),
    TEXTS("columns", CYAML_FLAG_POINTER, struct sphv_rates_group, columns, 40),
    CYAML_FIELD_BOOL_PTR("per_neighbour", SPHV_OPTIONAL, struct sphv_rates_group, per_neighbour),
    SPHV_TEXT("tolerance", CYAML_FLAG_POINTER, struct sphv_rates_group, tolerance, 80),
    SPHV_TEXT("rms", SPHV_OPTIONAL, struct sphv_rates_group, rms, 80),
    SPHV_TEXT("reason", CYAML_FLAG_POINTER, struct sphv_rates_group, reason, 600),
    CYAML_FIELD_END};

static const cyaml_schema_field_t row_fields[] = {
    SPHV_TEXT("quantity", CYAML_FLAG_POINTER, struct sphv_rates_row, quantity, 60),
    TEXTS("printed", CYAML_FLAG_POINTER, struct sphv_rates_row, printed, 40),
    TEXTS("limits", SPHV_OPTIONAL, struct sphv_rates_row, limits, 40), CYAML_FIELD_END};

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
    LIST("exceptions", SPHV_OPTIONAL, struct sphv_rates_table, exceptions, exception_entry, 0, 100),
    CYAML_FIELD_END};

static const cyaml_schema_field_t listed_fields[] = {
    SPHV_TEXT("scheme", CYAML_FLAG_POINTER, struct sphv_rates_listed, scheme, 60),
    TEXTS("neighbours", CYAML_FLAG_POINTER, struct sphv_rates_listed, neighbours, 64),
    TEXTS("h", CYAML_FLAG_POINTER, struct sphv_rates_listed, h, 64), CYAML_FIELD_END};

#define SERIES(structure)                                                                          \
    SPHV_TEXT("scheme", SPHV_OPTIONAL, structure, series.scheme, 60),                              \
        SPHV_TEXT("quantity", SPHV_OPTIONAL, structure, series.quantity, 60),                      \
        SPHV_TEXT("metric", SPHV_OPTIONAL, structure, series.metric, 40),                          \
        SPHV_TEXT("against", SPHV_OPTIONAL, structure, series.against, 40),                        \
        CYAML_FIELD_BOOL_PTR("per_neighbour", SPHV_OPTIONAL, structure, series.per_neighbour),     \
        CYAML_FIELD_BOOL_PTR("interior", SPHV_OPTIONAL, structure, series.interior),               \
        CYAML_FIELD_BOOL_PTR("alone", SPHV_OPTIONAL, structure, series.alone),                     \
        CYAML_FIELD_UINT_PTR("first", SPHV_OPTIONAL, structure, series.first),                     \
        CYAML_FIELD_UINT_PTR("last", SPHV_OPTIONAL, structure, series.last)

static const cyaml_schema_field_t claim_fields[] = {
    SPHV_STATED_FIRST(struct sphv_rates_claim),
    SPHV_TEXT("measure", CYAML_FLAG_POINTER, struct sphv_rates_claim, measure, 40),
    SERIES(struct sphv_rates_claim), SPHV_STATED_LAST(struct sphv_rates_claim), CYAML_FIELD_END};

static const cyaml_schema_field_t plot_fields[] = {
    SPHV_TEXT("id", CYAML_FLAG_POINTER, struct sphv_rates_plot, id, 60),
    SPHV_TEXT("title", CYAML_FLAG_POINTER, struct sphv_rates_plot, title, 200),
    SERIES(struct sphv_rates_plot),
    CYAML_FIELD_BOOL_PTR("picture", SPHV_OPTIONAL, struct sphv_rates_plot, picture),
    TEXTS("schemes", SPHV_OPTIONAL, struct sphv_rates_plot, schemes, 40),
    TEXTS("trends", SPHV_OPTIONAL, struct sphv_rates_plot, trends, SPHV_TRENDS_MAX),
    CYAML_FIELD_END};

static const cyaml_schema_field_t measure_fields[] = {
    SPHV_TEXT("quantity", CYAML_FLAG_POINTER, struct sphv_rates_measure, quantity, 60),
    SPHV_TEXT("measure", CYAML_FLAG_POINTER, struct sphv_rates_measure, measure, 40),
    CYAML_FIELD_END};

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
    SPHV_TEXT("kind", CYAML_FLAG_POINTER, struct sphv_rates_file, kind, 40),
    SPHV_HEAD_FIELDS(struct sphv_rates_file),
    CYAML_FIELD_INT("dimension", CYAML_FLAG_DEFAULT, struct sphv_rates_file, dimension),
    TEXTS("particles", CYAML_FLAG_POINTER, struct sphv_rates_file, particles, 64),
    TEXTS("ratios", SPHV_OPTIONAL, struct sphv_rates_file, ratios, 64),
    LIST("boxes", CYAML_FLAG_POINTER, struct sphv_rates_file, boxes, box_entry, 1, 16),
    LIST("fields", SPHV_OPTIONAL, struct sphv_rates_file, fields, field_entry, 0, 8),
    LIST("schemes", CYAML_FLAG_POINTER, struct sphv_rates_file, schemes, scheme_entry, 1, 40),
    CYAML_FIELD_MAPPING_PTR("table", SPHV_OPTIONAL, struct sphv_rates_file, table, table_fields),
    CYAML_FIELD_MAPPING_PTR("printed_levels", SPHV_OPTIONAL, struct sphv_rates_file, listed,
                            listed_fields),
    LIST("consistency", SPHV_OPTIONAL, struct sphv_rates_file, measures, measure_entry, 0, 10),
    LIST("claims", SPHV_OPTIONAL, struct sphv_rates_file, claims, claim_entry, 0, 100),
    LIST("plots", SPHV_OPTIONAL, struct sphv_rates_file, plots, plot_entry, 0, 40),
    CYAML_FIELD_END};

const cyaml_schema_value_t sphv_rates_schema = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_POINTER, struct sphv_rates_file, file_fields)};
