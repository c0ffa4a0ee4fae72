/* Planar 4R in plain C: the speed limit that the compiled plans are measured against.
 *
 * Arithmetic: the stable closed forms of the engine, strict IEEE (no contraction, no reassociation). What does not
 * depend on the input angle is computed once per design, and what does not depend on the assembly mode once per
 * design and angle: every quantity is even +- odd, with + for branch 2 and - for branch 1.
 *
 * Curves run with lanes = angles, so that stores are contiguous; cycle extremes run with lanes = designs, so that
 * the accumulators are arrays and no loop carries a scalar. There the root and the divisions have a loop of their own:
 * in one loop with the rest, their latency is longer than the processor can look ahead. (For curves the same split
 * gains nothing.)
 *
 * x: rows a1 a2 a3 a4 omega1 m1 m2 m3 I1 I2 I3 G1_u G1_v G2_u G2_v G3_u G3_v, each of n designs.
 * tables: rows cos, sin, Z, Z_low, C, C_low, each of K angles, with Z = sin^2(theta1/2), C = cos^2(theta1/2).
 */
#include <math.h>

#define LANES 64
#define INLINE static inline __attribute__((always_inline))

/* For lists of names and formulas: a struct of scalars, one of arrays, its writer and its reader. */
#define AS_SCALAR(name, formula) double name;
#define AS_ARRAY(name, formula) double name[LANES];
#define WRITE(name, formula) o->name[i] = formula;
#define READ(name, formula) .name = b->name[i],

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

/* Constants of a design with their formulas, of which the structs and their readers follow. */
#define CONSTANTS(_)                                                                                              \
    _(a, a) _(two_a, 2 * a) _(d_a, d - a) _(d, d) _(mu, (d - a) / (2 * a)) _(lambda, (a - d) / (2 * d))           \
    _(Z0, -Z.hi) _(Z0_low, -Z.lo) _(C0, C.hi) _(C0_low, C.lo)                                                     \
    _(Z0_ww, -0.25 * w * w * Z.hi) _(C0_ww, 0.25 * w * w * C.hi) _(gamma0, (a - d) * (a - d) * r)                 \
    _(kappa, (b - c) * (b + c) * r) _(eps, (a - d) * (a + d) * r) _(from_A, a + b <= c + d)                       \
    _(two_beta, 2 * b * (b - c) * r) _(two_delta, 2 * c * (b - c) * r) /* of the other sign */                    \
    _(half_w, 0.5 * w) _(half_ww, 0.5 * w * w) _(ww, w * w) _(r_2ad, 0.5 / a / d)                                 \
    _(f1_u, -w * w * m[0] * G[0]) _(f1_v, -w * w * m[0] * G[n]) _(g2_u, G[2 * n] / b) _(g2_v, G[3 * n] / b)       \
    _(f3_u, m[2 * n] * (G[4 * n] / c)) _(f3_v, m[2 * n] * (G[5 * n] / c)) _(m2, m[n]) _(m2_ww, m[n] * (w * w))    \
    _(I2, I[n]) _(I2_A, I[n] + m[n] * (G[2 * n] * G[2 * n] + G[3 * n] * G[3 * n]))                                \
    _(I3_D, I[2 * n] + m[2 * n] * (G[4 * n] * G[4 * n] + G[5 * n] * G[5 * n])) _(J3_r, o->I3_D[i] * o->r_2ad[i])
typedef struct { CONSTANTS(AS_SCALAR) } design;
typedef struct { CONSTANTS(AS_ARRAY) } __attribute__((aligned(64))) block;
typedef struct { double cos, sin, Z, Z_low, C, C_low; } angle;
typedef struct { double x, y; } vec;

INLINE design design_at(const block *b, int i) { return (design){CONSTANTS(READ)}; }

INLINE angle angle_at(const double *restrict t, long K, long k)
{
    return (angle){t[k], t[K + k], t[2 * K + k], t[3 * K + k], t[4 * K + k], t[5 * K + k]};
}

/* ---- once per design ---- */

/* Lanes past the last design repeat it; the compiler leaves out what a case does not read. */
INLINE void prepare(block *restrict o, const double *restrict x, long n, long first)
{
#pragma GCC ivdep
    for (int i = 0; i < LANES; i++) {
        long j = first + i < n ? first + i : n - 1;
        double a = x[j], b = x[n + j], c = x[2 * n + j], d = x[3 * n + j], w = x[4 * n + j];
        const double *m = x + 5 * n + j, *I = x + 8 * n + j, *G = x + 11 * n + j;
        dd Z = gap(sum4(a, -b, c, -d), sum4(a, b, -c, -d), a, d), C = gap(sum4(a, -b, -c, d), sum4(a, b, c, d), a, d);
        double r = 1 / (4 * a * d);
        CONSTANTS(WRITE)
    }
}

/* ---- once per design and angle ---- */

/* sigma is NaN where the linkage does not assemble; the shares are kappa/gamma + 1 and kappa/gamma - 1, twice the feet
 * of B on AD, from A and from D, over |AD|: sums with p keep their digits. */
typedef struct { double p, q, sigma, r_gamma, r_sigma, plus, minus; } closure;

INLINE closure with_shares(design d, double p, double q, double sigma, double r_gamma, double r_sigma)
{
    return (closure){p, q, sigma, r_gamma, r_sigma, (p + d.two_beta) * r_gamma, (d.two_delta - p) * r_gamma};
}

INLINE closure close_loop(design d, angle t)
{
    double p = (t.Z - d.Z0) + (t.Z_low - d.Z0_low), q = (t.C - d.C0) + (t.C_low - d.C0_low);
    double sigma = sqrt(p * q);
    return with_shares(d, p, q, sigma, 1 / (d.gamma0 + t.Z), 1 / sigma);
}

typedef struct { vec A, AB_even, DB_even, B_even, odd; } positions_t; /* AB, DB and B share their odd part */

INLINE positions_t positions(design d, angle t, closure l)
{
    vec A = {d.a * t.cos, d.a * t.sin}, u = {d.d_a + d.two_a * t.Z, -A.y};
    double ab = 0.5 * l.plus, db = 0.5 * l.minus, height = 0.5 * l.sigma * l.r_gamma;
    vec AB = {ab * u.x, ab * u.y}, DB = {db * u.x, db * u.y};
    vec B = {d.from_A > 0 ? A.x + AB.x : d.d + DB.x, DB.y}; /* by the shorter links */
    return (positions_t){A, AB, DB, B, {height * A.y, height * u.x}};
}

/* The first four, and n = omega2/omega1, n - 1 and omega4/omega1. */
typedef struct { pair omega2, omega4, alpha2, alpha4, coupler, joint, output; } rates_t;

/* H = h / sigma, dH its derivative; the factors omega1 / 2 and omega1^2 / 2 are taken in where that costs least. */
INLINE rates_t rates(design d, angle t, closure l)
{
    double h = 0.5 * t.sin, H = h * l.r_sigma, wH = d.half_w * H;
    double dH = (d.C0_ww * t.Z * l.p - d.Z0_ww * t.C * l.q) * (l.r_sigma * l.r_sigma * l.r_sigma);
    double k = d.kappa * l.r_gamma;
    double T = d.half_w * ((d.lambda + t.Z) * l.r_gamma), j = d.half_ww * h * l.r_gamma;
    double E = -(d.eps * j * l.r_gamma), L = H * k * j;
    double n = 0.5 * ((d.lambda + t.Z) * l.r_gamma), J = -(0.5 * ((d.mu + t.Z) * l.r_gamma)), half = 0.5 * H;
    return (rates_t){{T, wH * l.minus}, {T, wH * l.plus}, {E, dH * l.minus - L}, {E, dH * l.plus - L},
                     {n, half * l.minus}, {J, half * l.minus}, {n, half * l.plus}};
}

INLINE double at(double s, pair f) { return f.even + s * f.odd; }
INLINE vec at_vec(double s, vec even, vec odd) { return (vec){even.x + s * odd.x, even.y + s * odd.y}; }

/* ---- per configuration ---- */

typedef struct { vec F41, F21, F32, F43; double T41; } reactions_t;

INLINE vec turned(double u, double v, vec link) { return (vec){u * link.x - v * link.y, u * link.y + v * link.x}; }

/* The moments of links 2 and 3 about A and D give F32, since AB x DB = s 2 a d sigma; the other forces follow. The
 * torque is that of the power: where the links turn nearly as one, A x F21 is a small difference of great forces.
 * beside: from A to D in the frame of OA. */
INLINE reactions_t reactions(design d, angle t, closure l, positions_t o, rates_t f, double s)
{
    vec f1 = {d.f1_u * t.cos - d.f1_v * t.sin, d.f1_u * t.sin + d.f1_v * t.cos};
    vec aA = {-d.ww * o.A.x, -d.ww * o.A.y}, beside = {d.d_a - 2 * d.d * t.Z, -(d.d * t.sin)};
    vec AB = at_vec(s, o.AB_even, o.odd), DB = at_vec(s, o.DB_even, o.odd);
    double alpha2 = at(s, f.alpha2), w2 = at(s, f.omega2) * at(s, f.omega2);
    double alpha4 = at(s, f.alpha4), w4 = at(s, f.omega4) * at(s, f.omega4);
    vec g2 = turned(d.g2_u, d.g2_v, AB), g3 = turned(d.f3_u, d.f3_v, DB); /* g3 times m3 */
    vec f2 = {d.m2 * (aA.x - alpha2 * g2.y - w2 * g2.x), d.m2 * (aA.y + alpha2 * g2.x - w2 * g2.y)};
    double ab = 0.5 * l.plus, height = 0.5 * l.sigma * l.r_gamma;
    double AB_u = ab * beside.x - s * (height * beside.y), AB_v = ab * beside.y + s * (height * beside.x);
    double cross = d.a * (d.g2_u * AB_v + d.g2_v * AB_u); /* A x AG2 */
    double M2 = (d.I2_A * alpha2 + d.m2_ww * cross) * (s * (d.r_2ad * l.r_sigma));
    double M3 = alpha4 * (s * (d.J3_r * l.r_sigma));
    vec F32 = {M2 * DB.x + M3 * AB.x, M2 * DB.y + M3 * AB.y}, F21 = {F32.x - f2.x, F32.y - f2.y};
    vec F43 = {F32.x - (alpha4 * g3.y + w4 * g3.x), F32.y + (alpha4 * g3.x - w4 * g3.y)};
    double n2 = at(s, f.coupler), turn = n2 * at(s, f.joint);
    vec arm = {o.A.x + n2 * g2.x, o.A.y + n2 * g2.y};
    double T2 = alpha2 * (d.I2 * n2 + d.m2 * (g2.x * arm.x + g2.y * arm.y)) - d.m2_ww * (turn * cross);
    double T3 = (d.I3_D * alpha4) * at(s, f.output);
    return (reactions_t){{f1.x - F21.x, f1.y - F21.y}, F21, F32, F43, T2 + T3};
}

/* ---- the four cases ---- */

/* A curve is (n, 2, K); curve c of one design begins at y + c * size and its branch 2 at K further on. */
#define STORE(c, b1, b2) (y[(c) * size + k] = (b1), y[(c) * size + K + k] = (b2))
#define STORE_PAIR(c, f) STORE(c, at(-1, f), at(1, f))
#define STORE_VEC(c, b1, b2) (STORE(c, (b1).x, (b2).x), STORE((c) + 1, (b1).y, (b2).y))
/* A function of that name, which stores what it finds at each angle. */
#define CURVES(name, ...)                                                                                         \
    void c_##name(long n, long K, const double *restrict x, const double *restrict tables, double *restrict out)  \
    {                                                                                                             \
        long size = 2 * n * K;                                                                                    \
        block b;                                                                                                  \
        for (long first = 0; first < n; first += LANES) {                                                         \
            prepare(&b, x, n, first);                                                                             \
            for (long i = 0; i < LANES && first + i < n; i++) {                                                   \
                design d = design_at(&b, i);                                                                      \
                double *restrict y = out + (first + i) * 2 * K;                                                   \
                _Pragma("GCC ivdep") for (long k = 0; k < K; k++)                                                 \
                {                                                                                                 \
                    angle t = angle_at(tables, K, k);                                                             \
                    closure l = close_loop(d, t);                                                                 \
                    positions_t o = positions(d, t, l);                                                           \
                    rates_t f = rates(d, t, l);                                                                   \
                    __VA_ARGS__                                                                                   \
                }                                                                                                 \
            }                                                                                                     \
        }                                                                                                         \
    }

/* out: (4, n, 2, K) A_x A_y B_x B_y */
CURVES(positions, {
    STORE_VEC(0, o.A, o.A);
    STORE_VEC(2, at_vec(-1, o.B_even, o.odd), at_vec(1, o.B_even, o.odd));
})

/* out: (6, n, 2, K) B_x B_y omega2 omega4 alpha2 alpha4 */
CURVES(rates, {
    STORE_VEC(0, at_vec(-1, o.B_even, o.odd), at_vec(1, o.B_even, o.odd));
    STORE_PAIR(2, f.omega2);
    STORE_PAIR(3, f.omega4);
    STORE_PAIR(4, f.alpha2);
    STORE_PAIR(5, f.alpha4);
})

/* out: (9, n, 2, K) F41_x F41_y F21_x F21_y F32_x F32_y F43_x F43_y T41 */
CURVES(reactions, {
    reactions_t r1 = reactions(d, t, l, o, f, -1), r2 = reactions(d, t, l, o, f, 1);
    STORE_VEC(0, r1.F41, r2.F41);
    STORE_VEC(2, r1.F21, r2.F21);
    STORE_VEC(4, r1.F32, r2.F32);
    STORE_VEC(6, r1.F43, r2.F43);
    STORE(8, r1.T41, r2.T41);
})

/* out: (6, n, 2) omega4_max omega4_min alpha4_max alpha4_min T41_max F32_x_max. A comparison with NaN is false,
 * so a configuration that does not assemble changes nothing; the sentinel left over where none does becomes NaN. */
void c_extremes(long n, long K, const double *restrict x, const double *restrict tables, double *restrict out)
{
    static const double start[6] = {-INFINITY, INFINITY, -INFINITY, INFINITY, -INFINITY, -INFINITY};
    block b;
    struct { double p[LANES], q[LANES], sigma[LANES], r_gamma[LANES], r_sigma[LANES]; } c __attribute__((aligned(64)));
    double best[6][2][LANES] __attribute__((aligned(64)));
#define KEEP(q, branch, v, beyond) best[q][branch][i] = v beyond best[q][branch][i] ? v : best[q][branch][i];
#define KEEP_ALL(branch, s, r)                                                                                    \
    KEEP(0, branch, at(s, f.omega4), >) KEEP(1, branch, at(s, f.omega4), <) KEEP(2, branch, at(s, f.alpha4), >)   \
    KEEP(3, branch, at(s, f.alpha4), <) KEEP(4, branch, r.T41, >) KEEP(5, branch, r.F32.x, >)
    for (long first = 0; first < n; first += LANES) {
        prepare(&b, x, n, first);
        for (int q = 0; q < 6; q++)
            for (int i = 0; i < LANES; i++)
                best[q][0][i] = best[q][1][i] = start[q];
        for (long k = 0; k < K; k++) {
            angle t = angle_at(tables, K, k);
#pragma GCC ivdep
            for (int i = 0; i < LANES; i++) {
                closure l = close_loop(design_at(&b, i), t);
                c.p[i] = l.p, c.q[i] = l.q, c.sigma[i] = l.sigma, c.r_gamma[i] = l.r_gamma, c.r_sigma[i] = l.r_sigma;
            }
#pragma GCC ivdep
            for (int i = 0; i < LANES; i++) {
                design d = design_at(&b, i);
                closure l = with_shares(d, c.p[i], c.q[i], c.sigma[i], c.r_gamma[i], c.r_sigma[i]);
                positions_t o = positions(d, t, l);
                rates_t f = rates(d, t, l);
                reactions_t r1 = reactions(d, t, l, o, f, -1), r2 = reactions(d, t, l, o, f, 1);
                KEEP_ALL(0, -1, r1)
                KEEP_ALL(1, 1, r2)
            }
        }
        for (int q = 0; q < 6; q++)
            for (int branch = 0; branch < 2; branch++)
                for (int i = 0; i < LANES && first + i < n; i++) {
                    double v = best[q][branch][i];
                    out[(q * n + first + i) * 2 + branch] = v == start[q] ? NAN : v;
                }
    }
}
