"""The coupler point, and the kernel of paths: least squares on coupler points, eight linkages abreast.

A linkage is ten numbers: a1 a2 a3 a4 P_u P_v O_x O_y ground_angle phase, and a sign: +1 where B is left of the line
from A to D, which is branch 2. With times given, its crank stands at phase + times; else each point has an angle of its
own, which is eliminated (G. Golub, V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413): whatever the number of points, a
step solves for the ten numbers alone. Limits are linear, and kept at every step. The text of this module is that of
the kernel; linkages stand in the last axis of arrays.
"""

from __future__ import annotations

from typing import Any

from fastlink.numerics.compiler import inlined, lanes, outlined
from fastlink.numerics.elementary import cosine, sine, sqrt


@inlined
def assembled(
    a1: Any, a2: Any, a3: Any, a4: Any, u: Any, v: Any, side: Any, c: Any, s: Any, slider: int
) -> Any:
    """Return A, the directions of AB and DB, and P, in the frame with OD along x, by the crank's cosine and sine.

    NaN where the bars do not meet. A slider's D is infinitely far along y, and a3 its offset.
    """
    ax, ay = a1 * c, a1 * s
    dx, dy = (0.0 if slider != 0 else a4 - ax), (1.0 if slider != 0 else -ay)
    square = dx * dx + dy * dy
    along = (a3 - ay) / a2 if slider != 0 else (square + (a2 - a3) * (a2 + a3)) / (2.0 * a2 * square)
    across = side * sqrt(1.0 / square - along * along)
    bx, by = dx * along - dy * across, dx * across + dy * along
    fx, fy = (0.0 if slider != 0 else (a2 * bx - dx) / a3), (-1.0 if slider != 0 else (a2 * by - dy) / a3)
    return ax, ay, bx, by, fx, fy, ax + (u * bx - v * by), ay + (u * by + v * bx)


@inlined
def rates(a2: Any, ax: Any, ay: Any, bx: Any, by: Any, fx: Any, fy: Any, c: Any, s: Any, slider: int) -> Any:
    """Return how the coupler turns with a1 to a4 and the crank: the loop A + a2 b = a4 + a3 f, projected on f."""
    h = 1.0 / (a2 * (fx * by - fy * bx))
    return (
        (fx * c + fy * s) * h,
        (fx * bx + fy * by) * h,
        (h if slider != 0 else -h),
        -(fx * h),
        (fy * ax - fx * ay) * h,
    )


@outlined
def directions(p: Any, f: Any) -> None:
    """Store cosine and sine of the direction of OD."""
    for i in lanes(8):
        f[0, i] = cosine(p[8, i])
        f[1, i] = sine(p[8, i])


@outlined
def linearise(p: Any, side: Any, theta: Any, target: Any, roots: Any, timed: int, slider: int, open_: Any, f: Any,
              v: Any, m: Any, along: Any, slope: Any, across: Any) -> None:  # fmt: skip
    """Store the rows of the least squares of a step, and how each point moves along the curve with the numbers.

    In the frame with OD along x. With times each point has two rows; else one, of the part across the curve: the angle
    takes up the other.
    """
    directions(p, f)
    for i in lanes(8):
        v[4, i] = 0.0
    for n in range(target.shape[0]):
        x, y, root = target[n, 0], target[n, 1], roots[n]
        first = 2 * n if timed != 0 else n
        for i in lanes(8):
            c, s = cosine(theta[n, i]), sine(theta[n, i])
            ax, ay, bx, by, fx, fy, px, py = assembled(
                p[0, i], p[1, i], p[2, i], p[3, i], p[4, i], p[5, i], side[0, i], c, s, slider
            )
            r0, r1, r2, r3, r9 = rates(p[1, i], ax, ay, bx, by, fx, fy, c, s, slider)
            qx, qy = ay - py, px - ax
            tx, ty = qx * r9 - ay, qy * r9 + ax
            ex, ey = x - p[6, i], y - p[7, i]
            ox, oy = px - (f[0, i] * ex + f[1, i] * ey), py - (f[0, i] * ey - f[1, i] * ex)
            v[4, i] += root * root * (ox * ox + oy * oy)
            square = tx * tx + ty * ty + 1e-300
            slope[n, i] = square
            along[n, i] = tx * ox + ty * oy
            # the first row: along x with times, else across the curve
            length = root / sqrt(square)
            nx, ny = (root if timed != 0 else -(ty * length)), (0.0 if timed != 0 else tx * length)
            m[first, 0, i] = open_[0] * (nx * (qx * r0 + c) + ny * (qy * r0 + s))
            m[first, 1, i] = open_[1] * ((nx * qx + ny * qy) * r1)
            m[first, 2, i] = open_[2] * ((nx * qx + ny * qy) * r2)
            m[first, 3, i] = open_[3] * ((nx * qx + ny * qy) * r3)
            m[first, 4, i] = open_[4] * (nx * bx + ny * by)
            m[first, 5, i] = open_[5] * (ny * bx - nx * by)
            m[first, 6, i] = open_[6] * (nx * f[0, i] - ny * f[1, i])
            m[first, 7, i] = open_[7] * (nx * f[1, i] + ny * f[0, i])
            m[first, 8, i] = open_[8] * (ny * px - nx * py)
            m[first, 9, i] = open_[9] * (nx * tx + ny * ty)
            m[first, 10, i] = -(nx * ox + ny * oy)
            # the other: along y with times, else how the point moves along the curve
            gx, gy = (0.0 if timed != 0 else tx), (root if timed != 0 else ty)
            across[n, 0, i] = open_[0] * (gx * (qx * r0 + c) + gy * (qy * r0 + s))
            across[n, 1, i] = open_[1] * ((gx * qx + gy * qy) * r1)
            across[n, 2, i] = open_[2] * ((gx * qx + gy * qy) * r2)
            across[n, 3, i] = open_[3] * ((gx * qx + gy * qy) * r3)
            across[n, 4, i] = open_[4] * (gx * bx + gy * by)
            across[n, 5, i] = open_[5] * (gy * bx - gx * by)
            across[n, 6, i] = open_[6] * (gx * f[0, i] - gy * f[1, i])
            across[n, 7, i] = open_[7] * (gx * f[1, i] + gy * f[0, i])
            across[n, 8, i] = open_[8] * (gy * px - gx * py)
            across[n, 9, i] = open_[9] * (gx * tx + gy * ty)
            across[n, 10, i] = -(gx * ox + gy * oy)
        if timed != 0:
            for k in range(11):
                for i in lanes(8):
                    m[first + 1, k, i] = across[n, k, i]


@outlined
def damped(m: Any, rows: int, open_: Any, scales: Any, f: Any, v: Any, d: Any) -> None:
    """Store the damped step of least squares: by Householder's reflections, in place, of rows and of the damping's.

    The normal equations would square the condition, and short arcs have one of 1e8. Row r of the damping is zero but
    for the columns from r on, and the reflections keep it so.
    """
    for k in range(10):
        for i in lanes(8):
            f[k, i] = 0.0
    for n in range(rows):
        for k in range(10):
            for i in lanes(8):
                f[k, i] += m[n, k, i] * m[n, k, i]
    for k in range(10):
        for i in lanes(8):
            scales[k, i] = max(sqrt(f[k, i]), 0.3 * scales[k, i])
        for c in range(11):
            for i in lanes(8):
                m[rows + k, c, i] = 0.0
        for i in lanes(8):
            m[rows + k, k, i] = sqrt(v[2, i]) * (scales[k, i] + 1e-300) + (1.0 - open_[k])
    for j in range(10):
        for k in range(j, 11):
            for i in lanes(8):
                f[k, i] = 0.0
        for r in range(j, rows + j + 1):
            for k in range(j, 11):
                for i in lanes(8):
                    f[k, i] += m[r, j, i] * m[r, k, i]
        for i in lanes(8):
            size = sqrt(f[j, i])
            side = size if m[j, j, i] >= 0.0 else -size
            f[11, i] = m[j, j, i] + side
            f[12, i] = side
            f[13, i] = 1.0 / (side * (m[j, j, i] + side))
            m[j, j, i] = -side
        for k in range(j + 1, 11):
            for i in lanes(8):
                t = (f[k, i] + f[12, i] * m[j, k, i]) * f[13, i]
                m[j, k, i] -= f[11, i] * t
                f[k, i] = t
        for r in range(j + 1, rows + j + 1):
            for k in range(j + 1, 11):
                for i in lanes(8):
                    m[r, k, i] -= m[r, j, i] * f[k, i]
    for n in range(10):
        j = 9 - n
        for i in lanes(8):
            d[j, i] = m[j, 10, i]
        for k in range(j + 1, 10):
            for i in lanes(8):
                d[j, i] -= m[j, k, i] * d[k, i]
        for i in lanes(8):
            d[j, i] /= m[j, j, i]


@outlined
def in_order(theta: Any, side: Any, count: int, closed: int) -> None:
    """Move angles that overtake each other to where they meet; of a closed curve none goes beyond a turn."""
    for n in range(1, count):
        for i in lanes(8):
            behind = side[1, i] * (theta[n, i] - theta[n - 1, i]) < 0.0
            theta[n, i] = theta[n - 1, i] if behind else theta[n, i]
    if closed != 0:
        for n in range(1, count):
            for i in lanes(8):
                last = theta[0, i] + side[1, i] * 6.283185307179586
                theta[n, i] = last if side[1, i] * (theta[n, i] - last) > 0.0 else theta[n, i]


@outlined
def squares(
    p: Any, side: Any, theta: Any, target: Any, roots: Any, nearer: int, slider: int, f: Any, v: Any
) -> None:
    """Store the weighted sum of the squared distances; with `nearer` move angles to the places next to the points."""
    directions(p, f)
    for i in lanes(8):
        v[5, i] = 0.0
    for n in range(target.shape[0]):
        x, y, root = target[n, 0], target[n, 1], roots[n]
        for i in lanes(8):
            c, s = cosine(theta[n, i]), sine(theta[n, i])
            ax, ay, bx, by, fx, fy, px, py = assembled(
                p[0, i], p[1, i], p[2, i], p[3, i], p[4, i], p[5, i], side[0, i], c, s, slider
            )
            ex, ey = x - p[6, i], y - p[7, i]
            ox, oy = px - (f[0, i] * ex + f[1, i] * ey), py - (f[0, i] * ey - f[1, i] * ex)
            v[5, i] += root * root * (ox * ox + oy * oy)
            f[2, i] = px
            f[3, i] = py
            f[4, i] = ox
            f[5, i] = oy
            f[6, i] = (fy * ax - fx * ay) / (p[1, i] * (fx * by - fy * bx))
            f[7, i] = ax
            f[8, i] = ay
        if nearer != 0:
            for i in lanes(8):
                tx, ty = (f[8, i] - f[3, i]) * f[6, i] - f[8, i], (f[2, i] - f[7, i]) * f[6, i] + f[7, i]
                turn = (tx * f[4, i] + ty * f[5, i]) / (tx * tx + ty * ty + 1e-300)
                theta[n, i] -= min(max(turn, -0.2), 0.2)


@outlined
def back(m: Any, lane: int, x: Any) -> None:
    """Solve in place with the triangle R of a lane: R^T R x."""
    for a in range(10):
        t = x[a]
        for k in range(a):
            t -= m[k, a, lane] * x[k]
        x[a] = t / m[a, a, lane]
    for n in range(10):
        a = 9 - n
        t = x[a]
        for k in range(a + 1, 10):
            t -= m[a, k, lane] * x[k]
        x[a] = t / m[a, a, lane]


@outlined
def limits_of(p: Any, lane: int, lower: Any, upper: Any, crank: int, slider: int, open_: Any, g: Any) -> int:
    """Store the linear limits of a step of one linkage, and return how many: g[., :10] d >= g[., 10]."""
    count = 0
    for k in range(10):
        for end in range(2):
            bound = lower[k] - p[k, lane] if end == 0 else p[k, lane] - upper[k]
            if bound > -1e300 and open_[k] > 0.0:
                for c in range(10):
                    g[count, c] = 0.0
                g[count, k] = 1.0 if end == 0 else -1.0
                g[count, 10] = bound
                count += 1
    if crank != 0:
        longer = 1.0 if (slider != 0) | (p[3, lane] >= p[0, lane]) else -1.0
        for k in range(2 if slider != 0 else 3):
            for c in range(4, 10):
                g[count, c] = 0.0
            g[count, 0] = open_[0] * (-longer if k < 2 else -1.0)
            g[count, 3] = open_[3] * (longer if k < 2 else -1.0)
            g[count, 1] = open_[1] * (-1.0 if (k == 1) & (slider == 0) else 1.0)
            g[count, 2] = open_[2] * (-1.0 if k == 0 else 1.0)
            g[count, 10] = folded(p[0, lane], p[1, lane], p[2, lane], p[3, lane], 1.0 * k, slider)
            count += 1
    return count


@inlined
def folded(a1: Any, a2: Any, a3: Any, a4: Any, k: Any, slider: int) -> Any:
    """Return how much of Grashof's conditions on a shortest crank or ground link is missing: three, of a slider two."""
    by_side = (a1 - a4 if a4 >= a1 else a4 - a1) + (a2 - a3 if k == 1.0 else a3 - a2)
    by_all = 1e-9 * (a1 + a2 + a3 + a4) + (a1 + a4 - a2 - a3 if k == 2.0 else by_side)
    by_line = 1e-9 * (a1 + a2) + (a1 - a2 + (a3 if k == 0.0 else -a3))
    return (-1.0 if k == 2.0 else by_line) if slider != 0 else by_all


@outlined
def worst_limit(g: Any, count: int, w: Any, used: int) -> int:
    """Return the limit that a step, w[0], breaks most, for its size, of those that are not active; -1 for none."""
    worst, which = -1e-13, -1
    for c in range(count):
        value, size = -g[c, 10], abs(g[c, 10])
        for k in range(10):
            value += g[c, k] * w[0, k]
            size += abs(g[c, k] * w[0, k])
        for a in range(used):
            if w[2 + a, 11] == 1.0 * c:
                value = 0.0
        if value < 0.0 and value < worst * size:
            worst, which = value / size, c
    return which


@outlined
def multipliers(m: Any, lane: int, g: Any, w: Any, used: int, h: Any) -> int:
    """Store the multipliers of active limits; tell whether these are independent."""
    for a in range(used):
        row = int(w[2 + a, 11])
        t = g[row, 10]
        for k in range(10):
            w[2 + a, k] = g[row, k]
            t -= g[row, k] * w[1, k]
        w[2 + a, 10] = t
        back(m, lane, w[2 + a])
    for a in range(used):
        row = int(w[2 + a, 11])
        for b in range(used):
            t = 0.0
            for k in range(10):
                t += g[row, k] * w[2 + b, k]
            h[a, b] = t
        h[a, a] *= 1.0 + 1e-14
    # by Cholesky, and back
    for j in range(used):
        for i in range(j, used):
            t = h[i, j]
            for k in range(j):
                t -= h[i, k] * h[j, k]
            if i == j:
                if t <= 0.0:
                    return 0
                h[j, j] = sqrt(t)
            else:
                h[i, j] = t / h[j, j]
    for i in range(used):
        t = w[2 + i, 10]
        for k in range(i):
            t -= h[i, k] * w[2 + k, 10]
        w[2 + i, 10] = t / h[i, i]
    for n in range(used):
        i = used - 1 - n
        t = w[2 + i, 10]
        for k in range(i + 1, used):
            t -= h[k, i] * w[2 + k, 10]
        w[2 + i, 10] = t / h[i, i]
    return 1


@outlined
def step_within(m: Any, lane: int, d: Any, g: Any, count: int, w: Any, h: Any) -> None:
    """Change the step, which minimises the model with the triangle of m, to that within linear limits.

    Limits are added, the worst first, and dropped where their multiplier has the wrong sign; what is left is shortened.
    Of w: row 0 the step, 1 the first one, then for each active limit what it moves, its multiplier, its number.
    """
    used = 0
    for k in range(10):
        w[0, k] = d[k, lane]
        w[1, k] = d[k, lane]
    for _ in range(92):
        which = worst_limit(g, count, w, used)
        if which < 0 or used >= 10:
            break
        w[2 + used, 11] = float(which)
        used += 1
        while used > 0:
            if multipliers(m, lane, g, w, used, h) == 0:
                used -= 1
                break
            least, out = 0.0, -1
            for a in range(used):
                if w[2 + a, 10] < least:
                    least, out = w[2 + a, 10], a
            if out < 0:
                break
            for a in range(out, used - 1):
                w[2 + a, 11] = w[3 + a, 11]
            used -= 1
        for k in range(10):
            t = w[1, k]
            for a in range(used):
                t += w[2 + a, 10] * w[2 + a, k]
            w[0, k] = t
    share = 1.0
    for c in range(count):
        value = 0.0
        for k in range(10):
            value += g[c, k] * w[0, k]
        # those that are active hold but for rounding
        for a in range(used):
            if w[2 + a, 11] == 1.0 * c:
                value = 0.0
        if value < g[c, 10] and value < 0.0:
            share = min(share, max(g[c, 10] / value, 0.0))
    for k in range(10):
        d[k, lane] = share * w[0, k]


@outlined
def step(p: Any, side: Any, theta: Any, target: Any, roots: Any, times: Any, options: Any, open_: Any, lower: Any,
         upper: Any, enough: Any, most: int, q: Any, moved: Any, d: Any, scales: Any, f: Any, v: Any, m: Any,
         along: Any, slope: Any, across: Any, g: Any, w: Any, h: Any) -> None:  # fmt: skip
    """Take one step of Levenberg-Marquardt with eight linkages, each if it gains.

    Rows of v: the linkage, steps, damping, small gains in turn, squares before and after, whether a limit is broken,
    whether it has ended.
    """
    timed, crank, closed, slider, count = options[0], options[1], options[2], options[3], target.shape[0]
    linearise(p, side, theta, target, roots, timed, slider, open_, f, v, m, along, slope, across)
    damped(m, 2 * count if timed != 0 else count, open_, scales, f, v, d)
    for i in lanes(8):
        v[6, i] = 0.0
    for k in range(10):
        for i in lanes(8):
            q[k, i] = p[k, i] + d[k, i]
            v[6, i] = 1.0 if (q[k, i] < lower[k]) | (q[k, i] > upper[k]) else v[6, i]
    if crank != 0:
        for k in range(3):
            for i in lanes(8):
                v[6, i] = (
                    1.0 if folded(q[0, i], q[1, i], q[2, i], q[3, i], 1.0 * k, slider) > 0.0 else v[6, i]
                )
    for lane in range(8):
        if v[6, lane] > 0.0 and v[0, lane] >= 0.0:
            step_within(m, lane, d, g, limits_of(p, lane, lower, upper, crank, slider, open_, g), w, h)
    for k in range(10):
        for i in lanes(8):
            q[k, i] = min(max(p[k, i] + d[k, i], lower[k]), upper[k])
    if timed != 0:
        for n in range(count):
            for i in lanes(8):
                moved[n, i] = q[9, i] + times[n]
    else:
        for n in range(count):
            for i in lanes(8):
                t = across[n, 0, i] * d[0, i] + across[n, 1, i] * d[1, i] + across[n, 2, i] * d[2, i]
                t = t + across[n, 3, i] * d[3, i] + across[n, 4, i] * d[4, i] + across[n, 5, i] * d[5, i]
                t = t + across[n, 6, i] * d[6, i] + across[n, 7, i] * d[7, i] + across[n, 8, i] * d[8, i]
                moved[n, i] = theta[n, i] - min(max((along[n, i] + t) / slope[n, i], -0.4), 0.4)
        in_order(moved, side, count, closed)
        squares(q, side, moved, target, roots, 1, slider, f, v)
        in_order(moved, side, count, closed)
    squares(q, side, moved, target, roots, 0, slider, f, v)
    for i in lanes(8):
        built = (q[0, i] > 0.0) & (q[1, i] > 0.0) & ((slider != 0) | ((q[2, i] > 0.0) & (q[3, i] > 0.0)))
        good = built & (v[5, i] < v[4, i])
        f[0, i] = 1.0 if good else 0.0
        small = v[3, i] + 1.0 if v[4, i] - v[5, i] < 1e-9 * v[4, i] else 0.0
        v[3, i] = small if good else v[3, i]
        v[2, i] = max(v[2, i] * 0.1, 1e-18) if good else max(v[2, i] * 5.0, 1e-14)
        v[4, i] = v[5, i] if good else v[4, i]
        v[1, i] += 1.0
        stuck = (v[2, i] > 1e8) | (v[3, i] > 3.5) | (v[1, i] > 1.0 * most - 0.5) | (v[4, i] <= enough[0])
        v[7, i] = 1.0 if stuck | (v[4, i] != v[4, i]) else 0.0
    for k in range(10):
        for i in lanes(8):
            p[k, i] = q[k, i] if f[0, i] > 0.0 else p[k, i]
    for n in range(count):
        for i in lanes(8):
            theta[n, i] = moved[n, i] if f[0, i] > 0.0 else theta[n, i]


def kernel(numbers: Any, signs: Any, angles: Any, cost: Any, target: Any, roots: Any, times: Any, options: Any,
           open_: Any, lower: Any, upper: Any, enough: Any, most: int, p: Any, side: Any, theta: Any, q: Any,
           moved: Any, d: Any, scales: Any, f: Any, v: Any, m: Any, along: Any, slope: Any, across: Any, g: Any,
           w: Any, h: Any) -> None:  # fmt: skip
    """Refine linkages (rows of numbers, of signs and senses, and of angles) in place; store the sums of squares."""
    count, points, taken = numbers.shape[0], target.shape[0], 0
    for lane in range(8):
        v[0, lane] = -1.0
        v[7, lane] = 0.0
    going = 1
    while going > 0:
        going = 0
        for lane in range(8):
            row = int(v[0, lane])
            if row >= 0 and v[7, lane] > 0.0:
                cost[row] = v[4, lane]
                for k in range(10):
                    numbers[row, k] = p[k, lane]
                for n in range(points):
                    angles[row, n] = theta[n, lane]
                v[0, lane] = -1.0
            if v[0, lane] < 0.0 and taken < count:
                v[0, lane] = float(taken)
                for k in range(10):
                    p[k, lane] = numbers[taken, k]
                    scales[k, lane] = 0.0
                for k in range(2):
                    side[k, lane] = signs[taken, k]
                for n in range(points):
                    theta[n, lane] = p[9, lane] + times[n] if options[0] != 0 else angles[taken, n]
                for k in range(1, 8):
                    v[k, lane] = 0.0
                v[2, lane] = 1e-3
                taken += 1
            if v[0, lane] >= 0.0:
                going = 1
        if going > 0:
            step(p, side, theta, target, roots, times, options, open_, lower, upper, enough, most, q, moved, d,
                 scales, f, v, m, along, slope, across, g, w, h)  # fmt: skip
