"""Figs. 1b and 2 of Hayes, Hninn and Irani for their Table 1: ``python docs/images/hayes_fig2.py``."""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Arc

import fastlink as fl

DESIGN = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "theta1": 1.2, "branch": 2}
JOINTS = {1: "O", 2: "A", 3: "B", 4: "D"}
OFFSETS = {"O": (-8, -14), "A": (-10, 8), "B": (4, 18), "D": (10, -14)}
ENDS = {1: (1, 2), 2: (2, 3), 3: (3, 4)}
names = ["A_x", "A_y", "B_x", "B_y", *(f"{name}_{xy}" for name in ("G1", "G2", "G3") for xy in "xy")]
names += [f"r{i}{j}_{xy}" for i, ends in ENDS.items() for j in ends for xy in "xy"]
names += [f"joint_angle_{i}" for i in JOINTS]
at = fl.evaluate("planar_4r", names, **DESIGN, links=fl.round_bar(7750.0, 0.01))
points = np.array([(0, 0), (at["A_x"], at["A_y"]), (at["B_x"], at["B_y"]), (DESIGN["a4"], 0)])

figure, axes = plt.subplots(1, 2, figsize=(10.0, 3.3), layout="constrained", sharey=True)
for axis in axes:
    axis.plot(*points[[3, 0]].T, color="0.7", linewidth=4)
    axis.plot(*points.T, color="0.25", linewidth=2, marker="o", markerfacecolor="white", markersize=8)
    for (x, y), (number, letter) in zip(points, JOINTS.items(), strict=True):
        side = "left" if letter in "BD" else "right"
        text = f"{letter} (joint {number})"
        axis.annotate(text, (x, y), OFFSETS[letter], textcoords="offset points", ha=side)
    axis.set(aspect="equal", xlabel="x [m]", xlim=(-0.7, 2.1), ylim=(-0.4, 1.0))
axes[0].set(ylabel="y [m]", title="links, and the angles of eqs. (1) to (6)")
axes[1].set_title("mass centres, and the vectors of eq. (9)")

for i in range(4):
    start, end = points[i], points[(i + 1) % 4]
    before = start - points[i - 1]
    direction = np.degrees(np.arctan2(before[1], before[0]))
    turn = np.degrees(at[f"joint_angle_{i + 1}"])
    low, high = sorted((direction, direction + turn))
    beyond = start + 0.3 * before / np.hypot(*before)
    axes[0].plot(*np.array([start, beyond]).T, color="tab:blue", linewidth=0.8, linestyle=":")
    axes[0].add_patch(Arc(start, 0.36, 0.36, theta1=low, theta2=high, color="tab:blue"))
    middle = np.radians(direction + 0.5 * turn)
    at_arc, side = (
        start + (0.44 if i == 1 else 0.22) * np.array([np.cos(middle), np.sin(middle)]),
        "left" if np.cos(middle) > 0 else "right",
    )
    text = f"$\\theta_{i + 1}$ = {turn:.0f}°"
    axes[0].annotate(text, at_arc, color="tab:blue", ha=side, va="center")
    # on the outer side of the loop, which is run through clockwise; of crank and ground link on the inner one
    outside = np.array([before[1], -before[0]]) / np.hypot(*before) * (11.0 if i < 2 else -11.0)
    middle_of_bar = 0.5 * (points[i - 1] + start)
    label = {"textcoords": "offset points", "ha": "center", "va": "center"}
    axes[0].annotate(f"$a_{(i - 1) % 4 + 1}$", middle_of_bar, outside, **label)
for i, ends in ENDS.items():
    centre = np.array([at[f"G{i}_x"], at[f"G{i}_y"]])
    axes[1].plot(*centre, marker="o", color="tab:red")
    along = np.subtract(*points[[i, i - 1]])
    beside = 0.17 * np.array([along[1], -along[0]]) / np.hypot(*along)
    axes[1].annotate(f"$CG_{i}$", centre + beside, color="tab:red", ha="center", va="center")
    for j in ends:
        r = 0.92 * np.array([at[f"r{i}{j}_x"], at[f"r{i}{j}_y"]])
        across = 0.05 * np.array([-r[1], r[0]]) / np.hypot(*r)
        arrow = {"arrowstyle": "-|>", "color": "tab:red"}
        axes[1].annotate("", centre + across + r, centre + across, arrowprops=arrow)
        label = f"$r_{{{i}{j}}}$"
        axes[1].annotate(label, centre + 2.7 * across + 0.6 * r, color="tab:red", ha="center", va="center")
figure.savefig(Path(__file__).with_suffix(".png"), dpi=110)
