"""Searches find what a map of all designs has best, to the same bits, in any blocks, resumed or not."""

import math

import numpy as np
import pytest
from distributed import Client, LocalCluster
from numpy.testing import assert_array_equal
from tests.support.refusals import refused
from tests.support.sweeps import sweep_4r
from typer.testing import CliRunner

import fastlink as fl
from fastlink.app.cli import app
from fastlink.design import search
from fastlink.engine import cluster

RANGES = {"a1": (0.1, 0.5), "a2": (0.8, 1.3), "a3": (0.5, 1.2), "a4": 1.0, "omega1": 1.0}
WHERE = {"status": "rotates_fully", "transmission_angle_min": (0.5, None), "a1": (0.15, None)}
ONE = {"minimise": "omega4_max", "where": WHERE}
FRONT = {"minimise": "omega4_max", "maximise": ["swing", "a1"], "where": WHERE}
NAMES = ["omega4_max", "transmission_angle_min", "swing"]


def sample(n=3000):
    return fl.sobol(n, RANGES, seed=2)


GRID = fl.grid(
    a1=np.linspace(0.1, 0.5, 5), omega1=[1.0, 3.0, 7.0], a2=np.linspace(0.8, 1.3, 7), a3=0.8, a4=1.0
)
#: The angle that no design of the last part has.
HARD = {"minimise": "omega4_max", "where": {"a1": (None, 0.2), "swing_deg": (20, None)}, "refine": False}
SEARCHES = {
    "one objective": (sample(), {**ONE, "top": 2}),
    "front": (sample(1000), {**FRONT, "refine": False}),
    "front, refined": (sample(64), FRONT),
    "a target": (sample(400), {"minimise": "omega4_max", "where": {"swing_deg": 70}, "top": 2}),
    "an axis that scales": (GRID, {**HARD, "where": {**HARD["where"], "branch": (1, 2)}, "branch": [1, 2]}),
    "table": (
        fl.table({"a1": np.linspace(0.1, 0.5, 40), "a2": np.linspace(1.3, 0.8, 40), "part": [*map(str, range(40))]})
        .with_constants({"a3": 0.8, "a4": 1.0, "omega1": 1.0}),
        {**HARD, "top": 3, "refine": True},
    ),
    "positions": (
        sample(20),
        {"maximise": "F21", "where": {"theta1_deg": (30, 170)}, "top": 2, "theta1": np.linspace(0.5, 3.0, 24),
         "links": fl.round_bar(density=7750.0, radius=0.01), "branch": [1, 2]},
    ),
}  # fmt: skip


def check_rows(found, best):
    """The rows of a search are those of the best of a map."""
    assert found.sizes["design"] == best.sizes["design"]
    for name in (*best.data_vars, *(name for name in best.coords if name != "design")):
        assert_array_equal(found[name].values, best[name].values, err_msg=str(name))


@pytest.fixture(scope="module")
def maps():
    return fl.sweep("planar_4r", sample(), NAMES, branch=1)


@pytest.mark.sample(3)
@pytest.mark.parametrize("asked", [ONE, FRONT], ids=["one objective", "front"])
@pytest.mark.parametrize(("block", "threads"), [(None, 2), (60, 3), (1000, 1)])
def test_it_finds_the_best_of_a_map(maps, asked, block, threads):
    found = fl.search("planar_4r", sample(), NAMES, **asked, refine=False, block=block, threads=threads)
    best = fl.best(maps, **asked)
    check_rows(found, best)
    assert_array_equal(found.design, best.design)
    # of the counts each is of its condition alone
    attrs = found.attrs
    assert attrs["searched_designs"] == attrs["searched_rows"] == 3000
    assert attrs["searched_designs_rotates_fully"] == int((maps.status == 0).sum())
    assert attrs["excluded_by_status"] == int((maps.status != 0).sum())
    assert attrs["excluded_by_transmission_angle_min"] == int((~(maps.transmission_angle_min >= 0.5)).sum())
    assert attrs["excluded_by_a1"] == int((maps.a1 < 0.15).sum())
    assert f"of {attrs['searched_rows_considered']:,} rows" in attrs["selection"]
    assert attrs["searched_design_seed"] == 2


@pytest.mark.sample(2)
@pytest.mark.parametrize("of", SEARCHES)
def test_of_every_space_in_every_way(of):
    space, asked = SEARCHES[of]
    names = ["F21"] if of == "positions" else NAMES
    choice = {key: asked[key] for key in ("minimise", "maximise", "where", "top") if key in asked}
    of_sweep = {key: asked[key] for key in ("theta1", "links") if key in asked}
    whole = fl.sweep("planar_4r", space, names, **of_sweep, branch=asked.get("branch", 1))
    found = fl.search("planar_4r", space, names, **asked, block=4)
    check_rows(found, fl.best(whole, **choice, refine=asked.get("refine", True)))


def test_refined_designs_keep_to_bounds_and_inputs():
    narrow = fl.search("planar_4r", sample(), NAMES, **ONE, top=2, bounds={"a2": (0.9, 1.0)}, refine="a2")
    start = fl.search("planar_4r", sample(), NAMES, **ONE, top=2, refine=False)
    low, high = min(float(start.a2.min()), 0.9), max(float(start.a2.max()), 1.0)
    assert ((narrow.a2 >= low) & (narrow.a2 <= high)).all()
    assert set(narrow.a1.values) == set(start.a1.values)


class Stop(Exception):
    """Whatever ends a run."""


def stopped_after(monkeypatch, count):
    """End a search after some blocks, each of whose states is kept."""
    monkeypatch.setattr(search, "STEP_SECONDS", 0.0)
    write, calls = search.Unfinished.write, []

    def write_and_stop(self, kept, done):
        write(self, kept, done)
        calls.append(done)
        if len(calls) == count:
            raise Stop

    monkeypatch.setattr(search.Unfinished, "write", write_and_stop)
    return calls


@pytest.mark.parametrize("asked", [ONE, FRONT], ids=["one objective", "front"])
def test_a_killed_search_goes_on(tmp_path, monkeypatch, asked):
    path = tmp_path / "found.h5"
    options = {**asked, "refine": False, "block": 100, "threads": 2, "progress": False, "verify": 0}
    with monkeypatch.context() as patch:
        calls = stopped_after(patch, 3)
        with pytest.raises(Stop) as caught:
            fl.search("planar_4r", sample(), NAMES, **options, to=path)
    assert "run the same again" in " ".join(caught.value.__notes__)
    assert not path.exists()
    assert [one.name for one in tmp_path.iterdir()] == ["found.h5.search"]
    with refused("found.h5.search: is of a run that has not finished", "run the same again"):
        fl.open(tmp_path / "found.h5.search")
    done = sum(stop - start for start, stop in calls[-1])
    assert 0 < done < 3000
    with refused("another search", "restart"):
        fl.search("planar_4r", sample(), NAMES, **{**options, "top": None, "where": {}}, to=path)
    read = []
    take = search.Stream.read
    with monkeypatch.context() as patch:
        patch.setattr(search.Stream, "read", lambda *given: (read.append(given[2] - given[1]), take(*given)))
        with fl.search("planar_4r", sample(), NAMES, **options, to=path) as found:
            whole = fl.search("planar_4r", sample(), NAMES, **options)
            check_rows(found, whole)
            for name in ("excluded_by_status", "searched_rows_considered", "searched_designs_rotates_fully"):
                assert found.attrs[name] == whole.attrs[name]
    assert sum(read) <= 2 * 3000 - done
    assert [one.name for one in tmp_path.iterdir()] == ["found.h5"]


def test_a_finished_search_is_opened_as_it_is(tmp_path, monkeypatch):
    path = tmp_path / "found.h5"
    options = {**ONE, "top": 2, "to": path, "progress": False}
    with fl.search("planar_4r", sample(), NAMES, **options) as found:
        assert found.attrs["verified_designs"] == found.sizes["design"]
        assert fl.check(path)
        text = str(found.active[0].item())
    monkeypatch.setattr(search, "run", lambda *given, **options: pytest.fail("it was searched again"))
    with fl.search("planar_4r", sample(), NAMES, **options) as again:
        assert str(again.active[0].item()) == text
    with refused("search", "overwrite"):
        fl.search("planar_4r", sample(), NAMES, **{**options, "maximise": "swing", "top": None})


NOTHING = {"minimise": "omega4_max", "where": {"status": "invalid_input"}}


@pytest.mark.parametrize(
    ("options", "key", "remedy"),
    [
        ({"minimise": "omega_max"}, "minimise", "omega4_max"),
        ({"minimise": "omega4_max", "where": {"swin": (1, None)}}, "where", "swing"),
        ({}, "objective", "minimise"),
        ({"minimise": "omega4_max", "quantities": ["omega5"]}, "quantities", "omega4"),
        ({"minimise": "omega4_max", "where": np.array([True])}, "where", "ranges"),
        ({"minimise": "omega4_max", "bounds": {"a1": (2, 1)}}, "bounds", "lo < hi"),
        ({"minimise": "omega4_max", "bounds": {"a4": (1, 2)}}, "bounds", "a1, a2, a3"),
        ({"minimise": "omega4_max", "bounds": 3}, "bounds", "such as"),
        ({"minimise": "omega4_max", "refine": "a4"}, "refine", "a1, a2, a3"),
        ({"minimise": "omega4_max", "top": 0}, "top", "at least 1"),
        ({"minimise": "omega4_max", "part": "1/4000"}, "part", "at most 3,000"),
        (NOTHING, "3,000 rows", "widen"),
        (NOTHING | {"to": "a.h5"}, "3,000 fail status", "widen"),
    ],
)
def test_what_cannot_be_searched_is_refused(options, key, remedy, folder):
    with refused(key, remedy):
        fl.search("planar_4r", sample(), **options)
    assert not list(folder.iterdir())


WIPER = {"a1": (0.1, 0.5), "a2": (0.5, 1.5), "a3": (0.2, 1.2), "a4": 1.0}
ANGLES = {"transmission_angle_min_deg": (38, None), "transmission_angle_max_deg": ":142"}


@pytest.mark.sample(1)
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize(
    "asked",
    [{"maximise": "least_transmission_angle"}, {"minimise": "a1"}, {"minimise": ["a3", "time_ratio"]}],
)
def test_a_target_is_met_though_no_sample_meets_it(asked, seed):
    space = fl.sobol(20_000, seed=seed, **WIPER)
    found = fl.search("planar_4r", space, ["swing"], where={"swing_deg": 100, **ANGLES}, **asked)
    assert "none of 20,000 designs meets all conditions" in found.attrs["selection"]
    assert "missed" not in found.coords
    assert (abs(np.degrees(found.swing) - 100.0) <= 1e-9 * 100.0).all()
    assert (found.transmission_angle_min >= np.radians(38.0)).all()
    assert (found.transmission_angle_max <= np.radians(142.0)).all()
    assert found.active.values[0].startswith("swing = 1.74533 rad")


def test_a_map_is_refined_onto_targets():
    """Of an input, too: a3 is no value of the grid."""
    space = fl.grid(a1=np.linspace(0.2, 0.4, 5), a2=np.linspace(0.9, 1.1, 5), a3=[0.3, 0.5], a4=1.0)
    maps = fl.sweep("planar_4r", space, ["swing", "least_transmission_angle"], branch=1)
    where = {"swing_deg": 70, "a3": 0.42}
    with pytest.warns(fl.InputWarning, match="50 fail swing, 50 fail a3"):
        nearest = fl.best(maps, maximise="least_transmission_angle", where=where, top=1)
    assert all(f"{name} = " in nearest.missed.item() for name in ("swing", "a3"))
    found = fl.best(maps, maximise="least_transmission_angle", where=where, top=1, refine=True)
    assert found.a3.item() == 0.42
    assert abs(math.degrees(found.swing.item()) - 70.0) <= 1e-9 * 70.0
    assert found.active.item() == "swing = 1.22173 rad"


def test_where_no_design_does_the_answer_is_the_nearest_one():
    """By the sum of what it misses, each miss a share of its limit."""
    where = {"swing_deg": 100, **ANGLES, "transmission_angle_min_deg": "45:"}
    asked = {"where": where, "maximise": "a3", "top": 2}
    space, missed = fl.sobol(5_000, seed=1, **WIPER), []
    for refine in (False, True):
        with pytest.warns(
            fl.InputWarning, match="none of 5,000 designs meets all conditions: 5,000 fail swing, "
        ):
            found = fl.search("planar_4r", space, ["swing"], **asked, refine=refine)
        assert found.sizes["design"] == (1 if refine else 2)
        assert "swing = 1.74533 by " in found.missed.values[0]
        names = "swing", "transmission_angle_min", "transmission_angle_max"
        swing, low, high = (np.degrees(found[name].values.ravel()[0]) for name in names)
        missed.append(abs(swing - 100) / 100 + max(45 - low, 0.0) / 45 + max(high - 142, 0.0) / 142)
    assert missed[1] < missed[0]
    assert found.refinement.attrs["flag_meanings"].split()[found.refinement.item()] == "misses_a_condition"
    assert "transmission_angle_min >= 0.785398" in found.active.item()


def test_a_search_by_a_mean_of_positions_has_the_exact_extremes_of_a_sweep():
    space = fl.sobol(64, a1=0.4, a2=(1.1, 1.3), a3=(0.7, 0.9), a4=1.0, omega1=25.0)
    aims = {"minimise": "theta4_travel", "where": {"omega4_max": (None, 20)}}
    found = fl.search("planar_4r", space, **aims, positions=30, top=1)
    design = {name: found[name].item() for name in ("a1", "a2", "a3", "a4", "omega1")}
    assert found.omega4_max.item() == fl.sweep("planar_4r", design, ["omega4_max"]).omega4_max.item()
    travel = fl.sweep("planar_4r", design, ["theta4_travel"], positions=30)
    assert found.theta4_travel.item() == travel.theta4_travel.item()


STUDY = """
mechanism = "planar_4r"
quantities = ["omega4_min"]
[design]
a4 = 1.0
omega1 = 1.0
a3 = {linspace = [0.5, 1.2, 5]}
[search]
minimise = "omega4_max"
where = {status = "rotates_fully", transmission_angle_min_deg = [40, inf], swing_deg = [60, inf]}
samples = 2000
bounds = {a1 = [0.1, 0.5], a2 = [0.8, 1.3]}
top = 2
"""


def test_a_study_searches(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    where = {"status": "rotates_fully", "transmission_angle_min_deg": (40, None), "swing_deg": (60, None)}
    space = fl.sobol(2000, a3=(0.5, 1.2), a1=(0.1, 0.5), a2=(0.8, 1.3), a4=1.0, omega1=1.0)
    expected = fl.search("planar_4r", space, ["omega4_min"], minimise="omega4_max", where=where, top=2)
    with fl.run(path, to=tmp_path / "found.h5") as found:
        check_rows(found, expected)
        assert found.attrs["study"] == STUDY
        assert "2,000 designs" in found.fastlink.summary()
    needs = fl.explain(path).forecast
    assert needs.size == 2000
    assert needs.file < 1e5
    path.write_text(STUDY.replace('quantities = ["omega4_min"]', ""))  # nor has a search to name any
    with fl.run(path, to=tmp_path / "without.h5") as found:
        check_rows(found, expected.drop_vars("omega4_min"))
        assert "omega4_min" not in found
    path.write_text(STUDY.replace("60, inf", "170, inf") + "refine = false\n")
    for _ in range(2):  # searched, and found again
        done = CliRunner().invoke(app, ["run", str(path), "--to", str(tmp_path / "near.h5"), "--quiet"])
        assert done.exit_code == 1
        assert done.stderr.startswith("fastlink: where: none of 2,000 designs meets all conditions: ")


@pytest.mark.parametrize(
    ("old", "new", "key", "remedy"),
    [
        ('minimise = "omega4_max"', 'minimise = "omega_max"', "search.minimise", "omega4_max"),
        ("swing_deg = [60, inf]", "swin_deg = [60, inf]", "search.where", "swing"),
        ("[40, inf]", "[50, 40]", "search.where.transmission_angle_min_deg", "lesser end first"),
        ("[40, inf]", '"40:x"', "search.where.transmission_angle_min_deg", "inf"),
        ("top = 2", "top = 0", "search.top", "at least 1"),
        ("top = 2", "tops = 2", "search.tops", "top"),
        ("samples = 2000", "samples = 0", "search.samples", "at least 1"),
        ("samples = 2000", "seed = 3", "search.seed", "samples"),
        ("a1 = [0.1, 0.5]", "a1 = [0.5, 0.1]", "search.bounds.a1", "lo < hi"),
        ("a1 = [0.1, 0.5]", "a9 = [0.1, 0.5]", "a9", "did you mean"),
        ('"rotates_fully"', '"rotates"', "rotates", "rotates_fully"),
    ],
)
def test_what_is_wrong_in_a_search_of_a_study_is_said(folder, old, new, key, remedy):
    assert old in STUDY
    (folder / "study.toml").write_text(STUDY.replace(old, new))
    with pytest.raises(fl.InputError) as caught:
        fl.run("study.toml", to="found.h5")
    line = next(line for line in str(caught.value).splitlines() if key in line)
    assert "study.toml" in line
    assert remedy in line.partition("; ")[2]


def run(line):
    done = CliRunner().invoke(app, line.split())
    assert done.exit_code == 0, done.output
    return done.output


def test_parts_of_a_study_are_joined(folder):
    (folder / "study.toml").write_text(STUDY)
    with refused("layout", "leave it out"):
        fl.run("study.toml", layout="maps")
    for k in (1, 2):
        assert f"part {k}/2 of a search" in run(f"run study.toml --part {k}/2 --verify 2")
    said = run("join study.part-1-of-2.h5 study.part-2-of-2.h5 --to study.h5")
    assert "transmission_angle_min >= 0.698132 rad" in said  # the designs that were found
    assert "is up to date" in run("run study.toml --verify 2")
    with fl.open("study.h5") as joined, fl.run("study.toml", to="whole.h5", verify=2) as whole:
        check_same(joined, whole)


def check_same(found, whole):
    """The results of two searches are the same but for their making."""
    assert list(found.variables) == list(whole.variables)
    for name, one in whole.variables.items():
        assert_array_equal(found[name].values, one.values, err_msg=name)
        assert repr(found[name].attrs) == repr(one.attrs)
    of_making = {"history", "threads", "joined_parts", "core_time_s", "designs_per_second", "written_time_ns"}
    names = {name for name in (*found.attrs, *whole.attrs) if not name.endswith("time_s")} - of_making
    assert {n: repr(found.attrs.get(n)) for n in names} == {n: repr(whole.attrs.get(n)) for n in names}


def parts_of(folder, space, asked, count=3, **options):
    paths = [folder / f"found.part-{k}-of-{count}.h5" for k in range(1, count + 1)]
    for k, path in enumerate(paths, 1):
        own = {"progress": False, "part": (k, count), "to": path, **options}
        fl.search("planar_4r", space, ["swing"], **asked | own).close()
    return paths


@pytest.mark.sample(1)
@pytest.mark.parametrize("of", SEARCHES)
def test_joined_parts_are_the_result_of_one_search(of, tmp_path):
    space, asked = SEARCHES[of]
    path = tmp_path / "found.h5"
    paths = parts_of(tmp_path, space, asked, attrs={"by": "me"}, verify=3)
    options = {**asked, "attrs": {"by": "me"}, "verify": 3, "progress": False}
    with fl.join(paths[2:] + paths[:2], to=path) as joined:
        check_same(joined, fl.search("planar_4r", space, ["swing"], **options, to=tmp_path / "whole.h5"))
    assert fl.check(path)
    before = path.read_bytes()
    fl.search("planar_4r", space, ["swing"], **options, to=path).close()  # which is finished
    fl.join(tmp_path, to=path).close()
    assert path.read_bytes() == before


def test_a_part_is_no_whole_search(tmp_path):
    space, asked = SEARCHES["one objective"]
    first, second, *_ = paths = parts_of(tmp_path, space, asked, 3)
    for part in (fl.open(first), fl.best(first, minimise="omega4_max")):
        with part:
            assert "1/3: designs 0 to 999 of 3,000" in part.fastlink.summary()
    with fl.open(first) as part:
        assert "part 1/3 of a search, to be joined" in part.attrs["selection"]
        assert part.attrs["searched_designs"] == 1000
        assert part.sizes["design"] > 2  # of which the refinement chooses its starts
    with refused("part 1/3", "overwrite"):
        fl.search("planar_4r", space, ["swing"], **asked, to=first)
    with refused("part 2 of 3", "run it"):
        fl.join([paths[0], paths[2]], to=tmp_path / "found.h5")
    other = tmp_path / "other.h5"
    fl.search("planar_4r", space, ["swing"], **asked | {"top": 3}, part="3/3", to=other).close()
    with refused("do not belong together", "of one map"):
        fl.join([first, second, other], to=tmp_path / "found.h5")
    with refused("mechanism", "leave it out"):
        maps = sweep_4r(space, ["swing"], part=(1, 1), to=tmp_path / "maps.h5", verify=0)
        maps.close()
        fl.join(tmp_path / "maps.h5", to=tmp_path / "found.h5", mechanism=fl.extend("planar_4r"))


def test_parts_in_which_nothing_is_found(tmp_path):
    space, asked = SEARCHES["an axis that scales"]
    last = tmp_path / "last.h5"
    nothing = {**asked, "where": {"status": "invalid_input"}}
    with fl.search("planar_4r", space, **nothing, part="4/4", to=last) as part:
        assert "none is kept" in part.attrs["selection"]
    paths = parts_of(tmp_path, space, nothing, 2)
    with refused("none of 210 rows", "widen"):
        fl.join(paths, to=tmp_path / "found.h5")


def test_a_killed_part_goes_on(tmp_path, monkeypatch):
    options = {**ONE, "block": 100, "threads": 1, "progress": False}
    first, second = (tmp_path / f"found.part-{k}-of-2.h5" for k in (1, 2))
    fl.search("planar_4r", sample(), **options, part="1/2", to=first).close()
    with monkeypatch.context() as patch:
        stopped_after(patch, 3)
        with pytest.raises(Stop):
            fl.search("planar_4r", sample(), **options, part="2/2", to=second)
    with refused("part 2 of 2", "found.part-2-of-2.h5.search is of a run that has not finished"):
        fl.join(tmp_path, to=tmp_path / "found.h5")
    with fl.search("planar_4r", sample(), **options, part="2/2", to=second) as part:
        assert part.attrs["designs_of_earlier_runs"] == 300
        assert part.attrs["searched_designs"] == 1500
    with fl.join(tmp_path, to=tmp_path / "found.h5") as joined:
        check_same(joined, fl.search("planar_4r", sample(), **options, to=tmp_path / "whole.h5"))


def test_parts_by_quantities_of_ones_own_need_their_declarations(tmp_path, monkeypatch):
    own = fl.extend("planar_4r")

    @own.quantity(units="m", symbol="s")
    def bars(a1, a2):
        """Two bars."""
        return a1 + a2

    options = {"minimise": "bars", "where": {"status": "rotates_fully"}, "top": 1, "progress": False}
    paths = [tmp_path / f"found.part-{k}-of-2.h5" for k in (1, 2)]
    for k, path in enumerate(paths, 1):
        fl.search(own, sample(100), **options, part=(k, 2), to=path).close()
    with refused("mechanism", "mechanism="):
        fl.join(paths, to=tmp_path / "found.h5")
    with fl.join(paths, to=tmp_path / "found.h5", mechanism=own) as joined:
        check_same(joined, fl.search(own, sample(100), **options, to=tmp_path / "whole.h5"))
    with (
        refused("what it says of its search cannot be read", "run that part again"),
        monkeypatch.context() as patch,
    ):
        patch.setattr(search.json, "loads", lambda text: {})  # of a stranger
        fl.join(paths, to=tmp_path / "again.h5", mechanism=own)
    monkeypatch.setattr(search, "environment", lambda: b"other")
    with refused("by another version", "join with the version"):
        fl.join(paths, to=tmp_path / "again.h5", mechanism=own)


@pytest.fixture(scope="module")
def client():
    with (
        LocalCluster(processes=False, n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        yield client


@pytest.mark.sample(1)
@pytest.mark.parametrize("of", ["front", "an axis that scales"])
def test_the_workers_of_a_cluster_find_the_same(of, client, tmp_path, monkeypatch):
    monkeypatch.setattr(cluster, "GROWTH", 1)  # tasks of 64 designs
    space, asked = SEARCHES[of]
    options = {**asked, "verify": 0, "progress": False}
    on_cluster = {"client": client, "to": tmp_path / "found.h5"}
    with fl.search("planar_4r", space, ["swing"], **options, **on_cluster) as found:
        check_same(found, fl.search("planar_4r", space, ["swing"], **options, to=tmp_path / "whole.h5"))
        assert found.attrs["threads"] == 2
    (tmp_path / "parts").mkdir()
    paths = parts_of(tmp_path / "parts", space, options, 2, client=client)
    with fl.join(paths, to=tmp_path / "joined.h5") as joined:
        check_same(joined, fl.open(tmp_path / "whole.h5"))
    with refused("threads", "leave it out"):
        fl.search("planar_4r", space, **options, client=client, threads=2)
