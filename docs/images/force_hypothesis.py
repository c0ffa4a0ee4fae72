"""How well rates tell the greatest forces: ``python docs/images/force_hypothesis.py force_hypothesis.h5``."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import fastlink as fl

CLASSES = {0: "crank-rockers", 1: "double cranks"}
LOADS = {
    "shaking_force": "shaking force",
    "shaking_moment": "shaking moment",
    "F41": "force at O",
    "F43": "force at D",
}
RATES = {"alpha4": "-", "omega4": ":"}

with fl.open(sys.argv[1]) as maps:
    ratio = fl.planar.force_hypothesis(maps).ratio.isel(branch=0)
    classes = maps.grashof_class.values
figure, axes = plt.subplots(1, 2, figsize=(10.4, 3.8), layout="constrained", sharey=True)
for axis, (code, title) in zip(axes, CLASSES.items(), strict=True):
    share = np.linspace(0.0, 100.0, 501)
    for k, (load, label) in enumerate(LOADS.items()):
        for rate, style in RATES.items():
            best = ratio.sel(load=load, extreme=[f"{rate}_max", f"{rate}_min"]).max("extreme").values
            levels = np.quantile(best[classes == code], 1.0 - share / 100.0)
            axis.plot(share, levels, style, color=f"C{k}", label=label if rate == "alpha4" else None)
    axis.axhline(1.0 - 0.032, color="0.6", linewidth=0.8)
    axis.set(title=title, xlabel="% of the designs", xlim=(0.0, 100.0), ylim=(0.0, 1.02))
axes[0].set_ylabel("force at the rate's extreme / greatest force")
handles, labels = axes[0].get_legend_handles_labels()
look = {"title": "full: alpha4, dotted: omega4", "fontsize": "small", "frameon": False}
figure.legend(handles, labels, loc="outside right upper", **look)
figure.savefig(Path(__file__).with_suffix(".png"), dpi=110)
