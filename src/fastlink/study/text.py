"""The text of a study file, and what is said to files that are something else."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from fastlink._text import size
from fastlink.errors import InputError, Problem
from fastlink.io.reader import is_hdf5
from fastlink.options import not_a_file
from fastlink.study.schema import A_STUDY
from fastlink.study.wording import StudyWording

__all__ = ["contents_of", "text_of"]

#: Bytes of a study at most: tables of designs have files of their own.
LONGEST = 16 << 20
#: The remedy for what is not TOML.
TOML = "a study has lines `key = value` under heads such as [design]; `fastlink new planar_4r` prints one"
#: Endings of other files, and the text that they begin with, by what they hold.
OTHERS = (
    ("JSON", (".json",), re.compile(r"\s*\{")),
    ("YAML", (".yaml", ".yml"), re.compile(r"(\s*#.*\n|\s*\n|---\n)*[A-Za-z_]\w*:(\s|$)")),
)
TABLE = re.compile(r"[^=\[\n]*,[^=\[\n]*(\n|$)")


def text_of(path: Path) -> str:
    """Return the text of a study, or refuse what is no file of text.

    Raises
    ------
    InputError
        It is a folder, a device, a map, too long, or cannot be read.
    """
    try:
        length = path.stat().st_size
        if other := not_a_file(path):
            raise _refused(path, f"{other}, not a study", A_STUDY)
        if is_hdf5(path):
            raise _refused(path, "is a map, not a study", f"`fastlink info {path}` shows it")
        if length > LONGEST:
            remedy = 'keep designs in a CSV or Parquet file: [design] table = "designs.csv"'
            raise _refused(path, f"has {size(length)}, too long for a study", remedy)
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        what = f"is not UTF-8 text ({error.reason} at byte {error.start})"
        raise _refused(path, what, "save it as UTF-8") from None
    except InputError:
        raise
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        why = getattr(error, "strerror", None) or str(error)
        raise _refused(path, f"cannot be read ({why})", A_STUDY) from None


def contents_of(path: Path, text: str) -> dict[str, Any]:
    """Return the contents of a study as TOML, or say what its text is instead.

    Raises
    ------
    InputError
        With the line of the fault.
    """
    try:
        contents = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        for language, endings, beginning in OTHERS:
            if path.suffix.lower() in endings or beginning.match(text):
                raise _refused(path, f"is {language}, not TOML", TOML) from None
        if path.suffix.lower() in (".csv", ".tsv") or TABLE.match(text):
            remedy = f'name it in one: [design] table = "{path.name}"'
            raise _refused(path, "is a table of designs, not a study", remedy) from None
        raise _refused(path, f"is not TOML: {error}", TOML) from None
    if not contents:
        raise _refused(path, "is empty", A_STUDY)
    return contents


def _refused(path: Path, what: str, remedy: str) -> InputError:
    return InputError.of([Problem(what, ("study",), remedy)], StudyWording(path))
