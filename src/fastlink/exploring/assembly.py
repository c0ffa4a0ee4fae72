"""Put the page together: one file, with its styles, its scripts and what it has to know of a map."""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

from fastlink._text import filled

__all__ = ["page_of"]

#: The scripts, each after those that it needs.
SCRIPTS = (
    "base",
    "motion",
    "linkage",
    "map",
    "source",
    "embedded",
    "region",
    "designs",
    "pointing",
    "main",
    "end",
)


def page_of(content: dict[str, Any], nonce: str = "") -> str:
    """Return the page of a map.

    Parameters
    ----------
    content : dict
        What `fastlink.exploring.content.content_of` says, and how the page gets its values.
    nonce : str
        The random text that lets a browser run the page's own script, and no other.
    """
    folder = files("fastlink").joinpath("exploring", "page")

    def text(name: str) -> str:
        return folder.joinpath(name).read_text(encoding="utf-8")

    mechanism = content["mechanism"]
    facts = mechanism["script"] if mechanism else "{}"
    told = {**content, "mechanism": mechanism and {**mechanism, "script": ""}}
    # a text of the map must not end the script
    data = json.dumps(told, allow_nan=False).replace("<", "\\u003c")
    scripts = [filled(text(f"{name}.js"), {"/*FACTS*/": facts}) for name in SCRIPTS]
    script = "\n".join([f"const content = {data};", *scripts])
    return filled(text("page.html"), {"NONCE": nonce, "/*STYLE*/": text("style.css"), "/*SCRIPT*/": script})
