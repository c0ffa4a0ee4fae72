/* Every extreme of omega4 in plain C: the speed limit of the refined kernels.
 *
 * Arithmetic and search of the engine (docs/numerics.md, Extremes), strict IEEE, to the bit: samples on the graded
 * range with lanes = designs, marks, and then lanes = cells: golden section in valleys, Chandrupatla's method for
 * zeros. omega4 is the same in both branches up to a mirror, so half the range in both branches says all. Where the
 * extremes are is not computed.
 */
#include <stdint.h>
#include <string.h>

#include "sums.h"

/* ---- zeros and least magnitudes in their brackets, refined in the lanes: no cell waits for another design ---- */
/* Both ends of a bracket, the next place x, and for a valley the best place so far, xc. */
#define BRACKET(_) _(x) _(f) _(x1) _(f1) _(x2) _(f2) _(xc) _(fc) _(tolerance) _(steps) _(open)
typedef struct { BRACKET(AS_ARRAY) } __attribute__((aligned(64))) brackets;

#define GOLDEN 0.3819660112501051
INLINE double golden(double a, double c, double b) { return c + GOLDEN * (b - c > c - a ? b - c : a - c); }

/* One step of Chandrupatla's method: inverse quadratic interpolation where it is safe, else bisection. */
INLINE void advance_roots(brackets *restrict s, int width)
{
#pragma GCC ivdep
    for (int i = 0; i < width; i++) {
        double x = s->x[i], f = s->f[i], x1 = s->x1[i], f1 = s->f1[i], x2 = s->x2[i], f2 = s->f2[i];
        int same = (f > 0) == (f1 > 0);
        double x3 = same ? x1 : x2, f3 = same ? f1 : f2;
        x2 = same ? x2 : x1, f2 = same ? f2 : f1;
        int nearer = fabs(f2) < fabs(f);
        double best = nearer ? x2 : x, best_f = nearer ? f2 : f;
        double gap = x2 - x, r_gap = 1 / gap, limit = (0x1p-51 * fabs(best) + s->tolerance[i]) * fabs(r_gap);
        double r_f2 = 1 / f2, a = f * r_f2, b = f3 * r_f2, r_b = 1 / (1 - b);
        double xi = gap / (x2 - x3), phi = (1 - a) * r_b, skew = (x3 - x) * r_gap;
        int smooth = (phi * phi < xi) & ((1 - phi) * (1 - phi) < 1 - xi);
        double step = a * r_b * ((b * (b - a) - skew * (1 - a)) / ((1 - a) * (b - a)));
        double t = smooth ? step : 0.5;
        t = t > limit ? t : limit;
        t = t < 1 - limit ? t : 1 - limit;
        int done = (limit > 0.5) | (best_f == 0);
        double next = done ? best : x + t * gap;
        s->x[i] = s->open[i] > 0 ? next : x;
        s->x1[i] = x, s->f1[i] = f, s->x2[i] = x2, s->f2[i] = f2;
        s->open[i] = done ? 0 : s->open[i];
    }
}

/* The least value of the parabola through three points of a valley. */
INLINE double vertex(double a, double fa, double c, double fc, double b, double fb)
{
    double left = (fc - fa) / (c - a), right = (fb - fc) / (b - c), bend = (right - left) / (b - a);
    double slope = left + bend * (c - a);
    return fc - slope * slope / (4 * bend);
}

/* One golden-section step towards the least magnitude; a cell is done where the sign changes. */
INLINE void advance_valley(brackets *restrict s, int i)
{
    double c = s->xc[i], fc = s->fc[i], x = s->x[i], f = s->f[i];
    if ((f > 0) != (fc > 0)) {
        s->open[i] = 0;
        return;
    }
    int better = fabs(f) < fabs(fc);
    double inner = better ? x : c, f_inner = better ? f : fc, outer = better ? c : x, f_outer = better ? fc : f;
    if (outer < inner)
        s->x1[i] = outer, s->f1[i] = f_outer;
    else
        s->x2[i] = outer, s->f2[i] = f_outer;
    double a = s->x1[i], b = s->x2[i];
    s->xc[i] = inner, s->fc[i] = f_inner, s->steps[i]++;
    int at_end = (inner == a) | (inner == b);
    double least = at_end ? 0 : vertex(a, fabs(s->f1[i]), inner, fabs(f_inner), b, fabs(s->f2[i]));
    int high = s->steps[i] >= 4 && (at_end || least > 0.5 * fabs(f_inner));
    if (high || b - a <= 0x1p-26 * inner + s->tolerance[i])
        s->open[i] = 0;
    else
        s->x[i] = golden(a, inner, b);
}

#define CELLS 16 /* half the cells of the range */
#define SAMPLES (2 * CELLS + 1)
#define ROOM (2 * LANES * SAMPLES)

#define CONSTANTS(_)                                                                                              \
    _(Z_least) _(width) _(C_least) _(p_least) _(q_least) _(sine) _(gamma0) _(eps) _(C0_4) _(Z0_4) _(kappa)        \
    _(offset) _(w) _(half_w) _(excess)

typedef struct { CONSTANTS(AS_SCALAR) } design;
typedef struct {
    CONSTANTS(AS_ARRAY)
    double scale[2][LANES], start[2][LANES], toggle[2][LANES];
} __attribute__((aligned(64))) block;

/* A cell: which design, branch (-1 or 1) and end of the range, its bracket, and for a valley the place between. */
typedef struct { long lane; double branch, upper, xa, fa, xb, fb, xc, fc; } item;
typedef struct { item *at; long count; } list;

/* Cells under way. */
typedef struct {
    brackets z;
    double branch[LANES], upper[LANES], value[LANES];
    block of; /* of each cell's design */
} __attribute__((aligned(64))) state;

INLINE design design_at(const block *b, int i) { return (design){CONSTANTS(READ)}; }
INLINE void append(list *l, item i) { l->at[l->count++] = i; }

/* ---- once per design ---- */

INLINE void prepare(block *restrict o, const double *restrict x, long n, long first)
{
#pragma GCC ivdep
    for (int i = 0; i < LANES; i++) {
        long j = first + i < n ? first + i : n - 1;
        double a = x[j], b = x[n + j], c = x[2 * n + j], d = x[3 * n + j], w = x[4 * n + j];
        double ab = a > b ? a : b, cd = c > d ? c : d, longest = ab > cd ? ab : cd;
        double lift = longest < 0x1p-500 ? 0x1p540 : longest > 0x1p500 ? 0x1p-540 : 1;
        double q = (0x1p52 + 1) * (longest * lift), unit = fabs(q - (1 - 0x1p-53) * q);
        int valid = (a > 0) & (b > 0) & (c > 0) & (d > 0) & (longest < INFINITY);
        a = a * lift / unit, b = b * lift / unit, c = c * lift / unit, d = d * lift / unit;
        dd A1 = sum4(a, -b, c, -d), B1 = sum4(a, b, -c, -d), C1 = sum4(a, -b, -c, d), D1 = sum4(a, b, c, d);
        double A2 = sum4(a, b, c, -d).hi, B2 = sum4(a, -b, -c, -d).hi;
        double C2 = sum4(a, b, -c, d).hi, D2 = sum4(a, -b, c, d).hi;
        double least = 0x1p-53 * D1.hi, r = 0.25 / (a * d);
        double Z0 = (fabs(A1.hi) <= least) | (fabs(B1.hi) <= least) ? 0 : -gap(A1, B1, a, d).hi;
        double C0 = fabs(C1.hi) <= least ? 0 : gap(C1, D1, a, d).hi;
        int moves = valid & (A2 >= 0) & (B2 <= 0) & (C2 >= 0) & (D2 >= 0);
        double with_low = C0 > 0 ? 4 * (b * c) : C2 * D2, without = C0 > 0 ? -(A2 * B2) : 4 * (a * d);
        double width = moves ? (Z0 > 0 ? with_low : without) * r : NAN;
        double gamma0 = (a - d) * (a - d) * r;
        double near_low = Z0 == 0 ? gamma0 : fabs(Z0), near_high = fabs(C0);
        double low = near_low > 0 ? sqrt(near_low / (width + near_low)) : 1;
        double high = near_high > 0 ? sqrt(near_high / (width + near_high)) : 1;
        o->scale[0][i] = low, o->start[0][i] = Z0 >= 0 ? 0x1p-60 * low : 0, o->toggle[0][i] = Z0 > 0;
        o->scale[1][i] = high, o->start[1][i] = C0 >= 0 ? 0x1p-60 * high : 0, o->toggle[1][i] = C0 > 0;
        o->Z_least[i] = Z0 > 0 ? Z0 : 0, o->p_least[i] = Z0 < 0 ? -Z0 : 0;
        o->C_least[i] = C0 > 0 ? C0 : 0, o->q_least[i] = C0 < 0 ? -C0 : 0;
        o->width[i] = width, o->gamma0[i] = gamma0, o->sine[i] = 2 * (a / b) * (d / c);
        o->eps[i] = (a - d) * (a + d) * r, o->kappa[i] = (b - c) * (b + c) * r;
        o->offset[i] = 2 * b * (b - c) * r;
        o->C0_4[i] = 0.25 * C0, o->Z0_4[i] = 0.25 * Z0;
        o->w[i] = w, o->half_w[i] = 0.5 * w, o->excess[i] = 0.5 * (a - d) / d;
    }
}

/* ---- at a place of the range ---- */

typedef struct { pair omega4, slope; double sine; } rate; /* even +- odd; sine of the transmission angle */

/* low, high: distances from both ends over the width. */
INLINE rate rate_at(design d, double low, double high)
{
    double Z = d.Z_least + d.width * low, C = d.C_least + d.width * high;
    double p = d.p_least + d.width * low, q = d.q_least + d.width * high;
    double sigma = sqrt(p * q), r_sigma = 1 / sigma, r_gamma = 1 / (d.gamma0 + Z);
    double h = 0.5 * (2 * sqrt(Z * C)), j = 0.5 * (h * r_gamma), k = d.kappa * r_gamma, H = h * r_sigma;
    double share = (p + d.offset) * r_gamma; /* 1 + k, and keeps its digits */
    double dH = (d.C0_4 * Z * p - d.Z0_4 * C * q) * (r_sigma * r_sigma * r_sigma);
    pair slope = {-(d.eps * j * r_gamma), dH * share - H * k * j};
    return (rate){{d.half_w * ((d.excess + Z) * r_gamma), d.half_w * H * share}, slope, d.sine * sigma};
}

/* The derivative times the power of the sine that keeps it finite and not zero at a toggle. */
INLINE double scaled(design d, rate r, double branch)
{
    return d.w * (r.slope.even + branch * r.slope.odd) * r.sine * r.sine * r.sine;
}

INLINE void sample(const block *restrict b, double (*restrict places)[CELLS + 1][LANES],
                   double (*restrict f)[SAMPLES][LANES])
{
    double a[LANES], c[LANES], up[LANES], down[LANES];
    for (int i = 0; i < LANES; i++) {
        double g = 1 / sqrt(b->scale[0][i] * b->scale[1][i]);
        a[i] = g + sqrt(g * g + 1);
        for (int part = CELLS; part > 1; part /= 2)
            a[i] = sqrt(a[i]);
        c[i] = 1 / a[i], up[i] = down[i] = 1;
    }
    for (int j = 1; j <= CELLS; j++)
#pragma GCC ivdep
        for (int i = 0; i < LANES; i++) {
            up[i] *= a[i], down[i] *= c[i];
            places[0][j][i] = b->scale[0][i] * (0.5 * (up[i] - down[i]));
            places[1][j][i] = b->scale[1][i] * (0.5 * (up[i] - down[i]));
        }
    for (int end = 0; end < 2; end++)
        memcpy(places[end][0], b->start[end], sizeof b->start[end]);
    for (int j = 0; j < SAMPLES; j++) {
        int upper = j > CELLS;
        const double *place = upper ? places[1][SAMPLES - 1 - j] : places[0][j];
        double near[LANES], far[LANES], *low = upper ? far : near, *high = upper ? near : far;
#pragma GCC ivdep
        for (int i = 0; i < LANES; i++) { /* a loop of its own: 6 % faster */
            double square = place[i] * place[i], rest = 1 / (1 + square);
            near[i] = square * rest, far[i] = rest;
        }
#pragma GCC ivdep
        for (int i = 0; i < LANES; i++) {
            design d = design_at(b, i);
            rate r = rate_at(d, low[i], high[i]);
            double one = scaled(d, r, -1), two = scaled(d, r, 1), noise = 0x1p-50 * (fabs(one) + fabs(two));
            f[0][j][i] = fabs(one) <= noise ? 0 : one; /* else rounding errors would look like zeros */
            f[1][j][i] = fabs(two) <= noise ? 0 : two;
        }
    }
}

/* ---- cells that hold a zero, and least magnitudes that may hide two ---- */

enum { ROOT = 1, VALLEY = 2 };
#define FLAT 0x1p-40 /* a dip that is no deeper, over the ends of its valley, is an inflection */

/* Samples at an end of the range: with the sign of both neighbours where the function touches zero there. Beyond the
 * end, the derivative goes on as that of the other branch with its sign changed. */
INLINE void flatten(const double *restrict before, double *restrict here, const double *restrict after,
                    const double *restrict toggle)
{
#pragma GCC ivdep
    for (int i = 0; i < LANES; i++) {
        double a = -before[i], b = here[i], c = after[i], size = fabs(b);
        int same = (a > 0) == (c > 0), flat = (size <= FLAT * fabs(a)) & (size <= FLAT * fabs(c));
        here[i] = same & flat & (toggle[i] == 0) ? FLAT * c : b;
    }
}

INLINE void mark(const double *restrict before, const double *restrict here, const double *restrict after,
                 double sign, int8_t *restrict flags)
{
#pragma GCC ivdep
    for (int i = 0; i < LANES; i++) {
        double a = before[i], b = here[i], c = after[i];
        int differ = ((sign * b > 0) != (sign * c > 0)) & (b == b) & (c == c);
        a = fabs(a), b = fabs(b), c = fabs(c);
        int deep = ((a - c) * (a - c) > b * (a - 2 * b + c)) | ((b < 0.97 * a) & (b < 0.97 * c));
        int low = (b <= a) & (b <= c) & deep & (b > 0);
        flags[i] = (int8_t)(differ * ROOT + low * VALLEY);
    }
}

/* The place of a sample from the lower end, or from the upper one. */
INLINE double place_of(double (*restrict places)[CELLS + 1][LANES], int j, int upper, int i)
{
    if (upper)
        return places[1][SAMPLES - 1 - j][i];
    return j <= CELLS ? places[0][j][i] : 1 / places[1][SAMPLES - 1 - j][i];
}

INLINE void collect(const block *restrict b, double (*restrict places)[CELLS + 1][LANES],
                    double (*restrict f)[SAMPLES][LANES], int half, int lanes, list *valleys, list *roots)
{
    double (*own)[LANES] = f[half], (*beyond)[LANES] = f[1 - half], branch = half ? 1 : -1;
    flatten(beyond[1], own[0], own[1], b->toggle[0]);
    flatten(beyond[SAMPLES - 2], own[SAMPLES - 1], own[SAMPLES - 2], b->toggle[1]);
    for (int j = 0; j < SAMPLES; j++) {
        int last = SAMPLES - 1, left = j > 0 ? j - 1 : 0, right = j < last ? j + 1 : last;
        int8_t flags[LANES] __attribute__((aligned(64)));
        uint64_t words[LANES / 8];
        mark(j > 0 ? own[left] : beyond[1], own[j], j < last ? own[right] : beyond[last - 1], branch, flags);
        memcpy(words, flags, sizeof words);
        for (int k = 0; k < LANES / 8; k++) {
            if (!words[k])
                continue;
            for (int i = 8 * k; i < 8 * k + 8 && i < lanes; i++) {
                double fa = own[left][i], fb = own[right][i], fc = own[j][i];
                if ((flags[i] & ROOT) && j < last) {
                    int u = j >= CELLS;
                    double xa = place_of(places, j, u, i), xb = place_of(places, j + 1, u, i);
                    append(roots, (item){i, branch, u, xa, fc, xb, fb, 0, 0});
                }
                if ((flags[i] & VALLEY) && (fa > 0) == (fc > 0) && (fb > 0) == (fc > 0)) {
                    int u = left >= CELLS;
                    double xa = place_of(places, left, u, i), xb = place_of(places, right, u, i);
                    append(valleys, (item){i, branch, u, xa, fa, xb, fb, place_of(places, j, u, i), fc});
                }
            }
        }
    }
}

/* ---- refinement ---- */

enum { VALLEYS, ROOTS, ENDS };

/* How much farther from a fold than the first sample omega4 is evaluated too; how much less it is there at a pole. */
#define FARTHER 0x1p30
#define GROWS 0x1p20

/* Copy cells into the state, with their first places; return how many lanes are in use and how many of them open. */
INLINE int gather(state *restrict s, const block *restrict b, const item *restrict items, int real, int phase,
                  int *open)
{
    int width = (real + 7) / 8 * 8;
    long lane[LANES];
    *open = 0;
    for (int i = 0; i < width; i++) {
        item t = items[i < real ? i : real - 1];
        double a = t.xa, fa = t.fa, c = t.xb, fc = t.fb, x = a;
        int is_open = phase != ENDS;
        if (phase == VALLEYS) {
            if (c < a)
                a = t.xb, fa = t.fb, c = t.xa, fc = t.fa;
            x = golden(a, t.xc, c);
        } else if (phase == ROOTS) {
            double share = fa / (fa - fc);
            x = a + (share < 0.02 ? 0.02 : share > 0.98 ? 0.98 : share) * (c - a);
            if (fa == 0 || fc == 0)
                x = fa == 0 ? a : c, is_open = 0;
        }
        lane[i] = t.lane;
        s->branch[i] = t.branch, s->upper[i] = t.upper, s->z.x[i] = x, s->z.xc[i] = t.xc, s->z.fc[i] = t.fc;
        s->z.x1[i] = a, s->z.f1[i] = fa, s->z.x2[i] = c, s->z.f2[i] = fc;
        s->z.tolerance[i] = 0x1p-56 * (t.xa > t.xb ? t.xa : t.xb);
        s->z.steps[i] = 0, s->z.open[i] = is_open;
        *open += is_open;
    }
#define GATHER(name)                                                                                              \
    for (int i = 0; i < width; i++)                                                                               \
        s->of.name[i] = b->name[lane[i]];
    CONSTANTS(GATHER)
    return width;
}

INLINE void evaluate(state *restrict s, int width)
{
#pragma GCC ivdep
    for (int i = 0; i < width; i++) {
        double square = s->z.x[i] * s->z.x[i], rest = 1 / (1 + square), near = square * rest;
        int upper = s->upper[i] > 0;
        design d = design_at(&s->of, i);
        rate r = rate_at(d, upper ? rest : near, upper ? near : rest);
        s->z.f[i] = scaled(d, r, s->branch[i]);
        s->value[i] = r.omega4.even + s->branch[i] * r.omega4.odd;
    }
}

typedef struct { double greatest[LANES], least[LANES]; } extremes;

static void refine(state *restrict s, const block *restrict b, list items, int phase, list *roots,
                   extremes *restrict best)
{
    for (long start = 0; start < items.count; start += LANES) {
        int real = items.count - start < LANES ? (int)(items.count - start) : LANES, open;
        const item *at = items.at + start;
        int width = gather(s, b, at, real, phase, &open);
        double beside[LANES];
        if (phase == ENDS) {
            for (int i = 0; i < width; i++)
                s->z.x[i] = FARTHER * s->z.x[i];
            evaluate(s, width);
            for (int i = 0; i < width; i++)
                beside[i] = fabs(s->value[i]), s->z.x[i] = items.at[start + (i < real ? i : real - 1)].xa;
        }
        for (evaluate(s, width); open > 0; evaluate(s, width)) {
            if (phase == ROOTS)
                advance_roots(&s->z, width);
            else
                for (int i = 0; i < width; i++)
                    if (s->z.open[i] > 0)
                        advance_valley(&s->z, i);
            double count = 0;
            for (int i = 0; i < width; i++)
                count += s->z.open[i];
            open = (int)count;
        }
        for (int i = 0; i < real; i++) {
            item t = at[i];
            double value = s->value[i], x = s->z.x[i], f = s->z.f[i];
            if (phase == VALLEYS) {
                double ends = fabs(t.fa) > fabs(t.fb) ? fabs(t.fa) : fabs(t.fb);
                if ((f > 0) != (s->z.fc[i] > 0) && fabs(f) > FLAT * ends) {
                    append(roots, (item){t.lane, t.branch, t.upper, t.xa, t.fa, x, f, 0, 0});
                    append(roots, (item){t.lane, t.branch, t.upper, x, f, t.xb, t.fb, 0, 0});
                }
                continue;
            }
            if (phase == ENDS) {
                int fold = b->toggle[(int)t.upper][t.lane] == 0;
                int pole = fold & (x > 0) & (beside[i] > 0) & (fabs(value) > GROWS * beside[i]);
                if (pole | (!fold & (value != 0)))
                    value *= INFINITY;
            }
            if (value > best->greatest[t.lane])
                best->greatest[t.lane] = value;
            if (value < best->least[t.lane])
                best->least[t.lane] = value;
        }
    }
}

const long c_extrema_cells = CELLS;

/* x: rows a1 a2 a3 a4 omega1, each of n designs. out: (2, n, 2) omega4_max omega4_min. */
void c_extrema(long n, const double *restrict x, double *restrict out)
{
    block b;
    state s;
    double places[2][CELLS + 1][LANES] __attribute__((aligned(64)));
    double f[2][SAMPLES][LANES] __attribute__((aligned(64)));
    item of_valleys[ROOM], of_roots[3 * ROOM], of_ends[4 * LANES];
    extremes best;
    for (long first = 0; first < n; first += LANES) {
        int lanes = n - first < LANES ? (int)(n - first) : LANES;
        list valleys = {of_valleys, 0}, roots = {of_roots, 0}, ends = {of_ends, 0};
        prepare(&b, x, n, first);
        sample(&b, places, f);
        for (int half = 0; half < 2; half++)
            collect(&b, places, f, half, lanes, &valleys, &roots);
        for (int i = 0; i < LANES; i++)
            best.greatest[i] = -INFINITY, best.least[i] = INFINITY;
        refine(&s, &b, valleys, VALLEYS, &roots, &best);
        refine(&s, &b, roots, ROOTS, &roots, &best);
        for (int i = 0; i < lanes; i++)
            for (int half = 0; half < 2; half++)
                for (int upper = 0; upper < 2; upper++) {
                    double place = b.start[upper][i];
                    if (place > 0 || best.greatest[i] == -INFINITY)
                        append(&ends, (item){i, half ? 1 : -1, upper, place, 0, place, 0, 0, 0});
                }
        refine(&s, &b, ends, ENDS, &roots, &best);
        for (int i = 0; i < lanes; i++)
            for (int branch = 0; branch < 2; branch++) {
                out[2 * (first + i) + branch] = best.greatest[i] == -INFINITY ? NAN : best.greatest[i];
                out[2 * (n + first + i) + branch] = best.least[i] == INFINITY ? NAN : best.least[i];
            }
    }
}
