"""Where every mechanism is tested: its inputs, its families of configurations, and how exact it must be there."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any

import numpy as np
import pytest

from fastlink.facts.catalogue import Catalogue
from fastlink.mechanisms import NAMES, catalogue, inputs_of
from fastlink.numerics.compensated import UNIT_ROUNDING
from tests.support import configurations, focal_configurations, hart_configurations

#: Draw some configurations, or fewer: the inputs, the input position and the modes (``branch`` and inputs with choices)
#: by name. Of modes that are left out all are tested, without a position what belongs to a design alone.
Family = Callable[[np.random.Generator, int], dict[str, np.ndarray]]

#: The multiple of entries that do not say another one.
MULTIPLE = 4.0


@dataclass(frozen=True, eq=False)
class Entry:
    """One mechanism driven by one input."""

    mechanism: str
    input: str
    #: Configurations, easy and hard, and how many of each in a run, and in a long one.
    families: Mapping[str, Family]
    few: int
    many: int
    #: What tells it from other entries of the same input.
    about: str = ""
    #: As in `fastlink.evaluate`.
    solver: str = "eliminated"
    #: What is tested; all that is public (and belongs to a design, if there is no position) unless it is given.
    quantities: tuple[str, ...] = ()
    #: What is not tested, and why.
    left_out: Mapping[str, str] = field(default_factory=dict)
    #: The greatest error in roundings of the result and of each input: facts are short, and do not cancel.
    multiple: float = MULTIPLE
    #: The same of single quantities.
    long_chains: Mapping[str, float] = field(default_factory=dict)
    #: What is nothing but an error, and has no condition: the greatest value.
    errors: Mapping[str, float] = field(default_factory=dict)
    #: The greatest median of error bounds over errors, and the least share of bounds below a hundred errors.
    looseness: float = 25.0
    near_bounds: float = 0.9
    #: Quantities whose terms have errors in common, each of which a bound takes on its own: the least share is of
    #: bounds below a thousand errors. They are bounds as all others are.
    sharing_errors: tuple[str, ...] = ()
    #: Families where derivatives keep to the multiple, too.
    slopes: tuple[str, ...] = ("random",)

    def __str__(self) -> str:
        return " ".join(filter(None, (self.mechanism, self.about, self.input)))

    @cached_property
    def catalogue(self) -> Catalogue:
        return catalogue(self.mechanism, self.input)

    @cached_property
    def moves(self) -> bool:
        """Whether the families have an input position."""
        return self.input in next(iter(self.families.values()))(np.random.default_rng(1), 4)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The quantities that are tested."""
        names = self.quantities or tuple(
            name for name in self.catalogue.public if self.moves or not self.catalogue.varies(name)
        )
        return tuple(name for name in names if name not in self.left_out)

    def drawn(self, kind: str, seed: int, n: int) -> dict[str, np.ndarray]:
        """Return configurations of a family."""
        return self.families[kind](np.random.default_rng(seed), n)


def families(draw: Callable[..., Any], kinds: Iterable[str], *first: Any) -> dict[str, Family]:
    """Return families by their names."""
    return {kind: partial(draw, *first, kind) for kind in kinds}


def anywhere(mechanism: str, input: str, most: float = np.pi) -> dict[str, Family]:
    """Return the family of all inputs of about one size, at positions up to one of either sign."""

    def draw(rng: np.random.Generator, n: int) -> dict[str, np.ndarray]:
        drawn = configurations.draw(catalogue(mechanism, input).inputs, rng, n)
        return drawn | {input: rng.uniform(-most, most, n)}

    return {"random": draw}


#: Terms of at most 1, each right to some ten roundings times the amplification of the lengths and the angle.
CLOSURE = {
    name: 64 * UNIT_ROUNDING
    for name in ("loop_residual", *(f"io_residual_{pair}" for pair in ("12", "13", "14", "23", "24", "34")))
}
#: Derivatives that cancel are declared (`rates.py`).
SLOPES = ("random", "gap 1e-8", "toggle 1e-6")
REACTIONS = (
    *("F41_x", "F41_y", "F21_x", "F21_y", "F32_x", "F32_y", "F43_x", "F43_y"),
    *("T41", "shaking_moment"),
)

PLANAR_4R = (
    # The longest chain (T41) has about 40 operations: 1.9 is the worst seen.
    Entry(
        *("planar_4r", "theta1"),
        families=families(configurations.family, configurations.FAMILIES),
        few=30,
        many=600,
        errors=CLOSURE,
        slopes=SLOPES,
    ),
    Entry(
        *("planar_4r", "theta1"),
        about="under all loads",
        families=families(configurations.loaded, ("random", "gap 1e-8", "toggle 1e-6")),
        few=4,
        many=300,
        errors=CLOSURE,
        slopes=SLOPES,
    ),
    Entry(
        *("planar_4r", "theta1"),
        about="by the dense solver",
        solver="dense",
        quantities=REACTIONS,
        families=families(configurations.family, ("random", "toggle 1e-6")),
        few=25,
        many=25,
        # LU of the 9x9 is backward stable, with a growth factor below 4: the worst seen is 4.6.
        multiple=16.0,
    ),
    *(
        Entry(
            *("planar_4r", f"joint_angle_{joint}"),
            families=families(configurations.driven, configurations.FAMILIES, joint),
            few=8,
            many=300,
            errors=CLOSURE,
            slopes=SLOPES,
        )
        for joint in (1, 2, 3, 4)
    ),
)


#: 1 + w, w being right to 6 units of 2^-53: two sums, two quotients, two products.
COSINES = dict.fromkeys(
    ("cosh_theta_min", "cosh_theta_max", "cosh_psi_min", "cosh_psi_max", "cosh_theta_branching"), 7.0
)

MINKOWSKI_4R = (
    Entry(
        *("minkowski_4r", "theta"),
        families=anywhere("minkowski_4r", "theta", 4.0),
        looseness=10.0,
        few=12,
        many=300,
        # Two sums of four terms, each right to 2 roundings; a product of two sums of 10 terms of 8 roundings at most.
        errors={"loop_residual": 8 * UNIT_ROUNDING, "sextic_residual": 16 * UNIT_ROUNDING},
        # Of 110,000 values one of the second derivative is beyond 4, where lengths are very unequal: 4.2.
        long_chains=COSINES | {"d2psi_dtheta2": 6.0},
    ),
)


CIRCLES_OF_FOCAL = tuple(
    f"{points}_{of}" for points in ("PFQX", "SFTY", "PSQT") for of in ("x", "y", "radius")
)
PIVOTS_SEEN_FROM_AB = tuple(f"{joint}_{way}_AB" for joint in "MNS" for way in ("along", "across"))

FOCAL = (
    *(
        Entry(
            *("focal", drive),
            families=families(focal_configurations.family, focal_configurations.FAMILIES, drive),
            looseness=20.0,
            # By sigma one bound in five is greater near dead centres (as measured: nothing says it has to be).
            near_bounds=0.9 if drive == "phi" else 0.8,
            # Products and quotients of directions and places that come from the same few numbers.
            sharing_errors=CIRCLES_OF_FOCAL if drive == "phi" else (*CIRCLES_OF_FOCAL, *PIVOTS_SEEN_FROM_AB),
            few=10,
            many=600,
            # Where S is far away the changes of F with rho cancel, the roundings of s and r do not (6.2 at most).
            # Others follow F_y, or are turned by the direction of AB, a product of five (5.6); S there by both (8.7).
            long_chains=dict.fromkeys(("sigma", "alpha", "chi", "F_x", "F_y", "T_x", "T_y", "Y_x"), 8.0)
            | dict.fromkeys(("F_along_AB", "F_across_AB", "PSQT_x", "PFQX_x", "SFTY_x"), 8.0)
            | dict.fromkeys((*PIVOTS_SEEN_FROM_AB, "PSQT_radius", "sigma_rate", "dsigma_dphi"), 8.0)
            | dict.fromkeys(("S_along_AB", "S_across_AB"), 16.0),
            # Of the longest bar: two ends of two coordinates, each right to 8 roundings, and the length itself.
            errors={"closure_residual": 40 * UNIT_ROUNDING},
            left_out={"F_path_residual": "is measured by the reach of the dyads: test_focal_figure.py"},
        )
        for drive in focal_configurations.DRIVES
    ),
)


HART = (
    # 3.7 is the worst seen in 10^4 configurations.
    Entry(
        *("hart", "phi"),
        families=families(hart_configurations.family, hart_configurations.FAMILIES),
        looseness=10.0,
        few=4,
        many=300,
        # Three roundings of MP and PF, which sum to MP + PF; of each bar eight in its joints.
        errors={"F_deviation": 6.0, "closure_residual": 32 * UNIT_ROUNDING},
        # The direction of AB is a quotient by its size, 5 roundings, and the place in its frame takes 3: 5.9.
        long_chains={"N_across_AB": 8.0},
    ),
    # 2.2 is the worst seen in 2000 configurations.
    Entry(
        *("hart", "F_y"),
        families={"random": hart_configurations.along_line},
        # The rates by F_y are quotients of sums with common factors, each term of which is bounded on its own.
        near_bounds=0.85,
        few=3,
        many=200,
        # Some ten roundings from F_y to P, those of PF, and of five bars each eight.
        errors={"F_deviation": 16.0, "closure_residual": 32 * UNIT_ROUNDING},
        # Products of two directions, each a quotient of sums and roots (4.1), of which those of N have changes with the
        # lengths that may undo each other, and roundings that do not (13.4). The rate of psi is a quotient (4.5).
        long_chains={"M_across_AB": 8.0, "N_across_AB": 20.0, "dpsi_dF_y": 8.0},
    ),
)


SLIDER_CRANK = (
    # 3.2 is the worst seen in 10^4 configurations, but for the forces at A across the line.
    Entry(
        *("slider_crank", "theta"),
        families=anywhere("slider_crank", "theta"),
        few=6,
        many=600,
        # Where crank and rod are nearly alike and fold, the slider rests at O and terms undo each other: 8.7. Of 1200
        # configurations with a rod of 1e-8 the torque is beyond 4 in one, next to a zero: 5.2.
        long_chains={"F21_y": 16.0, "F41_y": 16.0, "T41": 8.0, "input_power": 8.0},
        # Of the rod's length six roundings, of the loop two.
        errors={"loop_residual": 8 * UNIT_ROUNDING},
    ),
)

ENTRIES = (*PLANAR_4R, *MINKOWSKI_4R, *FOCAL, *HART, *SLIDER_CRANK)
#: A test of every mechanism by each of its inputs.
every_input = pytest.mark.parametrize(
    ("mechanism", "drive"), [(name, drive) for name in NAMES for drive in inputs_of(name)]
)
