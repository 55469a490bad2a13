#include <gsl/gsl_math.h>

#include "internal.h"

/// Ŵ^(order) at a signed offset; odd derivatives change sign with it.
static double derivative_at(const sphv_profile *profile, int order, double s)
{
    double value = sphv_profile_derivative(profile, order, fabs(s)).value;
    return order % 2 && s < 0 ? -value : value;
}

static const sphv_term_row standard_rows[] = {
    {"A' sum W' delta ds^2", "A' delta O(ds^3)", SPHV_PHASE_SINE},
    {"(A/h) sum W'' delta ds^2", "(A/h) delta O(ds^3)", SPHV_PHASE_COSINE},
    {"(A/2h) sum W''' (1/12 + delta^2) ds^3", "(A/2h) (delta^2 + 1/12) O(ds^4)", SPHV_PHASE_COSINE},
    {"A' sum W'' (ds^2/12 + sbar delta ds) ds", "A' [delta O(ds^3) + O(ds^4)]", SPHV_PHASE_SINE},
    {"(A'' h/2) sum W' (ds^2/12 + (sbar + s) delta ds) ds", "A'' h [delta O(ds) + O(ds^4)]",
     SPHV_PHASE_COSINE},
    {NULL, NULL, SPHV_PHASE_SINE},
};

static const sphv_term_row corrected_rows[] = {
    {"A'' h int s W~ ds", "A'' h", SPHV_PHASE_COSINE},
    {"(A''' h^2/2) int s^2 W~ ds", "A''' h^2", SPHV_PHASE_SINE},
    {"(A'' h/2) sum W~' (ds^2/12 + (sbar + s) delta ds) ds", "A'' h [delta O(ds) + O(ds^4)]",
     SPHV_PHASE_COSINE},
    {NULL, NULL, SPHV_PHASE_SINE},
};

/// Eq. 20 divided by max|A′|: A = 1 and A″ = −k² on a crest, A′ = k at a zero of the sine.
static void standard_terms(const sphv_profile *profile, double K, const sphv_cells *cells,
                           double *terms)
{
    for (int i = 0; i < 5; i++) terms[i] = 0;
    for (int b = 0; b < cells->count; b++) {
        double s = cells->s[b], centre = cells->centroid[b], width = cells->volume[b];
        double shift = centre - s; // δ_b Δs_b
        double w1 = derivative_at(profile, 1, s), w2 = derivative_at(profile, 2, s);
        double w3 = derivative_at(profile, 3, s), square = width * width / 12;
        terms[0] += w1 * shift * width;
        terms[1] += w2 * shift * width / K;
        terms[2] += w3 * (square + shift * shift) * width / (2 * K);
        terms[3] += w2 * (square + centre * shift) * width;
        terms[4] -= 0.5 * K * w1 * (square + (centre + s) * shift) * width;
    }
}

/// Eq. 25 divided by max|A′| for the mixed correction: −W̃′ = αŴ′ + γŴ, so that
/// h A″∫sW̃ → (h A″/2)∫s²(−W̃′) ds and so on (W̃ need not vanish at κ).
static void corrected_terms(const sphv_profile *profile, double K, const sphv_cells *cells,
                            double *terms)
{
    double d = 0, d_slope = 0, moment = 0, sum = 0;
    for (int b = 0; b < cells->count; b++) {
        d += derivative_at(profile, 0, cells->s[b]) * cells->volume[b];
        d_slope += derivative_at(profile, 1, cells->s[b]) * cells->volume[b];
    }
    for (int b = 0; b < cells->count; b++)
        moment += cells->s[b] * cells->volume[b] *
                  (derivative_at(profile, 0, cells->s[b]) * d_slope -
                   derivative_at(profile, 1, cells->s[b]) * d) /
                  (d * d);
    double alpha = -1 / (d * moment), gamma = d_slope / (d * d * moment);
    for (int b = 0; b < cells->count; b++) {
        double s = cells->s[b], centre = cells->centroid[b], width = cells->volume[b];
        double slope = -alpha * derivative_at(profile, 1, s) - gamma * derivative_at(profile, 0, s);
        sum += slope * (width * width / 12 + (centre + s) * (centre - s)) * width;
    }
    terms[0] = -0.5 * K * gamma * profile->moment[2].value;
    terms[1] = 0.5 * K * K * alpha * profile->slope_moment[2].value;
    terms[2] = -0.5 * K * sum;
}

const sphv_term_row *sphv_disorder_terms(const sphv_experiment *experiment, const sphv_cells *cells,
                                         double *terms)
{
    double K = 2 * M_PI * experiment->h;
    if (experiment->volume != SPHV_VOLUME_TESSELLATED) return NULL;
    if (experiment->method == SPHV_SPH) {
        standard_terms(experiment->profile, K, cells, terms);
        return standard_rows;
    }
    if (experiment->method == SPHV_BONET_LOK) {
        corrected_terms(experiment->profile, K, cells, terms);
        return corrected_rows;
    }
    return NULL;
}
