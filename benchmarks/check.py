"""``python -m benchmarks --check``: ratios of times that got worse than the committed record has them.

A ratio is of two things that were timed in turns in one run: ours to C, to a peer, or to a fixed piece of Python. What
looks worse is measured again, in further rounds of which the least counts: other load seldom slows one side alone.
"""

from collections.abc import Callable

from benchmarks import answers, c_kernel, extrema, focal, leave_out, minkowski, peers, table, whole

#: A ratio that is more than so many times the record's is worse.
WORSE = 1.1
#: How often a group is measured that holds something worse.
ROUNDS = 4


def of_answers(label):
    """Return the group of a request's times to an answer."""

    def measure():
        return answer_ratios([answers.row_of(label, repeats=2)])

    return measure


def ratios(facts):
    """Return by name what facts have of ratios of times, where less is better."""
    return {what: value for what, value, unit, _ in facts if unit == "" and " / " in what}


def answer_ratios(rows):
    """Return by name the ratios of times to an answer."""
    found = {}
    for row in rows:
        label = row["request"]
        for column, other in (
            ("to_heyoka", "/ heyoka.py"),
            ("to_fixed", "/ fixed work"),
            ("known_to_fixed", "from the cache / fixed work"),
        ):
            if row.get(column) is not None:
                found[f"set-up of {label}, {other}"] = row[column]
    return found


def groups() -> dict[str, Callable]:
    """Return what is measured together, by name."""
    found = {
        "curves and sampled extremes": table.ratios_to_c,
        "refined extremes": extrema.against_c,
        "scan in numba": peers.against_scan,
        "refined over sampled": whole.refined_over_sampled,
        "one assembly mode": whole.one_mode,
        "end to end": whole.end_to_end,
        "Minkowskian 4R": minkowski.times,
        "what is left out": leave_out.measure,
        "derivative": extrema.derivative,
    }
    if c_kernel.available():
        found |= {case.title: lambda case=case: focal.facts_of(case, 64, 360, 12) for case in focal.CASES}
    measured = {name: lambda part=part: ratios(part()) for name, part in found.items()}
    return measured | {f"set-up of {label}": of_answers(label) for label in answers.LABELS}


def recorded(record):
    """Return the ratios of a record by name."""
    found = ratios([(fact["fact"], fact["value"], fact["unit"], fact["aim"]) for fact in record["facts"]])
    found |= answer_ratios(record.get("answers", []))
    for row in record["cases"]:
        if row.get("to_C") is not None:
            found[f"{row['case']}, time / C"] = row["to_C"]
    return found


def worse(now, then):
    """Return the names of what is worse than recorded."""
    return [name for name, value in now.items() if name in then and value > WORSE * then[name]]


def check(record, measured, log=lambda text: None):
    """Return what got worse: by name, the ratio now and the one recorded.

    ``measured`` has functions that measure some ratios together, by the name of the group.
    """
    then, found = recorded(record), {}
    for group, measure in measured.items():
        log(group)
        now = measure()
        for _ in range(ROUNDS - 1):
            if not worse(now, then):
                break
            log(f"{group}, again: {', '.join(worse(now, then))}")
            again = measure()
            now = {name: min(value, again.get(name, value)) for name, value in now.items()}
        found |= {name: (now[name], then[name]) for name in worse(now, then)}
        for name in now.keys() - then.keys():
            log(f"not in the record: {name}")
    return found


def report_worse(record, log=lambda text: None, measured=None):
    """Print what got worse; return the exit status, 1 if anything did."""
    if record is None:
        print("no record to check against: run `python -m benchmarks` first")
        return 1
    found = check(record, groups() if measured is None else measured, log)
    for name, (now, then) in found.items():
        print(f"{name}: {now:.3g}, recorded {then:.3g}, {100 * (now / then - 1):.0f} % worse")
    if not found:
        print(f"nothing is more than {100 * (WORSE - 1):.0f} % worse than recorded")
    return 1 if found else 0
