"""The doors: how each public function is called, and what each of its arguments is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from string import Template


@dataclass(frozen=True)
class Slot:
    """One argument of a door.

    Attributes
    ----------
    role : str
        What it is, see `values.ROLES`.
    base : str
        The source text of a good value.
    x : str
        What hostile values wrap, where it is not `base`.
    good : tuple of str
        Texts of the role that are good values here.
    """

    role: str
    base: str
    x: str = ""
    good: tuple[str, ...] = ()


@dataclass(frozen=True)
class Door:
    """One way to call fastlink.

    Attributes
    ----------
    name : str
        The public name.
    template : str
        The source text of a call, with ``$slot`` for each argument.
    slots : mapping of str to Slot
        Its arguments.
    check : str
        The independent check of its result, see `checks.CHECKS`; ``"refused"`` where every call is refused.
    """

    name: str
    template: str
    slots: Mapping[str, Slot]
    check: str = ""

    def text(self, given: Mapping[str, str]) -> str:
        """Return the source text of the call, with other arguments where they are given."""
        texts = {name: slot.base for name, slot in self.slots.items()}
        return Template(self.template).substitute(texts | dict(given))


def _slots(**slots: str | tuple[str, ...]) -> dict[str, Slot]:
    """Return slots from ``role base`` or (role, base, x, *good)."""
    made = {}
    for name, spec in slots.items():
        role, base, *rest = spec.split(" ", 1) if isinstance(spec, str) else spec
        made[name] = Slot(role, base, *rest[:1], good=tuple(rest[1:]))  # type: ignore[arg-type]
    return made


def _of(prefix: str, names: str) -> str:
    """Return keyword arguments, each with the slot of its name."""
    return ", ".join(f"{name}=${prefix}{name}" for name in names.split())


MORE = {"more": Slot("more", "", "")}
LENGTHS = _slots(a1="lengths 0.4", a2="lengths 1.2", a3="lengths 0.8", a4="lengths 1.0")
CURVE = LENGTHS | _slots(P_u="reals 0.6", P_v="reals 0.25")
MECHANISM = _slots(mechanism=("name", "'planar_4r'", "planar_4r", "'{x} '"))
OPTIONS = _slots(
    links=("thing", "None", "1.0", "None"),
    input=("choice", "None", "theta1"),
    solver=("name", "'eliminated'", "eliminated"),
    backend=("choice", "None", "llvm"),
)
EVALUATED = {name: OPTIONS[name] for name in ("links", "input", "solver")}
EXTREMA = _slots(extrema=("choice", "None", "refined"))
ANGLES = _slots(angles=("positions", "8", "0.5"))
SWEEP = "links=$links, input=$input, solver=$solver, backend=$backend, extrema=$extrema, angles=$angles, branch=$branch"
RUN = "threads=$threads, client=$client, block=$block, verify=$verify, to=$to, overwrite=$overwrite, "
RUN += "restart=$restart, part=$part, layout=$layout, progress=$progress, allow_invalid=$allow_invalid, attrs=$attrs"
RUNNING = _slots(
    threads=("count", "1", "2"),
    client=("thing", "None", "1.0", "None"),
    block=("count", "None", "2", "2**64", "10**30", "10**400"),
    verify=("count", "0", "1", "0"),
    to=("path", "None", "a.h5"),
    overwrite=("flag", "True"),
    restart=("flag", "False"),
    part=("choice", "None", "1/1", "None"),
    layout=("name", "'maps'", "maps"),
    progress=("flag", "False"),
    allow_invalid=("flag", "False"),
    attrs=("mapping", "None", "1", "xr.Dataset()"),
)
QUANTITIES = _slots(quantities=("names", "['theta4', 'omega4_max']", "theta4"))
BRANCH = _slots(branch=("branch", "(1, 2)"))
SPACE = _slots(space=("space", "SPACE", "SPACE"))
INPUTS = LENGTHS | _slots(omega1="reals 25.0")

AXES = {name: Slot("axis of lengths", slot.base) for name, slot in LENGTHS.items()} | _slots(
    omega1="axis 25.0"
)


def _sweep(space: str, slots: dict[str, Slot], check: str = "swept") -> Door:
    template = f"fl.sweep($mechanism, {space}, $quantities, {SWEEP}, {RUN}, $more)"
    everything = MECHANISM | slots | QUANTITIES | OPTIONS | EXTREMA | ANGLES | BRANCH | RUNNING | MORE
    return Door("sweep", template, everything, check)


def _evaluate(mechanism: str, quantities: str, input: str, lengths: str, reals: str, codes: str = "") -> Door:
    """Return the door of an evaluation of a mechanism; its inputs as ``name=value``."""
    pairs = [("lengths", one.split("=")) for one in lengths.split()]
    pairs += [("reals", one.split("=")) for one in reals.split()]
    pairs += [("code", one.split("=")) for one in codes.split()]
    slots = {name: Slot(role, base) for role, (name, base) in pairs}
    first = quantities.split("'")[1]
    slots |= _slots(branch=("modes", "1"), quantities=("names", quantities, first)) | MORE
    inputs = _of("", " ".join(name for _, (name, _) in pairs))
    template = f"fl.evaluate({mechanism!r}, $quantities, branch=$branch, input={input}, {inputs}, $more)"
    return Door("evaluate", template, slots, "evaluated")


def _curve(name: str, options: str = "", **slots: tuple[str, ...]) -> Door:
    template = f"fl.planar.{name}({_of('', 'a1 a2 a3 a4 P_u P_v')}{options}$more)"
    return Door(f"planar.{name}", template, CURVE | _slots(**slots) | MORE, name)


def _by_name(name: str, check: str = "", **slots: str | tuple[str, ...]) -> Door:
    """Return the door of a function all of whose arguments are given by name."""
    template = f"fl.{name}({_of('', ' '.join(slots))}, $more)"
    return Door(name, template, _slots(**slots) | MORE, check)


SAMPLES = {"branch": ("modes", "1"), "samples": ("count", "16", "16")}
SAMPLED = ", branch=$branch, samples=$samples, "
WITH_ERROR = {"branch": ("modes", "1"), "error": ("flag", "False")}

#: What is a dataset or a labelled array, though no map.
DATASETS = (
    "xr.Dataset()",
    "xr.DataArray('zz')",
    "xr.Dataset(attrs={'designs': 'x'})",
    "xr.Dataset({'status': 1})",
    "{x}.assign_attrs(designs='many').drop_vars('status', errors='ignore')",
)

#: A position of the four-bar MABN, and F of the focal mechanism in it: Figure 4 of Wunderlich.
FOUR_BAR = {"a": "lengths 5.0", "b": "lengths 5.0", "c": "lengths 2.0", "d": "lengths 4.0"}
POSITION: dict[str, str | tuple[str, ...]] = {**FOUR_BAR, "phi": "reals 1.369", "branch": ("modes", "2")}
F = {"x": "reals 2.0", "y": "reals 0.4495"}
BY = {"by": ("choice", "'rho'", "rho")}
HART = {"m": "lengths 4.0", "n": "lengths 8.0", "d": "lengths 6.0", "kappa": "reals 0.5"}
#: Vectors of the Minkowskian plane, and numbers beside them; among both NaN may stand.
SPACELIKE = {"z": "vectors [5.0, 3.0]", "w": "vectors [2.0, 1.0]"}
TRANSLATION = {"a": "gapped 1.0", "b": "gapped -3.0"}
SIDES = {"a": ("gapped lengths", "4.0"), "b": ("gapped lengths", "10.0")}
LINKAGE = {"a": "lengths 3.0", "b": "lengths 5.0", "g": "lengths 6.0", "h": "lengths 4.0"}
LINKAGE |= {"x": "reals 1.0", "y": "reals 0.5"}

NONE_AT_ALL = ("[]", "()", "np.array([])", "np.zeros((0, 3))")
ONE_DESIGN = "dict(a1=0.5, a2=1.0, a3=0.75, a4=2.0, P_u=0.0, P_v=2.0)"

NOTHING = ("[]", "()")

DOORS: list[Door] = [
    _sweep(f"fl.grid({_of('', 'a1 a2 a3 a4 omega1')})", AXES),
    _sweep("$space", SPACE),
    _sweep(
        "fl.grid(a1=0.4, a2=1.2, a3=0.8, a4=1.0, omega1=25.0, **$others)", _slots(others=("names_of", "{}"))
    ),
    Door(
        "grid",
        f"fl.grid({_of('', 'a1 a2 a3 a4 omega1')})",
        {name: Slot("axis", slot.base) for name, slot in INPUTS.items()},
        "space",
    ),
    Door(
        "sobol",
        "fl.sobol($n, seed=$seed, a1=$a1, a2=$a2)",
        _slots(
            n="count 8",
            seed=("count", "1", "1", "0", "2**64", "10**30", "10**400"),
            a1=("lo_hi", "(0.5, 1.5)"),
            a2=("lo_hi", "0.5"),
        ),
        "space",
    ),
    Door(
        "latin_hypercube",
        "fl.latin_hypercube($n, seed=$seed, a1=$a1, a2=$a2)",
        _slots(
            n="count 8",
            seed=("count", "1", "1", "0", "2**64", "10**30", "10**400"),
            a1=("lo_hi", "(0.5, 1.5)"),
            a2=("lo_hi", "0.5"),
        ),
        "space",
    ),
    Door(
        "round_bar",
        "fl.round_bar($density, $radius)",
        _slots(
            density=("positive", "7750.0", "7750.0", "None", "0.0", "-0.0", "0"),
            radius=("positive", "0.01", "0.01", "None", "0.0", "-0.0", "0"),
        ),
        "",
    ),
    Door(
        "evaluate",
        "fl.evaluate($mechanism, $quantities, branch=$branch, links=$links, input=$input, solver=$solver, "
        f"{_of('', 'a1 a2 a3 a4 omega1 theta1')}, $more)",
        MECHANISM
        | INPUTS
        | EVALUATED
        | _slots(
            branch=("modes", "1"), theta1="reals 0.75", quantities=("names", "['theta4', 'omega4']", "theta4")
        )
        | MORE,
        "evaluated",
    ),
    _evaluate(
        "planar_4r",
        "['transmission_angle', 'joint_omega_3']",
        "'joint_angle_2'",
        "a1=0.4 a2=1.2 a3=0.8 a4=1.0",
        "joint_omega_2=25.0 joint_angle_2=0.75",
    ),
    _evaluate("minkowski_4r", "['X_x', 'X_y']", "None", "a=3.0 b=5.0 g=6.0 h=4.0", "theta=1.25 x=1.0 y=0.5"),
    _evaluate(
        "focal", "['T_x', 'F_y']", "None", "a=5.0 b=5.0 c=2.0 d=4.0", "rho=1.0 phi=0.75", "completion=1"
    ),
    _evaluate("hart", "['F_y', 'A_x']", "None", "m=4.0 n=8.0 d=6.0", "phi=0.75 kappa=0.5"),
    _evaluate(
        "slider_crank",
        "['slider_position', 'omega2']",
        "None",
        "r=0.1 l=0.35",
        "theta=0.75 omega=25.0 e=0.02",
    ),
    Door(
        "function",
        f"fl.function($mechanism, $inputs, $outputs, {SWEEP}, a1=$a1, a3=0.8, a4=$a4, omega1=$omega1, $more)",
        MECHANISM
        | OPTIONS
        | EXTREMA
        | ANGLES
        | MORE
        | _slots(
            inputs=("names", "['a2']", "a2"),
            outputs=("names", "['omega4_max', 'transmission_angle_min']", "omega4_max"),
            branch=("branch", "1"),
            a1="length 0.4",
            a4="length 1.0",
            omega1="real 25.0",
        ),
        "function",
    ),
    Door("Function.__call__", "SPEED($x)", _slots(x=("matrix", "[1.2, 0.8]")), ""),
    Door("Function.gradient", "SPEED.gradient($x)", _slots(x=("matrix", "[1.2, 0.8]")), ""),
    Door(
        "quantities",
        "fl.quantities($mechanism, internal=$internal, input=$input)",
        MECHANISM | _slots(internal=("flag", "False"), input=("choice", "None", "theta1")),
        "",
    ),
    Door(
        "join",
        "fl.join($paths, to=$to, copy=$copy, overwrite=$overwrite, restart=$restart, progress=$progress)",
        _slots(
            paths=("path", "'part.h5'", "part.h5"), to=("path", "'joined.h5'", "a.h5"), copy=("flag", "False")
        )
        | {name: RUNNING[name] for name in ("overwrite", "restart", "progress")},
        "",
    ),
    Door("check", "fl.check($path)", _slots(path=("path", "'maps.h5'", "maps.h5")), ""),
    Door(
        "convert",
        "fl.convert($maps, $to, select=$select, quantities=$quantities, dtype=$dtype, compress=$compress, "
        "overwrite=$overwrite, progress=$progress)",
        _slots(
            maps=("dataset", "MAPS", "MAPS", DATASETS[-1]),
            to=("path", "'out.nc'", "a.nc"),
            select=("mapping", "None", "1", "xr.Dataset()"),
            quantities=("names", "['omega4_max']", "omega4_max", "None"),
            dtype=("choice", "None", "float32"),
            compress=("choice", "None", "gzip"),
            overwrite=("flag", "True"),
            progress=("flag", "False"),
        ),
        "",
    ),
    Door("summary", "fl.summary($maps)", _slots(maps=("dataset", "MAPS", "MAPS", DATASETS[-1])), ""),
    Door("finite", "fl.finite($maps)", _slots(maps=("dataset", "MAPS", "MAPS", *DATASETS)), ""),
    Door(
        "maps.fastlink.status_is",
        "MAPS.fastlink.status_is($meaning, of=$of)",
        _slots(
            meaning=("name", "'rotates_fully'", "rotates_fully", "'{x} '"), of=("name", "'status'", "status")
        ),
        "",
    ),
    Door("maps.fastlink.counts", "MAPS.fastlink.counts($of)", _slots(of=("name", "'status'", "status")), ""),
    Door(
        "maps.fastlink.convert",
        "MAPS.fastlink.convert(omega4_max=$units)",
        _slots(units=("name", "'rad s-1'", "rad s-1", "'{x} '")),
        "" if find_spec("pint") else "refused",
    ),
    Door(
        "maps.fastlink.top",
        "MAPS.fastlink.top($n, $by, largest=$largest, infinite=$infinite)",
        _slots(
            n=("count", "2", "2", "2**64", "10**30", "10**400"),
            by=("name", "'omega4_max'", "omega4_max"),
            largest=("flag", "True"),
            infinite=("flag", "False"),
        ),
        "",
    ),
    Door(
        "tolerance",
        "fl.tolerance($maps, $quantities, contributions=$contributions, to=$to, overwrite=$overwrite, "
        "mechanism=$mechanism, a1=$a1)",
        _slots(
            maps=("dataset", "MAPS", "MAPS", DATASETS[-1]),
            quantities=("names", "['omega4_max']", "omega4_max", "None"),
            contributions=("flag", "False"),
            to=("path", "None", "a.h5"),
            overwrite=("flag", "False"),
            mechanism=("thing", "None", "1.0", "None"),
            a1=("real", "1e-4", "1e-4", "0.0"),
        ),
        "",
    ),
    Door(
        "best",
        "fl.best($maps, minimise=$minimise, maximise=$maximise, where=$where, top=$top, infinite=$infinite, "
        "refine=$refine, mechanism=$mechanism)",
        _slots(
            maps=("dataset", "MAPS", "MAPS", DATASETS[-1]),
            minimise=("name", "'omega4_max'", "omega4_max"),
            maximise=("names", "[]", "a1"),
            where=("mapping", "None", "1", "xr.Dataset()", "{'omega4_max': (0, 1, 2)}", "{'omega4_max': 1}"),
            top=("count", "2", "2", "2**64", "10**30", "10**400"),
            infinite=("flag", "False"),
            refine=("flag", "False"),
            mechanism=("thing", "None", "1.0", "None"),
        ),
        "",
    ),
    Door(
        "search",
        "fl.search($mechanism, fl.sobol(64, a1=(0.2, 0.5), a2=1.2, a3=0.8, a4=1.0, omega1=25.0), $quantities, "
        f"minimise=$minimise, maximise=$maximise, where=$where, top=$top, infinite=$infinite, refine=$refine, "
        f"bounds=$bounds, {SWEEP}, threads=$threads, block=$block, verify=$verify, to=$to, overwrite=$overwrite, "
        "restart=$restart, progress=$progress, attrs=$attrs, $more)",
        MECHANISM
        | QUANTITIES
        | OPTIONS
        | EXTREMA
        | ANGLES
        | MORE
        | {name: RUNNING[name] for name in ("threads", "block", "verify", "to", "overwrite", "restart")}
        | {name: RUNNING[name] for name in ("progress", "attrs")}
        | _slots(
            branch=("branch", "1"),
            minimise=("name", "'omega4_max'", "omega4_max"),
            maximise=("names", "[]", "a1", *NOTHING),
            where=("mapping", "None", "1", "xr.Dataset()", "{'omega4_max': (0, 1, 2)}", "{'omega4_max': 1}"),
            top=("count", "2", "2", "2**64", "10**30", "10**400"),
            infinite=("flag", "False"),
            refine=("flag", "False"),
            bounds=("mapping", "None", "1", "xr.Dataset()"),
        ),
        "",
    ),
    Door(
        "draw",
        "fl.draw($mechanism, a1=$a1, a2=$a2, a3=$a3, a4=$a4, theta1=$theta1, branch=$branch, links=$links, "
        "input=$input, curves=$curves, show=$show, degrees=$degrees, to=$to, $more)",
        MECHANISM
        | {name: Slot("length", slot.base) for name, slot in LENGTHS.items()}
        | _slots(
            theta1="reals 0.75",
            branch=("branch", "1"),
            links=("thing", "None", "1.0", "None"),
            input=("choice", "None", "theta1"),
            curves=("names", "['theta4']", "theta4", *NOTHING),
            show=("names", "['circles']", "circles", *NOTHING, "None", "''", "'circles'"),
            degrees=("flag", "False"),
            to=("path", "None", "a.png"),
        )
        | MORE,
        "",
    ),
    Door(
        "draw",
        "fl.draw($maps, $design, at=$at, branch=$branch, strip=$strip, animate=$animate, frames=$frames, $more)",
        _slots(
            maps=("dataset", "MAPS", "MAPS", DATASETS[-1]),
            design=("count", "0", "1", "0"),
            at=("mapping", "None", "1", "xr.Dataset()"),
            branch=("branch", "1"),
            strip=("count", "None", "4", "None"),
            animate=("path", "None", "a.gif"),
            frames=("count", "2", "3", "2**64", "10**30", "10**400"),
        )
        | MORE,
        "",
    ),
    Door(
        "explore",
        "fl.explore($maps, to=$to, port=$port, browser=$browser).close()",
        _slots(
            maps=("dataset", "MAPS", "MAPS", DATASETS[-1]),
            to=("path", "None", "a.html"),
            port=("count", "0", "1"),
            browser=("flag", "False"),
        ),
        "",
    ),
    Door("extend", "fl.extend($mechanism, $more).text", MECHANISM | MORE, ""),
    Door(
        "Extension.input",
        "fl.extend('planar_4r').input($name, units=$units, default=$default, rule=$rule, $more)",
        _slots(
            name=("name", "'weight'", "weight", "'{x}'[:-1]", "'{x}_max_max'"),
            units=("name", "'N m'", "N m", "'{x}'[:-1]", "'{x} '"),
            default=("real", "0.5", "0.5", "None"),
            rule=("name", "'any'", "any"),
        )
        | MORE,
        "",
    ),
    Door(
        "Extension.quantity",
        "fl.extend('planar_4r').quantity(units='N')($function)",
        _slots(function=("thing", "len", "len")),
        "refused",
    ),
    Door("mechanisms", "fl.mechanisms($more)", dict(MORE), ""),
    Door("open", "fl.open($path)", _slots(path=("path", "'maps.h5'", "maps.h5")), ""),
    Door(
        "plot_map",
        "fl.plot_map($maps, $name, branch=$branch, at=$at, panels=$panels, lines=$lines, degrees=$degrees, to=$to)",
        _slots(
            maps=("dataset", "MAPS", "MAPS", DATASETS[-1]),
            name=("name", "'omega4_max'", "omega4_max"),
            branch=("branch", "1"),
            at=("mapping", "None", "1", "xr.Dataset()"),
            panels=("choice", "None", "a2"),
            lines=("choice", "None", "a2"),
            degrees=("flag", "False"),
            to=("path", "None", "a.png"),
        ),
        "",
    ),
    Door(
        "plot_designs",
        "fl.plot_designs($maps, $names, kind=$kind, where=$where, branch=$branch, degrees=$degrees, to=$to)",
        _slots(
            maps=("dataset", "MAPS", "MAPS", DATASETS[-1]),
            names=("names", "['omega4_max', 'a2']", "omega4_max"),
            kind=("choice", "None", "corner"),
            where=("mapping", "None", "1", "xr.Dataset()", "{'omega4_max': (0, 1, 2)}", "{'omega4_max': 1}"),
            branch=("branch", "1"),
            degrees=("flag", "False"),
            to=("path", "None", "a.png"),
        ),
        "",
    ),
    Door(
        "plot_front",
        "fl.plot_front($maps, minimise=$minimise, maximise=$maximise, branch=$branch, degrees=$degrees, to=$to)",
        _slots(
            maps=("dataset", "MAPS", "MAPS", DATASETS[-1]),
            minimise=("name", "'omega4_max'", "omega4_max"),
            maximise=("names", "['a2']", "a2"),
            branch=("branch", "1"),
            degrees=("flag", "False"),
            to=("path", "None", "a.png"),
        ),
        "",
    ),
    Door(
        "explain",
        "fl.explain($path)",
        _slots(path=("path", "'study.toml'", "study.toml", "'study.toml/a.h5'")),
        "",
    ),
    Door(
        "run_study",
        "fl.run_study($path, to=$to, threads=$threads, overwrite=$overwrite, restart=$restart, layout=$layout, "
        "client=$client, part=$part, progress=$progress, verify=$verify)",
        _slots(path=("path", "'study.toml'", "study.toml"))
        | {
            name: RUNNING[name]
            for name in ("threads", "client", "overwrite", "restart", "part", "layout", "progress", "verify")
        }
        | _slots(to=("path", "'out.h5'", "a.h5")),
        "",
    ),
    Door(
        "accuracy",
        "fl.accuracy($study, designs=$designs, outside=$outside, seed=$seed, to=$to, "
        "picture=$picture, overwrite=$overwrite, announce=$announce)",
        _slots(
            study=("path", "'no.toml'", "study.toml"),
            designs=("count", "2", "2"),
            outside=("flag", "False"),
            seed=("count", "0", "1", "0", "2**64", "10**30", "10**400"),
            to=("path", "None", "a.h5"),
            picture=("path", "None", "a.png"),
            overwrite=("flag", "True"),
            announce=("thing", "None", "1", "lambda: 1", "float"),
        ),
        "refused",
    ),
    Door(
        "accuracy_table",
        "fl.accuracy_table($measured)",
        _slots(measured=("dataset", "MEASURED", "MEASURED", DATASETS[-1])),
        "",
    ),
    _curve("sextic", ", "),
    _curve("curve_length", ", branch=$branch, error=$error, ", **WITH_ERROR),
    _curve("curve_area", ", branch=$branch, error=$error, ", **WITH_ERROR),
    _curve(
        "curve_straightness",
        ", theta1=$theta1, branch=$branch, samples=$samples, ",
        theta1=("range", "None", "1.0", "None"),
        **SAMPLES,
    ),
    _curve("inflections", SAMPLED, **SAMPLES),
    _curve("crunodes", ", tolerance=$tolerance, ", tolerance=("tolerance", "1e-9")),
    _curve("cusps", ", tolerance=$tolerance, ", tolerance=("tolerance", "1e-9")),
    _curve("crunode_count", ", "),
    _curve("cusp_count", ", "),
    Door(
        "planar.sextic",
        "fl.planar.sextic($design)",
        _slots(design=("mapping", ONE_DESIGN, "1")),
        "",
    ),
    Door(
        "planar.straightness",
        "fl.planar.straightness($x, $y)",
        _slots(x=("curve", "[0.0, 2.0, 4.0, 6.0]"), y=("curve", "[1.0, -1.0, -1.0, 1.0]")),
        "",
    ),
    Door(
        "planar.io_coefficients",
        f"fl.planar.io_coefficients({_of('', 'a1 a2 a3 a4')}, pair=$pair)",
        LENGTHS | _slots(pair=("choice", "'14'", "14")),
        "",
    ),
    Door(
        "planar.cognates",
        f"fl.planar.cognates({{**dict({_of('', 'a1 a2 a3 a4 P_u P_v')}), **$more}})",
        CURVE | _slots(more=("design", "{}")),
        "",
    ),
    Door(
        "planar.cognates",
        "fl.planar.cognates($design)",
        _slots(design=("mapping", ONE_DESIGN, "1")),
        "",
    ),
    Door(
        "planar.Cognate.configuration",
        "COGNATE.configuration($theta1, $theta2, $theta4)",
        _slots(theta1="gapped 1.0", theta2="gapped 2.0", theta4="gapped 2.5"),
        "",
    ),
    Door("planar.Cognate.to_ground", "COGNATE.to_ground($x, $y)", _slots(x="gapped 1.0", y="gapped 2.0"), ""),
    Door(
        "planar.force_balance",
        f"fl.planar.force_balance({{**dict({_of('', 'a1 a2 a3')}, a4=1.0), **$more}}, "
        "links=$links, radius1=$radius1, mass1=$mass1, radius3=$radius3, mass3=$mass3)",
        {name: slot for name, slot in LENGTHS.items() if name != "a4"}
        | _slots(
            more=("design", "{}", "{}", "{'a4': -1.0}"),  # a4 is not read
            links=("thing", "BARS", "1.0"),
            radius1=("lengths", "0.1", "0.1", "None"),
            mass1=("thing", "None", "1.0", "None"),
            radius3=("lengths", "0.2", "0.2", "None"),
            mass3=("thing", "None", "1.0", "None"),
        ),
        "",
    ),
    Door(
        "planar.flywheel_inertia",
        "fl.planar.flywheel_inertia($maps, $C_s)",
        _slots(maps=("dataset", "TORQUE", "TORQUE", DATASETS[-1]), C_s=("positive", "0.02")),
        "",
    ),
    Door(
        "planar.force_equations",
        f"fl.planar.force_equations({_of('', 'a1 a2 a3 a4 omega1 theta1')}, branch=$branch, links=BARS, $more)",
        INPUTS | _slots(theta1="reals 1.0", branch=("modes", "1")) | MORE,
        "",
    ),
    Door(
        "planar.bar_properties",
        f"fl.planar.bar_properties({_of('', 'a1 a2 a3')}, links=$links, $more)",
        {name: LENGTHS[name] for name in ("a1", "a2", "a3")}
        | _slots(links=("thing", "BARS", "1.0", "BARS"))
        | MORE,
        "",
    ),
    Door(
        "planar.rate_extrema",
        "fl.planar.rate_extrema($space, pair=$pair, threads=1)",
        _slots(
            space=("space", "fl.grid(a1=0.4, a2=[1.1, 1.2], a3=0.8, a4=1.0, joint_omega_1=25.0)", "SPACE"),
            pair=("name", "'14'", "14"),
        ),
        "",
    ),
    Door(
        "planar.force_hypothesis",
        "fl.planar.force_hypothesis($maps, $more)",
        _slots(maps=("dataset", "RATES", "RATES", DATASETS[-1])) | MORE,
        "",
    ),
    _by_name("focal.cubic", **POSITION),
    _by_name("focal.cubic_points", **POSITION, samples=("count", "4", "4")),
    _by_name("focal.from_point", "constructed", **POSITION, **F, **BY),
    _by_name("focal.best_point", "constructed", **POSITION, between=("range", "(0.1, 0.9)"), **BY),
    _by_name("focal.inscribed_conics", "touching", **POSITION, t="reals 0.75"),
    _by_name("focal.inscribed_conics", "touching", **POSITION, **F),
    _by_name("focal.involution", "paired", **POSITION, **F),
    Door("focal.Involution.partner", "RAYS.partner($direction)", _slots(direction="gapped 0.5"), ""),
    Door("focal.Involution.tangents", "RAYS.tangents($t)", _slots(t="gapped 0.75"), ""),
    _by_name(
        "focal.five_bar",
        "five bars",
        m="lengths 1.0",
        p="lengths 2.0",
        q="lengths 3.0",
        n="lengths 2.5",
        d="lengths 4.0",
        phi="reals 0.75",
        omega_angle="reals 1.5",
        branch=("modes", "1"),
    ),
    _by_name(
        "focal.from_five_bar",
        "of five bars",
        m="reals 0.84",
        n="reals 0.9",
        p="reals 1.9",
        q="reals 1.8",
        d="lengths 4.0",
    ),
    _by_name("focal.held_at_AB", "held", **FOUR_BAR, rho="reals 1.0", completion=("code", "1")),
    Door(
        "focal.held_at_AB",
        "fl.focal.held_at_AB($design)",
        _slots(design=("mapping", "dict(a=5.0, b=5.0, c=2.0, d=4.0, rho=1.0)", "1")),
        "",
    ),
    Door(
        "focal.straight_line",
        "fl.focal.straight_line($x, $y)",
        _slots(x=("curve", "[0.0, 2.0, 4.0, 6.0]"), y=("curve", "[1.0, -1.0, -1.0, 1.0]")),
        "",
    ),
    Door(
        "focal.T_deviation",
        "fl.focal.T_deviation($maps)",
        _slots(maps=("dataset", "PATH", "PATH", DATASETS[-1])),
        "",
    ),
    _by_name("minkowski.sextic", **LINKAGE),
    _by_name("minkowski.coupler_circles", "circles", **LINKAGE, X="reals 9.0", Y="reals 8.5"),
    *(
        _by_name(f"minkowski.{name}", "double numbers", **SPACELIKE)
        for name in ("multiply", "scalar_product")
    ),
    *(
        _by_name(f"minkowski.{name}", "double numbers", **SPACELIKE)
        for name in ("hyperbolic_angle", "triangle_excess")
    ),
    *(
        _by_name(f"minkowski.{name}", "double numbers", z=SPACELIKE["z"])
        for name in ("conjugate", "norm", "causal_type", "orientation", "rapidity")
    ),
    _by_name(
        "minkowski.polar",
        "double numbers",
        r=("gapped lengths", "4.0", "4.0", "0.0", "-0.0", "0"),
        phi="gapped 0.75",
    ),
    _by_name("minkowski.boost", "double numbers", phi="gapped 0.75"),
    _by_name("minkowski.motion", "double numbers", t="gapped 0.75", **TRANSLATION),
    _by_name("minkowski.moved", "double numbers", z=SPACELIKE["z"], t="gapped 0.75", **TRANSLATION),
    _by_name("minkowski.cosine_rule", "double numbers", **SIDES, angle="gapped 0.75"),
    _by_name("minkowski.cosine_rule_angle", "double numbers", **SIDES, c=("gapped lengths", "4.0")),
    _by_name(
        "minkowski.pure_triangle",
        "double numbers",
        A="vectors [0.0, 0.0]",
        B="vectors [3.0, 5.0]",
        C="vectors [0.0, 10.0]",
    ),
    _by_name(
        "minkowski.quadrilateral_excess",
        "double numbers",
        O="vectors [0.0, 0.0]",
        A="vectors [5.0, 3.0]",
        B="vectors [10.0, 0.0]",
        C="vectors [12.0, 0.0]",
    ),
    Door(
        "minkowski.linkage_table",
        "fl.minkowski.linkage_table($maps)",
        _slots(maps=("dataset", "LINKAGES", "LINKAGES", DATASETS[-1])),
        "",
    ),
    _by_name("hart.held_at_AB", "held", **HART),
    Door(
        "hart.held_at_AB",
        "fl.hart.held_at_AB($design)",
        _slots(design=("mapping", "dict(m=4.0, n=8.0, d=6.0, kappa=0.5)", "1")),
        "",
    ),
    Door(
        "hart.integer_designs",
        "fl.hart.integer_designs($max_size, movable=$movable)",
        _slots(max_size=("count", "8", "8"), movable=("flag", "False")),
        "",
    ),
    Door("DesignSpace.values", "SPACE.values($name)", _slots(name=("name", "'a2'", "a2")), ""),
    Door("DesignSpace.at", "SPACE.at($designs)", _slots(designs=("numbers of designs", "[0, 1]", "1")), ""),
    Door(
        "DesignSpace.some",
        "SPACE.some($count, $rng)",
        _slots(
            count=("count", "2", "2", "0", "2**64", "10**30", "10**400"), rng="thing np.random.default_rng(1)"
        ),
        "",
    ),
    Door(
        "DesignSpace.consecutive",
        "SPACE.consecutive($start, $stop)",
        _slots(start=("count", "1", "1", "0"), stop=("count", "2", "2")),
        "",
    ),
    Door(
        "DesignSpace.with_constants",
        "SPACE.with_constants($extra)",
        _slots(extra=("mapping", "{'omega2': 1.0}", "1", "xr.Dataset()", "{'a1': Sulky()}")),
        "space",
    ),
    Door(
        "DesignSpace.with_axis",
        "SPACE.with_axis($name, $values)",
        _slots(
            name=("thing", "'completion'", "1", "'text'", "'nan'", "np.str_('a')", "Name('a')"),
            values=("axis", "[1.0, 2.0]", "1.0"),
        ),
        "space",
    ),
    Door(
        "DesignSpace.fill",
        "filled(SPACE, $names, $start, $stop, $out)",
        _slots(
            names=("names", "['a2']", "a2", "['{x}', '{x}']", *NONE_AT_ALL),
            start=("count", "1", "1", "0"),
            stop="count 2",
            out="thing np.zeros((5, 4))",
        ),
        "",
    ),
]
