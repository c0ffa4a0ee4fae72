"""Quantities of one's own that the tests share."""

import math
from math import sin

import numpy as np

import fastlink as fl

LENGTHS = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
LINKS = fl.round_bar(density=7750.0, radius=0.01)

mine = fl.extend("planar_4r")
mine.input("weight", units="1", default=0.5, rule="non-negative", description="weight of poor transmission")
mine.input("F_allowed", units="N", default=400.0, rule="positive")


@mine.quantity(units="1", symbol="C")
def cost(transmission_angle, omega4, omega1, weight):
    """Poor transmission, and speed of the output."""
    poor = 1.0 - sin(transmission_angle)
    speed = omega4 / omega1
    return weight * poor + speed**2


@mine.quantity(units="N", description="Larger of the forces on the crank's bearings")
def bearing_load(F21, F41):
    return max(F21, F41)


@mine.quantity(units="N")
def smaller_load(F21, F41):
    return np.minimum(F21, F41)


@mine.quantity(units="1")
def overload(bearing_load, F_allowed):
    over = max(bearing_load / F_allowed - 1, 0)
    return over**2


@mine.quantity(units="rad")
def off_right_angle(transmission_angle):
    return abs(transmission_angle - math.pi / 2)


@mine.quantity(units="1")
def is_poor(transmission_angle):
    return 1.0 if transmission_angle < 0.7 or transmission_angle > 2.4 else 0.0
