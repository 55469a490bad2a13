/// The particle engine beside a plain scalar loop, PySPH (when it is installed) and the peak of
/// fused multiply-adds, in alternated rounds of one run; the first round is not counted. Times of
/// one thread are processor times, so that other work on the machine disturbs less; two threads
/// against one is wall time.
///
///     bench_engine PYSPH_SCRIPT|none [fused]
#include <gsl/gsl_errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "../../empirical/sums/pass.h"
#include "sphverify/estimate.h"

#ifdef _OPENMP
#include <omp.h>
#else
static void omp_set_num_threads(int n)
{
    (void)n;
}
#endif

enum { ROUNDS = 4, WORKLOADS = 3 };

/// A workload: perturbed particles by ±20 %, value and gradient.
struct workload {
    const char *name, *kernel, *peer_kernel;
    int dimension;
    size_t side;
    double h, peer_h; ///< smoothing length, and in PySPH's convention of the kernel
    sphv_method method;
    /// Floating-point operations of a pair, a fused multiply-add counted as two: distance 3d, root,
    /// radial functions, sums (pass.c); half of those that serve a pair's both ends (half_pass.c).
    double flops;
};

static const struct workload workloads[WORKLOADS] = {
    {"W1", "sigalotti-wendland-c4", "wendland-c4", 2, 250, 0.158, 0.079, SPHV_SPH, 17.5},
    {"W2", "cubic-spline", "cubic-spline", 2, 750, 1.2 / 750, 1.2 / 750, SPHV_BONET_LOK, 60},
    {"W3", "cubic-spline", "cubic-spline", 3, 100, 0.013, 0.013, SPHV_BONET_LOK, 75},
};

/// What a workload runs on.
struct setting {
    sphv_kernel *kernel;
    const sphv_profile *profile;
    sphv_particles particles;
    double *field[2];
    double h;
};

static double seconds_of(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool setting_make(struct setting *out, const char *kernel, const sphv_box *box, double h)
{
    sphv_error error;
    if (sphv_catalogue_find(getenv("SPHVERIFY_DATA"), kernel, &out->kernel, &error) != SPHV_OK ||
        sphv_particles_make(box, NULL, 0, &out->particles, &error) != SPHV_OK) {
        fprintf(stderr, "%s\n", error.message);
        return false;
    }
    out->profile = sphv_kernel_profile(out->kernel, box->dimension);
    out->h = h;
    for (int f = 0; f < 2; f++) {
        out->field[f] = malloc(out->particles.count * sizeof(double));
        if (!out->field[f]) return false;
        for (size_t b = 0; b < out->particles.count; b++)
            out->field[f][b] = sin((3 + f) * out->particles.x[0][b]) +
                               cos(2 * out->particles.x[box->dimension - 1][b]);
    }
    return true;
}

static void setting_free(struct setting *setting)
{
    sphv_particles_free(&setting->particles);
    sphv_kernel_free(setting->kernel);
    for (int f = 0; f < 2; f++) free(setting->field[f]);
}

static sphv_box box_of(int dimension, size_t side)
{
    return (sphv_box){.dimension = dimension,
                      .side = side,
                      .layout = SPHV_PERTURBED,
                      .placement = SPHV_PLACEMENT_CELL,
                      .jitter = SPHV_JITTER_UNIFORM,
                      .amplitude = 0.2,
                      .reflected = true,
                      .volume = SPHV_VOLUME_LATTICE,
                      .seed = 1};
}

/// Runs the engine. \return seconds on the clock, negative on failure
static double run(const struct setting *of, size_t fields, size_t methods,
                  const sphv_method *method, clockid_t clock, sphv_estimates *out)
{
    const double *field[2] = {of->field[0], of->field[1]};
    sphv_request request = {.profile = of->profile,
                            .h = of->h,
                            .method_count = methods,
                            .methods = method,
                            .field_count = fields,
                            .fields = field,
                            .route = SPHV_ROUTE_DIRECT};
    sphv_error error;
    double start = seconds_of(clock);
    if (sphv_estimate_particles(&of->particles, &request, NULL, NULL, out, &error) != SPHV_OK) {
        fprintf(stderr, "%s\n", error.message);
        exit(2);
    }
    return seconds_of(clock) - start;
}

/// Exchanges particles at random.
static void shuffle(struct setting *of)
{
    uint64_t state = 88172645463325252u;
    for (size_t b = of->particles.count - 1; b > 0; b--) {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        size_t other = state % (b + 1);
        double *arrays[6] = {of->particles.volume, of->field[0], of->field[1]};
        for (int i = 0; i < of->particles.dimension; i++) arrays[3 + i] = of->particles.x[i];
        for (int i = 0; i < 3 + of->particles.dimension; i++) {
            double kept = arrays[i][b];
            arrays[i][b] = arrays[i][other];
            arrays[i][other] = kept;
        }
    }
}

/// A plain loop: cells of the size of the support, linked lists, one pair after the other; value
/// and gradient by eq. 1, and for the other workloads the moments of the correction as well.
static double run_scalar(const struct setting *of, bool moments)
{
    const sphv_particles *p = &of->particles;
    double start = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
    double reach = of->profile->support * of->h;
    int d = p->dimension, cells = (int)(1 / reach) > 0 ? (int)(1 / reach) : 1;
    long all = cells * cells * (d == 3 ? cells : 1);
    long *head = malloc((size_t)all * sizeof *head), *next = malloc(p->count * sizeof *next);
    volatile double sink;
    double check = 0;
    if (!head || !next) exit(3);
    for (long c = 0; c < all; c++) head[c] = -1;
    for (size_t b = 0; b < p->count; b++) {
        long at = 0;
        for (int i = d - 1; i >= 0; i--) {
            int cell = (int)(p->x[i][b] * cells);
            at = at * cells + (cell < cells ? cell : cells - 1);
        }
        next[b] = head[at];
        head[at] = (long)b;
    }
    for (size_t a = 0; a < p->count; a++) {
        int at[3] = {0, 0, 0};
        double sum[20] = {0};
        for (int i = 0; i < d; i++) {
            at[i] = (int)(p->x[i][a] * cells);
            if (at[i] >= cells) at[i] = cells - 1;
        }
        for (int z = d == 3 ? at[2] - 1 : 0; z <= (d == 3 ? at[2] + 1 : 0); z++)
            for (int y = at[1] - 1; y <= at[1] + 1; y++)
                for (int x = at[0] - 1; x <= at[0] + 1; x++) {
                    if (x < 0 || y < 0 || z < 0 || x >= cells || y >= cells || z >= cells) continue;
                    for (long b = head[(z * cells + y) * (long)cells + x]; b >= 0; b = next[b]) {
                        double s[3] = {0, 0, 0}, square = 0;
                        for (int i = 0; i < d; i++) {
                            s[i] = p->x[i][b] - p->x[i][a];
                            square += s[i] * s[i];
                        }
                        if (square >= reach * reach) continue;
                        double q = sqrt(square) / of->h, w, slope;
                        if (moments) {
                            double t = 2 - q, u = q < 1 ? 1 - q : 0;
                            w = t * t * t - 4 * u * u * u;
                            slope = q > 0 ? (-3 * t * t + 12 * u * u) / q : 0;
                        } else {
                            double t = 1 - q, t2 = t * t, t5 = t2 * t2 * t;
                            w = t5 * t * (1 + q * (6 + q * (35.0 / 3)));
                            slope = -t5 * (56.0 / 3) * (1 + 5 * q);
                        }
                        w *= p->volume[b];
                        slope *= p->volume[b];
                        double jump = of->field[0][b] - (moments ? of->field[0][a] : 0);
                        sum[0] += w * jump;
                        for (int i = 0; i < d; i++) sum[1 + i] += slope * s[i] * jump;
                        if (!moments) continue;
                        sum[4] += w;
                        for (int i = 0; i < d; i++) {
                            sum[5 + i] += slope * s[i];
                            sum[8 + i] += w * s[i];
                            for (int j = i; j < d; j++) sum[11 + 3 * i + j] += slope * s[i] * s[j];
                        }
                    }
                }
        for (int k = 0; k < 20; k++) check += sum[k];
    }
    sink = check;
    (void)sink;
    free(head);
    free(next);
    return seconds_of(CLOCK_PROCESS_CPUTIME_ID) - start;
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/// Median of the counted rounds, with the range.
static void print_ratio(const char *what, const double *above, const double *below)
{
    double ratio[ROUNDS];
    for (int i = 1; i < ROUNDS; i++) ratio[i - 1] = above[i] / below[i];
    qsort(ratio, ROUNDS - 1, sizeof *ratio, ascending);
    printf("   %s %.3g (%.3g to %.3g)\n", what, ratio[(ROUNDS - 1) / 2], ratio[0],
           ratio[ROUNDS - 2]);
}

/// PySPH on the same particles. \return its fastest processor seconds after the first repetition,
/// or a negative number; `worst` receives the largest difference of any estimate
static double run_peer(const char *script, const struct workload *of, const struct setting *setting,
                       const sphv_estimates *ours, double *worst)
{
    char folder[] = "/tmp/bench_engine_XXXXXX", path[64], command[1024], line[256];
    const sphv_particles *p = &setting->particles;
    double fastest = -1;
    if (strcmp(script, "none") == 0 || !mkdtemp(folder)) return -1;
    snprintf(path, sizeof path, "%s/particles", folder);
    FILE *file = fopen(path, "wb");
    for (size_t b = 0; file && b < p->count; b++) {
        double row[5] = {p->x[0][b], p->x[1][b], p->x[2] ? p->x[2][b] : 0, p->volume[b],
                         setting->field[0][b]};
        if (fwrite(row, sizeof row, 1, file) != 1) break;
    }
    if (file) fclose(file);
    snprintf(command, sizeof command, "OMP_NUM_THREADS=1 /usr/bin/python3 '%s' %s %d %s %.17g %s 3",
             script, folder, of->dimension, of->peer_kernel, of->peer_h,
             of->method == SPHV_SPH ? "sph" : "bonet-lok");
    FILE *peer = popen(command, "r");
    for (int i = 0; peer && fgets(line, sizeof line, peer);) {
        double seconds;
        if (sscanf(line, "seconds %lf", &seconds) == 1 && i++ > 0)
            fastest = fastest < 0 || seconds < fastest ? seconds : fastest;
    }
    if (peer && pclose(peer) != 0) fastest = -1;
    remove(path);
    snprintf(path, sizeof path, "%s/estimates", folder);
    file = fopen(path, "rb");
    *worst = file ? 0 : INFINITY;
    for (size_t b = 0; file && b < p->count; b++) {
        double row[4];
        if (fread(row, sizeof row, 1, file) != 1) *worst = INFINITY;
        for (int i = 0; i <= of->dimension; i++)
            *worst = fmax(*worst, fabs(row[i] - ours->methods[0].estimate[i][b]));
    }
    if (file) fclose(file);
    remove(path);
    rmdir(folder);
    return fastest;
}

/// The first of two runs may have to wake or start a thread. \return seconds by the clock on the
/// wall
static double fastest_of_two(const struct setting *of, sphv_method method, int threads)
{
    sphv_estimates out;
    double seconds = INFINITY;
    omp_set_num_threads(threads);
    for (int i = 0; i < 2; i++) {
        seconds = fmin(seconds, run(of, 1, 1, &method, CLOCK_MONOTONIC, &out));
        sphv_estimates_free(&out);
    }
    return seconds;
}

static void bench(const struct workload *of, const char *script, double (*peak)(void))
{
    struct setting setting;
    sphv_box box = box_of(of->dimension, of->side);
    if (!setting_make(&setting, of->kernel, &box, of->h)) exit(2);
    double ours[ROUNDS], scalar[ROUNDS], fma[ROUNDS], rate[ROUNDS], shuffled[ROUNDS], one[ROUNDS],
        two[ROUNDS], worst = 0, peer = -1;
    sphv_estimates out;
    for (int round = 0; round < ROUNDS; round++) {
        fma[round] = peak();
        omp_set_num_threads(1);
        ours[round] = run(&setting, 1, 1, &of->method, CLOCK_PROCESS_CPUTIME_ID, &out);
        if (round == 0) {
            peer = run_peer(script, of, &setting, &out, &worst);
            printf("%s  N = %zu, %.1f neighbours, tested/in support %.3f\n", of->name, out.count,
                   out.pairs / (double)out.count, out.tested / out.pairs);
        }
        rate[round] = out.pairs / ours[round];
        sphv_estimates_free(&out);
        scalar[round] = run_scalar(&setting, of->method != SPHV_SPH);
        one[round] = fastest_of_two(&setting, of->method, 1);
        two[round] = fastest_of_two(&setting, of->method, 2);
    }
    shuffle(&setting);
    omp_set_num_threads(1);
    for (int round = 0; round < ROUNDS; round++) {
        shuffled[round] = run(&setting, 1, 1, &of->method, CLOCK_PROCESS_CPUTIME_ID, &out);
        sphv_estimates_free(&out);
    }
    double unit[ROUNDS] = {1, 1, 1, 1}, flops[ROUNDS];
    for (int i = 0; i < ROUNDS; i++) flops[i] = rate[i] * of->flops;
    print_ratio("pairs in support per second", rate, unit);
    printf("   %.3g flops a pair\n", of->flops);
    print_ratio("share of the peak of fused multiply-adds", flops, fma);
    print_ratio("times faster than the scalar loop", scalar, ours);
    print_ratio("time with shuffled particles, of that in order,", shuffled, ours);
    print_ratio("two threads, times one", one, two);
    double peers[ROUNDS] = {peer, peer, peer, peer};
    if (peer < 0)
        printf("   PySPH is not installed or failed: not compared\n");
    else if (!(worst < 1e-9))
        printf("   PySPH disagrees by %g: not compared\n", worst);
    else
        print_ratio("times faster than PySPH (estimates agree to 1e-9)", peers, ours);
    setting_free(&setting);
    fflush(stdout);
}

/// SPHn + CSPMn + FPMn of two fields in one pass, as in Sigalotti's largest column.
static void bench_fused(size_t side, double (*peak)(void))
{
    static const sphv_method methods[] = {SPHV_SPH_DIFFERENCE, SPHV_CSPM, SPHV_FPM};
    struct setting setting;
    sphv_box box = {.dimension = 2,
                    .side = side,
                    .layout = SPHV_LATTICE,
                    .placement = SPHV_PLACEMENT_VERTEX,
                    .volume = SPHV_VOLUME_LATTICE};
    double h = pow((double)(side * side), -1.0 / 6);
    if (!setting_make(&setting, "sigalotti-wendland-c4", &box, h)) exit(2);
    sphv_estimates out;
    double rate[ROUNDS], fma[ROUNDS], flops[ROUNDS], one[ROUNDS], two[ROUNDS];
    const double unit[ROUNDS] = {1, 1, 1, 1};
    for (int round = 0; round < ROUNDS; round++) {
        fma[round] = peak();
        omp_set_num_threads(1);
        one[round] = -seconds_of(CLOCK_MONOTONIC);
        double seconds = run(&setting, 2, 3, methods, CLOCK_PROCESS_CPUTIME_ID, &out);
        one[round] += seconds_of(CLOCK_MONOTONIC);
        if (round == 0)
            printf("fused sph-difference, cspm, fpm of two fields, N = %zu, %.0f neighbours, "
                   "tested/in support %.3f\n",
                   out.count, out.pairs / (double)out.count, out.tested / out.pairs);
        rate[round] = out.pairs / seconds;
        flops[round] = rate[round] * 50;
        sphv_estimates_free(&out);
        omp_set_num_threads(2);
        two[round] = run(&setting, 2, 3, methods, CLOCK_MONOTONIC, &out);
        sphv_estimates_free(&out);
    }
    print_ratio("pairs in support per second", rate, unit);
    printf("   50 flops a pair\n");
    print_ratio("share of the peak of fused multiply-adds", flops, fma);
    print_ratio("two threads, times one", one, two);
    setting_free(&setting);
    fflush(stdout);
}

/// Cost per pair over three decades of N.
static void bench_linearity(void)
{
    static const size_t sides[] = {32, 100, 316, 1000};
    static const sphv_method methods[] = {SPHV_SPH_DIFFERENCE, SPHV_CSPM, SPHV_FPM};
    printf("cost per pair, fused, cubic spline, h = 1.2 spacings:");
    omp_set_num_threads(1);
    for (int i = 0; i < 4; i++) {
        struct setting setting;
        sphv_box box = box_of(2, sides[i]);
        if (!setting_make(&setting, "cubic-spline", &box, 1.2 / (double)sides[i])) exit(2);
        double fastest = INFINITY, pairs = 1;
        for (int round = 0; round < ROUNDS; round++) {
            sphv_estimates out;
            fastest = fmin(fastest, run(&setting, 2, 3, methods, CLOCK_PROCESS_CPUTIME_ID, &out));
            pairs = out.pairs;
            sphv_estimates_free(&out);
        }
        printf("  N = %zu: %.2f ns", setting.particles.count, 1e9 * fastest / pairs);
        setting_free(&setting);
    }
    printf("\n");
}

double fma_peak_plain(void);
#ifdef SPHV_X86_PASSES
double fma_peak_avx2(void);
double fma_peak_avx512(void);
#endif

int main(int argc, char **argv)
{
    gsl_set_error_handler_off();
    const char *set = (*sphv_pass_sets())->name;
    double (*peak)(void) = fma_peak_plain;
#ifdef SPHV_X86_PASSES
    if (strcmp(set, "avx512") == 0) peak = fma_peak_avx512;
    if (strcmp(set, "avx2") == 0) peak = fma_peak_avx2;
#endif
    printf("instruction set %s\n", set);
    const char *script = argc > 1 ? argv[1] : "none";
    for (int i = 0; i < WORKLOADS && !(argc > 2); i++) bench(&workloads[i], script, peak);
    bench_fused(argc > 2 ? 750 : 250, peak);
    bench_linearity();
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    printf("most memory: %.0f MB\n", (double)usage.ru_maxrss / 1024);
    return 0;
}
