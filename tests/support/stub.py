"""Write the type hints that name mechanisms, quantities and inputs, from the catalogues and the real signatures.

``python -m tests.support.stub`` writes ``src/fastlink/typing.pyi`` and ``src/fastlink/__init__.pyi``.
"""

from __future__ import annotations

import ast
import builtins
import inspect
import subprocess
import sys
import textwrap
from collections.abc import Iterable
from inspect import Parameter
from pathlib import Path
from typing import get_args

import fastlink
from fastlink import typing
from fastlink.codegen.kernel import BACKENDS
from fastlink.facts.catalogue import Catalogue
from fastlink.mechanisms import NAMES, inputs_of
from fastlink.mechanisms import catalogue as find_catalogue
from fastlink.plan.query import Extrema
from fastlink.space.units import usual_name

SOURCE = Path(fastlink.__file__).parent
RULES = Path(__file__).parents[2] / "pyproject.toml"
BY = "Written by `python -m tests.support.stub`; do not edit."
WIDTH = 110
#: Public functions with a signature for each mechanism, and those whose keywords are inputs of any mechanism.
BY_MECHANISM, OF_INPUTS = ("sweep", "evaluate", "function"), ("grid", "sobol", "latin_hypercube")


def literal(name: str) -> str:
    """Return the definition of a type of names: results are the quantities, and what is made of these."""
    of = name.replace("Result", "Quantity")
    known, start = ((), "") if of == name else (typing._members(of), f"{of} | ")
    text = ", ".join(f'"{one}"' for one in typing._members(name) if one not in known)
    line = f"{name}: TypeAlias = {start}Literal[{text}]"
    if len(line) <= WIDTH:
        return line
    listed = textwrap.fill(text, WIDTH - 4, break_on_hyphens=False)
    return f"{name}: TypeAlias = {start}Literal[\n{textwrap.indent(listed, '    ')}\n]  # fmt: skip"


#: The names that a stub reads from `typing` and from `fastlink.typing`.
OWN = {"Literal", "TypedDict", "Unpack", "overload", *typing.__all__}


def names_stub() -> str:
    """Return the text of ``fastlink/typing.pyi``."""
    definitions = [literal(name) for name in typing.__all__]
    listed = "".join(f'    "{name}",\n' for name in typing.__all__)
    head = f"# {BY}\n\nfrom typing import Literal, TypeAlias\n"
    return f"{head}\n__all__ = [\n{listed}]\n\n" + "\n".join(definitions) + "\n"


def imports_of(module: str) -> dict[str, str]:
    """Return the import statement of each name that a module imports, for type checkers too."""
    found = {}
    for node in ast.walk(ast.parse(inspect.getsource(sys.modules[module]))):
        for one in getattr(node, "names", ()) if isinstance(node, (ast.Import, ast.ImportFrom)) else ():
            start = f"from {node.module} " if isinstance(node, ast.ImportFrom) else ""
            renamed = f" as {one.asname}" if one.asname else ""
            found[one.asname or one.name] = f"{start}import {one.name}{renamed}"
    return found


def choice(members: Iterable[str]) -> str:
    """Return the type of a few texts."""
    return f"Literal[{', '.join(f'{chr(34)}{one}{chr(34)}' for one in members)}]"


def narrowed(parameter: Parameter, mechanism: str) -> str:
    """Return the annotation of a parameter, with names of a mechanism in place of any text."""
    plain = str(parameter.annotation)
    if not mechanism:
        return plain.replace("str", "MechanismName | str") if parameter.name == "mechanism" else plain
    kind = {"quantities": "Result", "inputs": "Input"}.get(parameter.name)
    if kind == "Result" and plain.startswith("Iterable"):
        kind = "Quantity"
    texts = {
        "mechanism": f'Literal["{mechanism}"]',
        "input": typing._alias(mechanism, "Driver"),
        "solver": choice(find_catalogue(mechanism).solvers),
        "extrema": choice(get_args(Extrema)),
        "backend": choice(BACKENDS),
    }
    if kind is not None:
        return f"{plain.replace('str', typing._alias(mechanism, kind))} | {plain}"
    plain = plain.replace(" | Extension", "")
    return plain.replace("str", texts[parameter.name]) if parameter.name in texts else plain


def signature_text(name: str, mechanism: str = "", *, extended: bool = False) -> str:
    """Return the signature of a public function as a stub has it; for one mechanism, if one is named.

    That for extended mechanisms takes further keywords of any name.
    """
    function = getattr(fastlink, name)
    signature = inspect.signature(function)
    lines, keyword_only, by_position = [], False, False
    for parameter in signature.parameters.values():
        if parameter.kind is Parameter.VAR_KEYWORD and extended:
            lines.append(f"**{parameter.name}: {parameter.annotation}")
            continue
        if parameter.kind is Parameter.VAR_KEYWORD:
            lines += ["/"] if by_position else []
            if not mechanism:  # each by itself, which all editors complete
                lines += [] if keyword_only else ["*"]
                taken, inputs = set(signature.parameters), inputs_of_any()
                lines += [f"{one}: {parameter.annotation} = ..." for one in inputs if one not in taken]
            lines.append(f"**{parameter.name}: Unpack[{keywords_type(parameter.name, mechanism)}]")
            continue
        if parameter.kind is Parameter.KEYWORD_ONLY and not keyword_only:
            keyword_only = True
            lines.append("*")
        if parameter.kind is not Parameter.POSITIONAL_ONLY and by_position:
            lines.append("/")
        by_position = parameter.kind is Parameter.POSITIONAL_ONLY
        hint = "Extension" if extended and parameter.name == "mechanism" else narrowed(parameter, mechanism)
        default = "" if parameter.default is Parameter.empty else " = ..."
        lines.append(f"{parameter.name}: {hint}{default}")
    listed = "".join(f"    {line},\n" for line in lines)
    return f"def {name}(\n{listed}) -> {signature.return_annotation}: ..."


def keywords_type(parameter: str, mechanism: str) -> str:
    """Return the name of the type of further keywords of a function."""
    kind = "Positions" if parameter == "positions" else "Inputs"
    return f"_{typing._alias(mechanism, kind)}" if mechanism else "_InUnits"


def keywords_types() -> str:
    """Return the definitions of the types of further keywords: inputs in SI and in their usual units."""
    wanted = [("inputs", ""), *((kind, name) for name in NAMES for kind in ("inputs", "positions"))]
    texts = []
    for parameter, mechanism in wanted:
        name, names = keywords_type(parameter, mechanism), keywords_of(parameter, mechanism)
        listed = textwrap.fill(", ".join(f'"{one}": Any' for one in names), WIDTH - 4, break_on_hyphens=False)
        inside = textwrap.indent(listed, "    ")
        texts.append(f'{name} = TypedDict("{name}", {{\n{inside}\n}}, total=False)  # fmt: skip')
    return "\n".join(texts)


def catalogues_of(mechanism: str) -> list[Catalogue]:
    """Return the catalogues of a mechanism, or of all, by whatever drives."""
    names = [mechanism] if mechanism else NAMES
    return [find_catalogue(name, driver) for name in names for driver in inputs_of(name)]


def inputs_of_any() -> list[str]:
    """Return the inputs of the designs of all mechanisms."""
    known = (one.known_inputs(one.variant_inputs) for one in catalogues_of(""))
    return list(dict.fromkeys(name for inputs in known for name in inputs))


def keywords_of(parameter: str, mechanism: str) -> list[str]:
    """Return the names that stand for further keywords of a function; of those of any mechanism the ones with units."""
    found = (one.variables.items() for one in catalogues_of(mechanism))
    units = {name: given.units for items in found for name, given in items}
    names = inputs_of(mechanism) if parameter == "positions" else units if mechanism else inputs_of_any()
    in_units = [usual_name(name, units[name]) for name in names]
    return list(
        dict.fromkeys([*names, *in_units] if mechanism else [one for one in in_units if one not in units])
    )


def stub() -> str:
    """Return the text of ``fastlink/__init__.pyi``."""
    tree = ast.parse((SOURCE / "__init__.py").read_text(encoding="utf-8"))
    (block,) = [node for node in tree.body if isinstance(node, ast.If)]
    written, imports, kept = [], set(), []
    for statement in block.body:
        (one,) = statement.names
        if one.name in BY_MECHANISM:
            texts = [f"@overload\n{signature_text(one.name, mechanism)}" for mechanism in NAMES]
            texts.append(f"@overload\n{signature_text(one.name, extended=True)}")
        elif one.name in OF_INPUTS or one.name == "quantities":
            texts = [signature_text(one.name)]
        else:
            kept.append(ast.unparse(statement))
            continue
        written += texts
        known = imports_of(statement.module)
        read = {node.id for text in texts for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name)}
        own = {*dir(builtins), *OWN, *fastlink.__all__}
        imports |= {known.get(name) or _own(name, statement.module) for name in read - own}
    aliases = ", ".join(sorted(typing.__all__))
    names = "".join(f'    "{one}",\n' for one in sorted(fastlink.__all__))
    head = f"# {BY}\n# ruff: noqa: UP013\n\nfrom typing import Literal, TypedDict, Unpack, overload\n\n"
    used = "\n".join(sorted(filter(None, imports)))
    return (
        f"{head}{used}\n" + "\n".join(kept) + f"\nfrom fastlink.typing import {aliases}\n\n"
        f"__all__ = [\n{names}]\n\n{keywords_types()}\n\n" + "\n".join(written) + "\n"
    )


def _own(name: str, module: str) -> str:
    """Return the import of a name that a module defines itself; empty for builtins."""
    return f"from {module} import {name}" if hasattr(sys.modules[module], name) else ""


def files() -> dict[Path, str]:
    """Return the text of each file, formatted as the other sources."""
    texts = {SOURCE / "typing.pyi": names_stub(), SOURCE / "__init__.pyi": stub()}
    for path, text in texts.items():
        for command in (["check", "--fix-only", "--quiet", "--select", "I,F401"], ["format", "--quiet"]):
            # by the project's rules, wherever the package is installed
            options = ["--config", str(RULES), "--stdin-filename", str(path), "-"]
            done = subprocess.run(
                [sys.executable, "-m", "ruff", *command, *options],
                input=text,
                capture_output=True,
                check=False,
                encoding="utf-8",
            )
            assert done.returncode == 0, done.stderr
            text = done.stdout
        texts[path] = text
    return texts


if __name__ == "__main__":
    for path, text in files().items():
        path.write_text(text, encoding="utf-8")
