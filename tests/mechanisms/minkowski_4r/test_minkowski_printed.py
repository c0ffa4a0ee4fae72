"""Where the closed forms of section 3 hold, and what they leave undefined; their values are held by the loops."""

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal

import fastlink as fl
from fastlink.mechanisms import catalogue

FLAGS = {name: of.flags for name, of in catalogue("minkowski_4r").public.items() if of.flags}


def test_the_closed_form_of_the_remark_and_where_it_holds():
    rng, n = np.random.default_rng(31), 300
    inputs = dict(zip("abgh", rng.uniform(0.3, 3.0, (4, n)), strict=True))
    inputs |= {"theta": rng.uniform(-2.0, 2.0, n), "branch": rng.integers(1, 3, n)}
    inputs["h"][::3] += 2.0  # the Remark's form needs h > b
    names = ["psi", "psi_remark", "delta", "CB_orientation", "remark_status"]
    found = fl.evaluate("minkowski_4r", names, **inputs)
    a, b, g, h, theta = (inputs[name] for name in ("a", "b", "g", "h", "theta"))
    A, B = 2 * g * b - 2 * a * b * np.cosh(theta), 2 * a * b * np.sinh(theta)  # of Theorem 3.1
    C = h**2 - g**2 - b**2 - a**2 + 2 * a * g * np.cosh(theta)
    closes, above, forth = np.isfinite(found["psi"]), abs(B) < A, C >= 0
    meanings = np.vectorize(FLAGS["remark_status"].get)(found["remark_status"].astype(int))
    expected = np.select([~above, ~forth], ["A_not_above_the_size_of_B", "CB_past_pointing"], "holds")
    assert_array_equal(meanings[closes], expected[closes])
    assert_array_equal(np.isnan(found["delta"]), ~above)
    assert_array_equal(found["CB_orientation"][closes & above], np.where(forth, 1, -1)[closes & above])
    holds = closes & above & forth
    assert_array_equal(np.isnan(found["psi_remark"][closes]), ~holds[closes])
    # both angles are right to 12 roundings of what they were computed from, beside an end some 1e6 times that
    assert_allclose(found["psi_remark"][holds], found["psi"][holds], rtol=1e-8, atol=1e-8)
    assert holds.sum() > n // 20
    assert (closes & ~holds).sum() > n // 4


def test_what_a_lightlike_side_leaves_undefined():
    design = {"a": 1.0, "b": 1.0, "g": 4.0, "h": 1.0, "theta": 1.7}
    names = ["r_AX", "s_BX", "gamma", "lambda_AX", "mu_BX", "coupler_angles_status"]
    at = fl.evaluate("minkowski_4r", names, **design, x=[0.75, 1.5, 0.0, 0.25], y=[0.75, -0.5, 0.0, 0.125])
    told = [FLAGS["coupler_angles_status"][int(code)] for code in at["coupler_angles_status"]]
    assert told == ["AX_lightlike", "BX_lightlike", "AX_lightlike", "there"]
    assert_array_equal(np.isnan(at["gamma"]), [True, True, True, False])
    assert_array_equal(np.isnan(at["lambda_AX"]), [True, False, True, False])
    assert_array_equal(np.isnan(at["mu_BX"]), [False, True, False, False])
    assert_array_equal(at["r_AX"] == 0.0, [True, False, True, False])
