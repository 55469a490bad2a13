/// YAML files against a schema: each kind of bad file gives one line that names the place.
#include "core/yaml_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "support.h"

struct inner {
    int count;
    bool flag;
};

struct outer {
    char *name;
    struct inner *inner;
    char **words;
    unsigned words_count;
};

static const cyaml_schema_value_t word = {CYAML_VALUE_STRING(CYAML_FLAG_POINTER, char, 1, 8)};
static const cyaml_schema_field_t inner_fields[] = {
    CYAML_FIELD_INT("count", CYAML_FLAG_DEFAULT, struct inner, count),
    CYAML_FIELD_BOOL("flag", CYAML_FLAG_OPTIONAL, struct inner, flag), CYAML_FIELD_END};
static const cyaml_schema_field_t outer_fields[] = {
    CYAML_FIELD_STRING_PTR("name", CYAML_FLAG_POINTER, struct outer, name, 1, 10),
    CYAML_FIELD_MAPPING_PTR("inner", CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct outer, inner,
                            inner_fields),
    CYAML_FIELD_SEQUENCE("words", CYAML_FLAG_POINTER | CYAML_FLAG_OPTIONAL, struct outer, words,
                         &word, 1, 3),
    CYAML_FIELD_END};
static const cyaml_schema_value_t schema = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_POINTER, struct outer, outer_fields)};

static sphv_status load_bytes(const void *bytes, size_t size, sphv_yaml **out, sphv_error *error)
{
    char *folder = folder_make(), *path = file_write_bytes(folder, "f.yaml", bytes, size);
    sphv_status status = sphv_yaml_load(path, &schema, out, error);
    free(path);
    folder_remove(folder);
    return status;
}

static sphv_status load_text(const char *text, sphv_yaml **out, sphv_error *error)
{
    return load_bytes(text, strlen(text), out, error);
}

static void assert_refused(const char *text, const char *place, const char *part)
{
    sphv_yaml *yaml = NULL;
    sphv_error error = {SPHV_OK, ""};
    sphv_status status = load_text(text, &yaml, &error);
    assert_failed(status, &error, SPHV_INVALID_INPUT, part);
    assert_failed(status, &error, SPHV_INVALID_INPUT, place);
}

static void test_a_good_file(void **state)
{
    (void)state;
    sphv_yaml *yaml = NULL;
    sphv_error error = {SPHV_OK, ""};
    assert_ok(load_text("# c\nname: a b\ninner:\n  count: -7\n  flag: true\nwords: [x, 'y z']\n",
                        &yaml, &error),
              error);
    const struct outer *data = sphv_yaml_data(yaml);
    assert_string_equal(data->name, "a b");
    assert_int_equal(data->inner->count, -7);
    assert_true(data->inner->flag);
    assert_int_equal(data->words_count, 2);
    assert_string_equal(data->words[1], "y z");
    assert_int_equal(sphv_yaml_line(yaml, "inner.flag"), 5);
    assert_int_equal(sphv_yaml_line(yaml, "words.1"), 6);
    assert_int_equal(sphv_yaml_line(yaml, "inner.nothing"), 4); // where the mapping begins
    assert_int_equal(sphv_yaml_line(yaml, "words.99"), 6);
    assert_int_equal(sphv_yaml_fail(yaml, "inner.count", &error, "%d is odd", -7),
                     SPHV_INVALID_INPUT);
    assert_non_null(strstr(error.message, "f.yaml:4: -7 is odd"));
    sphv_yaml_free(yaml);
    sphv_yaml_free(NULL);
}

static void test_bad_texts(void **state)
{
    (void)state;
    static const struct {
        const char *text, *place, *part;
    } cases[] = {
        {"", ":1:", "empty"},
        {"\n\n# nothing\n", ":1:", "no document"},
        {"- a\n", ":1:", "a list"},
        {"just text\n", ":1:", "a single value"},
        {"inner: {count: 1}\n", ":1:", "lacks the key 'name'"},
        {"name: x\nnome: y\n", ":2:", "unknown key 'nome'"},
        {"name: x\nname: y\n", ":2:", "again"},
        {"name: [x]\n", ":1:", "a list"},
        {"name: {x: y}\n", ":1:", "a mapping"},
        {"name: x\ninner: 3\n", ":2:", "a single value"},
        {"name: x\ninner: {count: 1.5}\n", ":2:", "an integer"},
        {"name: x\ninner: {count: 99999999999999999999}\n", ":2:", "an integer"},
        {"name: x\ninner: {count: }\n", ":2:", "an integer"},
        {"name: x\ninner: {count: 0x10}\n", ":2:", "an integer"},
        {"name: x\ninner: {count: 1, flag: maybe}\n", ":2:", "true, false"},
        {"name: x\ninner:\n  flag: true\n", ":3:", "lacks the key 'count'"},
        {"name: x\nwords: []\n", ":2:", "1 to 3"},
        {"name: x\nwords: [a, b, c, d]\n", ":2:", "1 to 3"},
        {"name: x\nwords: [a, toolongbyfar]\n", ":2:", "characters"},
        {"name: ''\n", ":1:", "0 characters"},
        {"name: abcdefghijk\n", ":1:", "11 characters"},
        {"name: 'x\n", ":", "not YAML"},
        {"name: x\n\tinner: y\n", ":2:", "not YAML"},
        {"name: x: y\n", ":1:", "not YAML"},
        {"name: x\n}\n", ":2:", "not YAML"},
        {"name: \xff\xfe\n", ":1:", "not YAML"},
        {"name: x\nwords: [\xc3\x28]\n", ":2:", "not YAML"},
        {"? [a, b]\n: c\nname: x\n", ":1:", "unknown key"},
        {"&a name: *a\n", ":1:", "an alias"},
        {"name: x\nwords: &w [a]\ninner: *w\n", ":3:", "an alias"},
        {"name: x\n---\nname: y\n", ":2:", "a second document"},
        {"name: [[[[[[[[[[[[[[[[[x]]]]]]]]]]]]]]]]]\n", ":1:", "too deeply nested"},
        {"%YAML 9.9\n---\nname: x\n", ":1:", "not YAML"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_refused(cases[i].text, cases[i].place, cases[i].part);
}

static void test_binary_and_huge_files(void **state)
{
    (void)state;
    sphv_yaml *yaml = NULL;
    sphv_error error = {SPHV_OK, ""};
    assert_failed(load_bytes("name: x\n\0y", 10, &yaml, &error), &error, SPHV_INVALID_INPUT,
                  ":2: the file holds binary data");
    size_t size = ((size_t)1 << 20) + 1;
    char *huge = malloc(size);
    memset(huge, '#', size);
    assert_failed(load_bytes(huge, size, &yaml, &error), &error, SPHV_INVALID_INPUT, "too large");
    free(huge);
}

static void test_missing_files_and_folders(void **state)
{
    (void)state;
    sphv_yaml *yaml = NULL;
    sphv_error error = {SPHV_OK, ""};
    assert_failed(sphv_yaml_load("/nowhere/at/all.yaml", &schema, &yaml, &error), &error,
                  SPHV_INVALID_INPUT, "cannot be opened");
    assert_failed(sphv_yaml_load("/tmp", &schema, &yaml, &error), &error, SPHV_INVALID_INPUT,
                  "folder");
    assert_failed(sphv_yaml_load("/dev/zero", &schema, &yaml, &error), &error, SPHV_INVALID_INPUT,
                  "");
}

/// A name with a line break in it must not make two lines of one message.
static void test_messages_stay_one_line(void **state)
{
    (void)state;
    assert_refused("name: x\n\"un\\nknown\\x1b[31m\": 1\n", ":2:", "un?known?[31m");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_good_file),
        cmocka_unit_test(test_bad_texts),
        cmocka_unit_test(test_binary_and_huge_files),
        cmocka_unit_test(test_missing_files_and_folders),
        cmocka_unit_test(test_messages_stay_one_line),
    };
    return run_group(tests);
}
