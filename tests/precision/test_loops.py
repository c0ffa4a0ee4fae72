"""Facts and error bounds against the loops themselves, a reference that shares no formula with them."""

from collections import Counter
from dataclasses import dataclass, field, replace
from functools import lru_cache

import flint
import numpy as np
import pytest
from flint import acb, arb
from tests.support.neighbourhoods import DRAWN, ULP
from tests.support.precision import in_every_mode
from tests.support.registry import ENTRIES, every_input
from tests.support.sweeps import BARS, CRANK, sweep_both

import fastlink as fl
from fastlink.facts.formula import Formula
from fastlink.facts.powers import any_beyond_range
from fastlink.mechanisms import catalogue
from fastlink.plan.request import constants_of, selected_variants
from fastlink.precision.errors import unit_of
from fastlink.precision.independent import TOLERANCE, TURNING, IndependentValues, model_of
from fastlink.precision.loops import Singular, corner
from fastlink.precision.reference import CONTEXT, HighPrecision

ENTRY = {str(entry): entry for entry in ENTRIES if entry.solver == "eliminated"}

#: What loops do not give: codes, measures of the loop, centres, inertias and limits of designs. Each is held by a test
#: of its mechanism.
SILENT = {
    "planar_4r": "swing time_ratio circuit circuit_count r11 r12 r22 r23 r33 r34 G1 G2 G3 inertia",
    "minkowski_4r": "theta_min theta_max psi_min psi_max cosh_theta_branching theta_branching assembly_count_future",
    "focal": "h1 h2 transmission_angle_PQ_least transmission_angle_F_least least_transmission_angle grashof_excess"
    " phi_low phi_high psi_low psi_high",
    "hart": "ellipse_a ellipse_b",
    "slider_crank": "grashof_excess theta_low theta_high theta_outer theta_inner time_ratio"
    " least_transmission_angle",
}
MEASURES = ("residual", "deviation", "_dot", "_ddot")


@every_input
def test_every_quantity_has_an_independent_value_but_these(mechanism, drive):
    known = catalogue(mechanism, drive)
    names = IndependentValues(known, tuple(known.public)).names
    silent = tuple(SILENT[mechanism].split())
    for name in set(known.public) - set(names):
        assert known.public[name].flags or name.startswith(silent) or any(of in name for of in MEASURES), name
    derivative = f"d_{names[0]}_d_{known.position.name}"
    assert IndependentValues(known, [derivative, f"{names[0]}_error", "status"]).names == (derivative,)


def compared(entry, kind, n):
    """Assert that facts and loops agree in n configurations of a family; return how many values were compared."""
    inputs = in_every_mode(entry, entry.drawn(kind, n, n))
    position = entry.catalogue.position.name
    inputs = {position: np.ones_like(next(iter(inputs.values())))} | inputs
    independent = IndependentValues(entry.catalogue, entry.names)
    facts = HighPrecision(
        entry.catalogue,
        independent.names,
        inputs,
        selected_variants(entry.catalogue, None, entry.solver, inputs),
    )
    numbers = [name for name in inputs if name not in ("branch", "completion")]
    count = 0
    for i in range(len(inputs[position])):
        at = {name: float(values[i]) for name, values in inputs.items()}
        exact = facts.at(at)
        condition = facts.condition(exact, numbers)
        units = {name: unit_of(exact[name], condition[name], 1.0) for name in independent.names}
        found = independent.differences(at, exact, units)
        assert {name: value for name, value in found.items() if value > TOLERANCE} == {}, at
        count += len(found)
    return count


@pytest.mark.parametrize("name", ENTRY)
def test_facts_and_loops_agree_to_fifty_digits(name):
    assert compared(ENTRY[name], next(iter(ENTRY[name].families)), 1)


@pytest.mark.stress
@pytest.mark.parametrize("name", ENTRY)
def test_facts_and_loops_agree_in_many_configurations(name):
    assert sum(compared(ENTRY[name], kind, 40) for kind in ENTRY[name].families) > 1000


@pytest.mark.sample(4)
@pytest.mark.parametrize("n", [60, pytest.param(4000, marks=pytest.mark.stress)])
@pytest.mark.parametrize(("mechanism", "drive"), DRAWN)
def test_both_references_have_the_same_numbers(mechanism, drive, n):
    """Most configurations are next to something degenerate."""
    known = catalogue(mechanism, drive)
    inputs = DRAWN[mechanism, drive](np.random.default_rng(n), n) | {"branch": np.ones(n)}
    variants = known.variants_selected_by(inputs)
    constants = constants_of(known, None, variants).items()
    inputs |= {name: np.full(n, value) for name, value in constants} | inputs
    independent = IndependentValues(known, [name for name in known.public if name not in inputs])
    facts = HighPrecision(known, independent.names, inputs, variants)
    counts = Counter()
    for i in range(n):
        at = {name: float(values[i]) for name, values in inputs.items()}
        exact = facts.at(at)
        found = independent.differences(at, exact, dict.fromkeys(independent.names, 1.0))
        assert [name for name, difference in found.items() if difference == np.inf] == [], at
        counts[any(CONTEXT.isnan(exact[name]) for name in found)] += 1
    assert min(counts[True], counts[False]) > n // 12


#: Designs of each mechanism, of all its inputs together, in the long form: half an hour of one core each.
MANY = 1_000_000
#: In each run a few.
FEW = 40


@pytest.mark.sample(6)
@pytest.mark.parametrize(("mechanism", "drive"), DRAWN)
def test_values_are_within_their_bounds(mechanism, drive):
    tally = campaign(mechanism, drive, FEW)
    assert tally.failures == {}
    # more than a few values of each design, where it assembles or does not
    assert tally.counts["values"] > 5 * FEW


@pytest.mark.stress
@pytest.mark.parametrize("mechanism", dict.fromkeys(mechanism for mechanism, _ in DRAWN))
def test_a_million_designs(mechanism, tell):
    drives = [drive for of, drive in DRAWN if of == mechanism]
    tallies = [campaign(mechanism, drive, MANY // len(drives)) for drive in drives]
    tell(
        "\n".join(
            f"{tally.mechanism}, {tally.input}: {dict(tally.counts)}, worst {tally.worst}"
            for tally in tallies
        )
    )
    assert [tally.report() for tally in tallies if tally.failures] == []
    assert sum(tally.counts["values"] for tally in tallies) > 10 * MANY


def kites_with_a_pivot_on_the_circle_of_F(rng, n, first, second, s, fold):
    """Return near kites, crank nearly in MN: the last bits of the lengths decide on which side F passes M or N."""
    moved = 1.0 + rng.integers(-8, 9, (2, n)) * ULP
    names = "abcd" if first > second else "abdc"
    lengths = zip(names, (first, second, first * moved[0], second * moved[1]), strict=True)
    away = 10.0 ** rng.uniform(-30.0, -10.0, n)
    design = {name: np.broadcast_to(values, n) for name, values in lengths}
    design |= {"s": s * design["d"], "sigma": fold - np.sign(fold - 1.0) * away}
    return design | {"completion": np.ones(n), "omega": np.ones(n), "branch": rng.integers(1.0, 3.0, n)}


@pytest.mark.parametrize(
    "kite",
    [(559.1867775730996, 0.0681443389688298, -1.0, 0.0), (0.3069707532162749, 32.7295150031468, 2.0, np.pi)],
)
def test_the_last_bits_of_a_near_kite_decide_on_which_side_F_passes_a_pivot(kite):
    tally, rng = Tally("focal", "sigma"), np.random.default_rng(4)
    compare(tally, kites_with_a_pivot_on_the_circle_of_F(rng, 150, *kite))
    assert tally.failures == {}
    # of 17 by 17 near kites 17 have one equal pair, whose F may pass the pivot itself: nothing is known there
    assert tally.counts["values"] > 6 * tally.counts["flagged"] > 0


def test_a_value_beyond_its_bound_and_one_where_there_is_none_are_failures():
    """One value is right, one is off by more than its bound, one is off but flagged, one belongs to an open loop."""
    tally = Tally("planar_4r", "theta1")
    values, bounds = np.array([[1.0], [1.5], [1.5], [2.0]]), np.array([[0.1], [0.1], [np.inf], [0.1]])
    exact, kinds = np.array([[1.05], [1.0], [1.0], [np.nan]]), np.array([[0], [0], [0], [1]])
    names, errors = ["right", "off", "flagged", "open"], abs(values - exact)
    count(tally, names, [{"a1": 1.0}], values, bounds, errors, np.zeros((4, 1)), kinds, exact)
    assert set(tally.failures) == {("beyond", "off"), ("finite where none", "open")}
    assert tally.counts["flagged"] == 1
    assert tally.worst == (pytest.approx(0.5), "right")


def test_what_the_reference_cannot_tell_is_no_failure():
    """Angles half a turn apart less 1e-3; a double root of eq. (2.5), whose P is there though the four-bar is open."""
    apart = errors_of(np.array([[0.0]]), np.array([[np.pi - 1e-3]]), np.zeros((1, 1)), np.array([True]))
    assert apart[0, 0] == pytest.approx(np.pi - 1e-3)
    double = {"a": 3.0, "b": 1.0, "c": 4.0, "d": 2.0, "lambda_": -1.0, "completion": 2.0, "branch": 2.0}
    at = double | {"phi": -1375454924335.5095, "omega": 1.0}
    assert np.isfinite(fl.evaluate("focal", ["P_x"], **at)["P_x"])
    assert references(model_of(catalogue("focal")), {"P_x": 0}, [at], 256)[3] == UNKNOWN
    with pytest.raises(Singular, match="coincide"):  # a triangle over no base
        corner(CONTEXT, CONTEXT.mpc(0), CONTEXT.mpf(1), CONTEXT.mpf(1), 1)
    assert abs(corner(CONTEXT, CONTEXT.mpc(1), CONTEXT.mpf(1), CONTEXT.mpf(1), 1)) == 1


def nearly(right):
    """Return what a formula says that is wrong in the twelfth digit."""
    return right * 1.000000000001


#: A mechanism, a fact on the way, a quantity that it makes wrong, and inputs of a sweep.
WRONG = [
    ("planar_4r", "torque2", "T41", CRANK | {"omega1": 25.0}, {"links": BARS}),
    ("focal", "lambda_", "F_x", {"a": 4.0, "b": 5.0, "c": 2.0, "d": 4.0, "s": 1.5, "completion": 1}, {}),
]


@pytest.mark.parametrize(("mechanism", "fact", "quantity", "design", "options"), WRONG)
def test_a_wrong_formula_is_a_mismatch_in_the_file(
    monkeypatch, tmp_path, mechanism, fact, quantity, design, options
):
    """Kernels and 50-digit facts share their formulas: only what does not can tell that one is wrong."""
    known = catalogue(mechanism)
    law = known.facts[fact]
    options = options | {known.position.name: np.linspace(0.9, 1.1, 5), "verify": 1}

    def swept(name):
        with sweep_both(mechanism, fl.grid(**design), [quantity], **options, to=tmp_path / name) as maps:
            return dict(maps[quantity].attrs), maps.attrs["verify_mismatches"], maps.fastlink.summary()

    attrs, mismatches, summary = swept("right.h5")
    assert mismatches == 0
    assert attrs["independent_values"] == 1
    assert attrs["independent_max_difference"] < TOLERANCE
    assert "NOT AS" not in summary
    monkeypatch.setitem(known.facts, "right", replace(law, name="right", internal=True))
    monkeypatch.setitem(known.facts, fact, replace(law, formula=Formula.of(nearly), depends_on=("right",)))
    with pytest.warns(fl.InputWarning, match=f"{quantity} is wrong in 1 of "):
        attrs, mismatches, summary = swept("wrong.h5")
    assert attrs["verify_mismatches"] == attrs["independent_values"] == 1 <= mismatches
    assert attrs["independent_max_difference"] > 1e-16
    assert "NOT AS WITH 50 DIGITS" in summary


# == Values and bounds of many designs against the loops =====================================================
# The reference shares no formula with the facts: `fastlink.precision.independent` on balls of many bits.

#: Bits of the reference, each taken where the one before leaves something open.
BITS = (256, 1024, 4096)
BLOCK = 4096
#: A whole turn, and what rounding it to a double loses.
TURN, TURN_LOW = 6.283185307179586, 2.4492935982947064e-16
#: What a value of the reference is.
NUMBER, OPEN, UNKNOWN = 0, 1, 2
#: The share of a bound that a ball may have.
SHARP = 2.0**-20


class FlintContext:
    """The functions that the models call, on balls of so many bits (ten times as fast as mpmath); one at a time."""

    mpf, mpc = arb, acb
    sqrt, cos, sin, exp, log = map(staticmethod, (arb.sqrt, arb.cos, arb.sin, arb.exp, arb.log))
    atan2, atanh, acosh = map(staticmethod, (arb.atan2, arb.atanh, arb.acosh))
    #: Where the loop does not close: a ball that is no number has too few bits.
    nan = None
    #: Balls know what rounding leaves open.
    eps = 0

    def __init__(self, bits):
        self.bits, self.dps = bits, int(bits * 0.30103)

    def __enter__(self):
        self.before, flint.ctx.prec = flint.ctx.prec, self.bits
        return self

    def __exit__(self, *_):
        flint.ctx.prec = self.before

    @staticmethod
    def cos_sin(x):
        sine, cosine = x.sin_cos()
        return cosine, sine

    @property
    def pi(self):
        return arb.pi()


@lru_cache(maxsize=64)
def context(bits):
    return FlintContext(bits)


@dataclass
class Tally:
    """What came out for one mechanism by one input."""

    mechanism: str
    input: str
    #: Of designs, values and the like.
    counts: Counter = field(default_factory=Counter)
    #: The greatest share of an error in its bound, and the quantity that has it.
    worst: tuple[float, str] = (0.0, "")
    #: By kind and quantity how many there are, and the first: its configuration and what is wrong.
    failures: dict = field(default_factory=dict)

    def fail(self, kind, name, at, about):
        """Add a failure."""
        self.counts[kind] += 1
        number, *first = self.failures.get((kind, name), (0, at, about))
        self.failures[kind, name] = (number + 1, *first)

    def report(self):
        """Return the failures by their first examples."""
        examples = {}
        for (kind, name), (number, at, about) in self.failures.items():
            examples.setdefault(str(at), []).append(f"    {name}: {kind}, {number} times; {about}")
        return "\n".join(
            f"{self.mechanism}, {self.input}, {at}\n" + "\n".join(of) for at, of in examples.items()
        )


def references(model, names, rows, bits):
    """Return values as high and low parts, radii, and kinds, each (names, rows); `names` has their numbers."""
    shape = (len(names), len(rows))
    high, low, radius = np.full(shape, np.nan), np.zeros(shape), np.zeros(shape)
    kinds = np.full(shape, UNKNOWN)
    for i, at in enumerate(rows):
        lost = model.lost(at)
        if lost is None:
            continue
        with context(bits + 4 * lost) as ctx:
            for name, value in model.values(ctx, at, names).items():
                k = names[name]
                if value is None:
                    kinds[k, i] = OPEN
                    continue
                if not value.is_finite():
                    continue
                high[k, i] = float(value.mid())
                if np.isfinite(high[k, i]):
                    low[k, i] = float((value - high[k, i]).mid())
                radius[k, i] = float(value.rad())
                kinds[k, i] = NUMBER
    return high, low, radius, kinds


def computed(mechanism, drive, names, design):
    """Return the values in doubles and their error bounds, each (names, designs)."""
    n = len(next(iter(design.values())))
    known = catalogue(mechanism, drive)
    bounded = [name for name in names if not known.public_fact(name).flags]
    wanted = [*names, *(f"{name}_error" for name in bounded)]
    with np.errstate(all="ignore"):
        found = fl.evaluate(mechanism, wanted, input=drive, **design)
    values = np.array([np.broadcast_to(found[name], n) for name in names])
    bounds = np.array(
        [np.broadcast_to(found[f"{name}_error"], n) if name in bounded else np.zeros(n) for name in names]
    )
    return values, bounds


def errors_of(values, high, low, turning):
    """Return the errors of values, of angles modulo a turn."""
    with np.errstate(all="ignore"):
        errors = (values - high) - low
        turns = np.where(turning[:, None] & (abs(errors) > 0.5 * TURN), np.sign(errors), 0.0)
        return abs((((values - high) - turns * TURN) - low) - turns * TURN_LOW)


def compare(tally, design):
    """Compare one block of designs."""
    model = model_of(catalogue(tally.mechanism, tally.input))
    known = catalogue(tally.mechanism, tally.input)
    names = [
        name for name in (*model.orders, *model.of_design) if name in known.public and name not in design
    ]
    n = len(next(iter(design.values())))
    rows = [{str(name): float(values[i]) for name, values in design.items()} for i in range(n)]
    values, bounds = computed(tally.mechanism, tally.input, names, design)
    turning = np.array([name in TURNING for name in names])
    index = {name: k for k, name in enumerate(names)}
    high, low, radius, kinds = references(model, index, rows, BITS[0])
    for bits in BITS[1:]:
        errors = errors_of(values, high, low, turning)
        again = suspicious(values, bounds, errors, radius, kinds).any(axis=0).nonzero()[0]
        if not again.size:
            break
        found = references(model, index, [rows[i] for i in again], bits)
        for whole, part in zip((high, low, radius, kinds), found, strict=True):
            whole[:, again] = part
    count(tally, names, rows, values, bounds, errors_of(values, high, low, turning), radius, kinds, high)


def suspicious(values, bounds, errors, radius, kinds):
    """Return where the reference should be computed with more bits: wrong values, unless it is sharp."""
    with np.errstate(invalid="ignore"):
        right = (kinds == NUMBER) & (errors <= bounds) & ((radius <= SHARP * bounds) | (errors == 0.0))
    return np.isfinite(values) & np.isfinite(bounds) & ~right


def count(tally, names, rows, values, bounds, errors, radius, kinds, high):
    """Add a block to the tally; a value with an infinite bound is flagged, it claims nothing."""
    finite, claims = np.isfinite(values), np.isfinite(bounds)
    inside, is_open = (kinds == NUMBER) & np.isfinite(high), kinds == OPEN
    with np.errstate(all="ignore"):
        wrong = finite & inside & claims & (errors > bounds)
        beyond = wrong & (radius <= 0.01 * errors)
        sharp = finite & inside & claims & (bounds > 0.0) & (radius <= SHARP * np.maximum(errors, bounds))
        shares = np.where(sharp & ~beyond, errors / bounds, 0.0)
    unknown = finite & claims & (kinds == UNKNOWN)
    tally.counts += Counter(
        {
            "designs": len(rows),
            "values": int((finite & inside).sum() + (is_open & ~finite).sum()),
            "flagged": int((finite & ~claims & (kinds != UNKNOWN)).sum()),
            "NaN": int((np.isnan(values) & inside).sum()),
            "not told": int((unknown | wrong & ~beyond).sum()),
            "open": int(is_open.any(axis=0).sum()),
        }
    )
    k, i = np.unravel_index(np.argmax(shares), shares.shape)
    tally.worst = max(tally.worst, (float(shares[k, i]), names[k]))
    endless = np.isinf(values) & (bounds != np.inf) & inside & (radius <= SHARP * abs(high))
    failures = {"beyond": beyond, "finite where none": finite & is_open & claims, "infinite": endless}
    for kind, where in failures.items():
        for k, i in zip(*where.nonzero(), strict=True):
            about = f"value {float(values[k, i])!r}, exact {float(high[k, i])!r}, bound {bounds[k, i]:.3g}"
            tally.fail(kind, names[k], rows[i], about)


def campaign(mechanism, drive, designs, seed=0):
    """Return the tally of so many designs."""
    tally = Tally(mechanism, drive)
    rng = np.random.default_rng([seed, *map(ord, mechanism + drive)])
    for start in range(0, designs, BLOCK):
        n = min(BLOCK, designs - start)
        design = DRAWN[mechanism, drive](rng, n) | {"branch": rng.integers(1, 3, n).astype(float)}
        known = catalogue(mechanism, drive)
        far = any_beyond_range(known.known_inputs(known.variants_selected_by(design)), design)
        compare(tally, {name: values[~far] for name, values in design.items()})
    return tally
