"""What may stand for an argument: source texts, each with what may come of it.

Texts stand in blocks, two blanks or more apart; ``{x}`` is the value that the argument usually has, and after ``=>``
stands the plain value that is meant, where it is another text.
"""

import re
from functools import partial
from typing import NamedTuple

#: What may come of a value: it is refused; it is taken for the plain value; either of these.
REFUSED, TAKEN, EITHER = "refused", "taken", "either"


class Value(NamedTuple):
    """A text for an argument, what may come of it, and the text of the plain value that it means."""

    text: str
    verdict: str
    plain: str

    def about(self, x):
        """Return the value where the argument usually is `x`."""
        return Value(self.text.replace("{x}", x), self.verdict, self.plain.replace("{x}", x))


def texts_of(block, between=r"\s{2,}"):
    """Return the texts of a block."""
    return re.split(between, block.strip())


def _values(verdict, block):
    """Return the values of a block, of which one thing may come."""
    pairs = (text.partition(" => ") for text in texts_of(block))
    return [Value(text, verdict, plain or text) for text, _, plain in pairs]


refused, taken, either = (partial(_values, verdict) for verdict in (REFUSED, TAKEN, EITHER))

#: Of no use to any argument: other types, objects that raise, containers in containers, arrays of others.
GARBAGE = refused(
    """
    b'bytes'   {1.0, 2.0}   {'zz': 1}   lambda: 1   (k for k in [1.0, 2.0])   object()   float
    ...   1j   complex('nan')   np   memoryview(b'12345678')   slice(1, 2)
    ValueError('no')   iter([1.0])   Everything()   Sulky()   [Sulky()]   BadArray()   BadFloat()
    BadLength()   BadIteration()   BadTruth()   BadAttributes()   BadPath()   {'a1': Sulky()}   circle()
    deep()   [[], [[]]]   [[1.0], [1.0, 2.0]]   [{}]   np.array(['zz'])   np.array([None])
    np.array(object())   np.array(1 + 1j)
    np.datetime64('2020-01-01')   np.timedelta64(1, 's')   np.zeros(2, dtype=[('a', float), ('b', int)])
    np.void(b'abcd')   xr.DataArray('zz')   xr.Dataset()   pd.NA   pd.Series(['zz', 'b'])
    pd.DataFrame({'zz': ['b']})   pd.Timestamp('2020-01-01')   pd.Interval(0, 1)   pd.Index(['zz'])
    """
)
TEXTS = refused(
    r"""
    'text'   ''   ' '   'nan'   '1'   '\x00'   '\ud800'   'a\nb\rc\x1b[31m'   'ß' * 100_000   np.str_('a')
    Name('a')
    """
)
NONE = refused("None")
LOGICAL = refused("True   False   np.True_   np.array(True)   [True]   np.array([True, False])")
#: Among numbers: not finite, or masked. Where NaN is a gap it stays one, see `GAPS`.
NOT_FINITE = refused(
    """
    float('nan')   np.float32('nan')   Decimal('NaN')   np.array(np.nan)   np.ma.masked   [{x}, np.nan]
    np.ma.array([{x}], mask=[True])   np.ma.array([{x}, {x}], mask=[False, True])   np.ma.array({x}, mask=True)
    pd.array([None], dtype='Float64')
    """
)
#: Beyond doubles, texts, lists with others, complex numbers, dates.
NO_NUMBERS = refused(
    """
    float('inf')   -np.inf   Decimal('sNaN')   10**400   1e400
    Fraction(10**400)   Decimal('1e400')   [10**400]   np.longdouble('1e4000')
    np.array([10**400], dtype=object)   '{x}'   b'{x}'   ['{x}']   np.array(['{x}'])   pd.Series(['{x}'])
    [{x}, None]   [{x}, True]   [{x}, '1']   [{x}, {x} * 1j]   [{x}, [1.0, 2.0]]   [{x}, b'1']   [pd.NA]
    complex({x})   np.array({x} + 0j)   pd.to_datetime(['2020-01-01'])
    np.array([1], dtype='m8[s]')
    """
)
OTHER_UNITS = refused("xr.DataArray({x}, attrs={'units': 'K'})")
ONE_NUMBER = taken(
    """
    Decimal('{x}') => {x}   Fraction({x}) => {x}   np.float64({x}) => {x}
    np.float32({x}) => float(np.float32({x}))   np.float16({x}) => float(np.float16({x}))
    np.longdouble({x}) => {x}   np.array({x}) => {x}   np.array({x}, dtype='>f8') => {x}   Real({x}) => {x}
    np.int64(1) => 1.0   np.uint8(1) => 1.0   1 => 1.0   Whole(1) => 1.0
    """
) + either("np.array({x}, dtype=object) => {x}   np.ma.array({x}) => {x}   xr.DataArray({x}) => {x}")
EXTREME = either("5e-324   1e-310   2.3e-308   1e-200   1e200   1.7e308   0.1 + 0.2")
SIGNED = either("0.0   -0.0   -{x}")
NOT_POSITIVE = refused("0.0   -0.0   -{x}   0   -1   np.float32(-1)   -5e-324")
#: ``{two}`` is an array of two numbers.
TWO = "np.array([{x}, {x} + 0.125])"
MANY_NUMBERS = taken(
    """
    [{x}] => np.array([{x}])   ({x}, {x} + 0.125) => {two}
    np.array([{x}, {x} + 0.125], dtype='>f8') => {two}
    {two}[::-1] => np.array([{x} + 0.125, {x}])   np.array([[{x}, 9.0], [{x} + 0.125, 9.0]])[:, 0] => {two}
    np.array([1, 2], dtype=np.int8) => np.array([1.0, 2.0])
    np.array([1, 2], dtype=np.uint64) => np.array([1.0, 2.0])   range(1, 3) => np.array([1.0, 2.0])
    """.replace("{two}", TWO)
) + either(
    """
    {two}.astype(object) => {two}   np.ma.array({two}) => {two}   pd.Series({two}, index=['b', 'a']) => {two}
    pd.array({two}, dtype='Float64') => {two}   pd.Categorical([{x}]) => np.array([{x}])
    pd.arrays.SparseArray({two}) => {two}   array('d', {two}) => {two}
    [Decimal('{x}'), Fraction({x}) + Fraction(1, 8)] => {two}
    np.float32({two}) => np.float32({two}).astype(float)
    """.replace("{two}", TWO)
)
EMPTY = refused("[]   ()   {}   np.array([])   np.zeros((0, 3))   pd.Series(dtype=float)   range(0)")
EMPTY_ARRAYS = refused("{}") + either(
    "[] => np.array([])   () => np.array([])   np.array([])   range(0) => np.array([])   np.zeros((0, 3))"
)
GAPS = taken(
    """
    float('nan') => np.array(np.nan)   np.float32('nan') => np.array(np.nan)
    Decimal('NaN') => np.array(np.nan)   np.array(np.nan)   [{x}, np.nan] => np.array([{x}, np.nan])
    np.ma.masked => np.array(np.nan)   np.ma.array([{x}], mask=[True]) => np.array([np.nan])
    np.ma.array([{x}, {x}], mask=[False, True]) => np.array([{x}, np.nan])
    np.ma.array({x}, mask=True) => np.array(np.nan)
    pd.array([None], dtype='Float64') => np.array([np.nan])
    """
)

OPTIONAL = GARBAGE + TEXTS + LOGICAL
OTHERS = OPTIONAL + NONE
NOT_A_NUMBER = OTHERS + NO_NUMBERS + NOT_FINITE
NO_WHOLE = OPTIONAL + NO_NUMBERS + NOT_FINITE + EMPTY
NO_CODE = NOT_A_NUMBER + EMPTY_ARRAYS
NO_WORD = GARBAGE + LOGICAL + EMPTY
NUMBERS = ONE_NUMBER + MANY_NUMBERS + EXTREME
RANGES = refused(
    """
    (1.0, 1.0)   (2.0, 1.0)   (1.0,)   (1.0, 2.0, 3.0)   (-1.7e308, 1.7e308)   (1.0, np.nan)
    ((0.0, 1.0), (2.0, 3.0))   ('1.0', '2.0')   (True, 2.0)
    """
) + taken("[1, 2] => (1.0, 2.0)   np.array([1.0, 2.0]) => (1.0, 2.0)   range(1, 3) => (1.0, 2.0)")
MODES = refused(
    "0   3   -1   1.5   [1, 3]   [1, None]   2**63   [True, 2]   np.array([[1.5]])   np.int64(-1)   [1, 1.5]"
) + taken("np.int64(2) => 2   Code.LEFT => 2   np.uint8(1) => 1   Whole(2) => 2")
POSITIVE = NOT_A_NUMBER + OTHER_UNITS + EMPTY + ONE_NUMBER + EXTREME + NOT_POSITIVE

#: By what an argument is.
ROLES = {
    # the numbers of an axis of designs, whose units a sweep checks
    "axis": NOT_A_NUMBER + EMPTY + NUMBERS + SIGNED,
    "axis of lengths": NOT_A_NUMBER + EMPTY + NUMBERS + NOT_POSITIVE,
    # numbers of an input, one or several; with NaN for a gap
    "reals": NOT_A_NUMBER + OTHER_UNITS + EMPTY_ARRAYS + NUMBERS + SIGNED,
    "lengths": NOT_A_NUMBER + OTHER_UNITS + EMPTY_ARRAYS + NUMBERS + NOT_POSITIVE,
    "gapped": OTHERS + NO_NUMBERS + OTHER_UNITS + GAPS + EMPTY_ARRAYS + NUMBERS + SIGNED,
    "gapped lengths": OTHERS + NO_NUMBERS + OTHER_UNITS + GAPS + EMPTY_ARRAYS + NUMBERS + NOT_POSITIVE,
    # one number
    "real": NOT_A_NUMBER + OTHER_UNITS + EMPTY + ONE_NUMBER + EXTREME + SIGNED + refused("[{x}, {x}]"),
    "positive": POSITIVE,
    "length": POSITIVE,
    "tolerance": NOT_A_NUMBER
    + EMPTY
    + refused("-{x}   -1   -5e-324")
    + either("0.0   np.float32(0.5) => 0.5   1 => 1.0   Decimal('0.5') => 0.5"),
    "range": NOT_A_NUMBER + OTHER_UNITS + EMPTY + RANGES,
    "range or number": NOT_A_NUMBER
    + EMPTY
    + RANGES
    + either(
        """
        Decimal('0.5') => 0.5   np.float32(0.5) => 0.5   1 => 1.0   (0.0, 5e-324)   (1.0, 1.0 + 2**-52)
        (0.0, 1.7e308)   (-0.0, 1.0)
        """
    ),
    # whole numbers
    "count": NO_WHOLE
    + refused(
        """
        0   -1   2.5   {x}.0   1e3   np.float64({x})   -(2**63)   10**30   2**64   [{x}]   Decimal({x})
        Fraction({x})   np.array([{x}])
        """
    )
    + taken("np.int64({x}) => {x}   np.uint8({x}) => {x}   Whole({x}) => {x}")
    + either("np.array({x}) => {x}"),
    "branch": NO_WHOLE
    + MODES
    + refused("[1, 1]   [1, 2, 1]")
    + either("1.0 => 1   np.float32(1) => 1   np.array(2) => 2   Decimal(1) => 1   (1,)   1 + 0j => 1"),
    "modes": NO_CODE + MODES + either("1.0 => 1   Decimal(1) => 1   [1, 1]   np.array([2, 1]) => [2, 1]"),
    "code": NO_CODE
    + refused("0   3   1.5   -1.0   [1, 3]   2**63")
    + taken("np.int64(2) => 2.0   2 => 2.0   Code.LEFT => 2.0   [1, 2] => np.array([1.0, 2.0])"),
    "numbers of designs": NOT_A_NUMBER
    + refused("-1   1   [3]   [-1]   [0.5]   [1.0]   [2**64]   np.zeros((2, 2), dtype=int)")
    + taken("(0, 2) => [0, 2]   np.array([0, 2], dtype=np.uint8) => [0, 2]   range(2) => [0, 1]")
    + taken("[] => np.array([], dtype=int)")
    + either("pd.Series([0, 2], index=[5, 4]) => [0, 2]   [2, 0, 0]"),
    "positions": NO_WHOLE
    + OTHER_UNITS
    + refused(
        """
        0   -1   2.5   8.0   10**30   2**40   -(2**63)   np.float64(8)   Decimal(8)   [1.0, 1.0]   [1.0, np.nan]
        [[1.0, 2.0]]   [1.0, np.inf]   np.array(1.5)
        """
    )
    + taken(
        """
        np.int64(8) => 8   Whole(8) => 8   np.uint8(8) => 8   [0.5, 1.5] => np.array([0.5, 1.5])
        range(1, 3) => np.array([1.0, 2.0])   (0.5,) => np.array([0.5])   np.float32([0.5]) => np.array([0.5])
        """
    )
    + either(
        """
        pd.Series([0.5, 1.5]) => np.array([0.5, 1.5])   np.array(8) => 8   [Decimal('0.5')] => np.array([0.5])
        [1e300]   [5e-324]   [0.0, -0.0]   [-1.7e308]   {x}
        """
    ),
    # texts
    "name": NO_WORD
    + NONE
    + refused(
        r"""
        '{x}'[:-1]   '{x}'.upper() + '_'   '{x} '   '{x}\x00'   ['{x}']   '{x}'.encode()   1   ''   '\ud800'
        'é' * 100_000   'a\nb'   2.5   np.array('{x}' + '?')   '../{x}'   '{x}' * 2000   '__class__'
        '{x}_max_max'   'd_{x}_d_{x}'   '{x}.py'
        """
    )
    + either("np.str_('{x}') => '{x}'   Name('{x}') => '{x}'"),
    "names": NO_WORD
    + NONE
    + refused(
        r"""
        ['{x}', '{x}']   [['{x}']]   ['{x}', None]   ['{x}', 1]   ['{x}'[:-1]]   [b'{x}']   1   ['{x}', '']
        ['\ud800']   ['é' * 100_000]   ['a\nb']   ['{x}', 'd_x_d_y']   ['{x}', np.nan]   ['{x}__below_status']
        ['{x}_max_max']   ['{x}', ['{x}']]   ['{x}', float]   ['{x}', {}]
        """
    )
    + taken("('{x}',) => ['{x}']   np.array(['{x}']) => ['{x}']   [Name('{x}')] => ['{x}']")
    + either("{'{x}'} => ['{x}']   {'{x}': 1} => ['{x}']   iter(['{x}']) => ['{x}']   '{x}' => ['{x}']")
    + either("pd.Index(['{x}']) => ['{x}']   pd.Series(['{x}']) => ['{x}']"),
    "choice": NO_WORD
    + refused(r"'refine'   ''   ['{x}']   1   '{x} '   'é' * 100_000   '\ud800'   np.nan   '\x00'"),
    "flag": GARBAGE
    + TEXTS
    + EMPTY
    + refused("2   np.nan   np.array([True, False])   'yes'   1.5")
    + either("np.True_ => True   np.False_ => False   0 => False   1 => True"),
    "path": NO_WORD
    + refused(
        r"""
        ''   '.'   '..'   '/'   'a\x00b.h5'   '\ud800.h5'   'x' * 5000   'no/such/folder/a.h5'   1   0   1.5
        'study.toml/a.h5'   '~nosuchuser/a.h5'   Path('a\x00b')   b'a.h5'   'folder'   '/proc/self/mem'
        'x' * 300 + '.h5'   'loop/a.h5'   '/dev/null/a.h5'   Path()
        """
    ),
    "mapping": [value for value in GARBAGE if value.text != "{'zz': 1}"]
    + TEXTS
    + LOGICAL
    + refused(
        r"""
        {1: 2}   {None: 1}   {'': 1}   {'a\x00': 1}   {'a': Sulky()}   {'a': object()}   [('a', 1)]   {'a': {}}
        {'\ud800': 1}   {'a': '\ud800'}   {'a': lambda: 1}   {('a',): 1}   1   {'a': 1j}
        """
    ),
    "thing": NOT_A_NUMBER + EMPTY + refused("1   0   2.5"),
    # keywords after all other arguments, designs beside a mapping, and names of inputs
    "more": refused(
        r"""
        gravty=9.81   a_1=0.4   Theta1=1.0   branches=1   self=1   where=1   name=1   omega4=1.0   joint=2
        **{'a b': 1.0}   **{'': 1.0}   **{'\ud800': 1.0}   **{'é' * 1000: 1.0}   mechanisms='hart'   status=1
        design=3   cls=1   args=()   **{'a\x00': 1}
        """
    ),
    "design": refused(
        """
        {'a1': None}   {'a2': '1.2'}   {'a3': True}   {'a4': -1.0}   {'a1': np.nan}   {'a2': Sulky()}
        {'a1': 10**400}   {'nosuch': 1.0}   {'a9': 'x'}   {'theta': Sulky()}
        """
    ),
    "names of inputs": refused(
        r"{'é' * 100_000: 1.0}   {'\x00': 1.0}   {'\ud800': 1.0}   {'': 1.0}   {'a b\nc': [1.0, 2.0]}"
    ),
    # two coordinates along the last axis, NaN for a gap
    "vectors": OTHERS
    + OTHER_UNITS
    + refused(
        """
        1.0   [1.0]   [1.0, 2.0, 3.0]   np.zeros((2, 3))   []   ()   {}   np.zeros((3, 0))   [{x}, [1.0]]
        [{x}, 1.0]   np.array([])   range(3)   [[{x}], {x}]   [np.inf, 3.0]   [Decimal('sNaN'), 3.0]
        [5.0, 10**400]   [1e400, 3.0]   [5.0, Fraction(10**400)]   '{x}'   ['5.0', '3.0']   [5.0, '3.0']
        [5.0, b'3.0']   pd.Series(['5', '3'])   [5.0, None]   [5.0, True]   [5.0, pd.NA]   [5.0, [3.0]]
        [5.0, object()]   5.0 + 3j   [5.0 + 0j, 3.0]   np.array({x}) + 0j   [[5.0 + 3j]]
        np.array([5, 3], dtype='m8[s]')   pd.to_datetime(['2020-01-01', '2020-01-02'])
        """
    )
    + taken(
        """
        tuple({x}) => {x}   np.array({x}, dtype='>f8') => {x}   np.float32({x}) => np.float32({x}).astype(float)
        [5, 3] => [5.0, 3.0]   range(1, 3) => [1.0, 2.0]   np.array([1, 2], dtype=np.int8) => [1.0, 2.0]
        np.array([5.0, 9.0, 3.0, 9.0])[::2] => [5.0, 3.0]   [{x}] => np.array([{x}])
        [[{x}, {x}], [{x}, [2.0, 1.0]]] => np.array([[{x}, {x}], [{x}, [2.0, 1.0]]])
        np.array([{x}, [2.0, 1.0]]).T.copy().T => np.array([{x}, [2.0, 1.0]])   np.zeros((0, 2))
        [np.nan, 3.0] => np.array([np.nan, 3.0])   [5.0, Decimal('NaN')] => np.array([5.0, np.nan])
        np.ma.array([5.0, 3.0], mask=[False, True]) => np.array([5.0, np.nan])
        pd.array([5.0, None], dtype='Float64') => np.array([5.0, np.nan])
        [{x}, [np.nan, np.nan]] => np.array([{x}, [np.nan, np.nan]])
        """
    )
    + either(
        """
        [Decimal('5'), Fraction(3)] => [5.0, 3.0]   np.array({x}, dtype=object) => {x}   np.ma.array({x}) => {x}
        array('d', {x}) => {x}   pd.Series({x}, index=['b', 'a']) => {x}   pd.DataFrame([{x}]) => [{x}]
        xr.DataArray({x}) => {x}   xr.DataArray([{x}]) => [{x}]   [5e-324, 0.0]   [1.7e308, -1.7e308]
        [1e200, 1e-200]   [1e-310, 5e-324]   [0.0, 0.0]   [-0.0, 1.0]   [1.0, 1.0]   [-3.0, -5.0]
        [1.0, 1.0 - 2**-53]   [1e-200, 1e-300]
        """
    ),
    # the argument of a compiled function of two inputs, and one coordinate of a curve
    "matrix": OTHERS
    + EMPTY
    + refused(
        """
        ['1.2', '0.8']   [1.2, '0.8']   np.array(['1.2', '0.8'])   [1.2, b'0.8']   '1.2'   1.2   [1.2]
        [1.2, 0.8, 1.0]   [[1.2, 0.8, 1.0]]   np.zeros((0, 2))   [[1.2], [0.8, 0.9]]   [1.2, None]   [1.2, True]
        [1.2, 1j]   np.array([1.2, 0.8 + 0j])   [1.2, pd.NA]   [1.2, 10**400]   [1.2, Fraction(10**400)]
        np.array([1.2, 10**400], dtype=object)   np.array([1, 2], dtype='m8[s]')
        np.array(['2020-01-01', 'NaT'], dtype='M8[D]')
        """
    )
    + taken(
        """
        (1.2, 0.8) => [1.2, 0.8]   np.array([1.2, 0.8], dtype='>f8') => [1.2, 0.8]   [2, 1] => [2.0, 1.0]
        np.array([[1.2, 9.0], [0.8, 9.0]])[:, 0] => [1.2, 0.8]   np.zeros((2, 0))
        np.float32([1.5, 1]) => [1.5, 1.0]
        """
    )
    + either(
        """
        np.ma.array([1.2, 0.8], mask=[0, 1]) => [1.2, np.nan]
        pd.array([1.2, None], dtype='Float64') => [1.2, np.nan]   pd.Series([1.2, 0.8]) => [1.2, 0.8]
        np.ma.array([1.2, 0.8]) => [1.2, 0.8]   [Decimal('1.2'), 0.8] => [1.2, 0.8]
        array('d', [1.2, 0.8]) => [1.2, 0.8]   [np.nan, 0.8]   [1.2, np.inf]   [1.2, -1.0]   [5e-324, 1.7e308]
        [1.2, -0.0]
        """
    ),
    "curve": OTHERS
    + refused(
        """
        ['1.2', '0.8', '1', '2']   [1.2, '0.8', 1, 2]   [b'1', 2, 3, 4]   [1.0, 2.0]   [[1.2], [0.8, 0.9]]
        [1.0, 2.0, 3.0]   [1.2, None, 1, 2]   [1.2, 1j, 1, 2]   [1.2, True, 1, 2]   [1.2, pd.NA, 1, 2]
        [1.2, 10**400, 1, 2]   np.array([1.2, 10**400, 1, 2], dtype=object)
        np.array([1, 2, 3, 4], dtype='m8[s]')
        """
    )
    + taken(
        """
        np.ma.array([1.2, 0.8, 1, 2], mask=[0, 1, 0, 0]) => [1.2, np.nan, 1.0, 2.0]
        pd.array([1.2, None, 1, 2], dtype='Float64') => [1.2, np.nan, 1.0, 2.0]
        (1, 2, 3, 5) => [1.0, 2.0, 3.0, 5.0]   range(4) => [0.0, 1.0, 2.0, 3.0]
        """
    )
    + either(
        """
        np.zeros((3, 0))   [] => np.array([])   [Decimal(1), 2, 3, 5] => [1.0, 2.0, 3.0, 5.0]   [np.nan] * 4
        [1e308, -1e308, 1e308, 0.0]   [5e-324, 0.0, 0.0, 0.0]   [np.inf, 0.0, 1.0, 2.0]
        [1e200, -1e200, 0.0, 1.0]   [1.7e308, 1e308, 1.7e308, 1.6e308]
        """
    ),
    # designs, and maps
    "space": OTHERS
    + EMPTY
    + refused(
        """
        1.0   [SPACE]   fl.DesignSpace   fl.grid   fl.grid()   [1.0, 2.0]   np.zeros((3, 4))   MAPS.omega4_max
        fl.DesignSpace('grid', (), ())   fl.DesignSpace('x', ('a2',), (3,))   fl.DesignSpace(1, 2, 3)
        fl.grid(a1=np.full(1, 0.4))   {'a1': 'x', 'a2': 1.2, 'a3': 0.8, 'a4': 1.0}   {'a1': {}}   {'a1': None}
        dict(a1=-0.4, a2=1.2, a3=0.8, a4=1.0, omega1=1.0)   dict(a1=True, a2=1.2, a3=0.8, a4=1.0, omega1=1.0)
        xr.Dataset({'a1': 0.4})   pd.DataFrame()   pd.Series({'a1': 0.4})   BARS   SPEED
        """
    ),
    "dataset": OTHERS
    + EMPTY
    + refused(
        """
        xr.Dataset(attrs={'designs': 'x'})   xr.Dataset({'status': 1})   [{x}]   SPACE   1.0   'no.h5'
        {'T41_fluctuation': 1}   {'T_x': 1, 'T_y': 2}
        """
    ),
}
