"""Names that no quantity or input of a user can have."""

from __future__ import annotations

import re
from typing import Any

from fastlink._text import short_repr
from fastlink.errors import InputError
from fastlink.own.functions import HELPERS
from fastlink.symbolic.generate import NAMESPACE

__all__ = ["TAKEN", "check_name"]

#: Names of options and coordinates.
OPTIONS = (
    *("active", "refinement", "starts"),
    *(
        "allow_invalid",
        "angles",
        "angles_deg",
        "attrs",
        "backend",
        "block",
        "branch",
        "client",
        "design",
        "extrema",
    ),
    *(
        "extremum",
        "input",
        "inputs",
        "keep",
        "layout",
        "links",
        "mechanism",
        "n",
        "outputs",
        "overwrite",
        "part",
    ),
    *(
        "positions",
        "progress",
        "quantities",
        "restart",
        "seed",
        "solver",
        "space",
        "status",
        "threads",
        "to",
        "verify",
    ),
)
#: Names of variables and functions in the texts of kernels.
OF_KERNELS = (
    *("begin_certain", "collect_toggles", "flag_undecided", "keep_certain"),
    *("note_hidden", "note_uncertain", "settle_toggles"),
    *("collect_jumps", "forget_slopes", "forget_splits", "keep_slopes", "keep_splits", "mark_splits"),
    *("next_split", "place_split", "replace_cells", "splits"),
    *("bound_hidden", "count_turned", "keep_away", "keep_near", "keep_turned", "n_turned", "place_near"),
    *("abs", "advance_roots", "advance_valleys", "append_item", "append_of_lane", "append_unresolved"),
    *("array", "at", "begin_roots", "begin_valleys", "best", "bound_at_zero", "bound_ends"),
    *("bound_zeros", "clear", "collect", "collect_ends", "collect_fine", "collect_folds"),
    *("collect_octaves", "collect_rest", "collect_unresolved", "count_folded"),
    *("counts", "designs", "divide", "divided", "doubt", "drop_folds", "end_values", "ends", "entries"),
    *("every_vector", "extrema_at_zeros", "filled", "fine_marks", "flags", "flattened"),
    *("fluctuation_lanes", "forget_winners", "from_high", "from_low", "from_upper", "gather"),
    *("gradients", "has_no_bound", "i", "i0", "inf", "j", "j0", "j1", "j2", "judge_winners", "k"),
    *("keep_beside", "keep_beside_fold", "keep_fine", "keep_octave", "keep_slope", "kernel", "known"),
    *("lanes", "lists", "mark", "mark_ends", "mark_fine", "mark_unresolved", "marks", "max", "min"),
    *(
        "mirror_image",
        "n_angles",
        "n_designs",
        "n_ends",
        "n_here",
        "n_lost",
        "n_moving",
        "n_near",
        "n_octaves",
    ),
    *("n_open", "n_tries", "n_vectors", "nan", "note_kinks", "note_winners", "nothing_yet", "octaves"),
    *("of_better", "off_at_end", "outlined", "padded", "piece", "place_beside", "place_beside_fold"),
    *("place_ends", "place_fine", "place_lost", "place_octave", "place_samples", "place_slope"),
    *("begin_octaves", "weigh_octave"),
    *("position", "range", "rest", "roots", "samples", "set_bracket", "settle_jumps", "settle_noise"),
    *("settle_slopes", "side", "signs", "silence_rest", "silenced", "solve_lanes", "split", "square"),
    *("start", "state", "step", "store_best", "store_bound", "store_change", "store_counts"),
    *("store_extrema", "store_gradient", "store_list", "store_status", "sums", "table"),
    *("thin", "tile", "to_sample", "trial", "tries", "turn", "unresolved", "upper", "v", "valleys"),
    *("vectors", "w", "w2", "width", "winners"),
)
TAKEN = frozenset({*OPTIONS, *OF_KERNELS, *HELPERS, *NAMESPACE})
#: The beginnings of names that kernels make.
MADE = r"out_|whole_|(asked|columns|f|gradient|limit|part|rows|search|slope|split_by|value)_\d"
#: Letters of the longest name: results have endings, and files room for 255.
LONGEST = 60


def check_name(name: Any) -> None:
    """Refuse a name that no file or kernel could have.

    Examples
    --------
    >>> check_name("width")
    Traceback (most recent call last):
    fastlink.errors.InputError: 'width' is a word of fastlink's own; call it otherwise, such as 'my_width'
    """
    is_text = isinstance(name, str) and len(name) <= LONGEST
    if not (is_text and re.fullmatch("[A-Za-z](_?[A-Za-z0-9])*", name)):
        remedy = f"write up to {LONGEST} letters of a to z, digits and single underscores between them"
        raise InputError(f"{short_repr(name)} cannot be a name", remedy=remedy)
    if name in TAKEN or re.match(MADE, name):
        raise InputError(
            f"{name!r} is a word of fastlink's own", remedy=f"call it otherwise, such as 'my_{name}'"
        )
