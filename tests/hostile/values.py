"""What may stand for an argument: source texts, each with what may come of it.

A text holds ``{x}`` where it wraps the value that the argument usually has.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

#: What may come of a value: it is refused; it is taken for the plain value; either of these.
REFUSED, TAKEN, EITHER = "refused", "taken", "either"


@dataclass(frozen=True)
class Value:
    """One text for an argument.

    Attributes
    ----------
    kind : str
        The kind of hostility, for the report.
    text : str
        The source text.
    verdict : str
        What may come of it.
    plain : str
        The text of the plain value that it means, where it may be taken.
    """

    kind: str
    text: str
    verdict: str = REFUSED
    plain: str = ""

    def about(self, x: str) -> Value:
        """Return the value where the argument usually is `x`."""
        return replace(self, text=self.text.replace("{x}", x), plain=self.plain.replace("{x}", x))


def _refused(kind: str, *texts: str) -> list[Value]:
    return [Value(kind, text) for text in texts]


def _meant(kind: str, verdict: str, *pairs: tuple[str, str]) -> list[Value]:
    return [Value(kind, text, verdict, plain) for text, plain in pairs]


#: Of no use to any argument.
GARBAGE = [
    *_refused(
        "other types",
        "b'bytes'",
        "{1.0, 2.0}",
        "frozenset()",
        "{'zz': 1}",
        "lambda: 1",
        "(k for k in [1.0, 2.0])",
        "object()",
        "float",
        "...",
        "NotImplemented",
        "1j",
        "complex('nan')",
        "np",
        "memoryview(b'12345678')",
        "slice(1, 2)",
        "ValueError('no')",
        "iter([1.0])",
        "zip()",
        "Everything()",
    ),
    *_refused(
        "objects that raise",
        "Sulky()",
        "[Sulky()]",
        "BadArray()",
        "BadFloat()",
        "BadLength()",
        "BadIteration()",
        "BadTruth()",
        "BadAttributes()",
        "BadPath()",
        "{'a1': Sulky()}",
    ),
    *_refused("containers in containers", "circle()", "deep()", "[[], [[]]]", "[[1.0], [1.0, 2.0]]", "[{}]"),
    *_refused(
        "arrays of others",
        "np.array(['zz'])",
        "np.array([None])",
        "np.array(object())",
        "np.array(b'ab')",
        "np.array(1 + 1j)",
        "np.zeros((2, 2, 2), dtype=complex)",
        "np.datetime64('2020-01-01')",
        "np.timedelta64(1, 's')",
        "np.zeros(2, dtype=[('a', float), ('b', int)])",
        "np.void(b'abcd')",
        "xr.DataArray('zz')",
        "xr.Dataset()",
        "pd.NA",
        "pd.NaT",
        "pd.Series(['zz', 'b'])",
        "pd.DataFrame({'zz': ['b']})",
        "pd.Timestamp('2020-01-01')",
        "pd.Interval(0, 1)",
        "pd.Index(['zz'])",
    ),
]
#: Of no use to an argument that is no text.
TEXTS = _refused(
    "texts",
    "'text'",
    "''",
    "' '",
    "'nan'",
    "'1'",
    "'\\x00'",
    "'\\ud800'",
    "'a\\nb\\rc\\x1b[31m'",
    "'ß' * 100_000",
    "np.str_('a')",
    "Name('a')",
)
NOTHING = _refused("None", "None")
LOGICAL = _refused(
    "truth values", "True", "False", "np.True_", "np.array(True)", "[True]", "np.array([True, False])"
)

#: Numbers that are no numbers, and lists of them.
WRONG_NUMBERS = [
    *_refused("not finite", "float('nan')", "float('inf')", "-np.inf", "np.float32('nan')", "Decimal('NaN')"),
    *_refused("not finite", "Decimal('sNaN')", "Decimal('-Infinity')", "np.array(np.nan)", "np.ma.masked"),
    *_refused(
        "beyond doubles",
        "10**400",
        "-(10**400)",
        "1e400",
        "Fraction(10**400)",
        "Decimal('1e400')",
        "[10**400]",
    ),
    *_refused("beyond doubles", "np.longdouble('1e4000')", "np.array([10**400], dtype=object)"),
    *_refused("numbers as texts", "'{x}'", "b'{x}'", "['{x}']", "np.array(['{x}'])", "pd.Series(['{x}'])"),
    *_refused("masked", "np.ma.array([{x}], mask=[True])", "np.ma.array([{x}, {x}], mask=[False, True])"),
    *_refused("masked", "np.ma.array({x}, mask=True)", "pd.array([None], dtype='Float64')"),
    *_refused(
        "lists with others", "[{x}, None]", "[{x}, True]", "[{x}, '1']", "[{x}, np.nan]", "[{x}, {x} * 1j]"
    ),
    *_refused("lists with others", "[{x}, [1.0, 2.0]]", "[{x}, b'1']", "[pd.NA]"),
    *_refused("complex", "complex({x})", "np.complex128({x})", "[{x} + 0j]", "np.array({x} + 0j)"),
    *_refused("dates", "pd.to_datetime(['2020-01-01'])", "np.array([1], dtype='m8[s]')"),
    *_refused("other units", "xr.DataArray({x}, attrs={'units': 'K'})"),
]
#: One number in other clothes.
ONE_NUMBER = _meant(
    "other types of number",
    TAKEN,
    ("Decimal('{x}')", "{x}"),
    ("Fraction({x})", "{x}"),
    ("np.float64({x})", "{x}"),
    ("np.float32({x})", "float(np.float32({x}))"),
    ("np.float16({x})", "float(np.float16({x}))"),
    ("np.longdouble({x})", "{x}"),
    ("np.array({x})", "{x}"),
    ("np.array({x}, dtype='>f8')", "{x}"),
    ("Real({x})", "{x}"),
    ("np.int64(1)", "1.0"),
    ("np.uint8(1)", "1.0"),
    ("1", "1.0"),
    ("Whole(1)", "1.0"),
) + _meant(
    "other types of number",
    EITHER,
    ("np.array({x}, dtype=object)", "{x}"),
    ("np.ma.array({x})", "{x}"),
    ("xr.DataArray({x})", "{x}"),
)
EXTREME = _meant(
    "extreme numbers",
    EITHER,
    *((text, text) for text in ("5e-324", "1e-310", "2.3e-308", "1e-200", "1e200", "1.7e308", "0.1 + 0.2")),
)
SIGNED = _meant("signs", EITHER, ("0.0", "0.0"), ("-0.0", "-0.0"), ("-{x}", "-{x}"))
NOT_POSITIVE = _refused("signs", "0.0", "-0.0", "-{x}", "0", "-1", "np.float32(-1)", "-5e-324")
#: Several numbers in one argument.
MANY_NUMBERS = _meant(
    "arrays of numbers",
    TAKEN,
    ("[{x}]", "np.array([{x}])"),
    ("({x}, {x} + 0.125)", "np.array([{x}, {x} + 0.125])"),
    ("np.array([{x}, {x} + 0.125], dtype='>f8')", "np.array([{x}, {x} + 0.125])"),
    ("np.array([{x}, {x} + 0.125])[::-1]", "np.array([{x} + 0.125, {x}])"),
    ("np.array([[{x}, 9.0], [{x} + 0.125, 9.0]])[:, 0]", "np.array([{x}, {x} + 0.125])"),
    ("np.array([1, 2], dtype=np.int8)", "np.array([1.0, 2.0])"),
    ("np.array([1, 2], dtype=np.uint64)", "np.array([1.0, 2.0])"),
    ("range(1, 3)", "np.array([1.0, 2.0])"),
) + _meant(
    "arrays of numbers",
    EITHER,
    ("np.array([{x}, {x} + 0.125], dtype=object)", "np.array([{x}, {x} + 0.125])"),
    ("np.ma.array([{x}, {x} + 0.125])", "np.array([{x}, {x} + 0.125])"),
    ("pd.Series([{x}, {x} + 0.125], index=['b', 'a'])", "np.array([{x}, {x} + 0.125])"),
    ("pd.array([{x}, {x} + 0.125], dtype='Float64')", "np.array([{x}, {x} + 0.125])"),
    ("pd.Categorical([{x}])", "np.array([{x}])"),
    ("pd.arrays.SparseArray([{x}, {x} + 0.125])", "np.array([{x}, {x} + 0.125])"),
    ("array('d', [{x}, {x} + 0.125])", "np.array([{x}, {x} + 0.125])"),
    ("[Decimal('{x}'), Fraction({x}) + Fraction(1, 8)]", "np.array([{x}, {x} + 0.125])"),
    (
        "np.array([{x}, {x} + 0.125], dtype=np.float32)",
        "np.array([{x}, {x} + 0.125], dtype=np.float32).astype(float)",
    ),
)
EMPTY = _refused(
    "empty", "[]", "()", "{}", "np.array([])", "np.zeros((0, 3))", "pd.Series(dtype=float)", "range(0)"
)

EMPTY_ARRAYS = _meant(
    "empty", EITHER, *((text, "np.array([])") for text in ("[]", "()", "np.array([])", "range(0)"))
)
EMPTY_ARRAYS += [*_refused("empty", "{}"), *_meant("empty", EITHER, ("np.zeros((0, 3))", "np.zeros((0, 3))"))]

NOT_A_NUMBER = [*GARBAGE, *TEXTS, *NOTHING, *LOGICAL, *WRONG_NUMBERS]
#: By what an argument is.
ROLES: dict[str, list[Value]] = {
    # the numbers of an input, one or several
    "axis": [*NOT_A_NUMBER, *EMPTY, *ONE_NUMBER, *MANY_NUMBERS, *EXTREME, *SIGNED],
    "axis of lengths": [*NOT_A_NUMBER, *EMPTY, *ONE_NUMBER, *MANY_NUMBERS, *EXTREME, *NOT_POSITIVE],
    "reals": [*NOT_A_NUMBER, *EMPTY_ARRAYS, *ONE_NUMBER, *MANY_NUMBERS, *EXTREME, *SIGNED],
    "lengths": [*NOT_A_NUMBER, *EMPTY_ARRAYS, *ONE_NUMBER, *MANY_NUMBERS, *EXTREME, *NOT_POSITIVE],
    # one number
    "real": [
        *NOT_A_NUMBER,
        *EMPTY,
        *ONE_NUMBER,
        *EXTREME,
        *SIGNED,
        *_refused("arrays of numbers", "[{x}, {x}]"),
    ],
    "positive": [*NOT_A_NUMBER, *EMPTY, *ONE_NUMBER, *EXTREME, *NOT_POSITIVE],
    "range": [
        *NOT_A_NUMBER,
        *EMPTY,
        *_refused("ranges", "(1.0, 1.0)", "(2.0, 1.0)", "(1.0,)", "(1.0, 2.0, 3.0)", "(-1.7e308, 1.7e308)"),
        *_refused("ranges", "(1.0, np.nan)", "((0.0, 1.0), (2.0, 3.0))", "('1.0', '2.0')", "(True, 2.0)"),
        *_meant(
            "ranges",
            TAKEN,
            ("[1, 2]", "(1.0, 2.0)"),
            ("np.array([1.0, 2.0])", "(1.0, 2.0)"),
            ("range(1, 3)", "(1.0, 2.0)"),
        ),
    ],
    # how many
    "count": [
        *GARBAGE,
        *TEXTS,
        *LOGICAL,
        *WRONG_NUMBERS,
        *EMPTY,
        *_refused(
            "counts",
            "0",
            "-1",
            "2.5",
            "{x}.0",
            "1e3",
            "np.float64({x})",
            "-(2**63)",
            "10**30",
            "2**64",
            "[{x}]",
        ),
        *_refused("counts", "Decimal({x})", "Fraction({x})", "np.array([{x}])", "np.nan"),
        *_meant("counts", TAKEN, ("np.int64({x})", "{x}"), ("np.uint8({x})", "{x}"), ("Whole({x})", "{x}")),
        *_meant("counts", EITHER, ("np.array({x})", "{x}")),
    ],
    "branch": [
        *GARBAGE,
        *TEXTS,
        *LOGICAL,
        *WRONG_NUMBERS,
        *EMPTY,
        *_refused(
            "assembly modes",
            "0",
            "3",
            "-1",
            "1.5",
            "np.nan",
            "[1, 3]",
            "[1, 1]",
            "10**400",
            "'1'",
            "[1, None]",
        ),
        *_refused("assembly modes", "np.array([[1.5]])", "[1, 2, 1]", "np.int64(-1)", "2**63", "[True, 2]"),
        *_meant(
            "assembly modes",
            TAKEN,
            ("np.int64(2)", "2"),
            ("Code.LEFT", "2"),
            ("np.uint8(1)", "1"),
            ("Whole(2)", "2"),
        ),
        *_meant(
            "assembly modes", EITHER, ("1.0", "1"), ("2.0", "2"), ("np.float32(1)", "1"), ("np.array(2)", "2")
        ),
        *_meant(
            "assembly modes",
            EITHER,
            ("Decimal(1)", "1"),
            ("Fraction(2)", "2"),
            ("(1,)", "(1,)"),
            ("1 + 0j", "1"),
        ),
    ],
    # of one or many configurations
    "modes": [
        *GARBAGE,
        *TEXTS,
        *NOTHING,
        *LOGICAL,
        *WRONG_NUMBERS,
        *EMPTY_ARRAYS,
        *_refused(
            "assembly modes",
            "0",
            "3",
            "-1",
            "1.5",
            "[1, 3]",
            "10**400",
            "'1'",
            "[1, None]",
            "2**63",
            "[True, 2]",
        ),
        *_refused("assembly modes", "np.array([[1.5]])", "np.int64(-1)", "[1, 1.5]", "np.array([1, 9])"),
        *_meant(
            "assembly modes",
            TAKEN,
            ("np.int64(2)", "2"),
            ("Code.LEFT", "2"),
            ("np.uint8(1)", "1"),
            ("Whole(2)", "2"),
        ),
        *_meant(
            "assembly modes",
            EITHER,
            ("1.0", "1"),
            ("Decimal(1)", "1"),
            ("[1, 1]", "[1, 1]"),
            ("np.array([2, 1])", "[2, 1]"),
        ),
    ],
    "name": [
        *GARBAGE,
        *NOTHING,
        *LOGICAL,
        *EMPTY,
        *_refused(
            "names",
            "'{x}'[:-1]",
            "'{x}'.upper() + '_'",
            "'{x} '",
            "'{x}\\x00'",
            "['{x}']",
            "'{x}'.encode()",
            "1",
        ),
        *_refused(
            "names", "''", "'\\ud800'", "'é' * 100_000", "'a\\nb'", "2.5", "np.array('{x}' + '?')", "'../{x}'"
        ),
        *_refused("names", "'{x}' * 2000", "'__class__'", "'{x}_max_max'", "'d_{x}_d_{x}'", "'{x}.py'"),
        *_meant("names", EITHER, ("np.str_('{x}')", "'{x}'"), ("Name('{x}')", "'{x}'")),
    ],
    "names": [
        *GARBAGE,
        *NOTHING,
        *LOGICAL,
        *EMPTY,
        *_refused(
            "names",
            "['{x}', '{x}']",
            "[['{x}']]",
            "['{x}', None]",
            "['{x}', 1]",
            "['{x}'[:-1]]",
            "[b'{x}']",
            "1",
        ),
        *_refused(
            "names",
            "['{x}', '']",
            "['\\ud800']",
            "['é' * 100_000]",
            "['a\\nb']",
            "['{x}', 'd_x_d_y']",
            "['{x}', np.nan]",
        ),
        *_refused(
            "names",
            "['{x}__below_status']",
            "['{x}_max_max']",
            "['{x}', ['{x}']]",
            "['{x}', float]",
            "['{x}', {}]",
        ),
        *_meant(
            "names",
            TAKEN,
            ("('{x}',)", "['{x}']"),
            ("np.array(['{x}'])", "['{x}']"),
            ("[Name('{x}')]", "['{x}']"),
        ),
        *_meant(
            "names", EITHER, ("{'{x}'}", "['{x}']"), ("{'{x}': 1}", "['{x}']"), ("iter(['{x}'])", "['{x}']")
        ),
        *_meant(
            "names",
            EITHER,
            ("pd.Index(['{x}'])", "['{x}']"),
            ("'{x}'", "['{x}']"),
            ("pd.Series(['{x}'])", "['{x}']"),
        ),
    ],
    "choice": [
        *GARBAGE,
        *LOGICAL,
        *EMPTY,
        *_refused(
            "names",
            "'refine'",
            "''",
            "['{x}']",
            "1",
            "'{x} '",
            "'é' * 100_000",
            "'\\ud800'",
            "np.nan",
            "'\\x00'",
        ),
    ],
    "flag": [
        *GARBAGE,
        *TEXTS,
        *EMPTY,
        *_refused("truth values", "2", "np.nan", "np.array([True, False])", "'yes'", "1.5"),
        *_meant(
            "truth values",
            EITHER,
            ("np.True_", "True"),
            ("np.False_", "False"),
            ("0", "False"),
            ("1", "True"),
        ),
    ],
    "path": [
        *[value for value in GARBAGE if value.text != "b'bytes'"],
        *LOGICAL,
        *EMPTY,
        *_refused(
            "paths",
            "''",
            "'.'",
            "'..'",
            "'/'",
            "'a\\x00b.h5'",
            "'\\ud800.h5'",
            "'x' * 5000",
            "'no/such/folder/a.h5'",
            "1",
            "0",
        ),
        *_refused(
            "paths",
            "'study.toml/a.h5'",
            "'~nosuchuser/a.h5'",
            "Path('a\\x00b')",
            "1.5",
            "b'a.h5'",
            "'folder'",
        ),
        *_refused(
            "paths", "'/proc/self/mem'", "'x' * 300 + '.h5'", "'loop/a.h5'", "'/dev/null/a.h5'", "Path()"
        ),
    ],
    "mapping": [
        *[value for value in GARBAGE if value.text != "{'zz': 1}"],
        *TEXTS,
        *LOGICAL,
        *_refused(
            "mappings",
            "{1: 2}",
            "{None: 1}",
            "{'': 1}",
            "{'a\\x00': 1}",
            "{'a': Sulky()}",
            "{'a': object()}",
            "[('a', 1)]",
        ),
        *_refused(
            "mappings",
            "{'a': {}}",
            "{'\\ud800': 1}",
            "{'a': '\\ud800'}",
            "{'a': lambda: 1}",
            "{('a',): 1}",
            "1",
            "{'a': 1j}",
        ),
    ],
    "thing": [*NOT_A_NUMBER, *EMPTY, *_refused("numbers", "1", "0", "2.5", "np.nan", "10**400")],
    # after all other arguments
    "more": [
        *_refused(
            "unknown keywords",
            "gravty=9.81",
            "a_1=0.4",
            "Theta1=1.0",
            "branches=1",
            "self=1",
            "where=1",
            "name=1",
        ),
        *_refused(
            "unknown keywords",
            "omega4=1.0",
            "**{'a b': 1.0}",
            "**{'': 1.0}",
            "**{'\\ud800': 1.0}",
            "**{'é' * 1000: 1.0}",
        ),
        *_refused(
            "unknown keywords",
            "mechanisms='hart'",
            "status=1",
            "design=3",
            "cls=1",
            "args=()",
            "**{'a\\x00': 1}",
            "joint=2",
        ),
    ],
}
#: Among whose numbers NaN stands for a gap, which stays one.
GAPPED = _meant(
    "gaps",
    TAKEN,
    ("float('nan')", "np.array(np.nan)"),
    ("np.float32('nan')", "np.array(np.nan)"),
    ("Decimal('NaN')", "np.array(np.nan)"),
    ("np.array(np.nan)", "np.array(np.nan)"),
    ("[{x}, np.nan]", "np.array([{x}, np.nan])"),
    ("np.ma.masked", "np.array(np.nan)"),
    ("np.ma.array([{x}], mask=[True])", "np.array([np.nan])"),
    ("np.ma.array([{x}, {x}], mask=[False, True])", "np.array([{x}, np.nan])"),
    ("np.ma.array({x}, mask=True)", "np.array(np.nan)"),
    ("pd.array([None], dtype='Float64')", "np.array([np.nan])"),
)
#: Two coordinates along the last axis; NaN stands for a gap.
_VECTORS = [
    *GARBAGE,
    *TEXTS,
    *NOTHING,
    *LOGICAL,
    *_refused(
        "shapes", "1.0", "[1.0]", "[1.0, 2.0, 3.0]", "np.zeros((2, 3))", "[]", "()", "{}", "np.zeros((3, 0))"
    ),
    *_refused("shapes", "[{x}, [1.0]]", "[{x}, 1.0]", "np.array([])", "range(3)", "[[{x}], {x}]"),
    *_refused("not finite", "[np.inf, 3.0]", "[5.0, -np.inf]", "[Decimal('sNaN'), 3.0]"),
    *_refused("beyond doubles", "[5.0, 10**400]", "[1e400, 3.0]", "[5.0, Fraction(10**400)]"),
    *_refused(
        "numbers as texts",
        "'{x}'",
        "['5.0', '3.0']",
        "[5.0, '3.0']",
        "[5.0, b'3.0']",
        "pd.Series(['5', '3'])",
    ),
    *_refused(
        "lists with others", "[5.0, None]", "[5.0, True]", "[5.0, pd.NA]", "[5.0, [3.0]]", "[5.0, object()]"
    ),
    *_refused("complex", "5.0 + 3j", "[5.0 + 0j, 3.0]", "np.array({x}) + 0j", "[[5.0 + 3j]]"),
    *_refused("other units", "xr.DataArray({x}, attrs={'units': 'K'})"),
    *_refused("dates", "np.array([5, 3], dtype='m8[s]')", "pd.to_datetime(['2020-01-01', '2020-01-02'])"),
    *_meant(
        "other types of number",
        TAKEN,
        ("tuple({x})", "{x}"),
        ("np.array({x}, dtype='>f8')", "{x}"),
        ("np.float32({x})", "np.float32({x}).astype(float)"),
        ("[5, 3]", "[5.0, 3.0]"),
        ("range(1, 3)", "[1.0, 2.0]"),
        ("np.array([1, 2], dtype=np.int8)", "[1.0, 2.0]"),
        ("np.array([5.0, 9.0, 3.0, 9.0])[::2]", "[5.0, 3.0]"),
    ),
    *_meant(
        "other types of number",
        EITHER,
        ("[Decimal('5'), Fraction(3)]", "[5.0, 3.0]"),
        ("np.array({x}, dtype=object)", "{x}"),
        ("np.ma.array({x})", "{x}"),
        ("array('d', {x})", "{x}"),
        ("pd.Series({x}, index=['b', 'a'])", "{x}"),
        ("pd.DataFrame([{x}])", "[{x}]"),
        ("xr.DataArray({x})", "{x}"),
        ("xr.DataArray([{x}])", "[{x}]"),
    ),
    *_meant(
        "arrays of numbers",
        TAKEN,
        ("[{x}]", "np.array([{x}])"),
        ("[[{x}, {x}], [{x}, [2.0, 1.0]]]", "np.array([[{x}, {x}], [{x}, [2.0, 1.0]]])"),
        ("np.array([{x}, [2.0, 1.0]]).T.copy().T", "np.array([{x}, [2.0, 1.0]])"),
        ("np.zeros((0, 2))", "np.zeros((0, 2))"),
    ),
    *_meant(
        "gaps",
        TAKEN,
        ("[np.nan, 3.0]", "np.array([np.nan, 3.0])"),
        ("[5.0, Decimal('NaN')]", "np.array([5.0, np.nan])"),
        ("np.ma.array([5.0, 3.0], mask=[False, True])", "np.array([5.0, np.nan])"),
        ("pd.array([5.0, None], dtype='Float64')", "np.array([5.0, np.nan])"),
        ("[{x}, [np.nan, np.nan]]", "np.array([{x}, [np.nan, np.nan]])"),
    ),
    *_meant(
        "extreme numbers",
        EITHER,
        *(
            (text, text)
            for text in ("[5e-324, 0.0]", "[1.7e308, -1.7e308]", "[1e300, 1.0]", "[1e200, 1e-200]")
        ),
        *(
            (text, text)
            for text in ("[1e-310, 5e-324]", "[0.0, 0.0]", "[-0.0, 1.0]", "[1.0, 1.0]", "[-5.0, 3.0]")
        ),
        *((text, text) for text in ("[3.0, 5.0]", "[-3.0, -5.0]", "[1.0, 1.0 - 2**-53]", "[1e-200, 1e-300]")),
    ),
]
_GAPS = {gap.text for gap in GAPPED}
_POSITIONS = [
    *GARBAGE,
    *TEXTS,
    *LOGICAL,
    *WRONG_NUMBERS,
    *EMPTY,
    *_refused(
        "counts",
        "0",
        "-1",
        "2.5",
        "8.0",
        "10**30",
        "2**64",
        "2**40",
        "-(2**63)",
        "np.float64(8)",
        "Decimal(8)",
    ),
    *_refused("positions", "[1.0, 1.0]", "[1.0, np.nan]", "[[1.0, 2.0]]", "[1.0, np.inf]", "np.array(1.5)"),
    *_meant("counts", TAKEN, ("np.int64(8)", "8"), ("Whole(8)", "8"), ("np.uint8(8)", "8")),
    *_meant(
        "positions", TAKEN, ("[0.5, 1.5]", "np.array([0.5, 1.5])"), ("range(1, 3)", "np.array([1.0, 2.0])")
    ),
    *_meant("positions", TAKEN, ("(0.5,)", "np.array([0.5])"), ("np.float32([0.5])", "np.array([0.5])")),
    *_meant("positions", EITHER, ("pd.Series([0.5, 1.5])", "np.array([0.5, 1.5])"), ("np.array(8)", "8")),
    *_meant(
        "positions",
        EITHER,
        ("[Decimal('0.5')]", "np.array([0.5])"),
        ("[1e300]", "[1e300]"),
        ("[5e-324]", "[5e-324]"),
    ),
    *_meant(
        "positions", EITHER, ("[0.0, -0.0]", "[0.0, -0.0]"), ("[-1.7e308]", "[-1.7e308]"), ("{x}", "{x}")
    ),
]
ROLES |= {
    "positions": _POSITIONS,
    "length": [value for value in ROLES["positive"]],
    "numbers of designs": [
        *NOT_A_NUMBER,
        *_refused(
            "counts", "-1", "1", "[3]", "[-1]", "[0.5]", "[1.0]", "[2**64]", "np.zeros((2, 2), dtype=int)"
        ),
        *_meant("counts", TAKEN, ("(0, 2)", "[0, 2]"), ("np.array([0, 2], dtype=np.uint8)", "[0, 2]")),
        *_meant("counts", TAKEN, ("range(2)", "[0, 1]"), ("[]", "np.array([], dtype=int)")),
        *_meant("counts", EITHER, ("pd.Series([0, 2], index=[5, 4])", "[0, 2]"), ("[2, 0, 0]", "[2, 0, 0]")),
    ],
    "gapped": [value for value in ROLES["reals"] if value.text not in _GAPS] + GAPPED,
    "gapped lengths": [value for value in ROLES["lengths"] if value.text not in _GAPS] + GAPPED,
    "vectors": _VECTORS,
    "code": [
        *NOT_A_NUMBER,
        *EMPTY_ARRAYS,
        *_refused("codes", "0", "3", "1.5", "-1.0", "[1, 3]", "2**63"),
        *_meant(
            "codes",
            TAKEN,
            ("np.int64(2)", "2.0"),
            ("2", "2.0"),
            ("Code.LEFT", "2.0"),
            ("[1, 2]", "np.array([1.0, 2.0])"),
        ),
    ],
    "lo_hi": [
        *(value for value in ROLES["range"] if value.text not in ("None",)),
        *NOTHING,
        *_meant(
            "other types of number",
            EITHER,
            ("Decimal('0.5')", "0.5"),
            ("np.float32(0.5)", "0.5"),
            ("1", "1.0"),
        ),
        *_meant(
            "ranges",
            EITHER,
            ("(0.0, 5e-324)", "(0.0, 5e-324)"),
            ("(1.0, 1.0 + 2**-52)", "(1.0, 1.0 + 2**-52)"),
        ),
        *_meant("ranges", EITHER, ("(0.0, 1.7e308)", "(0.0, 1.7e308)"), ("(-0.0, 1.0)", "(-0.0, 1.0)")),
    ],
    "tolerance": [
        *NOT_A_NUMBER,
        *EMPTY,
        *_refused("signs", "-{x}", "-1", "-5e-324"),
        *_meant(
            "other types of number",
            EITHER,
            ("0.0", "0.0"),
            ("np.float32(0.5)", "0.5"),
            ("1", "1.0"),
            ("Decimal('0.5')", "0.5"),
        ),
    ],
    # the argument of a compiled function of two inputs
    "matrix": [
        *GARBAGE,
        *TEXTS,
        *NOTHING,
        *LOGICAL,
        *EMPTY,
        *_refused(
            "numbers as texts",
            "['1.2', '0.8']",
            "[1.2, '0.8']",
            "np.array(['1.2', '0.8'])",
            "[1.2, b'0.8']",
            "'1.2'",
        ),
        *_refused(
            "shapes",
            "1.2",
            "[1.2]",
            "[1.2, 0.8, 1.0]",
            "[[1.2, 0.8, 1.0]]",
            "np.zeros((0, 2))",
            "[[1.2], [0.8, 0.9]]",
        ),
        *_refused(
            "lists with others",
            "[1.2, None]",
            "[1.2, True]",
            "[1.2, 1j]",
            "np.array([1.2, 0.8 + 0j])",
            "[1.2, pd.NA]",
        ),
        *_refused(
            "beyond doubles",
            "[1.2, 10**400]",
            "np.array([1.2, 10**400], dtype=object)",
            "[1.2, Fraction(10**400)]",
        ),
        *_meant("masked", EITHER, ("np.ma.array([1.2, 0.8], mask=[0, 1])", "[1.2, np.nan]")),
        *_meant("masked", EITHER, ("pd.array([1.2, None], dtype='Float64')", "[1.2, np.nan]")),
        *_refused(
            "dates", "np.array([1, 2], dtype='m8[s]')", "np.array(['2020-01-01', 'NaT'], dtype='M8[D]')"
        ),
        *_meant(
            "arrays of numbers",
            TAKEN,
            ("(1.2, 0.8)", "[1.2, 0.8]"),
            ("np.array([1.2, 0.8], dtype='>f8')", "[1.2, 0.8]"),
        ),
        *_meant(
            "arrays of numbers",
            TAKEN,
            ("np.array([[1.2, 9.0], [0.8, 9.0]])[:, 0]", "[1.2, 0.8]"),
            ("[2, 1]", "[2.0, 1.0]"),
        ),
        *_meant(
            "arrays of numbers",
            TAKEN,
            ("np.zeros((2, 0))", "np.zeros((2, 0))"),
            ("np.float32([1.5, 1])", "[1.5, 1.0]"),
        ),
        *_meant(
            "arrays of numbers",
            EITHER,
            ("pd.Series([1.2, 0.8])", "[1.2, 0.8]"),
            ("np.ma.array([1.2, 0.8])", "[1.2, 0.8]"),
        ),
        *_meant(
            "arrays of numbers",
            EITHER,
            ("[Decimal('1.2'), 0.8]", "[1.2, 0.8]"),
            ("array('d', [1.2, 0.8])", "[1.2, 0.8]"),
        ),
        *_meant(
            "not finite",
            EITHER,
            ("[np.nan, 0.8]", "[np.nan, 0.8]"),
            ("[1.2, np.inf]", "[1.2, np.inf]"),
            ("[1.2, -1.0]", "[1.2, -1.0]"),
        ),
        *_meant(
            "extreme numbers",
            EITHER,
            ("[5e-324, 1.7e308]", "[5e-324, 1.7e308]"),
            ("[1.2, -0.0]", "[1.2, -0.0]"),
        ),
    ],
    "curve": [
        *GARBAGE,
        *TEXTS,
        *NOTHING,
        *LOGICAL,
        *_refused("numbers as texts", "['1.2', '0.8', '1', '2']", "[1.2, '0.8', 1, 2]", "[b'1', 2, 3, 4]"),
        *_refused("shapes", "[1.0, 2.0]", "[[1.2], [0.8, 0.9]]", "[1.0, 2.0, 3.0]"),
        *_refused(
            "lists with others",
            "[1.2, None, 1, 2]",
            "[1.2, 1j, 1, 2]",
            "[1.2, True, 1, 2]",
            "[1.2, pd.NA, 1, 2]",
        ),
        *_refused("beyond doubles", "[1.2, 10**400, 1, 2]", "np.array([1.2, 10**400, 1, 2], dtype=object)"),
        *_meant(
            "masked", TAKEN, ("np.ma.array([1.2, 0.8, 1, 2], mask=[0, 1, 0, 0])", "[1.2, np.nan, 1.0, 2.0]")
        ),
        *_meant("masked", TAKEN, ("pd.array([1.2, None, 1, 2], dtype='Float64')", "[1.2, np.nan, 1.0, 2.0]")),
        *_meant("empty", EITHER, ("np.zeros((3, 0))", "np.zeros((3, 0))"), ("[]", "np.array([])")),
        *_refused("dates", "np.array([1, 2, 3, 4], dtype='m8[s]')"),
        *_meant(
            "arrays of numbers",
            TAKEN,
            ("(1, 2, 3, 5)", "[1.0, 2.0, 3.0, 5.0]"),
            ("range(4)", "[0.0, 1.0, 2.0, 3.0]"),
        ),
        *_meant(
            "arrays of numbers",
            EITHER,
            ("[Decimal(1), 2, 3, 5]", "[1.0, 2.0, 3.0, 5.0]"),
            ("[np.nan] * 4", "[np.nan] * 4"),
        ),
        *_meant(
            "extreme numbers", EITHER, ("[1e308, -1e308, 1e308, 0.0]",) * 2, ("[5e-324, 0.0, 0.0, 0.0]",) * 2
        ),
        *_meant(
            "extreme numbers", EITHER, ("[np.inf, 0.0, 1.0, 2.0]",) * 2, ("[1e200, -1e200, 0.0, 1.0]",) * 2
        ),
        *_meant("extreme numbers", EITHER, ("[1.7e308, 1e308, 1.7e308, 1.6e308]",) * 2),
    ],
    "space": [
        *[value for value in GARBAGE if value.kind != "mappings"],
        *TEXTS,
        *NOTHING,
        *LOGICAL,
        *EMPTY,
        *_refused(
            "spaces",
            "1.0",
            "[SPACE]",
            "fl.DesignSpace",
            "fl.grid",
            "fl.grid()",
            "[1.0, 2.0]",
            "np.zeros((3, 4))",
            "MAPS.omega4_max",
        ),
        *_refused(
            "spaces",
            "fl.DesignSpace('grid', (), ())",
            "fl.DesignSpace('x', ('a2',), (3,))",
            "fl.DesignSpace(1, 2, 3)",
        ),
        *_refused(
            "spaces",
            "fl.grid(a1=np.full(1, 0.4))",
            "{'a1': 'x', 'a2': 1.2, 'a3': 0.8, 'a4': 1.0}",
            "{'a1': {}}",
            "{'a1': None}",
        ),
        *_refused(
            "spaces",
            "dict(a1=-0.4, a2=1.2, a3=0.8, a4=1.0, omega1=1.0)",
            "dict(a1=True, a2=1.2, a3=0.8, a4=1.0, omega1=1.0)",
        ),
        *_refused(
            "spaces", "xr.Dataset({'a1': 0.4})", "pd.DataFrame()", "pd.Series({'a1': 0.4})", "BARS", "SPEED"
        ),
    ],
    "dataset": [
        *GARBAGE,
        *TEXTS,
        *NOTHING,
        *LOGICAL,
        *EMPTY,
        *_refused(
            "datasets",
            "xr.Dataset(attrs={'designs': 'x'})",
            "xr.Dataset({'status': 1})",
            "[{x}]",
            "SPACE",
            "1.0",
            "'no.h5'",
        ),
        *_refused(
            "datasets",
            "{x}.assign_attrs(designs='many').drop_vars('status', errors='ignore')",
            "{'T41_fluctuation': 1}",
            "{'T_x': 1, 'T_y': 2}",
        ),
    ],
    "design": [
        *_refused(
            "designs",
            "{'a1': None}",
            "{'a2': '1.2'}",
            "{'a3': True}",
            "{'a4': -1.0}",
            "{'a1': np.nan}",
            "{'a2': Sulky()}",
            "{'a1': 10**400}",
        ),
        *_refused("designs", "{'nosuch': 1.0}", "{'a9': 'x'}", "{'theta': Sulky()}"),
    ],
    "names_of": [
        *_refused(
            "names",
            "{'é' * 100_000: 1.0}",
            "{'\\x00': 1.0}",
            "{'\\ud800': 1.0}",
            "{'': 1.0}",
            "{'a b\\nc': [1.0, 2.0]}",
        ),
    ],
}
# A design space keeps the units that it is given, which a sweep refuses; assembly modes have none.
for _role in ("axis", "lo_hi", "branch", "modes"):
    ROLES[_role] = [value for value in ROLES[_role] if value.kind != "other units"]
