"""Units of a designer's own, by names such as a1_mm: the same bits as in SI at every door, and the same refusals."""

import math
import pickle
from fractions import Fraction

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mp
from numpy.testing import assert_allclose, assert_array_equal
from tests.support.refusals import assert_refusal, refused
from tests.support.sweeps import BARS, TURNING, sweep_4r, sweep_both
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app
from fastlink.errors import Problem
from fastlink.mechanisms import NAMES, catalogue
from fastlink.space.units import (
    KINDS,
    PI,
    TABLE,
    UNITS,
    factor_of,
    has_unit,
    looks_like_degrees,
    scaled,
    split,
    usual_name,
    with_unit,
)

CURVE = {"P_u": 0.5, "P_v": 0.1, "a2": 1.1, "a3": 0.8, "a4": 1.0}
REST = {"a2": 1.1, "a3": 0.8, "a4": 1.0, "omega1": 25.0}
FORCES = ["shaking_force_max", "omega4_max"]


PAIRS = [("mm", "m"), ("in", "m"), ("lb", "kg"), ("g_cm3", "kg m-3"), ("kg_mm2", "kg m2"), ("mm/s", "m s-1")]
OTHERS = [("rpm", "s-1"), ("mm", "m2"), ("g cm3", "kg m-3"), ("N", "N m"), ("furlong", "m")]
OTHERS += [(text, "m") for text in ("", "kg m-", "m**9**9**9", "--", "m s-1x", "°°", "(m)", "m%")]


@given(st.floats(1e-290, 1e290) | st.integers(1, 10**6).map(float), st.sampled_from(PAIRS))
def test_values_are_rounded_once(value, pair):
    factor = factor_of(*pair)
    assert scaled(value, factor) == float(Fraction(value) * factor)
    assert scaled(-value, 1 / factor) == float(-Fraction(value) / factor)


def test_the_usual_ones():
    assert scaled(400.0, factor_of("mm", "m")) == 0.4
    assert scaled(7.85, factor_of("g/cm3", "kg m-3")) == 7850.0
    assert scaled(60.0, factor_of("rpm", "rad s-1")) == 2 * math.pi
    assert scaled(180.0, factor_of("deg", "rad")) == math.pi
    assert scaled(3.0, factor_of("N mm", "N m")) == scaled(3.0, factor_of("Nmm", "N m")) == 0.003


@pytest.mark.parametrize(("text", "units"), OTHERS)
def test_another_kind_or_what_is_no_unit_has_no_factor(text, units):
    assert factor_of(text, units) is None
    assert not has_unit(text, units)


def test_every_unit_of_the_catalogues_is_read_and_every_name_is_split_again():
    for name in NAMES:
        for of, one in catalogue(name).variables.items():
            assert factor_of(one.units, one.units) == 1
            known = {of: one.units}
            assert split(of, known) == (of, "")
            usual = usual_name(of, one.units)
            assert usual == of or factor_of(split(usual, known)[1], one.units) is not None
            for text, (*_, written) in UNITS.items():
                assert split(with_unit(of, text), known) == (of, written)
    assert len(UNITS) == sum(len(texts.split()) for texts, *_ in TABLE)
    assert all(factor_of(usual, units) for units, (_, usual) in KINDS.items())


def study(folder, inputs, tables=""):
    path = folder / "study.toml"
    links = "" if "[links]" in tables else "[links]\nmodel = 'round_bar'\ndensity = 7750.0\nradius = 0.01\n"
    design = "".join(f"{name} = {value!r}\n" for name, value in {**REST, **inputs}.items())
    head = f"mechanism = 'planar_4r'\nquantities = {FORCES}\n"
    path.write_text(f"{head}{tables}\n{links}[design]\n{design}[cycle]\nbranch = 1\n")
    return path


def ran(path):
    with fl.run(path, to=path.with_suffix(".h5"), overwrite=True, verify=0) as maps:
        return maps.load()


def swept(space, **options):
    return fl.sweep("planar_4r", space, FORCES, branch=1, **{"links": BARS, **options})


def several(inputs):
    return {name: [value, 2 * value] for name, value in inputs.items()}


def from_file(folder, columns):
    pd.DataFrame({**several(REST), **columns}).to_csv(folder / "designs.csv", index=False)
    return swept(fl.table(folder / "designs.csv"))


def function(**inputs):
    rest = {name: value for name, value in REST.items() if name != "a4"}
    return fl.function("planar_4r", ["a4"], FORCES, links=BARS, **rest, **inputs)([1.0])


def function_of(inputs):
    made = pickle.loads(pickle.dumps(fl.function("planar_4r", list(inputs), FORCES, links=BARS, **REST)))
    x = list(inputs.values())
    return np.stack([made(x), made(np.transpose([x, x]))[:, 1]])


def drawn(**inputs):
    figure = fl.draw("planar_4r", **{name: REST[name] for name in ("a2", "a3", "a4")}, **inputs)
    return [np.asarray(line.get_xydata()) for line in figure.axes[0].lines]


def searched(bounds):
    space = fl.grid(a1=[0.4, 0.5], **REST)
    return fl.search("planar_4r", space, minimise="omega4_max", bounds=bounds)


def ended(*words):
    """Return what a command prints, or raise what it refuses."""
    done = CliRunner().invoke(app, [str(word) for word in words], prog_name="fastlink")
    if done.exit_code == 2:
        raise fl.InputError.of([Problem(done.stderr.removeprefix("fastlink: ").strip())])
    assert done.exit_code == 0, done.output
    return done.output


def painted(folder, inputs):
    words = [f"{name}={value}" for name, value in {**inputs, "a2": 1.1, "a3": 0.8, "a4": 1.0}.items()]
    ended("draw", "planar_4r", *words, "--to", folder / "one.svg")
    text = (folder / "one.svg").read_text()
    return [line for line in text.splitlines() if line.lstrip().startswith(("M ", "L "))]


#: The doors: functions of a folder and of inputs, among which is a1.
DOORS = {
    "sweep of one design": lambda folder, inputs: swept({**REST, **inputs}),
    "grid": lambda folder, inputs: swept(fl.grid(**REST, **inputs)),
    "an axis": lambda folder, inputs: swept(fl.grid(**REST, **several(inputs))),
    "table": lambda folder, inputs: swept(fl.table({**REST, **several(inputs)})),
    "frame": lambda folder, inputs: swept(pd.DataFrame({**REST, **several(inputs)})),
    "dataset": lambda folder, inputs: swept(xr.Dataset({**REST, **inputs})),
    "file": lambda folder, inputs: from_file(folder, several(inputs)),
    "evaluate": lambda folder, inputs: fl.evaluate("planar_4r", ["F21"], **REST, **inputs, theta1=1.0, links=BARS),
    "function": lambda folder, inputs: function(**inputs),
    "inputs of a function": lambda folder, inputs: function_of(inputs),
    "curve_length": lambda folder, inputs: fl.planar.curve_length(**CURVE, **inputs),
    "curve_length of a mapping": lambda folder, inputs: fl.planar.curve_length({**CURVE, **inputs}),
    "draw": lambda folder, inputs: drawn(**inputs),
    "draw by the command": painted,
    "tolerance": lambda folder, inputs: fl.tolerance(swept({**REST, "a1": 0.4}), ["omega4_max"], **inputs),
    "bounds of a search": lambda folder, inputs: searched(several(inputs)),
    "study": lambda folder, inputs: ran(study(folder, inputs)),
    "tolerances of a study": lambda folder, inputs: ran(
        study(folder, {"a1": 0.4}, "[tolerances]\n" + "".join(f"{of} = {value!r}\n" for of, value in inputs.items()))
    ),
}  # fmt: skip


def assert_same(found, expected):
    """Assert that two results have the same bits."""
    if isinstance(found, xr.Dataset):
        xr.testing.assert_equal(found, expected)
    elif isinstance(found, dict):
        assert found == expected
    else:
        for one, other in (
            zip(found, expected, strict=True) if isinstance(found, list) else [(found, expected)]
        ):
            assert_array_equal(one, other)


@pytest.mark.sample(6)
@pytest.mark.parametrize("door", DOORS)
def test_a_length_in_mm_has_the_bits_of_that_in_m(door, tmp_path):
    expected = DOORS[door](tmp_path, {"a1": 0.4})
    for name, value in (("a1_mm", 400.0), ("a1_cm", 40.0), ("a1_um", 400000.0), ("a1_m", 0.4)):
        assert_same(DOORS[door](tmp_path, {name: value}), expected)


def test_derivatives_are_per_unit_of_the_inputs():
    names = ["theta4_travel", "omega4_max"]
    asked = {"extrema": "sampled", **{name: REST[name] for name in ("a2", "a3", "a4")}}
    given = fl.function("planar_4r", ["a1_mm", "omega1_rpm"], names, positions=20, **asked)
    plain = fl.function("planar_4r", ["a1", "omega1"], names, theta1=20, **asked)
    found, expected = given.gradient([400.0, 60.0]), plain.gradient([0.4, 2 * math.pi])
    factors = [factor_of("mm", "m"), factor_of("rpm", "rad s-1")]
    assert_array_equal(
        found, np.transpose([scaled(of, one) for of, one in zip(expected.T, factors, strict=True)])
    )
    with refused("jitted", "make a function of a1 and omega1"):
        given.jitted  # noqa: B018


MISTAKES = {
    "another kind": ({"a1_kg": 0.4}, "a1_kg", "write a1, or such as a1_mm"),
    "degrees": ({"a1_deg": 0.4}, "a1_deg", "write a1"),
    "no unit": ({"a1_furlong": 0.4}, "a1_furlong", "a1"),
    "two": ({"a1": 0.4, "a1_mm": 400.0}, "a1_mm", "write one of them"),
    "two units": ({"a1_cm": 40.0, "a1_mm": 400.0}, "a1_cm", "write one of them"),
    "a text": ({"a1": "400 mm"}, "a1", "write a1_mm"),
}


@pytest.mark.sample(20)
@pytest.mark.parametrize("mistake", MISTAKES)
@pytest.mark.parametrize("door", DOORS)
def test_every_door_refuses_alike(door, mistake, tmp_path):
    inputs, key, remedy = MISTAKES[mistake]
    if (door, mistake) == ("inputs of a function", "a text"):
        return  # its values are cells of an array
    with pytest.raises(fl.InputError) as caught:
        DOORS[door](tmp_path, inputs)
    first, *follow = str(caught.value).splitlines()
    assert_refusal(fl.InputError(first), key, remedy)
    assert all("a1 is missing" in line for line in follow)


def test_samples_are_drawn_in_their_unit():
    ranges = {"a1_mm": (100.0, 500.0), "omega1_rpm": (60, 90), "a2": 1.1, "a3": 0.8, "a4": 1.0}
    for space in (fl.sobol(64, ranges, seed=1), fl.latin_hypercube(64, **ranges, seed=1)):
        found = swept(space)
        assert_array_equal(found.a1, [float(Fraction(value) / 1000) for value in space.columns["a1_mm"]])
        assert found.a1.attrs["comment"] == "given in mm"
        assert found.omega1.attrs["units"] == "rad s-1"


def test_positions_that_are_lengths_and_turns():
    hart = {"m": 1.0, "n": 1.4, "d": 2.5, "kappa": 0.6}
    names, values = ["phi"], np.array([0.1, 0.2])
    expected = sweep_both("hart", fl.grid(**hart), names, input="F_y", F_y=values)
    for positions in (
        {"F_y_mm": 1000 * values},
        {"F_y": xr.DataArray(100 * values, dims="k", attrs={"units": "cm"})},
    ):
        found = sweep_both("hart", fl.grid(**hart), names, input="F_y", **positions)
        xr.testing.assert_equal(found, expected)
    with refused("F_y_kg", "F_y_mm"):
        sweep_both("hart", fl.grid(**hart), names, input="F_y", F_y_kg=values)
    turned = sweep_4r({"a1": 0.4, **REST}, ["theta4"], theta1_turn=[0.25, 0.5])
    assert_array_equal(turned.theta1, [math.pi / 2, math.pi])
    assert turned.theta1.attrs["comment"] == "given in turn"


def test_models_of_links():
    bars = fl.round_bar(density_g_cm3=7.75, radius_mm=10)
    assert bars.values == BARS.values
    for wrong, key, remedy in (
        ({"radius_kg": 1.0}, "radius_kg", "radius_mm"),
        ({"radius": 1.0, "radius_mm": 1.0}, "radius_mm", "write one of them"),
        ({"radius_mm": -1.0}, "radius_mm", "at least 0"),
        ({"radiu_mm": 1.0}, "radiu_mm", "radius"),
    ):
        with refused(key, remedy):
            fl.round_bar(**wrong)


def test_a_text_with_no_unit_of_the_kind_is_no_number():
    with refused("a1", "write a number"):
        fl.grid(a1="40 furlongs", **REST)


AXES = fl.grid(a1=[0.3, 0.4, 0.5], a2=1.1, a3=[0.7, 0.8], a4=1.0, omega1=25.0, P_u=0.5, P_v=0.1)


@pytest.fixture(scope="module")
def maps():
    return fl.sweep("planar_4r", AXES, ["shaking_force_max", "P_y_max", "swing"], links=BARS, branch=1)


#: The doors of conditions: functions of a map and of a condition.
CONDITIONS = {
    "best": lambda maps, where: fl.best(maps, minimise="swing", where=where, top=9),
    "search": lambda maps, where: fl.search("planar_4r", AXES, minimise="swing", where=where, **SEARCHED),
    "plot of designs": lambda maps, where: np.concatenate(
        [one.get_offsets() for one in maps.fastlink.plot(["swing", "P_y_max"], where=where).axes[0].collections]
    ),
}  # fmt: skip
SEARCHED = {"top": 9, "refine": False, "progress": False, "links": BARS}
LIMITS = {
    "a1": ("a1_mm", 1000.0),
    "shaking_force_max": ("shaking_force_max_kN", 0.001),
    "P_y_max": ("P_y_max_cm", 100.0),
}


@pytest.mark.sample(3)
@pytest.mark.parametrize("name", LIMITS)
@pytest.mark.parametrize("door", CONDITIONS)
def test_conditions_in_other_units(maps, door, name):
    other, scale = LIMITS[name]
    limit = float(maps[name].median())
    found = CONDITIONS[door](maps, {other: (None, limit * scale * (1 + 1e-12))})
    assert_same(found, CONDITIONS[door](maps, {name: (None, limit * (1 + 1e-12))}))
    with refused(f"{name}_rpm", f"write {name}"):
        CONDITIONS[door](maps, {f"{name}_rpm": (None, 1.0)})
    with refused("where"):
        CONDITIONS[door](maps, {f"{name}_furlong": (None, 1.0)})


def test_parts_of_a_map_in_other_units(maps, tmp_path):
    with fl.open(fl.convert(maps, tmp_path / "part.h5", select={"a1_mm": "350:500", "a3_cm": 80})) as part:
        assert_array_equal(part.a1, [0.4, 0.5])
        assert part.a3 == 0.8
    lines = [
        fl.plot(maps, "swing", at=at).axes[0].lines[0].get_xydata() for at in ({"a3": 0.7}, {"a3_mm": 700})
    ]
    assert_array_equal(*lines)
    with refused("a3_kg", "a3_mm"):
        fl.plot(maps, "swing", at={"a3_kg": 0.7})
    fl.convert(maps, tmp_path / "map.h5")
    drawn = [
        fl.draw(tmp_path / "map.h5", at=at) for at in ({"a1": 0.3, "a3": 0.8}, {"a1_mm": 300, "a3_cm": 80})
    ]
    first, second = ([line.get_xydata() for line in figure.axes[0].lines] for figure in drawn)
    assert_same(first, second)
    shown = ended("best", tmp_path / "map.h5", "--minimise", "swing", "--where", "P_y_max_mm=:5000")
    heads, units = (line.split() for line in shown.splitlines()[1:3])
    assert dict(zip(heads[-1:], units[-1:], strict=True)) == {"P_y_max": "mm"}


#: Doors that take labelled values of a1.
LABELLED = {
    "sweep": lambda value: swept(fl.grid(a1=value, **REST)),
    "evaluate": lambda value: fl.evaluate("planar_4r", ["F21"], a1=value, **REST, theta1=1.0, links=BARS)["F21"].item(),
    "function": lambda value: function(a1=value),
    "curve_length": lambda value: fl.planar.curve_length({"a1": value, **CURVE}),
}  # fmt: skip


@pytest.mark.parametrize("door", LABELLED)
def test_labels_state_any_unit_of_the_kind(door):
    expected = LABELLED[door](xr.DataArray(0.4))
    for value, unit in ((400.0, "millimetre"), (0.4, "metre")):
        assert_same(LABELLED[door](xr.DataArray(value, attrs={"units": unit})), expected)
    for unit in ("kg", "furlong", "m s-1", "mm2"):
        with refused("a1", "convert it to m"):
            LABELLED[door](xr.DataArray(0.4, attrs={"units": unit}))


HEADS = ["a1 [mm]", "a1 (mm)", "a1[ mm ]", "a1_mm", "a1  [millimeters]"]


@pytest.mark.parametrize("head", HEADS)
def test_heads_of_columns_state_units(head, tmp_path):
    links = fl.round_bar(radius=0.01)
    expected = swept(fl.table({"a1": [0.4, 0.41], "density": 7850.0, **several(REST)}), links=links)
    frame = pd.DataFrame(
        {head: [400.0, 410.0], **{f"{name} [{unit}]": [one, 2 * one] for name, unit, one in COLUMNS}}
    )
    frame["density [g/cm3]"] = 7.85
    frame.to_csv(tmp_path / "designs.csv", index=False)
    frame.to_parquet(tmp_path / "designs.parquet")
    expected = expected.drop_vars("density")
    for source in (frame, tmp_path / "designs.csv", tmp_path / "designs.parquet"):
        xr.testing.assert_equal(swept(fl.table(source), links=links).drop_vars("density"), expected)


COLUMNS = [("a2", "m", 1.1), ("a3", "cm", 80.0), ("a4", "mm", 1000.0), ("omega1", "rad/s", 25.0)]
WRONG_HEADS = [
    ("a1 [kg]", "a1", "convert it to m"),
    ("a1 [furlong]", "a1", "convert it to m"),
    ("a2 [mm]", "a2", "each"),
    ("a2_mm", "a2_mm", "write one of them"),
    ("crank [mm]", "crank", "a1"),
]


@pytest.mark.parametrize(("head", "key", "remedy"), WRONG_HEADS)
def test_wrong_heads_of_columns(head, key, remedy):
    with refused(key, remedy):
        swept(fl.table({head: [400.0, 410.0], **several(REST)}))


def test_results_in_other_units(maps, monkeypatch):
    monkeypatch.setattr("fastlink.maps.units.require_package", lambda *_: pytest.fail("pint was asked"))
    given = swept(fl.grid(a1_mm=[400.0, 321.7], omega1_rpm=[60.0, 61.3], a2=1.1, a3=0.8, a4=1.0))
    shown = given.fastlink.convert("mm", "kN", omega1="rpm", omega4_max="deg/s")
    assert_array_equal(shown.a1, [400.0, 321.7])
    assert_allclose(shown.omega1, [60.0, 61.3], rtol=2.0**-52)  # there and back through pi
    assert shown.a2 == 1100.0
    assert shown.radius == 10.0
    assert_array_equal(shown.shaking_force_max, given.shaking_force_max / 1000)
    assert {name: shown[name].attrs["units"] for name in ("a1", "radius", "omega1")} == {
        "a1": "mm", "radius": "mm", "omega1": "rpm",
    }  # fmt: skip
    again = swept(shown.fastlink.designs.drop_vars(["density", "radius"]))
    xr.testing.assert_equal(again, given)
    assert set(fl.best(shown, minimise="omega4_max", where={"a1_cm": (35, None)}).a1.values) == {400.0}
    for wrong, key, remedy in (
        ({"of_all": ["mm", "in"]}, "units", "write one of them"),
        ({"of_all": ["kg m"]}, "units", "write units of"),
        ({"of_all": [3]}, "units", "write units of"),
        ({"a1": "rpm"}, "a1", "'mm'"),
    ):
        with refused(key, remedy):
            given.fastlink.convert(*wrong.pop("of_all", ()), **wrong)
    lazy = given.chunk().fastlink.convert("mm")
    assert lazy.shaking_force_max.chunks is not None
    xr.testing.assert_equal(lazy.compute(), given.fastlink.convert("mm"))
    assert given.astype("float32").shaking_force_max.fastlink.convert("kN").dtype == np.float32


STUDY = """
mechanism = "planar_4r"
quantities = ["omega4_max", "shaking_force_max"]
UNITS
[design]
a1 = 400
a2 = {linspace = [1000, 1400, 5]}
a3 = {values = [700.0, 800.0]}
a4 = 1000
omega1 = 60
[links]
model = "round_bar"
density = 7.75
radius = 10
[tolerances]
a2 = 0.1
a3 = "0.1 %"
[cycle]
theta1 = {values = [10, 20]}
extrema = "sampled"
branch = 1
[search]
minimise = "omega4_max"
where = {shaking_force_max = [0.0, 100.0], swing = [10, inf], a3 = "750:"}
bounds = {a2 = [900, 1500]}
"""
KINDS_IN = "[units]\nlength = 'mm'\ndensity = 'g/cm3'\nspeed = 'rpm'\nangle = 'deg'\nshaking_force_max = 'kN'"


#: What is called otherwise in the same study with units in its names.
RENAMED = {
    "\na1 =": "a1_mm", "\na2 = {": "a2_mm", "\na3 = {": "a3_mm", "\na4 =": "a4_mm", "\nomega1 =": "omega1_rpm",
    "\ndensity =": "density_g_cm3", "\nradius =": "radius_mm", "\na2 = 0": "a2_mm", "\ntheta1 =": "theta1_deg",
    " swing =": "swing_deg", "{shaking_force_max =": "shaking_force_max_kN", ' a3 = "7': "a3_mm", "{a2 =": "a2_mm",
}  # fmt: skip


def by_names():
    """Return the study with the units in its names."""
    text = STUDY.replace("UNITS", "")
    for old, name in RENAMED.items():
        assert text.count(old) == 1, old
        text = text.replace(old, f"{old[0]}{name}{old[old.index(' =', 1) :]}")
    return text


def test_units_of_a_study(tmp_path):
    read = []
    for text in (STUDY.replace("UNITS", KINDS_IN), by_names()):
        (tmp_path / "study.toml").write_text(text)
        read.append(ran(tmp_path / "study.toml"))
    xr.testing.assert_equal(*read)
    found = read[0]
    assert (found.a1, found.radius, found.omega1) == (0.4, 0.01, 2 * math.pi)
    (tmp_path / "study.toml").write_text(STUDY.split("[search]")[0].replace("UNITS", KINDS_IN))
    swept = ran(tmp_path / "study.toml")
    assert_array_equal(swept.a2, [1.0, 1.1, 1.2, 1.3, 1.4])
    assert (swept.a2_tolerance, swept.a3_relative_tolerance) == (0.0001, 0.001)


WRONG_UNITS = [
    ("length = 'mm'", "length = 'kg'", "units.length", "mm"),
    ("length = 'mm'", "length = 3", "units.length", "mm"),
    ("length = 'mm'", "lenght = 'mm'", "units.lenght", "length"),
    ("length = 'mm'", "a1 = 'rpm'", "units.a1", "mm"),
    ("[units]", "units = 'mm'\n[unit]", "units", "[units]"),
]


@pytest.mark.parametrize(("old", "new", "key", "remedy"), WRONG_UNITS)
def test_wrong_units_of_a_study(old, new, key, remedy, tmp_path):
    (tmp_path / "study.toml").write_text(STUDY.replace("UNITS", KINDS_IN).replace(old, new))
    with pytest.raises(fl.InputError) as caught:
        ran(tmp_path / "study.toml")
    (line,) = [line for line in str(caught.value).splitlines() if f": {key} " in line]
    assert remedy in line.partition("; ")[2]


def test_lengths_that_look_like_millimetres_get_a_remark():
    lengths = {"a1": 400.0, "a2": 1100.0, "a3": 800.0, "a4": 1000.0, "omega1": 25.0}
    doors = (
        lambda inputs, bars: swept(inputs, links=bars),
        lambda inputs, bars: swept(
            fl.sobol(4, {**inputs, "a2": (0.9 * inputs["a2"], inputs["a2"])}), links=bars
        ),
        lambda inputs, bars: fl.evaluate("planar_4r", ["F21"], **inputs, theta1=1.0, links=bars),
    )
    for door in doors:
        with pytest.warns(fl.InputWarning, match=r"a1 is up to 400 m.*write a1_mm") as caught:
            door(lengths, BARS)
        assert len(caught) == 1
        with pytest.warns(fl.InputWarning, match="a1_mm"):
            door({**lengths, "radius": 0.01}, fl.round_bar(density=7750.0))
        door(lengths, fl.round_bar(density=7750.0, radius=10.0))  # in mm alike, or a crane
        door({name: value / 1000 for name, value in lengths.items()}, BARS)


# == Angles in degrees, by names that end in _deg, at every door; and remarks on angles that look like degrees

FIXED = {name: value for name, value in TURNING.items() if name != "a4"}
WEIGHT = {"counterweight1_mass": 1.0, "counterweight1_radius": 0.1}
ANGLES = [0.0, 40.0, 80.0, 180.0]


def radians(degrees):
    return scaled(degrees, PI / 180)


def exact(degrees):
    with mp.workprec(300):
        return float(mp.mpf(degrees) * mp.pi / 180)


def test_degrees_of_inputs_are_rounded_once():
    """The sum of two doubles has pi/180 to 2^-106; the chance that a product is rounded otherwise is 2^-50 each."""
    rng = np.random.default_rng(1)
    values = [*range(-720, 721), *rng.uniform(-400, 400, 2000), 1e-300, 5e-324, 1e15, 1e300, 1.7e308, 0.1]
    assert_array_equal(radians(np.array(values, float)), [exact(float(value)) for value in values])
    assert radians(180.0) == math.pi
    assert math.copysign(1.0, radians(-0.0)) == -1.0
    assert_array_equal(radians([np.inf, np.nan]), [np.inf, np.nan])
    with mp.workprec(300):
        assert abs(mp.pi - mp.mpf(PI.numerator) / PI.denominator) < mp.mpf(2) ** -280
    # Of a grid; that all doors take units by name alike is tested with lengths.
    name = "counterweight1_direction"
    got, expected = (
        fl.sweep("planar_4r", fl.grid(**TURNING, **WEIGHT, **given), ["shaking_force_max"], links=BARS)
        for given in ({f"{name}_deg": ANGLES}, {name: [exact(value) for value in ANGLES]})
    )
    xr.testing.assert_equal(got, expected)
    assert got[name].attrs["comment"] == "given in degrees"


def test_input_positions_in_degrees():
    names = ["theta4", "omega4"]
    got = sweep_4r(fl.grid(**TURNING), names, theta1_deg=ANGLES)
    expected = sweep_4r(fl.grid(**TURNING), names, theta1=[exact(value) for value in ANGLES])
    xr.testing.assert_equal(got, expected)
    assert got.theta1.attrs["units"] == "rad"
    assert got.theta1.attrs["comment"] == "given in degrees"
    assert expected.theta1.attrs["comment"] == "direction of OA in the ground frame"
    lengths = fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0)
    one = sweep_4r(lengths, ["joint_angle_3"], input="joint_angle_2", joint_angle_2_deg=[100.0])
    assert one.joint_angle_2.item() == exact(100.0)


def test_labelled_and_unlabelled_configurations_in_degrees():
    for theta in (40.0, [[40.0], [80]], xr.DataArray([40, 80], dims="k", coords={"k": [1, 2]})):
        got = fl.evaluate("planar_4r", ["omega4"], **TURNING, theta1_deg=theta)["omega4"]
        expected = fl.evaluate("planar_4r", ["omega4"], **TURNING, theta1=radians_of(theta))
        assert_array_equal(got, expected["omega4"])
        assert type(got) is type(expected["omega4"])
    degrees = fl.evaluate("planar_4r", ["omega4"], **TURNING, theta1=labelled(60.0, "degree"))["omega4"]
    by_name = fl.evaluate("planar_4r", ["omega4"], **TURNING, theta1_deg=60.0)["omega4"]
    both = fl.evaluate("planar_4r", ["omega4"], **TURNING, theta1_deg=labelled(60.0, "degree"))["omega4"]
    assert float(degrees) == by_name == float(both)
    swept = fl.sweep("planar_4r", TURNING, ["omega4"], theta1=labelled([60.0], "deg"), branch=1)
    assert swept.omega4.item() == by_name


def radians_of(theta):
    return theta.copy(data=radians(theta.values)) if hasattr(theta, "dims") else radians(theta)


def labelled(values, units):
    values = np.asarray(values)
    return xr.DataArray(values, dims=["x"][: values.ndim], attrs={"units": units})


@pytest.mark.parametrize("name", ["theta1", "theta1_deg"])
def test_positions_in_another_unit_are_refused(name):
    remedy = "convert it to degrees" if name.endswith("_deg") else "convert it to rad"
    unit = "turn" if name.endswith("_deg") else "mm"
    for call in (
        lambda: sweep_4r(TURNING, ["omega4"], **{name: labelled([0.1, 0.2], unit)}),
        lambda: fl.evaluate("planar_4r", ["omega4"], **TURNING, **{name: labelled(0.1, unit)}),
        lambda: fl.function("planar_4r", ["a4"], ["omega4"], **FIXED, **{name: labelled([0.1], unit)}),
    ):
        with refused(name, remedy):
            call()


def test_functions_and_studies_in_degrees(tmp_path):
    function = fl.function("planar_4r", ["a4"], ["omega4"], theta1_deg=ANGLES, **FIXED)
    expected = fl.sweep("planar_4r", fl.grid(**TURNING), ["omega4"], theta1_deg=ANGLES, branch=1)
    assert_array_equal(function([1.0])[0], expected.omega4)
    path = tmp_path / "study.toml"
    design = "\n".join(f"{name} = {value}" for name, value in TURNING.items())
    for axis in (f"{{values = {ANGLES}}}", "{linspace = [0.0, 180.0, 4]}"):
        path.write_text(
            f'mechanism = "planar_4r"\nquantities = ["omega4"]\n[design]\n{design}\n'
            f"[cycle]\nbranch = 1\ntheta1_deg = {axis}\n"
        )
        with fl.run(path, to=tmp_path / "map.h5", overwrite=True, verify=0) as maps:
            assert maps.theta1.values[-1] == math.pi
            assert maps.theta1.attrs["comment"] == "given in degrees"
            assert maps.omega4.values[0] == expected.omega4.values[0]
    path.write_text(path.read_text().replace("{linspace = [0.0, 180.0, 4]}", "72"))
    with pytest.raises(fl.InputError, match=r"cycle\.theta1_deg"):
        fl.run(path, to=tmp_path / "map.h5", overwrite=True)


SWEEPS = {
    "both": ({"theta1": [0.5], "theta1_deg": [40.0]}, "theta1_deg", "write one of them"),
    "a number": ({"theta1_deg": 72}, "theta1_deg", "a flat array of degrees; theta1 may be a number"),
    "nan": ({"theta1_deg": [1.0, math.nan]}, "theta1_deg[1]", "finite angles in degrees"),
    "twice": ({"theta1_deg": [1.0, 1.0]}, "theta1_deg", "each position once"),
    "angles_deg": ({"angles_deg": [1.0]}, "angles_deg", "theta1_deg"),
}


@pytest.mark.parametrize(("options", "key", "remedy"), SWEEPS.values(), ids=SWEEPS)
def test_what_is_no_array_of_degrees(options, key, remedy):
    with refused(key, remedy):
        sweep_4r(fl.grid(**TURNING), ["omega4"], **options)


def test_what_is_no_position_in_degrees():
    with refused("theta1_deg", "write one of them"):
        fl.evaluate("planar_4r", ["omega4"], theta1=1.0, theta1_deg=40.0, **TURNING)
    with refused("theta1_deg", "write"):
        fl.evaluate("planar_4r", ["omega4"], theta1_deg="forty", **TURNING)


IN_DEGREES = [[40, 80, 120], [-90.0], 45]
IN_RADIANS = [[0, 1, 2, 3, 4, 5, 6], np.linspace(0, 2 * np.pi, 73), [12.566370614359172], 5.5, [np.nan]]


@pytest.mark.parametrize("values", IN_DEGREES)
def test_what_can_hardly_be_radians_gets_a_remark(values):
    assert looks_like_degrees(values)
    if np.ndim(values):
        with pytest.warns(fl.InputWarning, match="theta1_deg"):
            sweep_4r(fl.grid(**TURNING), ["omega4"], theta1=values)
        with pytest.warns(fl.InputWarning, match="theta1_deg"):
            sweep_4r(fl.grid(**TURNING), ["omega4"], angles=values)
    with pytest.warns(fl.InputWarning, match="theta1_deg"):
        fl.evaluate("planar_4r", ["omega4"], theta1=values, **TURNING)
    with pytest.warns(fl.InputWarning, match="counterweight1_direction_deg"):
        sweep_4r(fl.grid(counterweight1_direction=values, **WEIGHT, **TURNING), ["omega4_max"])


@pytest.mark.parametrize("values", IN_RADIANS)
def test_radians_get_none(values):
    assert not looks_like_degrees(values)
