"""Input positions by the input's own name: every mechanism, every input, at every door."""

import re

import numpy as np
import pytest
from tests.support.configurations import draw
from tests.support.four_bar import sweep_4r
from tests.support.refusals import refused
from tests.support.study_files import written

import fastlink as fl
from fastlink.mechanisms import NAMES, catalogue, inputs_of

DRIVES = [(mechanism, input) for mechanism in NAMES for input in inputs_of(mechanism)]
EVERY = pytest.mark.parametrize(("mechanism", "input"), DRIVES)
VALUES = [-0.4, 0.1, 0.3]


def request_of(mechanism, input):
    """Return a design that assembles and a quantity that changes over the cycle: nothing of it is written by hand."""
    result = catalogue(mechanism, input)
    columns = draw(result.inputs, np.random.default_rng(7), 64)
    for name, known in result.inputs.items():
        if known.choices:
            columns[name][:] = min(known.choices)
    for name in reversed(list(columns)):
        if any(other in columns for other in result.mutually_exclusive_inputs(name)):
            del columns[name]
    quantity = next(name for name, fact in result.public.items() if result.varies(name) and not fact.flags)
    values = fl.sweep(mechanism, fl.table(columns), [quantity], input=input, angles=VALUES, branch=(1, 2))[
        quantity
    ].values
    first = int(np.flatnonzero(np.isfinite(values.reshape(64, -1)).any(axis=1))[0])
    return {name: float(column[first]) for name, column in columns.items()}, quantity


def study_of(mechanism, input, design, quantity, positions):
    """Return the text of a study with positions by some name."""
    text = f'mechanism = "{mechanism}"\nquantities = ["{quantity}"]\n[design]\n'
    text += "".join(f"{name} = {value!r}\n" for name, value in design.items())
    return text + f'[cycle]\ninput = "{input}"\n{positions} = {{values = {VALUES}}}\n'


@pytest.mark.sample(3)
@EVERY
def test_every_door_takes_positions_by_the_name_of_the_input(folder, mechanism, input):
    design, quantity = request_of(mechanism, input)
    first, *others = design
    fixed = {name: design[name] for name in others}
    found = []
    for name in ("angles", input):
        at = {"input": input, name: VALUES}
        swept = fl.sweep(mechanism, fl.grid(**design), [quantity], **at)
        function = fl.function(mechanism, [first], [quantity], **fixed, **at)
        assert function.shape == (len(VALUES),)
        np.testing.assert_array_equal(swept[input], VALUES)
        assert swept.mechanism == mechanism  # a name that `fl.sweep` takes, whatever drives
        study = written(study_of(mechanism, input, design, quantity, name))
        with fl.run(study, to=f"{name}.h5", verify=0) as result:
            found += [swept[quantity].values, function([design[first]])[0], result[quantity].values]
    for values in found[1:]:
        np.testing.assert_array_equal(values, found[0])


@pytest.mark.sample(3)
@EVERY
def test_the_name_of_another_input_is_refused_with_the_right_one(folder, mechanism, input):
    design, quantity = request_of(mechanism, input)
    others = {other for _, other in DRIVES} - {input, *catalogue(mechanism, input).inputs}
    for wrong in [*sorted(others), f"{input}_"]:
        message = rf"{re.escape(wrong)}\b.*\b{re.escape(input)}\b"
        with pytest.raises(fl.InputError, match=message):
            fl.sweep(mechanism, fl.grid(**design), [quantity], input=input, **{wrong: VALUES}, branch=(1, 2))
        with pytest.raises(fl.InputError, match=message):
            fl.function(mechanism, list(design), [quantity], input=input, **{wrong: VALUES})
        with pytest.raises(fl.InputError, match=rf"cycle\.{message}"):
            fl.run(written(study_of(mechanism, input, design, quantity, wrong)))


@pytest.mark.parametrize("name", ["theta1", "theta1_deg", "angles"])
def test_a_range_of_more_positions_than_can_be_read_is_refused_at_once(name):
    design = {"a1": 0.4, "a2": 1.2, "a3": 0.8, "a4": 1.0}
    with refused(name, "at most"):
        sweep_4r(design, ["theta4"], **{name: range(10**12)})
