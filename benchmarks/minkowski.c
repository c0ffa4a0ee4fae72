/* Minkowskian 4R in plain C: the speed limit of psi with its orientation, and of the types of a design.
 *
 * The arithmetic is that of the facts, operation by operation, strict IEEE, so that the results have the same bits. What
 * does not depend on theta is computed once per design; lanes are designs there and inputs in the curves.
 *
 * x: rows a b g h, each of n designs.
 * tables: rows side, twos, r, S_r, S_r_low, p_r, p_r_low, per_p, per_p_low, each of K inputs.
 */
#include <stdint.h>
#include <string.h>
#include "sums.h"

#define CONSTANTS(_)                                                                                              \
    _(inner) _(inner_low) _(outer) _(outer_low) _(CB_inner) _(CB_outer) _(share) _(share_low) _(b_share) _(a_two) \
    _(product_two)
#define TILE 512
typedef double tile[TILE] __attribute__((aligned(64)));

typedef struct { CONSTANTS(AS_SCALAR) } design;
typedef struct { CONSTANTS(AS_ARRAY) } __attribute__((aligned(64))) block;

INLINE design design_at(const block *b, int i) { return (design){CONSTANTS(READ)}; }

/* ---- once per design ---- */

INLINE double greater(double a, double b) { return a > b ? a : b; }

INLINE double power_of_two_below(double x)
{
    double q = (0x1p52 + 1) * x;
    return fabs(q - (1 - 0x1p-53) * q);
}

/* (g - a - b - h) (g - a + b + h)/(4 a g) */
INLINE dd limit(double a, double b, double g, double h, double a_one, double g_one)
{
    return gap(sum4(g, -a, -b, -h), sum4(g, -a, b, h), a_one, g_one);
}

INLINE void prepare(block *restrict o, const double *restrict x, long n, long first)
{
#pragma GCC ivdep
    for (int i = 0; i < LANES; i++) {
        long j = first + i < n ? first + i : n - 1;
        double a = x[j], b = x[n + j], g = x[2 * n + j], h = x[3 * n + j];
        double longest = greater(greater(a, b), greater(g, h));
        double lift = longest < 0x1p-500 ? 0x1p540 : longest > 0x1p500 ? 0x1p-540 : 1;
        double unit = power_of_two_below(longest * lift);
        int valid = (a > 0) & (b > 0) & (g > 0) & (h > 0) & (longest < INFINITY);
        a = a * lift / unit, b = b * lift / unit, g = g * lift / unit, h = h * lift / unit;
        double a_two = power_of_two_below(a), g_two = power_of_two_below(g), a_one = a / a_two, g_one = g / g_two;
        dd inner = limit(a, b, g, h, a_one, g_one), outer = limit(a, b, g, -h, a_one, g_one);
        dd share = gap((dd){g, 0}, (dd){4, 0}, a, 1);
        o->inner[i] = valid ? inner.hi : NAN;
        o->inner_low[i] = inner.lo;
        o->outer[i] = valid ? outer.hi : NAN;
        o->outer_low[i] = outer.lo;
        o->CB_inner[i] = b * (b + h) / (2 * (a_one * g_one));
        o->CB_outer[i] = b * (b - h) / (2 * (a_one * g_one));
        o->share[i] = share.hi;
        o->share_low[i] = share.lo;
        o->a_two[i] = a_two;
        o->b_share[i] = b / (2 * g_one);
        o->product_two[i] = a_two * g_two;
    }
}

/* ---- once per design and input ---- */

INLINE int64_t bits_of(double x)
{
    int64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

INLINE double of_bits(int64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Whether 2^-1021 <= x, y < 2^1022, by their bits. */
INLINE int have_quotient(double x, double y)
{
    uint64_t x_above = (uint64_t)bits_of(x) - (2ull << 52), y_above = (uint64_t)bits_of(y) - (2ull << 52);
    return (x_above > y_above ? x_above : y_above) < 2043ull << 52;
}

/* ln |x/y| + twos ln 2 */
INLINE double log_quotient(double x, double y, double twos)
{
    x = fabs(x), y = fabs(y);
    int64_t k = (bits_of(x) - bits_of(y) + ((int64_t)1 << 51)) >> 52;
    double near = of_bits(bits_of(y) + (int64_t)((uint64_t)k << 52));
    double s = (x - near) / (x + near), z = s * s, z2 = z * z;
    double series = ((0.666666666666729 + 0.39999999996057706 * z) + (0.2857142941420829 + 0.2222213693929062 * z) * z2) +
                    ((0.18186420619325075 + 0.1524888774956877 * z) + 0.15378368156080974 * z2) * (z2 * z2);
    double found = ((double)k + twos) * 0x1.62e42fefa39efp-1 + ((s + s) + (s * z) * series);
    return have_quotient(x, y) ? found : NAN;
}

INLINE double quotient_sign(double x, double y)
{
    double sign = copysign(1, x) * copysign(1, y);
    return have_quotient(fabs(x), fabs(y)) ? sign : 0;
}

/* Half the sum of the roots and the half sum that does not cancel; b alpha and b beta. */
INLINE void loop_to_root(long m, long K, design d, const double *restrict t, double *restrict halves,
                         double *restrict totals, double *restrict alphas, double *restrict betas)
{
    const double *restrict r = t + 2 * K, *restrict S = t + 3 * K, *restrict S_low = t + 4 * K, *restrict p = t + 5 * K;
    const double *restrict p_low = t + 6 * K, *restrict per_p = t + 7 * K, *restrict per_p_low = t + 8 * K;
#pragma GCC ivdep
    for (long k = 0; k < m; k++) {
        double high = S[k] * d.product_two, low = S_low[k] * d.product_two;
        double inside = (d.inner * r[k] - high) + (d.inner_low * r[k] - low);
        double outside = (high - d.outer * r[k]) + (low - d.outer_low * r[k]);
        double within = -(d.CB_inner * r[k] + inside), beyond = outside - d.CB_outer * r[k];
        double half = inside >= 0 ? within : beyond;
        double root = sqrt(-(inside * 0x1p1000 * outside)) * 0x1p-500;
        double minus = half - root, plus = half + root;
        halves[k] = half;
        totals[k] = half < 0 ? minus : plus;
        alphas[k] = d.b_share * (d.a_two * ((d.share * r[k] - p[k]) + (d.share_low * r[k] - p_low[k])));
        betas[k] = d.b_share * (d.a_two * ((d.share - per_p[k]) + (d.share_low - per_p_low[k])));
    }
}

INLINE void loop_of_logs(long m, long K, const double *restrict t, const double *restrict halves,
                         const double *restrict totals, const double *restrict alphas, const double *restrict betas,
                         tile *restrict signs, double *restrict psi, int8_t *restrict ahead)
{
    const double *restrict side = t, *restrict twos = t + K;
#pragma GCC ivdep
    for (long k = 0; k < m; k++) {
        double by_sum = log_quotient(totals[k], betas[k], twos[k]), other = log_quotient(alphas[k], totals[k], 0);
        double of_sum = quotient_sign(totals[k], betas[k]), of_other = quotient_sign(alphas[k], totals[k]);
        int sum_first = (halves[k] < 0) == (side[k] < 0);
        psi[k] = side[k] * (sum_first ? by_sum : other);
        psi[K + k] = side[k] * (sum_first ? other : by_sum);
        signs[0][k] = sum_first ? of_sum : of_other;
        signs[1][k] = sum_first ? of_other : of_sum;
    }
    for (long k = 0; k < m; k++)
        ahead[k] = (int8_t)signs[0][k];
    for (long k = 0; k < m; k++)
        ahead[K + k] = (int8_t)signs[1][k];
}

/* psi: (n, 2, K); ahead: (n, 2, K) of bytes. The root and the logarithms have a loop each: in one loop their latency
 * is longer than the processor can look ahead. */
void c_minkowski_psi(long n, long K, const double *restrict x, const double *restrict tables, double *restrict psi,
           int8_t *restrict ahead)
{
    tile halves, totals, alphas, betas, signs[2];
    block b;
    for (long first = 0; first < n; first += LANES) {
        prepare(&b, x, n, first);
        for (long i = 0; i < LANES && first + i < n; i++)
            for (long start = 0; start < K; start += TILE) {
                design d = design_at(&b, i);
                long m = K - start < TILE ? K - start : TILE;
                const double *t = tables + start;
                loop_to_root(m, K, d, t, halves, totals, alphas, betas);
                loop_of_logs(m, K, t, halves, totals, alphas, betas, signs, psi + (first + i) * 2 * K + start,
                             ahead + (first + i) * 2 * K + start);
            }
    }
}

/* ---- types ---- */

/* A number of the sign of p + q - r - s: rounded sums are in the order of the sums. */
INLINE double sign(double p, double q, double r, double s)
{
    dd left = two_sum(p, q), right = two_sum(r, s);
    double lost = left.lo - right.lo, found = left.hi - right.hi;
    return left.hi == right.hi ? lost : found;
}

/* linkage_type of n designs: 4 kind + 2 (the input is no crank) + (the output is no crank), 16 of invalid lengths */
void c_minkowski_types(long n, const double *restrict x, int8_t *restrict type)
{
    double code[LANES] __attribute__((aligned(64)));
    for (long first = 0; first < n; first += LANES) {
        long m = n - first < LANES ? n - first : LANES;
#pragma GCC ivdep
        for (long i = 0; i < m; i++) {
            double a = x[first + i], b = x[n + first + i], g = x[2 * n + first + i], h = x[3 * n + first + i];
            double T1 = sign(g, b, h, a), T2 = sign(a, b, g, h), T3 = sign(g, -a, b, h), T4 = sign(g, b, a, -h);
            double T5 = sign(a, g, h, -b), T6 = sign(a, g, b, -h);
            int valid = (a > 0) & (b > 0) & (g > 0) & (h > 0) & ((a + b) + (g + h) < INFINITY);
            int strange = (T3 > 0) | (T4 < 0) | (T5 < 0) | (T6 < 0), rigid = (T3 == 0) | (T4 == 0) | (T5 == 0) | (T6 == 0);
            int input = ((T3 > 0) & (T4 > 0)) | ((T3 < 0) & (T4 < 0)) | ((T1 > 0) & (T2 < 0)) | ((T1 < 0) & (T2 > 0));
            int output = ((T4 > 0) & (T5 < 0)) | ((T4 < 0) & (T5 > 0)) | (T1 < 0);
            double kind = strange ? 0 : rigid ? 4 : (T1 == 0) | (T2 == 0) ? 8 : 12;
            code[i] = valid ? kind + ((input ? 2.0 : 0.0) + (output ? 1.0 : 0.0)) : 16;
        }
        for (long i = 0; i < m; i++)
            type[first + i] = (int8_t)code[i];
    }
}
