/* Zeros and least magnitudes in their brackets, refined in the lanes: no cell waits for another design. */
#include "sums.h"

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
