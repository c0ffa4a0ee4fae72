"""The five-bar MPFQN of section 1: free, with two inputs, and with Hart's condition, by which it has a four-bar."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from fastlink.analysis.designs import broadcast, check_lengths
from fastlink.analysis.focal.position import GREATEST_LENGTH
from fastlink.catalogue.catalogue import Input
from fastlink.doors import door
from fastlink.engine.broadcast import like
from fastlink.engine.evaluate import evaluate
from fastlink.mechanisms.planar_4r import planar_4r
from fastlink.plan.validate import branch_codes

__all__ = ["five_bar", "from_five_bar"]

#: The bars by the names of their lengths.
BARS = {"m": "MP", "p": "PF", "q": "FQ", "n": "QN", "d": "MN"}
#: MF is at least this of the longest bar: what is shorter moves F by less than any rounding.
SHORTEST = 2.0**-100


def _bars(names: str, rule: Literal["positive", "any"] = "positive") -> list[Input]:
    """Return the declarations of bars; d is always a length."""
    return [
        Input(name, "m", name, f"length {BARS[name]}", "positive" if name == "d" else rule) for name in names
    ]


@door
def five_bar(
    m: Any, p: Any, q: Any, n: Any, d: Any, phi: Any, *, omega_angle: Any, branch: Any = 1
) -> dict[str, Any]:
    """Return positions of the free five-bar MPFQN, which has two inputs.

    Parameters
    ----------
    m, p, q, n, d : float or array_like
        Lengths of MP, PF, FQ, QN and MN [m], broadcast with the inputs.
    phi : float or array_like
        Direction of MP, seen from MN [rad].
    omega_angle : float or array_like
        The angle omega of MP and PF at P: F = exp(i phi)(m - p exp(i omega)) [rad].
    branch : int or array_like
        1: Q to the right of the directed line from F to N; 2: to the left.

    Returns
    -------
    dict of str to ndarray
        ``P_x``, ``P_y``, ``F_x``, ``F_y``, ``Q_x``, ``Q_y`` [m], ``psi`` (the direction of NQ) and ``angle_FQN`` in 0
        to pi [rad]. Q is NaN where FQ and QN do not reach from F to N.

    Raises
    ------
    InputError
        A length is not in 1e-70 ... 1e70, a number is not valid, or the numbers do not broadcast.

    Notes
    -----
    F comes from M by two bars, Q is where circles about F and N meet (eqs. (1.2) to (1.4) with another angle at Q).
    Hart's condition (1.1) takes one freedom: where ``angle_FQN`` is pi - omega, F lies on the circle about S.
    With omega fixed it is the four-bar of a1 = MF, a2 = q, a3 = n, a4 = d, a ``planar_4r`` for `fastlink.sweep`.

    Examples
    --------
    The five-bar of Figure 4, where omega and the angle at Q are right angles:

    >>> import numpy as np
    >>> import fastlink as fl
    >>> m, p = 0.8404082057734577, 1.8696938456699069
    >>> at = fl.focal.five_bar(m, p, p, m, 4.0, np.arccos(0.2), omega_angle=np.pi / 2, branch=[1, 2])
    >>> at["F_x"].round(9), at["F_y"].round(9), np.degrees(at["angle_FQN"]).round(9)
    (array([2., 2.]), array([0.44948974, 0.44948974]), array([90., 90.]))
    """
    names = "mpqnd"
    angles = [
        Input("phi", "rad", "phi", "direction of MP"),
        Input("omega_angle", "rad", "omega", "angle of MP and PF"),
    ]
    mode = Input("branch", "1", "branch", "assembly mode")
    declared = [*_bars(names), *angles, mode]
    given = (m, p, q, n, d, phi, omega_angle, like(branch, branch_codes(planar_4r, branch)))
    m, p, q, n, d, phi, omega_angle, branch = broadcast("five_bar", declared, *given)
    check_lengths("five_bar", declared[:5], (m, p, q, n, d), GREATEST_LENGTH, "four lengths")
    u = np.exp(1j * phi)
    P = m * u
    # m - p + p (1 - w), in which the first difference alone cancels
    half = np.sin(0.5 * omega_angle)
    F = u * ((m - p) + 2.0 * p * half * (half - 1j * np.cos(0.5 * omega_angle)))
    longest = np.max([m, p, q, n, d], axis=0)
    reach = np.maximum(np.abs(F), SHORTEST * longest)
    rest = evaluate(
        "planar_4r",
        ["B_x", "B_y", "theta4", "transmission_angle"],
        a1=reach,
        a2=q,
        a3=n,
        a4=d,
        theta1=np.angle(F),
        branch=branch,
    )
    Q_x, Q_y, psi, angle = (np.asarray(value) for value in rest.values())
    joints = {"P_x": P.real, "P_y": P.imag, "F_x": F.real, "F_y": F.imag, "Q_x": Q_x, "Q_y": Q_y}
    return {**joints, "psi": psi, "angle_FQN": angle}


@door
def from_five_bar(m: Any, n: Any, p: Any, q: Any, d: Any) -> dict[str, Any]:
    r"""Return the focal mechanism of a five-bar MPFQN whose angles at P and Q have the sum pi.

    Parameters
    ----------
    m, n, p, q : float or array_like
        Lengths of MP, NQ, PF and QF [m], broadcast, with the signs of eqs. (1.3) and (1.4): m and p, n and q, or p and
        q may change theirs together.
    d : float or array_like
        Length of MN [m].

    Returns
    -------
    dict of str to ndarray
        The inputs ``a``, ``b``, ``c``, ``d``, ``rho``, ``completion`` of ``focal``, as `fastlink.sweep` takes them; c
        is NaN where the five-bar never assembles.

    Raises
    ------
    InputError
        A length is not in 1e-70 ... 1e70 in magnitude, a number is not valid, or the numbers do not broadcast.

    Notes
    -----
    Eq. (2.6), lambda = (m n + p q)/(m n), a = lambda m, b = lambda n, and with its sums made products

    .. math:: (m n)^2 c^2 = (m n + p q)(m p + n q)(m q + n p) - m n p q\,d^2.

    Examples
    --------
    >>> import fastlink as fl
    >>> m, p = 0.8404082057734577, 1.8696938456699069
    >>> design = fl.focal.from_five_bar(m, m, p, p, 4.0)
    >>> {name: round(float(value), 9) for name, value in design.items()}
    {'a': 5.0, 'b': 5.0, 'c': 2.0, 'd': 4.0, 'rho': 1.0, 'completion': 1.0}
    >>> round(float(fl.evaluate("focal", ["r"], **design, phi=1.0)["r"]), 4)
    0.4495
    """
    declared = _bars("mnpqd", "any")
    m, n, p, q, d = broadcast("from_five_bar", declared, m, n, p, q, d)
    sizes = [np.abs(length) for length in (m, n, p, q, d)]
    check_lengths("from_five_bar", _bars("mnpqd"), sizes, GREATEST_LENGTH, "four lengths")
    size = 2.0 ** np.ceil(np.log2(np.max(sizes, axis=0)))
    m, n, p, q, d = (length / size for length in (m, n, p, q, d))
    with np.errstate(all="ignore"):
        excess = (p / m) * (q / n)
        lambda_ = (m * n + p * q) / (m * n)
        c = np.sqrt(lambda_ * (p / n + q / m) * (m * q + n * p) - excess * (d * d))
        completion = np.where(np.abs(excess) * d >= c, 1.0, 2.0)
        rho = (m / n) * (p / q)
        bars = {"a": np.abs(lambda_ * m), "b": np.abs(lambda_ * n), "c": c, "d": d}
    return {name: bar * size for name, bar in bars.items()} | {"rho": rho, "completion": completion}
