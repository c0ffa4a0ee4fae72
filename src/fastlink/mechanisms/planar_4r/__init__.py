"""The Euclidean planar 4R of Hayes, Hninn and Irani: its facts stand in the sheets beside this file."""

from fastlink.facts.catalogue import Catalogue
from fastlink.facts.fact import GradedRange, Input, KnownExtremes
from fastlink.facts.sheet import read_sheets
from fastlink.mechanisms._shared.picture import Bar, Circle, Force, Picture, Point, Torque, joint

__all__ = ["DRIVEN", "PICTURE", "planar_4r"]

planar_4r = Catalogue(
    "planar_4r",
    "Euclidean planar four-bar linkage with four revolute joints, driven at O",
    branches={
        1: "B to the right of the directed line from A to D",
        2: "B to the left of the directed line from A to D",
    },
    position=Input("theta1", "rad", "theta_1", "input angle; direction of OA in the ground frame"),
)
planar_4r.closes = ("sigma", "p", "q")
planar_4r.most_asked = (
    "theta4 omega4 alpha4 theta2 omega2 transmission_angle least_transmission_angle swing time_ratio "
    "grashof_class status P_x P_y P_straightness T41 T41_peak F41_max F21_max shaking_force_max "
    "shaking_moment_peak"
)
read_sheets(
    __file__,
    ("inputs", "classes", "position", "rates", "dense", "forces", "graded"),
    planar_4r,
)

# Between extremes of a rate its derivative has the sign of a polynomial of degree 6 in tan^2(theta1/2): never more
# than one maximum and one minimum by branch; that of an acceleration is of degree 11: at most 5 were found.
MONOTONE = ("omega2", "omega4", "theta2", "theta4", "transmission_angle")
ACCELERATIONS = ("alpha2", "alpha4")
#: The pairs of joints of which the input-output equations are.
PAIRS = ("12", "13", "14", "23", "24", "34")

REST_OF_OUTPUT = {1: ("place_folded",), 2: ("place_stretched",)}
OUTPUT = KnownExtremes(REST_OF_OUTPUT, {1: ("place_output_back",)})
COUPLER = KnownExtremes({1: ("place_opposite",), 2: ("place_parallel",)}, {1: ("place_coupler_back",)})
IN_GROUND_LINE = {1: ("place_output_back",), 2: ("place_output_on",)}
#: Where the output link rests or points along the ground link: of a place of each kind there is one.
ALONG = KnownExtremes({1: ("place_folded_or_back",), 2: ("place_on_or_stretched",)})
#: Z alone determines these, and they grow with it or fall.
AT_ENDS = dict.fromkeys(("transmission_angle", "joint_angle_3", "A_x"), KnownExtremes())

planar_4r.graded = GradedRange(
    bounded_factor="sine_mu",
    cells=dict.fromkeys(MONOTONE, 16) | dict.fromkeys(ACCELERATIONS, 32),
    max_extrema=dict.fromkeys(MONOTONE, 2) | dict.fromkeys(ACCELERATIONS, 5),
    not_differentiable=(
        "loop_residual",
        "joint_angle_1",
        *(f"io_residual_{pair}" for pair in PAIRS),
        *(f"v{k}{of}" for k in range(1, 5) for of in ("", "_dot", "_ddot")),
    ),
    wraps_at={"theta2": "AB_y", "theta4": "DB_y", "joint_angle_2": "AB_v", "joint_angle_4": "DB_y"},
    divisors={"curvature": ("curve_rate", 5)},  # (P' x P'')/|P'|^3
    turns={"load_torque": "omega4"},  # T_2 omega4 |omega4|
    poles={
        "mechanical_advantage": ("output_ratio",),
        **dict.fromkeys(("instant_centre_x", "instant_centre_y"), ("coupler_ratio",)),
        "relative_centre_x": ("output_excess",),
    },
    known={
        **AT_ENDS,
        "A_y": KnownExtremes({1: ("place_crosswise",), 2: ("place_crosswise",)}),
        "B_x": ALONG,
        "theta4": OUTPUT,
        "joint_angle_4": OUTPUT,
        "theta2": COUPLER,
        "joint_angle_2": KnownExtremes(IN_GROUND_LINE, {1: ("place_folded",)}),
    },
)

#: Figs. 1 and 2 of Hayes, Hninn and Irani.
PICTURE = Picture(
    points=(
        Point("O", 0.0, 0.0, "ground"),
        Point("D", "a4", 0.0, "ground"),
        joint("A"),
        joint("B"),
        joint("P", "traced"),
        *(joint(f"G{number}", "mark", group="centres") for number in (1, 2, 3)),
    ),
    bars=(
        Bar("O D", {"O D": "a4"}, is_ground=True),
        Bar("O A", {"O A": "a1"}),
        Bar("A B P", {"A B": "a2"}),
        Bar("D B", {"D B": "a3"}),
    ),
    circles=(Circle("O", "a1"), Circle("D", "a3")),
    forces=(Force("F41", "O"), Force("F21", "A"), Force("F32", "B"), Force("F43", "D")),
    torques=(Torque("T41", "O"),),
    traced={"path": "P"},
    title="{grashof_class}, swing {swing}",
)

from fastlink.mechanisms.planar_4r import by_joint  # noqa: E402 (it reads what is declared above)

#: The same linkage by its other inputs.
DRIVEN = by_joint.driven_catalogues()
