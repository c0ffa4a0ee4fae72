"""Kernels of synthesis, compiled by numba: least squares on coupler points, and shapes compared with a task.

A linkage is ten numbers: a1 a2 a3 a4 P_u P_v O_x O_y ground_angle phase, and a sign s: +1 where B is left of the line
from A to D, which is branch 2. With times given, its crank stands at phase + times; else each point has an angle of its
own, which is eliminated (G. Golub, V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413): whatever the number of points, a
step solves for the ten numbers alone. The text is compiled as it stands here; it is not run as Python.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fastlink.numerics.compiler import outlined

#: Numbers of a linkage; linear limits: two of each number, three of Grashof's.
SIZE, LIMITS = 10, 23


@outlined
def unit(angle: float) -> complex:
    """Return e^(i angle)."""
    return complex(np.cos(angle), np.sin(angle))


@outlined
def clear(row: Any, n: int) -> None:
    """Store zeros."""
    for k in range(n):
        row[k] = 0.0


@outlined
def clear_all(m: Any) -> None:
    """Store zeros."""
    for i in range(m.shape[0]):
        for k in range(m.shape[1]):
            m[i, k] = 0.0


@outlined
def coupler(p: Any, s: float, theta: float) -> Any:
    """Return whether the bars meet at a crank angle, the coupler point, e^(i theta), e^(i theta2), e^(i theta4)."""
    e = unit(theta)
    far = p[3] - p[0] * e
    size = np.sqrt(far.real * far.real + far.imag * far.imag)
    cosine = (size * size + (p[1] - p[2]) * (p[1] + p[2])) / (2.0 * size * p[1])
    rest = 1.0 - cosine * cosine
    if not rest > 0.0:
        return False, e, e, e, e
    b = far / size * complex(cosine, s * np.sqrt(rest))
    f = (p[1] * b - far) / p[2]
    turn = unit(p[8])
    at = complex(p[6], p[7]) + turn * (p[0] * e + complex(p[4], p[5]) * b)
    return True, at, e, b, f


@outlined
def slopes(p: Any, at: complex, e: complex, b: complex, f: complex, out: Any) -> None:
    """Store the derivatives of the coupler point by the numbers; the last one is that by the crank angle.

    The loop A + a2 b = a4 + a3 f, projected on f, gives the turn of the coupler.
    """
    turn = unit(p[8])
    w = complex(p[4], p[5])
    sine = (np.conj(f) * b).imag * p[1]
    swing = turn * w * 1j * b / sine
    out[0] = turn * e + swing * (np.conj(f) * e).real
    out[1] = swing * (np.conj(f) * b).real
    out[2] = -swing
    out[3] = -swing * f.real
    out[4] = turn * b
    out[5] = turn * b * 1j
    out[6] = 1.0
    out[7] = 1j
    out[8] = 1j * (at - complex(p[6], p[7]))
    out[9] = turn * (p[0] * 1j * e) + swing * (np.conj(f) * (p[0] * 1j * e)).real


@outlined
def cholesky(m: Any, n: int) -> bool:
    """Factor a symmetric matrix in place, lower triangle; tell whether it is positive."""
    for j in range(n):
        d = m[j, j]
        for k in range(j):
            d -= m[j, k] * m[j, k]
        if not d > 0.0:
            return False
        d = np.sqrt(d)
        m[j, j] = d
        for i in range(j + 1, n):
            t = m[i, j]
            for k in range(j):
                t -= m[i, k] * m[j, k]
            m[i, j] = t / d
    return True


@outlined
def solve(m: Any, n: int, x: Any) -> None:
    """Solve in place with a factored matrix."""
    for i in range(n):
        t = x[i]
        for k in range(i):
            t -= m[i, k] * x[k]
        x[i] = t / m[i, i]
    for i in range(n - 1, -1, -1):
        t = x[i]
        for k in range(i + 1, n):
            t -= m[k, i] * x[k]
        x[i] = t / m[i, i]


@outlined
def limits_of(p: Any, lower: Any, upper: Any, crank: int, rows: Any, bounds: Any) -> int:
    """Store the linear limits rows d >= bounds of a step, and return how many there are."""
    count = 0
    for k in range(SIZE):
        if lower[k] > -np.inf:
            clear(rows[count], SIZE)
            rows[count, k] = 1.0
            bounds[count] = lower[k] - p[k]
            count += 1
        if upper[k] < np.inf:
            clear(rows[count], SIZE)
            rows[count, k] = -1.0
            bounds[count] = p[k] - upper[k]
            count += 1
    if crank != 0:
        longer = 1.0 if p[3] >= p[0] else -1.0
        margin = 1e-9 * (p[0] + p[1] + p[2] + p[3])
        for k in range(3):
            clear(rows[count], SIZE)
            side = 1.0 if k == 0 else -1.0
            if k < 2:
                rows[count, 0], rows[count, 3] = -longer, longer
                rows[count, 1], rows[count, 2] = side, -side
            else:
                rows[count, 0], rows[count, 1], rows[count, 2], rows[count, 3] = -1.0, 1.0, 1.0, -1.0
            value = margin
            for j in range(4):
                value -= rows[count, j] * p[j]
            bounds[count] = value
            count += 1
    return count


@outlined
def worst_limit(free: Any, n: int, rows: Any, bounds: Any, count: int, active: Any, used: int, d: Any) -> int:
    """Return the limit that a step breaks most, for its size, of those that are not active; -1 for none."""
    worst, which = -1e-13, -1
    for c in range(count):
        value = 0.0
        size = abs(bounds[c])
        for k in range(n):
            value += rows[c, free[k]] * d[k]
            size += abs(rows[c, free[k]] * d[k])
        value -= bounds[c]
        for a in range(used):
            if active[a] == c:
                value = 0.0
        if value < 0.0 and value < worst * size:
            worst, which = value / size, c
    return which


@outlined
def multipliers(m: Any, free: Any, n: int, rows: Any, bounds: Any, active: Any, used: int, first: Any, inverse: Any,
                small: Any, mu: Any) -> bool:  # fmt: skip
    """Store the multipliers of active limits; tell whether these are independent."""
    for a in range(used):
        mu[a] = bounds[active[a]]
        for k in range(n):
            inverse[a, k] = rows[active[a], free[k]]
            mu[a] -= rows[active[a], free[k]] * first[k]
        solve(m, n, inverse[a])
    for a in range(used):
        for b in range(used):
            t = 0.0
            for k in range(n):
                t += rows[active[a], free[k]] * inverse[b, k]
            small[a, b] = t
        small[a, a] *= 1.0 + 1e-14
    if not cholesky(small, used):
        return False
    solve(small, used, mu)
    return True


@outlined
def step_within(m: Any, free: Any, n: int, rows: Any, bounds: Any, count: int, d: Any) -> None:
    """Change the step d, which minimises the model with the factored matrix m, to that within linear limits.

    Limits are added, the worst first, and dropped where their multiplier has the wrong sign; what is left is shortened.
    """
    active, used = np.zeros(LIMITS, np.int64), 0
    if worst_limit(free, n, rows, bounds, count, active, used, d) < 0:
        return
    inverse, small = np.zeros((LIMITS, SIZE)), np.zeros((LIMITS, LIMITS))
    first, mu = np.zeros(SIZE), np.zeros(LIMITS)
    for k in range(n):
        first[k] = d[k]
    for _ in range(4 * LIMITS):
        which = worst_limit(free, n, rows, bounds, count, active, used, d)
        if which < 0 or used >= n:
            break
        active[used] = which
        used += 1
        while used > 0:
            if not multipliers(m, free, n, rows, bounds, active, used, first, inverse, small, mu):
                used -= 1
                break
            least, out = 0.0, -1
            for a in range(used):
                if mu[a] < least:
                    least, out = mu[a], a
            if out < 0:
                break
            for a in range(out, used - 1):
                active[a] = active[a + 1]
            used -= 1
        for k in range(n):
            d[k] = first[k]
            for a in range(used):
                d[k] += mu[a] * inverse[a, k]
    share = 1.0
    for c in range(count):
        value = 0.0
        for k in range(n):
            value += rows[c, free[k]] * d[k]
        # those that are active hold but for rounding
        for a in range(used):
            if active[a] == c:
                value = 0.0
        if value < bounds[c] and value < 0.0:
            share = min(share, max(bounds[c] / value, 0.0))
    for k in range(n):
        d[k] *= share


@outlined
def in_order(theta: Any, sense: float, closed: int) -> None:
    """Move angles that overtake each other to where they meet; of a closed curve none goes beyond a turn."""
    for i in range(1, theta.size):
        if sense * (theta[i] - theta[i - 1]) < 0.0:
            theta[i] = theta[i - 1]
    if closed != 0:
        last = theta[0] + sense * 2.0 * np.pi
        for i in range(1, theta.size):
            if sense * (theta[i] - last) > 0.0:
                theta[i] = last


@outlined
def squares(p: Any, s: float, theta: Any, target: Any, weights: Any) -> float:
    """Return the weighted sum of the squared distances, infinite where the bars do not meet."""
    total = 0.0
    for i in range(theta.size):
        meets, at, _, _, _ = coupler(p, s, theta[i])
        if not meets:
            return np.inf
        off = at - target[i]
        total += weights[i] * (off.real * off.real + off.imag * off.imag)
    return total


@outlined
def triangular(m: Any, rows: int, n: int, r: Any, right: Any) -> None:
    """Reduce rows of n columns and a right-hand side by Householder's reflections; store the transposed triangle.

    The normal equations would square the condition, and short arcs have one of 1e8.
    """
    for j in range(n):
        size = 0.0
        for i in range(j, rows):
            size += m[i, j] * m[i, j]
        size = np.sqrt(size)
        if size == 0.0:
            continue
        first = m[j, j] + size if m[j, j] >= 0.0 else m[j, j] - size
        scale = 1.0 / (first * (size if m[j, j] >= 0.0 else -size))
        pivot = -size if m[j, j] >= 0.0 else size
        m[j, j] = first
        for c in range(j + 1, n + 1):
            t = 0.0
            for i in range(j, rows):
                t += m[i, j] * m[i, c]
            t *= scale
            for i in range(j, rows):
                m[i, c] -= t * m[i, j]
        m[j, j] = pivot
        for i in range(j + 1, rows):
            m[i, j] = 0.0
    for j in range(n):
        right[j] = m[j, n]
        for c in range(n):
            r[c, j] = m[j, c] if c >= j else 0.0


@outlined
def nearer(
    p: Any, s: float, theta: Any, target: Any, weights: Any, sense: float, ordered: int, closed: int
) -> float:
    """Move each angle towards the place of the curve next to its point, and return the sum of squares there."""
    by = np.zeros(SIZE, np.complex128)
    for i in range(theta.size):
        meets, at, e, b, f = coupler(p, s, theta[i])
        if not meets:
            return np.inf
        slopes(p, at, e, b, f, by)
        off, t = at - target[i], by[9]
        turn = -(t.real * off.real + t.imag * off.imag) / (t.real * t.real + t.imag * t.imag + 1e-300)
        theta[i] += min(max(turn, -0.2), 0.2)
    if ordered != 0:
        in_order(theta, sense, closed)
    return squares(p, s, theta, target, weights)


@outlined
def linearise(p: Any, s: float, theta: Any, target: Any, weights: Any, timed: int, free: Any, n: int, j: Any,
              along: Any, slope: Any, across: Any) -> None:  # fmt: skip
    """Store the rows of the least squares of a step, and how each point moves along the curve with the numbers."""
    by = np.zeros(SIZE, np.complex128)
    clear_all(j)
    for i in range(target.size):
        _, at, e, b, f = coupler(p, s, theta[i])
        slopes(p, at, e, b, f, by)
        off, root, t = at - target[i], np.sqrt(weights[i]), by[9]
        if timed != 0:
            for a in range(n):
                k = by[free[a]]
                j[2 * i, a] = root * k.real
                j[2 * i + 1, a] = root * k.imag
            j[2 * i, n] = -root * off.real
            j[2 * i + 1, n] = -root * off.imag
            continue
        # the part across the curve alone: the angle takes up the other
        slope[i] = t.real * t.real + t.imag * t.imag + 1e-300
        along[i] = t.real * off.real + t.imag * off.imag
        length = root / np.sqrt(slope[i])
        for a in range(n):
            k = by[free[a]]
            across[i, a] = t.real * k.real + t.imag * k.imag
            j[i, a] = length * (t.real * k.imag - t.imag * k.real)
        j[i, n] = -length * (t.real * off.imag - t.imag * off.real)


@outlined
def damped(whole: Any, right: Any, scales: Any, damping: float, n: int, both: Any, r: Any, d: Any) -> None:
    """Store the damped step of a triangle of least squares, and the triangle that gives it."""
    clear_all(both)
    root = np.sqrt(damping)
    for a in range(n):
        for c in range(a, n):
            both[a, c] = whole[c, a]
        both[a, n] = right[a]
        both[n + a, a] = root * (scales[a] + 1e-300)
    triangular(both, 2 * n, n, r, d)
    for a in range(n - 1, -1, -1):
        t = d[a]
        for c in range(a + 1, n):
            t -= r[c, a] * d[c]
        d[a] = t / r[a, a]


@outlined
def moved_cost(q: Any, s: float, sense: float, theta: Any, moved: Any, target: Any, weights: Any, times: Any,
               options: Any, d: Any, n: int, along: Any, slope: Any, across: Any) -> float:  # fmt: skip
    """Store the angles after a step d to the numbers q, and return the sum of squares there."""
    if not (q[0] > 0.0 and q[1] > 0.0 and q[2] > 0.0 and q[3] > 0.0):
        return np.inf
    if options[0] != 0:
        for i in range(target.size):
            moved[i] = q[9] + times[i]
        return squares(q, s, moved, target, weights)
    for i in range(target.size):
        t = along[i]
        for a in range(n):
            t += across[i, a] * d[a]
        moved[i] = theta[i] + min(max(-t / slope[i], -0.4), 0.4)
    if options[2] != 0:
        in_order(moved, sense, options[3])
    return nearer(q, s, moved, target, weights, sense, options[2], options[3])


@outlined
def refine_one(p: Any, s: float, sense: float, theta: Any, target: Any, weights: Any, times: Any, options: Any,
               lower: Any, upper: Any, most: int) -> Any:  # fmt: skip
    """Refine a linkage in place by Levenberg-Marquardt; return the sum of squares and the steps taken.

    Options: whether times are given, whether the crank is to turn fully, whether angles stay in order, whether closed.
    """
    timed, n_points = options[0], target.size
    free = np.zeros(SIZE, np.int64)
    n = 0
    for k in range(SIZE):
        if lower[k] < upper[k] and (timed != 0 or k < 9):
            free[n] = k
            n += 1
    rows_of = max(2 * n_points if timed != 0 else n_points, n)
    j, both = np.zeros((rows_of, SIZE + 1)), np.zeros((2 * SIZE, SIZE + 1))
    r, whole, rows, across = (
        np.zeros((SIZE, SIZE)),
        np.zeros((SIZE, SIZE)),
        np.zeros((LIMITS, SIZE)),
        np.zeros((n_points, SIZE)),
    )
    d, q, scales, right, bounds = (
        np.zeros(SIZE),
        np.zeros(SIZE),
        np.zeros(SIZE),
        np.zeros(SIZE),
        np.zeros(LIMITS),
    )
    along, slope, moved, size = np.zeros(n_points), np.zeros(n_points), np.zeros(n_points), 0.0
    for i in range(n_points):
        if timed != 0:
            theta[i] = p[9] + times[i]
        size += abs(target[i] - target[0]) ** 2
    cost = squares(p, s, theta, target, weights)
    damping, taken, small = 1e-3, 0, 0
    while taken < most and cost > 1e-31 * size and cost < np.inf:
        linearise(p, s, theta, target, weights, timed, free, n, j, along, slope, across)
        triangular(j, rows_of, n, whole, right)
        for a in range(n):
            t = 0.0
            for c in range(a + 1):
                t += whole[a, c] * whole[a, c]
            scales[a] = max(np.sqrt(t), 0.3 * scales[a])
        accepted = False
        while taken < most and damping <= 1e8:
            taken += 1
            damped(whole, right, scales, damping, n, both, r, d)
            count = limits_of(p, lower, upper, options[1], rows, bounds)
            step_within(r, free, n, rows, bounds, count, d)
            for k in range(SIZE):
                q[k] = p[k]
            for a in range(n):
                k = free[a]
                q[k] = min(max(p[k] + d[a], lower[k]), upper[k])
            other = moved_cost(
                q, s, sense, theta, moved, target, weights, times, options, d, n, along, slope, across
            )
            if other < cost:
                small = small + 1 if (cost - other) < 1e-9 * cost else 0
                cost = other
                for k in range(SIZE):
                    p[k] = q[k]
                for i in range(n_points):
                    theta[i] = moved[i]
                damping = max(damping * 0.1, 1e-18)
                accepted = True
                break
            damping = max(damping * 5.0, 1e-14)
        if not accepted or small >= 4:
            break
    return cost, taken


def refine(numbers: Any, signs: Any, theta: Any, target: Any, weights: Any, times: Any, options: Any, lower: Any,
           upper: Any, cost: Any, steps: Any, most: int) -> None:  # fmt: skip
    """Refine linkages (rows of numbers, of signs s and senses, and of angles) in place."""
    for k in range(numbers.shape[0]):
        value, taken = refine_one(
            numbers[k],
            signs[k, 0],
            signs[k, 1],
            theta[k],
            target,
            weights,
            times,
            options,
            lower,
            upper,
            most,
        )
        cost[k] = value
        steps[k] += taken


@outlined
def similarity(z: Any, target: Any, n: int) -> Any:
    """Return the sum of squares that the best turn, size and place leave, the factor of these, and the place."""
    zm, wm = 0j, 0j
    for i in range(n):
        zm += z[i]
        wm += target[i]
    zm /= n
    wm /= n
    both, own, whole = 0j, 0.0, 0.0
    for i in range(n):
        a, b = z[i] - zm, target[i] - wm
        both += np.conj(a) * b
        own += a.real * a.real + a.imag * a.imag
        whole += b.real * b.real + b.imag * b.imag
    if not own > 0.0:
        return np.inf, 1 + 0j, wm
    factor = both / own
    return whole - (both.real * both.real + both.imag * both.imag) / own, factor, wm - factor * zm


@outlined
def beyond(shape: Any, factor: complex, place: complex, lower: Any, upper: Any) -> float:
    """Return 1 for a placed shape within the limits of its numbers, else a penalty."""
    size = abs(factor)
    for k in range(8):
        x = size if k == 0 else size * shape[k - 1] if k < 6 else place.real if k == 6 else place.imag
        if x < lower[k] or x > upper[k]:
            return 1e4
    return 1.0


@outlined
def swept(p: Any, s: float, count: int, z: Any, length: Any) -> bool:
    """Store the coupler curve of a whole turn at equal angles, and its length up to each."""
    for k in range(count):
        meets, at, _, _, _ = coupler(p, s, 2.0 * np.pi * k / count)
        if not meets:
            return False
        z[k] = at
        if k > 0:
            length[k] = length[k - 1] + abs(z[k] - z[k - 1])
    z[count] = z[0]
    length[count] = length[count - 1] + abs(z[0] - z[count - 1])
    return True


@outlined
def placed(length: Any, count: int, start: int, sense: float, share: Any, span: float, theta: Any) -> None:
    """Store the angles at shares of a part of the curve, by its length, from a start in one sense."""
    whole = length[count]
    k = start
    for i in range(share.size):
        wanted = share[i] * span * whole
        turns = 0.0
        if sense > 0.0:
            at = length[start] + wanted
            if at > whole:
                at -= whole
                turns = 1.0
        else:
            at = length[start] - wanted
            if at < 0.0:
                at += whole
                turns = -1.0
        # the interval that holds it: close to the one before
        for _ in range(count + 1):
            if at < length[k]:
                k = k - 1 if k > 0 else count - 1
            elif at > length[k + 1]:
                k = k + 1 if k < count - 1 else 0
            else:
                break
        part = length[k + 1] - length[k]
        inside = (at - length[k]) / part if part > 0.0 else 0.0
        theta[i] = 2.0 * np.pi * ((k + inside) / count + turns)


@outlined
def between(z: Any, count: int, theta: Any, out: Any) -> None:
    """Store points of a swept curve at angles, by lines between its places."""
    for i in range(theta.size):
        t = theta[i] / (2.0 * np.pi) * count
        low = np.floor(t)
        k = int(low) % count
        out[i] = z[k] + (t - low) * (z[k + 1] - z[k])


@outlined
def shape_numbers(shape: Any, p: Any) -> None:
    """Store a shape as the numbers of a linkage with a1 = 1 at the origin."""
    p[0] = 1.0
    for k in range(5):
        p[1 + k] = shape[k]
    p[6], p[7], p[8], p[9] = 0.0, 0.0, 0.0, 0.0


def compare(shapes: Any, target: Any, share: Any, times: Any, spans: Any, timed: int, count: int, phases: int,
            senses: int, lower: Any, upper: Any, best: Any, how: Any) -> None:  # fmt: skip
    """Store for each shape and sign what the best similarity leaves, and the phase, sense and span of it.

    What lies beyond limits counts 10,000 times as much.
    Shapes have a1 = 1 and cranks that turn fully. Points without times are compared by shares of the curve's length.
    """
    n = target.size
    z, length = np.zeros(count + 1, np.complex128), np.zeros(count + 1)
    theta, points, p = np.zeros(n), np.zeros(n, np.complex128), np.zeros(SIZE)
    for j in range(shapes.shape[0]):
        shape_numbers(shapes[j], p)
        for mode in range(2):
            s = 2.0 * mode - 1.0
            row = 2 * j + mode
            best[row] = np.inf
            if timed == 0 and not swept(p, s, count, z, length):
                continue
            for phase in range(phases):
                if timed != 0:
                    start = 2.0 * np.pi * phase / phases
                    meets = True
                    for i in range(n):
                        meets, at, _, _, _ = coupler(p, s, start + times[i])
                        if not meets:
                            break
                        points[i] = at
                    if not meets:
                        continue
                    left, factor, place = similarity(points, target, n)
                    if left < best[row]:
                        left *= beyond(shapes[j], factor, place, lower, upper)
                    if left < best[row]:
                        best[row] = left
                        how[row, 0], how[row, 1], how[row, 2] = start, 1.0, 1.0
                    continue
                first = phase * count // phases
                for side in range(senses):
                    sense = 1.0 - 2.0 * side
                    for c in range(spans.size):
                        placed(length, count, first, sense, share, spans[c], theta)
                        between(z, count, theta, points)
                        left, factor, place = similarity(points, target, n)
                        if left < best[row]:
                            left *= beyond(shapes[j], factor, place, lower, upper)
                        if left < best[row]:
                            best[row] = left
                            how[row, 0], how[row, 1], how[row, 2] = float(first), sense, spans[c]


def begin(shapes: Any, signs: Any, how: Any, target: Any, share: Any, times: Any, timed: int, count: int,
          numbers: Any, theta: Any) -> None:  # fmt: skip
    """Store the linkages and angles of shapes that were compared: turned, sized and placed as the similarity says."""
    n = target.size
    z, length, points = np.zeros(count + 1, np.complex128), np.zeros(count + 1), np.zeros(n, np.complex128)
    for j in range(shapes.shape[0]):
        p, s = numbers[j], signs[j, 0]
        shape_numbers(shapes[j], p)
        if timed != 0:
            p[9] = how[j, 0]
            for i in range(n):
                theta[j, i] = how[j, 0] + times[i]
        else:
            swept(p, s, count, z, length)
            placed(length, count, int(how[j, 0]), how[j, 1], share, how[j, 2], theta[j])
        for i in range(n):
            _, at, _, _, _ = coupler(p, s, theta[j, i])
            points[i] = at
        _, factor, place = similarity(points, target, n)
        for k in range(6):
            p[k] *= abs(factor)
        p[6], p[7], p[8] = place.real, place.imag, np.arctan2(factor.imag, factor.real)


@outlined
def _times(a: Any, b: Any, out: Any) -> None:
    """Store the product of two polynomials, lowest power first."""
    clear(out, out.size)
    for i in range(a.size):
        for k in range(b.size):
            if i + k < out.size:
                out[i + k] += a[i] * b[k]


@outlined
def quartic_roots(c: Any, roots: Any) -> None:
    """Store the roots of c[0] + ... + c[4] x^4 by Aberth's iteration."""
    size = 0.0
    for k in range(4):
        if c[k] != 0.0:
            size = max(size, abs(c[k] / c[4]) ** (1.0 / (4 - k)))
    for k in range(4):
        roots[k] = 0.8 * size * unit(0.7 + 0.5 * np.pi * k)
    for _ in range(60):
        most = 0.0
        for k in range(4):
            x = roots[k]
            value, change = c[4] + 0j, 0j
            for m in range(3, -1, -1):
                change = change * x + value
                value = value * x + c[m]
            if value == 0j:
                continue
            if change == 0j:
                change = 1e-300 + 0j
            ratio = value / change
            others = 0j
            for m in range(4):
                if m != k and x != roots[m]:
                    others += 1.0 / (x - roots[m])
            step = ratio / (1.0 - ratio * others)
            roots[k] = x - step
            most = max(most, abs(step) / (abs(x) + 1e-300))
        if most < 1e-15:
            break


@outlined
def solve_small(m: Any, n: int, x: Any) -> bool:
    """Solve in place by elimination with row pivots; x is the right-hand side and then the solution."""
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(m[i, k]) > abs(m[best, k]):
                best = i
        if m[best, k] == 0.0:
            return False
        for c in range(n):
            t = m[k, c]
            m[k, c] = m[best, c]
            m[best, c] = t
        t = x[k]
        x[k] = x[best]
        x[best] = t
        for i in range(k + 1, n):
            f = m[i, k] / m[k, k]
            for c in range(k, n):
                m[i, c] -= f * m[k, c]
            x[i] -= f * x[k]
    for k in range(n - 1, -1, -1):
        for c in range(k + 1, n):
            x[k] -= m[k, c] * x[c]
        x[k] /= m[k, k]
    return True


@outlined
def dyads_of(rows: Any, d: Any, e: Any, polish: int, out: Any) -> int:
    """Store all dyads (centre c, body point w) whose linear form meets five rows, and return how many there are.

    |d + e w - c|^2 = R^2 is linear in (p0, w, c, q, k) with q p0 = conj(c) w: five rows leave three dimensions, and the
    two real parts of the condition are two conics there. Each of their at most four points is refined on the circles of
    the poses themselves.
    """
    m = np.zeros((8, 6))
    q = np.zeros((8, 8))
    for k in range(8):
        q[k, k] = 1.0
    for i in range(5):
        for k in range(8):
            m[k, i] = rows[i, k]
    v = np.zeros(8)
    for j in range(5):
        size = 0.0
        for k in range(j, 8):
            size += m[k, j] * m[k, j]
        size = np.sqrt(size)
        if not size > 0.0:
            return 0
        for k in range(8):
            v[k] = m[k, j] if k >= j else 0.0
        v[j] += size if v[j] >= 0.0 else -size
        vv = 0.0
        for k in range(8):
            vv += v[k] * v[k]
        for c in range(5):
            t = 0.0
            for k in range(8):
                t += v[k] * m[k, c]
            for k in range(8):
                m[k, c] -= 2.0 * t / vv * v[k]
        for r in range(8):
            t = 0.0
            for k in range(8):
                t += q[r, k] * v[k]
            for k in range(8):
                q[r, k] -= 2.0 * t / vv * v[k]
    # three vectors orthogonal to all rows, mixed so that no point lies at infinity by chance
    mix, basis = np.zeros((3, 3)), np.zeros((3, 8))
    mix[0, 0], mix[0, 1], mix[0, 2] = 0.6, 0.48, 0.64
    mix[1, 0], mix[1, 1], mix[1, 2] = -0.8, 0.36, 0.48
    mix[2, 1], mix[2, 2] = -0.8, 0.6
    for i in range(3):
        for k in range(8):
            for c in range(3):
                basis[i, k] += mix[i, c] * q[k, 5 + c]
    one, two = np.zeros((3, 3)), np.zeros((3, 3))
    for i in range(3):
        for k in range(3):
            a, b = basis[i], basis[k]
            re = a[0] * b[5] + b[0] * a[5] - (a[3] * b[1] + b[3] * a[1] + a[4] * b[2] + b[4] * a[2])
            im = a[0] * b[6] + b[0] * a[6] - (a[3] * b[2] + b[3] * a[2] - a[4] * b[1] - b[4] * a[1])
            one[i, k], two[i, k] = 0.5 * re, 0.5 * im
    a1, a2 = one[2, 2], two[2, 2]
    b1, b2, c1, c2, slope = np.zeros(2), np.zeros(2), np.zeros(3), np.zeros(3), np.zeros(2)
    u, w, left, right, quartic = np.zeros(3), np.zeros(4), np.zeros(4), np.zeros(5), np.zeros(5)
    for k in range(2):
        b1[k], b2[k] = 2.0 * one[k, 2], 2.0 * two[k, 2]
        slope[k] = a1 * b2[k] - a2 * b1[k]
    c1[0], c1[1], c1[2] = one[0, 0], 2.0 * one[0, 1], one[1, 1]
    c2[0], c2[1], c2[2] = two[0, 0], 2.0 * two[0, 1], two[1, 1]
    for k in range(3):
        u[k] = a1 * c2[k] - a2 * c1[k]
    _times(b1, c2, w)
    _times(b2, c1, left)
    for k in range(4):
        w[k] -= left[k]
    _times(u, u, quartic)
    _times(slope, w, right)
    for k in range(5):
        quartic[k] -= right[k]
    roots = np.zeros(4, np.complex128)
    quartic_roots(quartic, roots)
    count = 0
    jac, step, p = np.zeros((4, 4)), np.zeros(4), np.zeros(8)
    for k in range(4):
        # of a pair that nearly meets both count as real: the conics tell
        if abs(roots[k].imag) > 1e-5 * (1.0 + abs(roots[k])):
            continue
        x = roots[k].real
        under = slope[0] + slope[1] * x
        y = -(u[0] + u[1] * x + u[2] * x * x) / under
        f1, f2, size = 0.0, 0.0, 0.0
        for _ in range(8):
            f1 = (
                one[0, 0]
                + 2 * one[0, 1] * x
                + one[1, 1] * x * x
                + (2 * one[0, 2] + 2 * one[1, 2] * x + one[2, 2] * y) * y
            )
            f2 = (
                two[0, 0]
                + 2 * two[0, 1] * x
                + two[1, 1] * x * x
                + (2 * two[0, 2] + 2 * two[1, 2] * x + two[2, 2] * y) * y
            )
            g11, g12 = (
                2 * (one[0, 1] + one[1, 1] * x + one[1, 2] * y),
                2 * (one[0, 2] + one[1, 2] * x + one[2, 2] * y),
            )
            g21, g22 = (
                2 * (two[0, 1] + two[1, 1] * x + two[1, 2] * y),
                2 * (two[0, 2] + two[1, 2] * x + two[2, 2] * y),
            )
            det = g11 * g22 - g12 * g21
            if det == 0.0:
                break
            x -= (f1 * g22 - f2 * g12) / det
            y -= (g11 * f2 - g21 * f1) / det
        size = 1.0 + x * x + y * y
        if not abs(f1) + abs(f2) < 1e-11 * size:
            continue
        for c in range(8):
            p[c] = basis[0, c] + x * basis[1, c] + y * basis[2, c]
        if p[0] == 0.0:
            continue
        centre, wp = complex(p[3], p[4]) / p[0], complex(p[1], p[2]) / p[0]
        if polish != 0:
            for _ in range(3):
                first = d[0] + e[0] * wp - centre
                for i in range(4):
                    other = d[i + 1] + e[i + 1] * wp - centre
                    turn = np.conj(other) * e[i + 1] - np.conj(first) * e[0]
                    shift = first - other
                    jac[i, 0], jac[i, 1] = 2.0 * shift.real, 2.0 * shift.imag
                    jac[i, 2], jac[i, 3] = 2.0 * turn.real, -2.0 * turn.imag
                    # the difference of two squares as a product, which loses nothing
                    away = other - first
                    step[i] = away.real * (other.real + first.real) + away.imag * (other.imag + first.imag)
                if not solve_small(jac, 4, step):
                    break
                centre -= complex(step[0], step[1])
                wp -= complex(step[2], step[3])
        again = False
        for i in range(count):
            off = abs(complex(out[i, 0], out[i, 1]) - centre) + abs(complex(out[i, 2], out[i, 3]) - wp)
            again = again or off < 1e-9 * (1.0 + abs(centre) + abs(wp))
        if not again and abs(centre) < 1e12:
            out[count, 0], out[count, 1], out[count, 2], out[count, 3] = (
                centre.real,
                centre.imag,
                wp.real,
                wp.imag,
            )
            count += 1
    return count


@outlined
def form_row(d: complex, e: complex, row: Any) -> None:
    """Store the linear form of a pose."""
    m = np.conj(d) * e
    row[0] = d.real * d.real + d.imag * d.imag
    row[1], row[2] = 2.0 * m.real, -2.0 * m.imag
    row[3], row[4] = -2.0 * d.real, -2.0 * d.imag
    row[5], row[6] = -2.0 * e.real, 2.0 * e.imag
    row[7] = 1.0


def dyads(poses: Any, forms: Any, found: Any, counts: Any) -> None:
    """Store all dyads of tasks of five poses (x, y, angle), and how many each has; the others are NaN.

    Where the first angle of a task is NaN its linear form is given instead, in a unit of its own.
    """
    d, e = np.zeros(5, np.complex128), np.zeros(5, np.complex128)
    rows, out = np.zeros((5, 8)), np.zeros((4, 4))
    for k in range(poses.shape[0]):
        formed = np.isnan(poses[k, 0, 2])
        origin, size = 0j, 0.0
        if formed:
            for i in range(5):
                for c in range(8):
                    rows[i, c] = forms[k, i, c]
            size = 1.0
        else:
            for i in range(5):
                origin += complex(poses[k, i, 0], poses[k, i, 1]) / 5.0
            for i in range(5):
                d[i] = complex(poses[k, i, 0], poses[k, i, 1]) - origin
                e[i] = unit(poses[k, i, 2])
                size = max(size, abs(d[i]))
            size = size if size > 0.0 else 1.0
            for i in range(5):
                d[i] /= size
                form_row(d[i], e[i], rows[i])
        counts[k] = dyads_of(rows, d, e, 0 if formed else 1, out)
        for i in range(4):
            for c in range(4):
                found[k, i, c] = np.nan
        for i in range(counts[k]):
            found[k, i, 0], found[k, i, 1] = size * out[i, 0] + origin.real, size * out[i, 1] + origin.imag
            found[k, i, 2], found[k, i, 3] = size * out[i, 2], size * out[i, 3]


def freudenstein(cos_in: Any, sin_in: Any, cos_out: Any, sin_out: Any, error: Any, ratios: Any) -> None:
    """Store for each pair of start angles the greatest structural error of the best K1, K2, K3, to first order.

    Tables of cosines and sines: (start angle, place). The least squares of K1 cos psi - K2 cos phi + K3 = cos(phi-psi)
    are weighed by the rate at which the output angle changes it; where that changes its sign the linkage would have to
    change its assembly mode, and the error is infinite.
    """
    n = cos_in.shape[1]
    rate, m, x = np.zeros(n), np.zeros((3, 3)), np.zeros(3)
    for i in range(cos_in.shape[0]):
        for k in range(cos_out.shape[0]):
            error[i, k] = np.inf
            for t in range(n):
                rate[t] = 1.0
            fine = True
            worst = np.inf
            for _ in range(3):
                clear_all(m)
                clear(x, 3)
                for t in range(n):
                    weight = 1.0 / (rate[t] * rate[t])
                    a, b = cos_out[k, t], -cos_in[i, t]
                    f = cos_in[i, t] * cos_out[k, t] + sin_in[i, t] * sin_out[k, t]
                    m[0, 0] += weight * a * a
                    m[0, 1] += weight * a * b
                    m[0, 2] += weight * a
                    m[1, 1] += weight * b * b
                    m[1, 2] += weight * b
                    m[2, 2] += weight
                    x[0] += weight * a * f
                    x[1] += weight * b * f
                    x[2] += weight * f
                m[1, 0], m[2, 0], m[2, 1] = m[0, 1], m[0, 2], m[1, 2]
                if not solve_small(m, 3, x):
                    fine = False
                    break
                worst = 0.0
                first = 0.0
                for t in range(n):
                    turn = sin_in[i, t] * cos_out[k, t] - cos_in[i, t] * sin_out[k, t]
                    value = x[0] * cos_out[k, t] - x[1] * cos_in[i, t] + x[2]
                    value -= cos_in[i, t] * cos_out[k, t] + sin_in[i, t] * sin_out[k, t]
                    rate[t] = -x[0] * sin_out[k, t] - turn
                    if t == 0:
                        first = rate[0]
                    if not rate[t] * first > 0.0:
                        fine = False
                    worst = max(worst, abs(value / rate[t]))
                if not fine:
                    break
            k3 = x[2]
            if fine and x[0] != 0.0 and x[1] != 0.0:
                r2, r4 = 1.0 / x[0], 1.0 / x[1]
                if 1.0 + r2 * r2 + r4 * r4 - 2.0 * r2 * r4 * k3 > 0.0 and abs(r2) < 1e3 and abs(r4) < 1e3:
                    error[i, k] = worst
                    ratios[i, k, 0], ratios[i, k, 1], ratios[i, k, 2] = x[0], x[1], x[2]
