#include "json_parts.h"

#include <math.h>
#include <string.h>

#include "text.h"

json_t *sphv_json_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *sphv_json_text(const char *text)
{
    json_t *string = json_string(text);
    if (string) return string;
    char clean[1200], one[5];
    size_t used = 0;
    while (used + sizeof one < sizeof clean && sphv_text_next(&text, one)) {
        memcpy(clean + used, one, strlen(one));
        used += strlen(one);
    }
    clean[used] = '\0';
    return json_string(clean);
}

json_t *sphv_json_text_or_null(const char *text)
{
    return text && *text ? sphv_json_text(text) : json_null();
}

json_t *sphv_json_result(sphv_result result)
{
    return json_pack("{s:o, s:o}", "value", sphv_json_number(result.value), "bound",
                     sphv_json_number(result.bound));
}

json_t *sphv_check_result_json(const sphv_check_result *result)
{
    return json_pack(
        "{s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:b, s:s, s:o}", "id", result->id, "dimension",
        result->dimension ? json_integer(result->dimension) : json_null(), "claim",
        sphv_json_text(result->claim), "claimed", sphv_json_number(result->claimed), "analytic",
        sphv_json_number(result->analytic), "empirical", sphv_json_number(result->empirical),
        "bound", sphv_json_number(result->bound), "informative", result->informative, "verdict",
        sphv_verdict_name(result->verdict), "cause", sphv_json_text_or_null(result->cause));
}
