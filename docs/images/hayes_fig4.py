"""Fig. 4 of Hayes, Hninn and Irani as it follows from their Table 1: ``python docs/images/hayes_fig4.py``."""

from pathlib import Path

import matplotlib.pyplot as plt

import fastlink as fl

maps = fl.sweep(
    "planar_4r",
    fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0),
    ["shaking_force", "shaking_moment", "shaking_force_max", "theta1_at_shaking_force_max"],
    links=fl.round_bar(density=7750.0, radius=0.01),
    branch=2,
    theta1=1440,
)

figure, axis = plt.subplots(figsize=(7.2, 4.2), layout="constrained")
other = axis.twinx()
(force,) = axis.plot(maps.theta1, maps.shaking_force, color="tab:blue")
(moment,) = other.plot(maps.theta1, abs(maps.shaking_moment), color="tab:orange", linestyle="--")
place, greatest = float(maps.theta1_at_shaking_force_max), float(maps.shaking_force_max)
axis.annotate(f"{greatest:.1f} N at {place:.4f} rad", (place, greatest), (0.6, greatest), va="center")
axis.set(xlabel="theta1 [rad]", ylabel="shaking force [N]", xlim=(0.0, 6.2832), ylim=(0.0, 2700.0))
other.set(ylabel="shaking moment about O, magnitude [N m]", ylim=(0.0, 2700.0))
axis.legend([force, moment], ["force", "moment"], loc="upper center")
axis.set_title("Table 1 of Hayes, Hninn and Irani, assembly mode 2, omega1 = 25 rad/s")
figure.savefig(Path(__file__).with_suffix(".png"), dpi=110)
