"""The first example of Hegedüs and Moore, drawn by what assembles: ``python docs/images/minkowski_example1.py``."""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import fastlink as fl

THETA = 1.6
COLOURS = {1: "tab:blue", -1: "tab:orange"}
design = fl.grid(a=1.0, b=1.0, g=4.0, h=1.0, x=0.5, y=0.0)
curves = fl.sweep(
    "minkowski_4r", design, ["psi", "CB_orientation"], theta=np.linspace(-4.0, 4.0, 1601), branch=(1, 2)
).squeeze()
one = fl.sweep(
    "minkowski_4r", design, ["A_x", "A_y", "B_x", "B_y", "CB_orientation"], theta=[THETA], branch=(1, 2)
).squeeze()

figure, (plane, rapidities) = plt.subplots(1, 2, figsize=(9.6, 4.4), layout="constrained")
t = np.linspace(-3.0, 3.0, 301)
plane.plot(np.cosh(t), np.sinh(t), color="0.6", linewidth=1)
for arm in (1, -1):
    plane.plot(4 + arm * np.cosh(t), np.sinh(t), color=COLOURS[arm], linewidth=1, alpha=0.5)
for pivot in (0.0, 4.0):
    plane.plot(
        [pivot - 5, pivot, pivot + 5],
        [-5, 0, 5],
        [pivot - 5, pivot, pivot + 5],
        [5, 0, -5],
        color="0.9",
        zorder=0,
    )
for k in range(2):
    at = one.isel(branch=k)
    plane.plot([0.0, at.A_x], [0.0, at.A_y], "o-", color="black", markersize=4)
    plane.plot(
        [at.A_x, at.B_x, 4.0],
        [at.A_y, at.B_y, 0.0],
        "o-",
        color=COLOURS[int(at.CB_orientation)],
        markersize=4,
    )
    plane.annotate("B", (at.B_x, at.B_y), (5, 4), textcoords="offset points")
for name, x, y in (("O", 0.0, 0.0), ("C", 4.0, 0.0), ("A", float(one.A_x[0]), float(one.A_y[0]))):
    plane.annotate(name, (x, y), (-12, 4), textcoords="offset points")
plane.set(xlabel="X", ylabel="Y", xlim=(-1.5, 7.5), ylim=(-3, 5), aspect="equal", title=f"theta = {THETA}")
for arm, label in ((1, "CB future-pointing"), (-1, "CB past-pointing")):
    rows = curves.psi.where(curves.CB_orientation == arm)
    lines = rapidities.plot(curves.theta, rows.T, ".", color=COLOURS[arm], markersize=1.5)
    lines[0].set_label(label)
for place in (np.arccosh(1.625), np.arccosh(2.125)):
    for side in (-1, 1):
        rapidities.axvline(side * place, color="0.8", linewidth=1, zorder=0)
rapidities.set(
    xlabel="theta", ylabel="psi", ylim=(-5, 5), title="transmission function, theta_min and theta_max"
)
rapidities.legend(markerscale=6, loc="upper left")
figure.savefig(Path(__file__).with_suffix(".png"), dpi=110)
