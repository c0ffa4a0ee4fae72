"""The doors: a good call of each public function; its keywords are arguments, whose roles follow from their names."""

import ast
from dataclasses import dataclass
from functools import cached_property
from importlib.util import find_spec

from tests.hostile.values import ROLES, texts_of

#: The role of an argument by its name, unless a door has another; see `values.ROLES`.
NAMED = {
    "name": "mechanism solver layout minimise meaning of by name units rule",
    "names": "quantities maximise inputs curves show names",
    "choice": "input backend extrema part dtype compress kind panels lines pair find",
    "flag": "overwrite restart progress allow_invalid infinite refine contributions degrees copy internal largest "
    "movable outside browser trust_code error measure",
    "count": "threads block verify top n seed designs strip frames port samples max_size start stop count",
    "mapping": "attrs select where at bounds design extra",
    "path": "to path paths picture animate study subject",
    "thing": "links client announce mass1 mass3 function out rng",
    "space": "space",
    "dataset": "maps",
    "branch": "branch",
    "positions": "angles",
    "lengths": "a1 a2 a3 a4 a b c d g h m p q r l radius1 radius3",
    "reals": "omega1 theta1 P_u P_v phi rho kappa x y X Y e theta omega t",
    "tolerance": "tolerance",
    "positive": "density radius C_s",
}
ROLE_OF = {name: role for role, names in NAMED.items() for name in names.split()}
#: What hostile values wrap where the argument of a good call is none, or is a name with another role.
WRAPPED = {
    **dict(links="1.0", client="1.0", mass1="1.0", mass3="1.0", announce="1", input="theta1", backend="llvm"),
    **dict(
        extrema="refined",
        part="1/1",
        dtype="float32",
        compress="gzip",
        kind="corner",
        panels="a2",
        lines="a2",
    ),
    **dict(
        block="2",
        strip="4",
        to="a.h5",
        picture="a.png",
        animate="a.gif",
        find="torque",
        measure="True",
        maximise="a1",
    ),
}
ANY_SIZE = "2**64   10**30   10**400"
#: Texts of a role that are good values of an argument.
GOOD = {
    **dict(
        block=ANY_SIZE,
        n=ANY_SIZE,
        top=ANY_SIZE,
        frames=ANY_SIZE,
        seed=f"0   {ANY_SIZE}",
        verify="0",
        port="0",
    ),
    **dict(attrs="xr.Dataset()", select="xr.Dataset()", at="xr.Dataset()", bounds="xr.Dataset()"),
    **dict(where="xr.Dataset()", mechanism="'{x} '", meaning="'{x} '"),
    "find": r"'refine'   '{x} '   'é' * 100_000   '\ud800'   '\x00'   ''",
}


@dataclass(frozen=True)
class Door:
    """One way to call fastlink."""

    #: The source text of a good call.
    text: str
    #: Roles of arguments that are other than those of their names; an empty one for what is left as it is.
    roles: dict[str, str]
    #: Texts of roles, as in `values`, that are good values here.
    good: dict[str, str]
    #: Whether the call as it stands is accepted, and whether unknown keywords are refused.
    opens: bool = True
    more: bool = True

    @property
    def name(self):
        """The public name."""
        return self.text.partition("(")[0].removeprefix("fl.")

    @cached_property
    def slots(self):
        """Where each argument stands in the text."""
        found = {
            node.arg: (node.value.col_offset, node.value.end_col_offset or 0)
            for node in ast.walk(ast.parse(self.text))
            if isinstance(node, ast.keyword) and node.arg and self.role(node.arg)
        }
        return found | ({"more": (len(self.text) - 1, len(self.text) - 1)} if self.more else {})

    def role(self, name):
        """Return the role of an argument."""
        return "more" if name == "more" else self.roles.get(name, ROLE_OF.get(name, ""))

    def base(self, name):
        """Return the text of an argument in the good call, which is ASCII."""
        return self.text[slice(*self.slots[name])]

    def values(self, name):
        """Return the hostile values of an argument."""
        base, good = self.base(name), texts_of(f"{GOOD.get(name, '')}   {self.good.get(name, '')}")
        x = base.strip("[]'") if "'" in base else base
        x = WRAPPED.get(name, x) if base in ("None", "[]", "[1.0, 2.0]") else x.partition("'")[0]
        keywords = {f"{one}=" for one in self.slots} if name == "more" else set()
        return [
            value.about(x)
            for value in ROLES[self.role(name)]
            if value.text not in (*good, base) and not value.text.startswith(tuple(keywords))
        ]

    def called(self, given):
        """Return the text of the call with other arguments."""
        text = self.text
        for name in sorted(given, key=lambda name: self.slots[name], reverse=True):
            start, stop = self.slots[name]
            comma = ", " if name == "more" and not text[:start].endswith("(") else ""
            text = text[:start] + comma + given[name] + text[stop:]
        return text


def _door(text, good=None, opens=True, more=True, **roles):
    return Door(text, roles, good or {}, opens, more)


def _roles(role, names):
    return dict.fromkeys(names.split(), role)


FOUR_BAR = "a1=0.4, a2=1.2, a3=0.8, a4=1.0"
CURVE = f"{FOUR_BAR}, P_u=0.6, P_v=0.25"
WANTED = "input=None, solver='eliminated', links=None"
POSITIONS = f"{WANTED}, backend=None, extrema=None, angles=8"
RUNNING = "threads=1, client=None, block=None, verify=0, to=None, overwrite=True, restart=False, part=None"
SWEEP = (
    f"{POSITIONS}, branch=(1, 2), {RUNNING}, progress=False, layout='maps', allow_invalid=False, attrs=None"
)
CHOSEN = "minimise='omega4_max', maximise=[], where=None, top=2, infinite=False, refine=False"
RANGE = "fl.sobol(64, {'a1': (0.2, 0.5), 'a2': 1.2, 'a3': 0.8, 'a4': 1.0, 'omega1': 25.0})"
SHOWN = "where=None, branch=1, degrees=False, to=None"
#: A position of the four-bar MABN, and F of the focal mechanism in it: Figure 4 of Wunderlich.
FOCAL = "a=5.0, b=5.0, c=2.0, d=4.0"
AT = f"{FOCAL}, phi=1.369, branch=2"
F = "x=2.0, y=0.4495"
LINKAGE = "a=3.0, b=5.0, g=6.0, h=4.0, x=1.0, y=0.5"
ONE_DESIGN = "{'a1': 0.5, 'a2': 1.0, 'a3': 0.75, 'a4': 2.0, 'P_u': 0.0, 'P_v': 2.0}"
AXES, ONE = _roles("axis", "a1 a2 a3 a4 omega1"), _roles("length", "a1 a2 a3 a4") | {"omega1": "real"}
NOTHING = "[]   ()   np.array([])   np.zeros((0, 3))   {}   range(0)   pd.Series(dtype=float)"
OBJECTIVES = {"maximise": NOTHING, "minimise": "['{x}']   {'a1': Sulky()}"}
MODES = {"branch": "modes"}
VECTORS = _roles("vectors", "z w O A B C")
GAPPED = _roles("gapped", "phi t a b angle")
SIDES = _roles("gapped lengths", "a b c") | {"angle": "gapped"}
ODD_NAMES = {"name": "'{x}'[:-1]   '{x}_max_max'", "units": "'{x}'[:-1]"}

DOORS = [
    _door(
        f"fl.sweep(mechanism='planar_4r', space=fl.grid({FOUR_BAR}, omega1=25.0), "
        f"quantities=['theta4', 'omega4_max'], {SWEEP})",
        **_roles("axis of lengths", "a1 a2 a3 a4"),
        omega1="axis",
    ),
    _door(
        f"fl.sweep('planar_4r', fl.grid({FOUR_BAR}, omega1=25.0, **dict(others={{}})['others']), ['omega4_max'])",
        **dict.fromkeys(("a1", "a2", "a3", "a4", "omega1"), ""),
        others="names of inputs",
        more=False,
    ),
    _door(f"fl.grid({FOUR_BAR}, omega1=25.0)", more=False, **AXES),
    *(
        _door(
            f"fl.{sample}(n=8, seed=1, a1=(0.5, 1.5), a2=0.5)",
            more=False,
            **_roles("range or number", "a1 a2"),
        )
        for sample in ("sobol", "latin_hypercube")
    ),
    _door(
        "fl.round_bar(density=7750.0, radius=0.01)",
        {name: "None   0.0   -0.0   0" for name in ("density", "radius")},
    ),
    _door(
        f"fl.evaluate(mechanism='planar_4r', quantities=['theta4', 'omega4'], branch=1, {WANTED}, "
        f"{FOUR_BAR}, omega1=25.0, theta1=0.75)",
        **MODES,
    ),
    _door(
        "fl.evaluate('planar_4r', quantities=['transmission_angle', 'joint_omega_3'], branch=1, "
        f"input='joint_angle_2', {FOUR_BAR}, joint_omega_2=25.0, joint_angle_2=0.75, allow_invalid=False)",
        **MODES,
        **_roles("reals", "joint_omega_2 joint_angle_2"),
    ),
    *(
        _door(f"fl.evaluate('{mechanism}', quantities=[{names}], branch=1, {inputs})", **MODES, **codes)
        for mechanism, names, inputs, codes in (
            ("minkowski_4r", "'X_x', 'X_y'", "a=3.0, b=5.0, g=6.0, h=4.0, theta=1.25, x=1.0, y=0.5", {}),
            ("focal", "'T_x', 'F_y'", f"{FOCAL}, rho=1.0, phi=0.75, completion=1", {"completion": "code"}),
            ("hart", "'F_y', 'A_x'", "m=4.0, n=8.0, d=6.0, phi=0.75, kappa=0.5", {"n": "lengths"}),
            ("slider_crank", "'slider_position'", "r=0.1, l=0.35, theta=0.75, omega=25.0, e=0.02", {}),
        )
    ),
    _door(
        "fl.function(mechanism='planar_4r', inputs=['a2'], quantities=['omega4_max', 'transmission_angle_min'], "
        f"{POSITIONS}, branch=1, a1=0.4, a3=0.8, a4=1.0, omega1=25.0)",
        **ONE,
    ),
    _door("SPEED(x=[1.2, 0.8])", x="matrix", more=False),
    _door("SPEED.gradient(x=[1.2, 0.8])", x="matrix", more=False),
    _door("fl.quantities(mechanism='planar_4r', internal=False, input=None, find=None)"),
    _door("fl.mechanisms()"),
    _door("fl.mechanism(file='nowhere.facts')", opens=False, more=False, file="path"),
    _door(
        "fl.join(paths='part.h5', to='joined.h5', copy=False, overwrite=True, restart=False, progress=False)"
    ),
    _door("fl.check(path='maps.h5')"),
    _door("fl.open(path='maps.h5')", more=False),
    _door(
        "fl.convert(maps=MAPS, to='out.nc', select=None, quantities=['omega4_max'], dtype=None, compress=None, "
        "overwrite=True, progress=False)",
        {"quantities": "None"},
    ),
    _door("MAPS.fastlink.status_is(dict(meaning='rotates_fully')['meaning'], of='status')"),
    _door("MAPS.fastlink.counts(of='status')"),
    _door(
        "MAPS.fastlink.convert(omega4_max='rad s-1')",
        {"omega4_max": "'{x} '"},
        opens=bool(find_spec("pint")),
        more=False,
        omega4_max="name",
    ),
    _door("MAPS.fastlink.top(n=2, by='omega4_max', largest=True, infinite=False)"),
    _door(
        "fl.tolerance(maps=MAPS, quantities=['omega4_max'], contributions=False, to=None, overwrite=False, "
        "progress=False, mechanism=None, a1=1e-4)",
        {"quantities": "None", "a1": "0.0"},
        mechanism="thing",
        a1="real",
    ),
    _door(f"fl.best(maps=MAPS, {CHOSEN}, mechanism=None)", OBJECTIVES, mechanism="thing", maximise="choice"),
    _door(
        f"fl.search(mechanism='planar_4r', space={RANGE}, quantities=['theta4', 'omega4_max'], {CHOSEN}, bounds=None, "
        f"{POSITIONS}, branch=1, {RUNNING}, progress=False, attrs=None)",
        OBJECTIVES | {"quantities": NOTHING},
        maximise="choice",
    ),
    _door(
        f"fl.draw(mechanism='planar_4r', {FOUR_BAR}, theta1=0.75, branch=1, links=None, input=None, "
        "curves=['theta4'], show=['circles'], degrees=False, to=None)",
        {"curves": NOTHING, "show": f"None   ''   'circles'   {NOTHING}"},
        **_roles("length", "a1 a2 a3 a4"),
    ),
    _door(
        "fl.draw(mechanism=MAPS, design=0, at=None, branch=1, strip=None, animate=None, frames=2)",
        mechanism="dataset",
        design="count",
    ),
    _door("fl.explore(maps=MAPS, to=None, port=0, browser=False)"),
    _door("fl.extend(mechanism='planar_4r').text", more=False),
    _door(
        "fl.extend('planar_4r').input(name='weight', units='N m', default=0.5, rule='any')",
        ODD_NAMES | {"default": "None"},
        default="real",
    ),
    _door("fl.extend('planar_4r').quantity(units='N')(function=len)", opens=False, units="", more=False),
    _door(
        "fl.plot(maps=MAPS, names='omega4_max', branch=1, at=None, panels=None, lines=None, degrees=False, to=None)"
    ),
    _door(f"fl.plot(maps=MAPS, names=['omega4_max', 'a2'], kind=None, {SHOWN})"),
    _door(f"fl.plot(maps=MAPS, minimise='omega4_max', maximise=['a2'], {SHOWN})", OBJECTIVES),
    _door(
        "fl.explain(subject='study.toml', measure=None, trust_code=False).title",
        {"subject": "'study.toml/a.h5'"},
        more=False,
    ),
    _door(
        "fl.run(path='study.toml', to='out.h5', threads=1, overwrite=True, progress=False, verify=0, "
        "restart=False, part=None, layout='maps', client=None, trust_code=False)",
        {"layout": "None"},
    ),
    _door(
        "fl.accuracy(study='no.toml', designs=2, outside=False, seed=0, to=None, picture=None, overwrite=True, "
        "announce=None)",
        {"announce": "lambda: 1   float"},
        opens=False,
    ),
    # planes
    *(
        _door(f"fl.planar.{name}({CURVE}{options})", **MODES)
        for name, options in (
            ("sextic", ""),
            ("curve_length", ", branch=1, error=False"),
            ("curve_area", ", branch=1, error=False"),
            ("inflections", ", branch=1, samples=16"),
            ("crunodes", ", tolerance=1e-9"),
            ("cusps", ", tolerance=1e-9"),
            ("crunode_count", ""),
            ("cusp_count", ""),
        )
    ),
    _door(
        f"fl.planar.curve_straightness({CURVE}, theta1=None, branch=1, samples=16)", **MODES, theta1="range"
    ),
    *(
        _door(f"fl.{package}({x})", **_roles("curve", "x y"))
        for package in ("planar.straightness", "focal.straight_line")
        for x in ("x=[0.0, 2.0, 4.0, 6.0], y=[1.0, -1.0, -1.0, 1.0]",)
    ),
    _door(f"fl.planar.io_coefficients({FOUR_BAR}, pair='14')"),
    *(_door(f"fl.planar.{name}(design={ONE_DESIGN})") for name in ("sextic", "cognates")),
    _door(
        f"fl.planar.cognates({{**dict({CURVE}), **dict(others={{}})['others']}})", others="design", more=False
    ),
    _door(
        "COGNATE.configuration(theta1=1.0, theta2=2.0, theta4=2.5)",
        more=False,
        **_roles("gapped", "theta1 theta2 theta4"),
    ),
    _door("COGNATE.to_ground(x=1.0, y=2.0)", more=False, **_roles("gapped", "x y")),
    _door(
        "fl.planar.force_balance({**dict(a1=0.4, a2=1.2, a3=0.8, a4=1.0), **dict(others={})['others']}, links=BARS, "
        "radius1=0.1, mass1=None, radius3=0.2, mass3=None)",
        {"others": "{'a4': -1.0}", "radius1": "None", "radius3": "None"},
        others="design",
        a4="",
    ),
    _door("fl.planar.flywheel_inertia(maps=TORQUE, C_s=0.02)"),
    _door(f"fl.planar.force_equations({FOUR_BAR}, omega1=25.0, theta1=1.0, branch=1, links=BARS)", **MODES),
    _door("fl.planar.bar_properties(a1=0.4, a2=1.2, a3=0.8, links=BARS)"),
    _door(
        "fl.planar.rate_extrema(space={'a1': 0.4, 'a2': [1.1, 1.2], 'a3': 0.8, 'a4': 1.0, 'joint_omega_1': 25.0}, "
        "pair='14', threads=1)",
        pair="name",
    ),
    _door("fl.planar.force_hypothesis(maps=RATES)"),
    _door(f"fl.focal.cubic({AT})", **MODES),
    _door(f"fl.focal.cubic_points({AT}, samples=4)", **MODES),
    _door(f"fl.focal.from_point({AT}, {F}, by='rho')", **MODES, by="choice"),
    _door(f"fl.focal.best_point({AT}, between=(0.1, 0.9), by='rho')", **MODES, by="choice", between="range"),
    _door(f"fl.focal.inscribed_conics({AT}, t=0.75)", **MODES),
    _door(f"fl.focal.inscribed_conics({AT}, {F})", **MODES),
    _door(f"fl.focal.involution({AT}, {F})", **MODES),
    _door("RAYS.partner(direction=0.5)", more=False, direction="gapped"),
    _door("RAYS.tangents(t=0.75)", more=False, t="gapped"),
    _door(
        "fl.focal.five_bar(m=1.0, p=2.0, q=3.0, n=2.5, d=4.0, phi=0.75, omega_angle=1.5, branch=1)",
        **MODES,
        omega_angle="reals",
        n="lengths",
    ),
    _door("fl.focal.from_five_bar(m=0.84, n=0.9, p=1.9, q=1.8, d=4.0)", **_roles("reals", "m n p q")),
    _door(f"fl.focal.held_at_AB({FOCAL}, rho=1.0, completion=1)", completion="code"),
    _door("fl.focal.held_at_AB(design={'a': 5.0, 'b': 5.0, 'c': 2.0, 'd': 4.0, 'rho': 1.0})"),
    _door("fl.focal.T_deviation(maps=PATH)"),
    _door(f"fl.minkowski.sextic({LINKAGE})"),
    _door(f"fl.minkowski.coupler_circles({LINKAGE}, X=9.0, Y=8.5)"),
    *(
        _door(f"fl.minkowski.{name}(z=[5.0, 3.0], w=[2.0, 1.0])", **VECTORS)
        for name in ("multiply", "scalar_product", "hyperbolic_angle", "triangle_excess")
    ),
    *(
        _door(f"fl.minkowski.{name}(z=[5.0, 3.0])", **VECTORS)
        for name in ("conjugate", "norm", "causal_type", "orientation", "rapidity")
    ),
    _door("fl.minkowski.polar(r=4.0, phi=0.75)", {"r": "0.0   -0.0   0"}, **GAPPED, r="gapped lengths"),
    _door("fl.minkowski.boost(phi=0.75)", **GAPPED),
    _door("fl.minkowski.motion(t=0.75, a=1.0, b=-3.0)", **GAPPED),
    _door("fl.minkowski.moved(z=[5.0, 3.0], t=0.75, a=1.0, b=-3.0)", **GAPPED, **VECTORS),
    _door("fl.minkowski.cosine_rule(a=4.0, b=10.0, angle=0.75)", **SIDES),
    _door("fl.minkowski.cosine_rule_angle(a=4.0, b=10.0, c=4.0)", **SIDES),
    _door("fl.minkowski.pure_triangle(A=[0.0, 0.0], B=[3.0, 5.0], C=[0.0, 10.0])", **VECTORS),
    _door(
        "fl.minkowski.quadrilateral_excess(O=[0.0, 0.0], A=[5.0, 3.0], B=[10.0, 0.0], C=[12.0, 0.0])",
        **VECTORS,
    ),
    _door("fl.minkowski.linkage_table(maps=LINKAGES)"),
    _door("fl.hart.held_at_AB(m=4.0, n=8.0, d=6.0, kappa=0.5)", n="lengths"),
    _door("fl.hart.held_at_AB(design={'m': 4.0, 'n': 8.0, 'd': 6.0, 'kappa': 0.5})"),
    _door("fl.hart.integer_designs(max_size=8, movable=False)"),
    # methods of design spaces
    _door("SPACE.values(name='a2')"),
    _door("SPACE.at(designs=[0, 1])", designs="numbers of designs"),
    _door("SPACE.some(count=2, rng=np.random.default_rng(1))", {"count": f"0   {ANY_SIZE}"}),
    _door("SPACE.consecutive(start=1, stop=2)", {"start": "0"}),
    _door("SPACE.with_constants(extra={'omega2': 1.0})", {"extra": "xr.Dataset()   {'a1': Sulky()}"}),
    _door(
        "SPACE.with_axis(name='completion', values=[1.0, 2.0])",
        {"name": "'text'   'nan'   np.str_('a')   Name('a')   '{x}'"},
        name="thing",
        values="axis",
    ),
    _door(
        "filled(SPACE, names=['a2'], start=1, stop=2, out=np.zeros((5, 4)))",
        {"names": f"['{{x}}', '{{x}}']   {NOTHING}", "start": "0"},
        more=False,
    ),
]
