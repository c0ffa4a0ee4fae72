"""A Chromium without a window, for tests of pages."""

from __future__ import annotations

import contextlib
import os
import shutil
import warnings
from collections.abc import Iterator
from importlib.util import find_spec
from typing import Any

import pytest

__all__ = ["CHROMIUM", "PATIENCE", "chromium", "new_tab", "opened"]

#: What the browser is called, and the variable that names another.
NAMES, CHROMIUM = ("chromium", "chromium-browser", "google-chrome", "chrome"), "FASTLINK_CHROMIUM"
#: Milliseconds that a page may take on a busy machine.
PATIENCE = 60_000


@contextlib.contextmanager
def chromium() -> Iterator[Any]:
    """Yield a browser, or skip loudly where there is none."""
    found = os.environ.get(CHROMIUM) or next(filter(None, map(shutil.which, NAMES)), None)
    lacking = "playwright is not installed" if find_spec("playwright") is None else ""
    lacking = lacking or ("" if found else f"no Chromium is found (set {CHROMIUM}, or install chromium)")
    if lacking:
        warnings.warn(f"NOT TESTED: {lacking}", stacklevel=1)
        pytest.skip(lacking)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=["--no-sandbox", "--disable-gpu"])
        try:
            yield browser
        finally:
            browser.close()


@contextlib.contextmanager
def opened(browser: Any, address: str, **options: Any) -> Iterator[Any]:
    """Yield a tab that shows a page of `fastlink.explore`, and let no error in it pass."""
    with new_tab(browser, **options) as show:
        yield show(address)


@contextlib.contextmanager
def new_tab(browser: Any, **options: Any) -> Iterator[Any]:
    """Yield a function that shows a page in a tab, from its start, and returns the tab; let no error in it pass."""
    context = browser.new_context(
        **{"viewport": {"width": 1280, "height": 860}, "reduced_motion": "reduce", **options}
    )
    context.set_default_timeout(PATIENCE)
    tab, errors = context.new_page(), list[str]()
    tab.on("pageerror", lambda error: errors.append(str(error)))
    tab.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)

    def show(address: str) -> Any:
        tab.goto("about:blank")  # the same address with another view would be the same page
        tab.goto(address)
        tab.wait_for_selector("body[data-ready=yes]")
        return tab

    try:
        yield show
        assert not errors, errors
    finally:
        context.close()
