"""The text of derivatives by inputs of extremes that are known: where the greatest or the least of the candidates is.

Which of them that is, how near the next best comes and what derivatives are worth there is as in a search, see
`fastlink.codegen.runtime.winners`. They are evaluated once, at the place of the best in each lane.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fastlink.codegen.known import Candidate, KnownWriter
    from fastlink.plan.program import ExtremumSearch

__all__ = ["kind_at_end", "write_gradients"]

#: What is known of the best candidate: its value, input position, place and kind, where that is, and the next best.
FIRST = {"best": "-inf", "place": "nan", "x": "nan", "upper": "0.0", "kind": "nan", "mirrored": "0.0"}
FIRST |= {"branch": "1.0", "side": "1.0", "second": "-inf"}


def kind_at_end(writer: KnownWriter, search: ExtremumSearch, value: str, rests: str) -> str:
    """Return the kind of an extreme at an end of the range: 0 at limits of motion, else 1 or, where an angle folds, 2.

    Driven past 0 or pi an angle from 0 to pi turns back there, whatever the lengths: its extreme is one or the other.
    """
    if not search.folds:
        return f"(1.0 if {rests} else 0.0)"
    writer.text.use("codegen.runtime.winners", "FOLD")
    writer.text.use("numerics.elementary", "PI")
    folded = f"({value} < FOLD) | ({value} > PI - FOLD)"
    return f"(2.0 if {folded} else (1.0 if {rests} else 0.0))"


def write_gradients(
    writer: KnownWriter, search: ExtremumSearch, candidates: Sequence[Candidate], sign: int, label: str
) -> dict[tuple[str, bool] | str, str]:
    """Write the derivatives of a greatest or least value and of its place.

    Returns
    -------
    dict
        The values' names: by input and whether it is that of the place, and by an empty text the code of their status.
    """
    best = {key: f"{key}__of__{label}" for key in FIRST}
    for key, name in best.items():
        writer.text.add(f"{name} = {FIRST[key]}")
    for candidate in candidates:
        _write_candidate(writer, candidate, sign, best)
    code, at_limit = _write_code(writer, best, label)
    endings = _write_place(writer, best, at_limit, label)
    found: dict[tuple[str, bool] | str, str] = {"": code}
    known = f"(({code} <= TIED) | ({code} == CONSTANT))"
    for gradient in search.gradients:
        *held, moving = [*writer.values_at(gradient.held, label, endings), "0.0"]
        if gradient.moving:
            (moving,) = writer.values_at((gradient.moving,), label, endings)
        quotient = gradient.is_position and bool(held)
        still = f"-({held[0]} / {held[1]})" if quotient else (held or ["0.0"])[0]
        turned = gradient.is_position or search.parity < 0
        name = f"slope_{'of_place' if gradient.is_position else 'of_value'}_{gradient.by}__{label}"
        writer.text.add(f"{name} = {moving} if {at_limit} else {still}")
        if turned:
            writer.text.add(f"{name} = -{name} if {best['mirrored']} > 0.0 else {name}")
        none = "nan" if gradient.is_position else f"(0.0 if {code} == JUMP else nan)"
        writer.text.add(f"{name} = {name} if {known} else {none}")
        found[gradient.by, gradient.is_position] = name
    return found


def _write_candidate(writer: KnownWriter, candidate: Candidate, sign: int, best: dict[str, str]) -> None:
    """Write whether a candidate is better than the best so far, and what is kept then."""
    text, at, half = writer.text, candidate.at, candidate.half
    text.use("codegen.runtime.winners", "SAME")
    text.use("numerics.elementary", "TWO_PI")
    text.add(f"high = {candidate.greatest}" if sign > 0 else f"high = -({candidate.least})")
    text.add(f"apart = abs({candidate.place} - {best['place']})")
    text.add("same = (apart < SAME) | (abs(apart - TWO_PI) < SAME)")
    text.add("differs = (apart >= SAME) & (abs(apart - TWO_PI) >= SAME)")
    text.add(f"better = high > {best['best']}")
    second = best["second"]
    other = f"(high if (high > {second}) & differs else {second})"
    text.add(f"{second} = ({second} if same else {best['best']}) if better else {other}")
    writer.write_place(at)
    values = {
        "best": "high",
        "place": candidate.place,
        "x": f"x__{at}",
        "upper": writer.is_upper(at),
        "kind": candidate.kind,
        "mirrored": f"{int(half.mirrored)}.0",
        "branch": f"{half.branch}.0",
        "side": f"{half.side}.0",
    }
    for key, value in values.items():
        text.add(f"{best[key]} = {value} if better else {best[key]}")


def _write_code(writer: KnownWriter, best: dict[str, str], label: str) -> tuple[str, str]:
    """Write what derivatives are worth, and whether they are those at a limit of motion; return their names."""
    text, code, at_limit = writer.text, f"code__{label}", f"at_limit__{label}"
    codes = ("AT_CHANGE_POINT", "AT_LIMIT", "CONSTANT", "JUMP", "NOTHING", "SMOOTH", "TIED")
    text.use("numerics.gradient_status", *codes)
    text.use("codegen.runtime.winners", "TIE")
    text.use("codegen.runtime.results", "FOLDED")
    (_, low, toggle_low), (_, high, toggle_high) = writer.program.graded.ends
    text.add(f"first__{label} = abs({high} if {best['upper']} > 0.0 else {low})")
    text.add(f"toggle__{label} = ({toggle_high} if {best['upper']} > 0.0 else {toggle_low}) > 0.0")
    text.add(f"no_toggle__{label} = ({toggle_high} if {best['upper']} > 0.0 else {toggle_low}) == 0.0")
    kind, value = best["kind"], best["best"]
    beside = f"(({kind} == 0.0) | ({best['x']} < FOLDED * first__{label}))"
    text.add(f"{code} = 1.0 * AT_LIMIT if {kind} == 0.0 else 1.0 * SMOOTH")
    text.add(f"{code} = 1.0 * TIED if {best['second']} >= {value} - TIE * abs({value}) else {code}")
    text.add(f"{code} = 1.0 * CONSTANT if ({kind} == 0.0) & no_toggle__{label} else {code}")
    text.add(
        f"{code} = 1.0 * AT_CHANGE_POINT if (first__{label} > 0.0) & no_toggle__{label} & {beside} else {code}"
    )
    text.add(f"{code} = 1.0 * JUMP if {kind} == 2.0 else {code}")
    text.add(f"{code} = {code} if {kind} == {kind} else 1.0 * NOTHING")
    text.add(f"{at_limit} = ({kind} == 0.0) & (({code} < CONSTANT) | ({code} > CONSTANT))")
    return code, at_limit


def _write_place(writer: KnownWriter, best: dict[str, str], at_limit: str, label: str) -> dict[str, str]:
    """Write the place of the best in each lane, at limits beside them; return the endings of names there."""
    text, (low, high, side), first = writer.text, writer.program.coordinates, f"first__{label}"
    x = best["x"]
    text.add(f"x__{label} = {first} if {at_limit} & ({x} < {first}) else {x}")
    writer.write_parts(label, f"{best['upper']} > 0.0", (low, high))
    text.add(f"{side}__{label} = {best['side']}")
    text.add(f"branch__{label} = {best['branch']}")
    return {"branch": label, "side": label}
