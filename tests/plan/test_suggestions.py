"""Suggestions: what users write for quantities and inputs, and what they are told."""

import re
from difflib import SequenceMatcher, get_close_matches

import pytest
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r, sweep_both

import fastlink as fl
from fastlink.facts import find
from fastlink.facts.names import innermost
from fastlink.mechanisms import NAMES
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.query import parse_request, suggest_input, suggest_quantity

# Written down before the scorer was: textbook symbols, words of machine designers, other spellings, typing errors.
# Each phrase is of a mechanism; what is meant must be among the first three suggestions.

#: Phrases for quantities, by mechanism: `NAME: PHRASE | PHRASE` a line.
QUANTITIES = {
    "planar_4r": """
        transmission_angle: mu | μ | \\mu | transmissionAngle | pressure angle
        transmission_angle_min: mu_min | μmin | minimum transmission angle
        mechanical_advantage: mechanical advantage | force amplification
        P_speed: path length
        theta4_travel: theta4 dwell
        T41: torque | crank torque | motor torque | T_41 | T14
        T41_peak: peak torque
        T41_rms: rms(T41)
        shaking_force: shaking force | F_shaking
        F41: bearing force | force at O
        F32: reaction at B
        F41_x: F41x
        omega4: w4 | ω₄ | omeg4 | rocker speed | output angular velocity
        omega2: angular velocity of coupler | omega3
        alpha4: acceleration
        theta4: output angle | follower angle | psi
        P_y: coupler_point_y
        P_x: coupler curve
        P_vx: vPx
        B_x: position of B
        omega4_max: max_omega4
        omega4_peak: peak omega4
        omega4_max_error: error of the greatest omega4
        omega4_mean: omega4_avg
        theta1_at_omega4_max: theta1_at_max_omega4 | argmax omega4
        theta1_at_transmission_angle_min: crank angle of minimum transmission angle
        T41_extrema: all extrema of T41
        omega4_extrema_count: number of extrema of omega4
        d_omega4_d_a2: domega4_da2 | derivative of omega4 with respect to a2
        d_omega4_d_a2_max: d_omega4_da2_max
        omega4_error: omega4_err
        grashof_class: grashof | crank-rocker
        swing: oscillation angle
        time_ratio: quick return ratio
        input_power: power
        jerk4: jerk
        theta1_low: dead centre | limit angles
        status: assembles
        joint_angle_1: joint angle
        loop_residual: closure error
        T41_fluctuation: torque fluctuation
    """,
    "slider_crank": """
        omega2_max: omega4_max
        transmission_angle_min: mu_min
        slider_velocity: piston velocity
        slider_position: piston position | x
        slider_acceleration_max: piston acceleration max
        slider_acceleration: a
        side_force: side thrust
        theta2: connecting rod angle
        omega2: conrod angular velocity
        T41: crank torque
        outer_dead_centre: top dead center | TDC
        F32: wrist pin force
        slider_velocity_rms: slider velocity rms
        d_slider_position_d_r: dslider_position_dr
    """,
    "focal": """
        transmission_angle_F: pressure angle
        F_x: F position
        lambda_: lambda
        dpsi_dphi: dψ/dφ
        F_path_residual: straight line error
        sigma: crank angle
    """,
    "hart": """
        F_deviation: straight line deviation
        stroke: stroke length
        F_x: point F
        lambda_: lambda
        dF_y_dphi: velocity of F
    """,
    "minkowski_4r": """
        zeta: transmission angle
        X_x: coupler point
        theta_branching: branching point
        phi: coupler angle
    """,
}

#: Phrases for inputs, by mechanism.
INPUTS = {
    "planar_4r": """
        a1: A1 | l1 | length_crank
        a2: coupler length
        a3: output link | follower length
        a4: frame | fixed link
        omega1: w1 | rpm | input speed
        density: rho
        radius: bar_radius
        m1: mass_crank
        m2: mass coupler
        I2: J2
        I3: moment of inertia of the output link
        gravity_y: gravity
        G2_u: centre of mass of the coupler
        P_u: coupler point
        T_load: load torque
        alpha1: angular acceleration
        FP_x: external force
    """,
    "slider_crank": """
        r: crank radius | a1
        l: connecting rod length | L
        e: offset
        m3: piston mass
        F_load: gas force
    """,
    "hart": """
        kappa: k
        d: base length
    """,
    "focal": """
        d: ground
        lambda_: lambda
        c: coupler
        omega: angular velocity
    """,
    "minkowski_4r": """
        h: coupler
        g: ground
        tolerance: tol
    """,
}

#: Phrases for mechanisms.
MECHANISMS = """
        planar_4r: fourbar | four-bar linkage | crank_rocker | Planar_4R
        slider_crank: crank_slider | piston
        minkowski_4r: minkowski
        focal: burmester
        hart: six-bar | straight line
"""


def pairs(lines):
    """Return the phrases of a table with what they mean."""
    rows = [line.partition(": ") for line in map(str.strip, lines.splitlines()) if line]
    return [(phrase, name) for name, _, phrases in rows for phrase in phrases.split(" | ")]


# == Suggestions: what users write for quantities and inputs, and what they are told =========================

OF_QUANTITIES = [pair for mechanism in NAMES for pair in pairs(QUANTITIES[mechanism])]
DESIGN = {"a1": 0.4, "a2": 1.1, "a3": 0.8, "a4": 1.0, "omega1": 25.0}


@pytest.mark.parametrize(("table", "suggest"), [(QUANTITIES, suggest_quantity), (INPUTS, suggest_input)])
@pytest.mark.parametrize("mechanism", NAMES)
def test_what_a_phrase_means_is_suggested(mechanism, table, suggest):
    near = {pair: suggest(pair[0], find_catalogue(mechanism)) for pair in pairs(table[mechanism])}
    assert {pair: names for pair, names in near.items() if pair[1] not in names} == {}
    assert max(map(len, near.values())) <= 3


@pytest.mark.sample(2)
@pytest.mark.parametrize("mechanism", NAMES)
def test_every_suggestion_can_be_requested(mechanism):
    """Whatever phrase, of this mechanism or another: all that is suggested exists here."""
    catalogue = find_catalogue(mechanism)
    for phrase, _ in OF_QUANTITIES:
        for name in suggest_quantity(phrase, catalogue):
            assert parse_request(name, catalogue).name == name
        for name in suggest_quantity(phrase, catalogue, over_cycle=False):
            assert catalogue.is_quantity(name)


@pytest.mark.sample(2)
@pytest.mark.parametrize("mechanism", NAMES)
def test_a_name_finds_itself_in_any_spelling(mechanism):
    catalogue = find_catalogue(mechanism)
    for name in catalogue.public:
        for spelt in (name, name.upper(), name.replace("_", " "), name.replace("_", "-")):
            assert name in suggest_quantity(spelt, catalogue)


@pytest.mark.parametrize("mechanism", NAMES)
def test_keywords_are_of_names_that_exist(mechanism):
    catalogue = find_catalogue(mechanism)
    known = {*catalogue.public, *catalogue.variables}
    for name, phrases in catalogue.keywords.items():
        assert innermost(name, catalogue) in known
        assert all(phrases)
        assert len(set(phrases)) == len(phrases)


LONG = ["x" * 100_000, "max omega4 " * 9000, "d" * 50_000, "d d " * 5000, "1" * 5000]
ODD = ["\ud800", "a\0b", "", " ", "_d_", "²"]


@pytest.mark.sample(3)
@pytest.mark.parametrize("text", [*LONG, *ODD])
def test_any_text_is_answered_from_its_first_letters(text, monkeypatch):
    """A search of all letters of the longest text would take hours."""
    catalogue, listed = find_catalogue("planar_4r"), fl.quantities("planar_4r")
    compared = []

    def noted(word, *others):
        compared.append(len(word))
        return get_close_matches(word, *others)

    monkeypatch.setattr(find, "get_close_matches", noted)
    assert len(suggest_quantity(text, catalogue)) <= 3
    assert len(suggest_input(text, catalogue)) <= 3
    with pytest.raises(fl.InputError):
        listed[text]
    assert max(compared, default=0) <= find.LONGEST


@pytest.mark.parametrize("text", ["", " ", "_", "_mm", " _mm", "omega4_"])
def test_a_name_of_hardly_any_letters_is_unknown(text):
    with refused(repr(text), "fastlink quantities planar_4r" if text != "omega4_" else "'omega4'"):
        sweep_4r(fl.grid(), [text])
    for door in (lambda: fl.evaluate("planar_4r", [text]), lambda: fl.quantities("planar_4r")[text]):
        with pytest.raises(fl.InputError, match=re.escape(repr(text))):
            door()


def test_few_names_are_compared_letter_by_letter(monkeypatch):
    """The nine that are closest by difflib's quick bounds: to compare all took 80 ms in place of 4."""
    catalogue, compared = find_catalogue("planar_4r"), []
    names = len(catalogue.public)

    class Noted(SequenceMatcher):
        def __init__(self, *arguments):
            compared.append(arguments)
            super().__init__(*arguments)

    monkeypatch.setattr(find, "SequenceMatcher", Noted)
    assert suggest_quantity("minimum transmision angel", catalogue) == ["transmission_angle_min"]
    assert 0 < len(compared) <= 9 < names


@pytest.mark.parametrize(
    ("mechanism", "name", "remedy"),
    [
        ("slider_crank", "omega4_max", "did you mean 'omega2_max'"),
        ("planar_4r", "A1", "leave it out"),
        ("planar_4r", "xyzzy", "fastlink quantities planar_4r"),
        ("planar_4r", "d_omega3_d_a1", "'d_omega2_d_a1'"),
        ("planar_4r", "d_omega4_d_A1", "'a1'"),
    ],
)
def test_the_message_about_a_quantity(mechanism, name, remedy):
    with refused(repr(name), remedy):
        sweep_both(mechanism, fl.grid(), [name])


def test_mechanisms_keywords_and_quantities_of_other_mechanisms_are_suggested():
    for phrase, name in pairs(MECHANISMS):
        with refused(repr(phrase), f"did you mean {name!r}?"):
            fl.quantities(phrase)
    for name, remedy in {"crank": "'a1'", "solvr": "'solver'", "brnch": "'branch'"}.items():
        with refused(name, remedy):
            fl.evaluate("planar_4r", ["omega4"], **DESIGN, theta1=1.0, **{name: 1})
    with refused("known to focal and hart"):
        sweep_4r(fl.grid(**DESIGN), ["F_x"])


@pytest.mark.parametrize("mechanism", NAMES)
@pytest.mark.parametrize("line", ["", "quantities = 3\n", "quantities = []\n"])
def test_a_study_without_quantities_is_given_one_of_its_mechanism(mechanism, line, tmp_path):
    study = tmp_path / "study.toml"
    study.write_text(f'mechanism = "{mechanism}"\n{line}')
    with pytest.raises(fl.InputError) as caught:
        fl.run(study)
    (name,) = re.search(r'quantities.*\["(\w+)"\]', str(caught.value)).groups()
    assert parse_request(name, find_catalogue(mechanism)).name == name


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("mu", "'transmission_angle'"),
        ("omega4_max", "'omega4'"),
        ("peak omega4", "'omega4'"),
        ("A1", "leave it out"),
    ],
)
def test_evaluate_answers_in_the_same_words(name, remedy):
    with refused(repr(name), remedy):
        fl.evaluate("planar_4r", [name], **DESIGN, theta1=1.0)


@pytest.mark.parametrize("name", ["F32", "shaking_force", "T41_max"])
def test_missing_masses_name_the_links(name):
    with pytest.raises(fl.InputError) as caught:
        sweep_4r(fl.grid(**DESIGN), [name])
    (line,) = str(caught.value).splitlines()
    assert "links=fl.round_bar(density=..., radius=...)" in line
    assert all(mass in line for mass in ("m2", "m3", "G2_u"))


def test_masses_and_inputs_of_links_name_the_links():
    with refused("m1", "T41_max and shaking_force_max depend on them"):
        sweep_4r(fl.grid(**DESIGN), ["T41_max", "shaking_force_max"])
    with refused("m2", "links=fl.round_bar(density=..., radius=...)"):
        fl.evaluate("planar_4r", ["T41", "F32"], **DESIGN, theta1=1.0)
    for line in (
        lambda: sweep_4r(fl.grid(**DESIGN, density=1.0), ["omega4"]),
        lambda: fl.evaluate("planar_4r", ["omega4"], **DESIGN, density=1.0, theta1=1.0),
    ):
        with refused("density", "links=fl.round_bar(density=..., radius=...)"):
            line()


@pytest.mark.parametrize(
    ("given", "name"), [("theta4", "joint_angle_4"), ("thet1", "theta1"), ("joint2", "joint_angle_2")]
)
def test_the_joint_of_an_input_is_the_number_in_its_name(given, name):
    with refused(repr(given), repr(name)):
        sweep_4r(fl.grid(**DESIGN), ["theta4"], input=given)
