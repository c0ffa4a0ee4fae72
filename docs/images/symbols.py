"""The figure of the symbols of the planar 4R: ``python docs/images/symbols.py``."""

from pathlib import Path

import numpy as np
from matplotlib.patches import Arc
from PIL import Image

import fastlink as fl

DESIGN = {"a1": 0.4, "a2": 1.0, "a3": 0.75, "a4": 1.0, "P_u": 0.35, "P_v": 0.3}
THETA1 = 65.0
COLOURS = 40
NAMES = ("A_x", "A_y", "B_x", "B_y", "P_x", "P_y", "theta2", "theta4", "transmission_angle")

at = fl.evaluate("planar_4r", NAMES, **DESIGN, theta1_deg=THETA1, branch=2)
A, B, P = (np.array([float(at[f"{joint}_x"]), float(at[f"{joint}_y"])]) for joint in "ABP")
O, D = np.zeros(2), np.array([DESIGN["a4"], 0.0])
theta2, theta4 = (float(np.degrees(at[name])) for name in ("theta2", "theta4"))
figure = fl.draw("planar_4r", DESIGN, theta1_deg=THETA1, branch=2, show=())
(axis,) = figure.axes


def direction(degrees):
    """Return the unit vector of an angle."""
    return np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])


def length(start, end, text, off=0.06):
    """Write the name of a length beside the middle of a bar."""
    along = (end - start) / np.hypot(*(end - start))
    place = (start + end) / 2 + off * np.array([-along[1], along[0]])
    axis.text(*place, text, color="C0", ha="center", va="center", fontsize=13)


def angle(corner, first, second, text, radius):
    """Draw an angle from one direction to another, in degrees, with its name."""
    reference = np.transpose([corner, corner + 1.5 * radius * direction(first)])
    axis.plot(*reference, "k:", lw=0.9)
    axis.add_patch(Arc(corner, 2 * radius, 2 * radius, theta1=first, theta2=second, color="C0", lw=1.5))
    middle = (first + second) / 2
    place = corner + 1.35 * radius * direction(middle)
    axis.text(*place, text, color="C0", ha="center", va="center", fontsize=13)


angle(O, 0.0, THETA1, r"$\theta_1$", 0.13)
angle(A, 0.0, theta2, r"$\theta_2$", 0.2)
angle(D, 0.0, theta4, r"$\theta_4$", 0.13)
angle(B, 180.0 + theta2, 180.0 + theta4, "", 0.12)
axis.text(B[0] + 0.06, B[1] - 0.12, "transmission\nangle", color="C0", va="center", fontsize=11)
foot = A + DESIGN["P_u"] * direction(theta2)
axis.plot(*np.transpose([foot, P]), "k:", lw=0.9)
length(A, foot, "$P_u$", 0.05)
length(foot, P, "$P_v$", -0.06)
target = Path(__file__).with_suffix(".png")
figure.savefig(target, dpi=100, bbox_inches="tight")
with Image.open(target) as picture:
    small = picture.convert("RGB").quantize(COLOURS)
small.save(target, optimize=True)
