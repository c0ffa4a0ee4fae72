"""Formula sheets: what each construct declares, and what is refused, with file, line, reason and remedy."""

from fractions import Fraction

import pytest
from tests.support.registry import every_input
from tests.support.toys import add, function_of, toy

from fastlink.errors import InputError
from fastlink.facts.catalogue import ELIMINATED
from fastlink.facts.evaluate import read_facts
from fastlink.facts.expression import GraphAsWritten
from fastlink.facts.fact import Input, System
from fastlink.facts.formula import NAMESPACE, CatalogueError
from fastlink.facts.sheet import SheetError, read_sheet
from fastlink.mechanisms import NAMES
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.precision.reference import CONTEXT

SHEET = """\
# A sheet of every construct.

let HALF = 2.0**-1
let TWICE_PI = PI * -HALF * (-4.0)  # of constants, those of formulas too

[inputs]
{a,b} [m] {a,b}_0: length of the {crank,coupler}
    also: {crank,coupler}, {l,r}1
    rule: positive
mode [1] k: which of both
    0: lower
    1: upper
    -1: neither
omega [rad s-1] omega: rate

[tables]
## Table 1
s [1] sin theta: Sine
    low: s_low
    = sin(theta)

[facts]
d_s_d_theta = cos(theta)

## Book, eq. (7); numbered.md#eq-7
step sum [m] a + b: Sum of all lengths, of which the meaning
        goes on
    = a + b
reach [m] r_{max}: Reach
    also: range, radius
    sign = HALF * omega
    high, low = two_sum(sum,
        sign)  # a remark
    = high + low
P_{x,y} [m] P_{x,y}: Point P, {x,y}
    = {a,b} * s {-,+} {b,a}

## Book, eq. (8)
step exact [m2] a^2: Square without loss
    low: exact_low
    = two_product(a, a)
reach_max [m] r: A limit with the name of an extreme
    hides: its reduction
    = 2.0 * reach
class_ [1] c: Class of the design
    0: short
    1: long
    = select(a < b, 0.0, 1.0)
also theta: crank angle, input angle

[variant loaded]
weight [N] W: weight
    default: -1.5
reach [m] r_{max}: Reach under load
    = reach + weight
[variant matrix]
## Book, eq. (9)
system rows: P_x, P_y
    scale = 2.0 * a
    | scale, 0.0, b
    | 1.0, -HALF, s
"""


@pytest.fixture(scope="module")
def made():
    return toy(SHEET)


def test_a_sheet_of_every_construct_is_declared_in_full(made):
    made.check()
    assert [*made.inputs] == ["a", "b", "mode", "omega"]
    assert [*made.public] == ["reach", "P_x", "P_y", "reach_max", "class_"]
    assert [name for name, fact in made.facts.items() if fact.internal] == [
        *("d_s_d_theta", "sum", "exact", "exact_low")
    ]
    assert made.facts["reach"].symbol == "r_{max}"
    assert made.facts["sum"].meaning == "Sum of all lengths, of which the meaning goes on"
    assert made.facts["reach"].formula.lines == (
        "sign = HALF * omega",
        "high, low = two_sum(sum, sign)",
        "return high + low",
    )
    sources = [made.facts[name].source for name in ("sum", "P_y", "exact", "class_")]
    assert sources == ["Book, eq. (7); numbered.md#eq-7"] * 2 + ["Book, eq. (8)"] * 2
    assert made.tables["s"].source == "Table 1"
    slope = made.facts["d_s_d_theta"]
    assert (slope.units, slope.source, slope.internal) == (
        "rad-1",
        "Table 1; docs/numerics.md#derivatives",
        True,
    )
    assert slope.formula.lines == ("return cos(theta)",)


def test_braces_stand_for_entries_part_by_part(made):
    assert made.inputs["a"] == Input("a", "m", "a_0", "length of the crank", "positive")
    assert made.inputs["b"] == Input("b", "m", "b_0", "length of the coupler", "positive")
    assert made.keywords["a"] == ("crank", "l1")
    assert made.keywords["b"] == ("coupler", "r1")
    x, y = made.facts["P_x"], made.facts["P_y"]
    assert (x.symbol, x.meaning, x.depends_on) == ("P_x", "Point P, x", ("a", "s", "b"))
    assert (y.symbol, y.meaning, y.depends_on) == ("P_y", "Point P, y", ("b", "s", "a"))
    assert x.formula.lines == ("return a * s - b",)
    assert y.formula.lines == ("return b * s + a",)


def test_formulas_are_read_with_what_they_depend_on_their_low_parts_and_constants(made):
    assert made.facts["reach"].depends_on == made.facts["reach"].formula.parameters == ("omega", "sum")
    assert read_facts(made, ["reach"], {"a": 1.0, "b": 2.0, "omega": 4.0})["reach"] == 5.0
    assert made.table_low_parts == {"s_low": "s"}
    assert made.facts["exact_low"] is made.facts["exact"]
    assert made.facts["exact"].names == ("exact", "exact_low")
    assert read_facts(made, ["exact_low"], {"a": 1.0 + 2.0**-52})["exact_low"] == 2.0**-104
    assert made.facts["reach"].formula.names["HALF"] == 0.5
    assert made.facts["reach"].formula.names["TWICE_PI"] == made.facts["reach"].formula.names["TWO_PI"]
    called = {value for value in NAMESPACE.values() if callable(value)}
    assert all(function.__module__.startswith("fastlink.numerics.") for function in called)


def test_labels_further_names_codes_and_rules(made):
    reach = made.facts["reach"]
    assert (reach.units, reach.symbol, reach.meaning, reach.internal) == ("m", "r_{max}", "Reach", False)
    assert made.keywords["reach"] == ("range", "radius")
    assert made.keywords["theta"] == ("crank angle", "input angle")
    assert made.facts["class_"].flags == {0: "short", 1: "long"}
    assert made.inputs["mode"] == Input(
        "mode", "1", "k", "which of both", "any", None, {0: "lower", 1: "upper", -1: "neither"}
    )
    assert made.hiding == {"reach_max"}


def test_variants_have_inputs_facts_and_systems(made):
    assert made.variant_inputs["loaded"]["weight"] == Input("weight", "N", "W", "weight", "any", -1.5)
    assert made.variants["loaded"]["reach"].meaning == "Reach under load"
    given = {"a": 1.0, "b": 2.0, "omega": 4.0, "weight": -1.5}
    assert read_facts(made, ["reach"], given, ("loaded",))["reach"] == 3.5
    system = made.variants["matrix"]["P_x"]
    assert isinstance(system, System)
    assert system is made.variants["matrix"]["P_y"]
    assert (system.name, system.unknowns, system.depends_on) == ("rows", ("P_x", "P_y"), ("a", "b", "s"))
    assert system.formula(3.0, 2.0, 0.25) == ((6.0, 0.0, 2.0), (1.0, -0.5, 0.25))
    assert made.solvers == (ELIMINATED, "matrix")


def test_a_sheet_may_be_of_several_mechanisms():
    both = toy(), toy()
    read_sheet(
        "[inputs]\na [m] a: a length\n[facts]\n## here\nb [m] b: Twice\n    = 2.0 * a", "toy.facts", *both
    )
    assert [read_facts(each, ["b"], {"a": 1.5})["b"] for each in both] == [3.0, 3.0]


#: What each refused sheet begins with; its own first line is the fifth.
BEFORE = "[inputs]\n{a,b} [m] x: a length\n[facts]\n## here\n"
HEAD = "c [m] x: Something\n"
#: Which the text of a formula, the notes of an input or the facts of a variant may follow.
OF, INPUT, OF_V = HEAD + "    = ", "[inputs]\nc [m] x: a length\n    ", "[variant v]\n"
#: Sheets, the line of what is wrong, what the reason says, and what the remedy says.
REFUSED = {
    # heads
    "no head": ("c [m] Something\n    = a", 5, "'c [m] Something' is no head", "write NAME [units] symbol"),
    "no head before": ("[facts]\n    = a", 6, "an indented line without an entry", "write its head"),
    "digit": ("1c [m] x: Something\n    = a", 5, "'1c [m] x: Something' is no head", "write NAME [units]"),
    "keyword": ("lambda [m] x: Something\n    = a", 5, "lambda is a function or", "such as lambda_"),
    "keyword as an input": ("[inputs]\nclass [m] x: a length", 6, "or a word of Python", "call it otherwise"),
    "low part": ("step c [m] x: Something\n    low: 2\n    = two_sum(a, b)", 5, "'2' is no name", "letters"),
    "no units": ("c [] x: Something\n    = a", 5, "fact c has no units", "write"),
    "no symbol": ("c [m] : Something\n    = a", 5, "fact c has no symbol", "write"),
    "no source": ("##\nc [m] x: Something\n    = a", 6, "fact c has no source", "write"),
    "no units of an input": ("[inputs]\nc [] x: Something", 6, "input c has no units", "write"),
    "twice": (OF + "a\n" + OF + "b", 7, "c is declared twice", "call one otherwise"),
    "an input twice": ("[inputs]\na [m] x: a length", 6, "a is declared twice", "call one otherwise"),
    "the position": ("theta [m] x: Something\n    = a", 5, "theta is declared twice", "call one otherwise"),
    "the branch": ("branch [m] x: Something\n    = a", 5, "branch is declared twice", "call one otherwise"),
    "a function": ("[inputs]\nsin [m] x: a length", 6, "sin is a function or constant", "call it otherwise"),
    "no derivative": ("d_c_d_a = 1.0", 5, "d_c_d_a is no derivative", "write NAME [units]"),
    "public low part": (
        HEAD + "    low: c_low\n    = two_sum(a, b)",
        5,
        "a low part, and is not internal",
        "step",
    ),
    "table": (
        "[tables]\nc [1] x: Something\n    = a",
        6,
        "table c must depend on theta alone",
        "make it a step",
    ),
    # sections, braces, inputs, constants
    "section": ("[quantities]", 5, "[quantities] is no section", "write [inputs], [tables], [facts]"),
    "section with an end": ("[variant two words]", 5, "is no section", "[variant NAME]"),
    "braces": (OF + "{a,b} * {a,b,c}", 5, "different numbers of parts", "as many parts in each"),
    "rule": (INPUT + "rule: negative", 6, "'negative' is no rule", "did you mean 'non-negative'"),
    "default against its rule": (
        INPUT + "rule: positive\n    default: -1.0",
        6,
        "-1.0 of c is not positive",
        "another",
    ),
    "rule of a fact": (
        HEAD + "    rule: positive\n    = a",
        5,
        "c has a formula, and a rule",
        "leave them out",
    ),
    "default": (INPUT + "default: much", 6, "'much' is no number", "2.0**-500"),
    "constant": ("let C = sin(1.0)", 5, "'sin(1.0)' is no number", "write such as 2.0**-500"),
    "constant of nothing": ("let C", 5, "'' is no number", "write such as"),
    "constant of inputs": ("let C = 2.0 * a", 5, "'2.0 * a' is no number", "write such as"),
    "constant of text": ("let C = '1'", 5, "is no number", "write such as"),
    "constant over nothing": ("let C = 1.0 / 0.0", 5, "'1.0 / 0.0' is no number", "write such as"),
    "constant beyond doubles": ("let C = 1e308 * 10.0", 5, "'1e308 * 10.0' is no number", "write such as"),
    "constant twice": ("let C = 1.0\nlet C = 2.0", 6, "C is a function or constant", "call it otherwise"),
    "code twice": (HEAD + "    0: a\n    0: b\n    = a", 5, "c says one thing twice", "write it once"),
    # formulas
    "no formula": (HEAD, 5, "the formula of c has no line", "end it in one line `= ...`"),
    "no return": (HEAD + "    d = a", 5, "the formula of c has 'd = a'", "end it in one line `= ...`"),
    "two returns": (OF + "a\n    = b", 5, "the formula of c has '= a'", "end it in one line"),
    "nothing": (HEAD + "    d = a\n    a + b\n    = d", 5, "the formula of c has 'a + b'", "end it in one"),
    "loop": (HEAD + "    for i in a: pass\n    = a", 5, "has 'for i in a: pass'", "end it in one line"),
    "target": (HEAD + "    a.d = b\n    = a", 5, "has Attribute", "write operators"),
    "keyword as a target": (HEAD + "    is = b\n    = a", 5, "is no expression of Python", "mend it"),
    "no variant": ("system s: a, b\n    | 1.0, 0.0, a", 5, "system s is in no variant", "[variant NAME]"),
    "an unknown": (OF_V + "system s: 2x\n    | 1.0, a", 6, "'2x' is no name", "write letters"),
    # what `check` finds
    "unfinished": (
        HEAD + "    d = a\n    = d +",
        5,
        "formula of c, line '= d +', is no expression",
        "mend it",
    ),
    "power": (OF + "a**2", 5, "line '= a ** 2', has Pow", "write powers"),
    "choice": (OF + "a if a < b else b", 5, "has IfExp", "select(condition, a, b)"),
    "attribute": (OF + "a.real", 5, "has Attribute", "write operators"),
    "lambda": (OF + "(lambda: a)", 5, "has Lambda", "write operators"),
    "and": (OF + "a < b and b < a", 5, "has BoolOp", "write operators"),
    "named argument": (OF + "sqrt(x=a)", 5, "has keyword", "write operators"),
    "three numbers": (OF + "select(a < b < a, a, b)", 5, "compares more than two numbers", "by &"),
    "text": (OF + "a + 'b'", 5, "has 'b', which is no number", "write numbers"),
    "truth": (OF + "select(True, a, b)", 5, "has True, which is no number", "write numbers"),
    "unknown function": (OF + "sqr(a)", 5, "calls sqr, which is no function", "did you mean 'sqrt'"),
    "called quantity": (OF + "a(2.0)", 5, "calls a, which is no function", "known: abs"),
    "called local": (
        HEAD + "    sin = a\n    = sin(a)",
        5,
        "calls sin, which is no function",
        "did you mean",
    ),
    "function": (OF + "2.0 * sqrt", 5, "has the function sqrt without arguments", "write sqrt(...)"),
    "of a table": ("[tables]\nc [1] x: Something\n    = sin(theta", 6, "is no expression", "mend it"),
    "of a variant": (OF_V + "a [m] x: Something\n    = b**2", 6, "has Pow", "write powers"),
    "a row": (OF_V + "system s: a, b\n    | 1.0, 0.0, a", 6, "2 unknowns has rows of 3", "2 rows of 3"),
    "a row without a right-hand side": (
        OF_V + "system s: a, b\n    | 1.0, 0.0, a\n    | b, 1.0",
        6,
        "2 unknowns has rows of 3, 2 numbers",
        "the right-hand side last",
    ),
    "unknown name": (
        OF + "a + z",
        5,
        "c depends on z, which is not declared",
        "declare it, or mend the name",
    ),
    "itself": (OF + "a + c", 5, "circular: c -> c", "let one of them depend on inputs"),
    "circle": (OF + "d\nd [m] x: Something\n    = c", 5, "circular: c -> d -> c", "let one"),
    "variant of nothing": (
        OF_V + "c [m] x: Something\n    = a",
        6,
        "v gives c, which is not",
        "make it a step",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_no_sheet_is_refused(case):
    text, line, reason, remedy = REFUSED[case]
    with pytest.raises(SheetError) as told:
        add(toy(), BEFORE + text).check()
    error = told.value
    assert error.place == f"toy.facts, line {line}"
    assert reason in error.what
    assert remedy in error.remedy
    assert str(error) == f"{error.place}: {error.what}; {error.remedy}"
    assert "\n" not in str(error)


def test_what_check_finds_is_found_by_its_first_use_too_and_unknown_names_are_the_user_s():
    made = add(toy(), f"{BEFORE}{HEAD}    = a if a < b else b\ne [m] x: Something\n    = a +")
    for name in ("c", "e"):
        with pytest.raises(SheetError, match=rf"toy.facts, line \d: formula of {name}, line"):
            made.resolve(f"d_{name}_d_a")
    with pytest.raises(InputError, match="'reech' is unknown to toy; did you mean 'reach'"):
        raise toy(SHEET).unknown_error("reech")


# == Declarations: what follows from them, what a catalogue rejects, and that all mechanisms are declared in full


@pytest.fixture
def made_catalogue():
    return toy("[inputs]\na [m] a: a length")


def declare(made, name, of, variant=""):
    section = f"[variant {variant}]" if variant else "[facts]"
    add(made, f"{section}\n## here\n{name} [m] x: Something\n    = {of}")


SQUARE = """\
## here
step b [m] x: Square of a, without loss
    low: b_low
    = two_product(a, a)
"""


def test_a_fact_with_a_low_part_determines_two_values(made_catalogue):
    add(made_catalogue, f"{SQUARE}c [m] x: Square of a, rounded twice\n    = (b - 1.0) + b_low")
    made_catalogue.check()
    a = 1.0 + 2.0**-40
    found = read_facts(made_catalogue, ["c"], {"a": a})
    assert Fraction(found["b"]) + Fraction(found["b_low"]) == Fraction(a) ** 2
    assert found["b_low"] != 0.0
    assert [step.names for step in made_catalogue.dependencies(["b_low", "b", "c"], ["a"])] == [
        ("b", "b_low"),
        ("c",),
    ]
    # the derivative is that of the high part, and the low part carries none
    assert read_facts(made_catalogue, ["d_c_d_a"], {"a": a})["d_c_d_a"] == 2.0 * a
    with pytest.raises(InputError, match="b_low does not depend on a"):
        made_catalogue.resolve("d_b_low_d_a")
    # to error bounds the low part is what the high one lost: their sum has no error
    bounds = made_catalogue.selection((), ()).error_bounds
    ((low, (times, high)),) = bounds.of(bounds.graph.name("b")).lost.items()
    assert (low.value, times, high.value) == ("b_low", -1.0, "b")
    # 50 digits hold the square, so that nothing is lost
    exact = read_facts(made_catalogue, ["b"], {"a": CONTEXT.mpf(a)})
    assert (exact["b"], exact["b_low"]) == (CONTEXT.mpf(a) ** 2, 0)


def test_names_are_declared_once_and_missing_ones_told_with_what_needs_them(made_catalogue):
    add(made_catalogue, SQUARE)
    with pytest.raises(CatalogueError, match="b_low is declared twice"):
        declare(made_catalogue, "b_low", "a")
    with pytest.raises(InputError, match=r"a is missing \(a length \[m\]\); b depends on it"):
        list(made_catalogue.dependencies(["b"], []))


def test_a_fact_has_not_the_name_of_a_variant(made_catalogue):
    """What is selected counts as given where facts are among what is given: such a fact had no derivative."""
    declare(made_catalogue, "load", "a")
    with pytest.raises(CatalogueError, match="load is the name of a fact and of a variant"):
        add(made_catalogue, "[variant load]\nweight [N] W: weight\n    default: 0.0")
    add(made_catalogue, "[variant brake]\nspeed [1] v: speed\n    default: 0.0")
    with pytest.raises(CatalogueError, match="brake is the name of a fact and of a variant"):
        declare(made_catalogue, "brake", "a")
    # but the fact that an input of that name replaces
    declare(made_catalogue, "c", "a")
    add(made_catalogue, "[variant c]\nc [1] c: c")


def test_inputs_that_determine_each_other(made_catalogue):
    add(made_catalogue, "[inputs]\nrho [1] rho: ratio")
    for other in ("s", "lambda_"):
        add(made_catalogue, f"[variant {other}]\n{other} [1] x: {other}")
        declare(made_catalogue, "rho", other, variant=other)
    declare(made_catalogue, "r", "rho")
    made_catalogue.check()
    assert made_catalogue.variants_selected_by(["s"]) == ("s",)
    assert made_catalogue.mutually_exclusive_inputs("rho") == ("s", "lambda_")
    assert made_catalogue.mutually_exclusive_inputs("s") == ("rho", "lambda_")
    with pytest.raises(InputError, match=r"rho is missing .*add it, or 's' instead, or 'lambda_' instead"):
        list(made_catalogue.dependencies(["r"], []))


@every_input
def test_every_mechanism_is_declared_in_full(mechanism, drive):
    """What it takes 10 ms a catalogue to find out is found out here, not at each start of a program."""
    find_catalogue(mechanism, drive).check()


@pytest.mark.parametrize(
    "text",
    [
        "if x > 0:\n        return x\n    return -x",
        "for _ in range(3):\n        x = x + 1\n    return x",
        "return x**2",
        "y = x",
    ],
)
def test_a_function_that_formulas_call_keeps_to_their_grammar(text):
    graph, function = GraphAsWritten(()), function_of("f(x)", text)
    with pytest.raises(CatalogueError, match=r"formula of .* (has .*grammar|must end in its one return)"):
        graph.read(function, [graph.name("x")])


@pytest.mark.parametrize("mechanism", NAMES)
def test_symbols_of_inputs_differ(mechanism):
    """A picture shows an input by its symbol alone."""
    declared = find_catalogue(mechanism)
    inputs = declared.known_inputs(declared.variant_inputs).values()
    symbols = [given.symbol for given in inputs]
    assert len(set(symbols)) == len(symbols)
