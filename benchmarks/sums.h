/* What the C limit kernels share: lanes, sums and quotients that keep every digit. */
#include <math.h>

#define LANES 64
#define INLINE static inline __attribute__((always_inline))

/* For lists of names: a struct of scalars, one of arrays, and its reader. */
#define AS_SCALAR(name) double name;
#define AS_ARRAY(name) double name[LANES];
#define READ(name) .name = b->name[i],

typedef struct { double even, odd; } pair;
typedef struct { double hi, lo; } dd;

INLINE dd two_sum(double a, double b)
{
    double s = a + b, t = s - a;
    return (dd){s, (a - (s - t)) + (b - t)};
}

/* The last sum matters: next to a change point hi may have cancelled to less than lo. */
INLINE dd sum4(double a, double b, double c, double d)
{
    dd r = two_sum(a, b), s = two_sum(r.hi, c), t = two_sum(s.hi, d);
    return two_sum(t.hi, r.lo + s.lo + t.lo);
}

/* u v / (4 a d) to twice the working precision: p and q lose their leading digits near toggles and change points. */
INLINE dd gap(dd u, dd v, double a, double d)
{
    double p = u.hi * v.hi, p_low = fma(u.hi, v.hi, -p) + (u.hi * v.lo + u.lo * v.hi);
    double g = 4 * a * d, g_low = fma(4 * a, d, -g);
    double ratio = p / g;
    return two_sum(ratio, (fma(-ratio, g, p) + p_low - ratio * g_low) / g);
}
