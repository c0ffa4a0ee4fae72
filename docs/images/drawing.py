"""The pictures of docs/drawing.md, by its own commands: ``python docs/images/drawing.py``."""

import re
import shlex
import subprocess
import tempfile
from pathlib import Path

from PIL import Image

HERE = Path(__file__).parent
WIDTH, COLOURS = 840, 40
page = (HERE.parent / "drawing.md").read_text()
blocks = re.findall(r"^```sh\n(.*?)^```", page, flags=re.MULTILINE | re.DOTALL)
shown = set(re.findall(r"images/(\w+\.png)", page))
with tempfile.TemporaryDirectory() as folder:
    for line in "".join(blocks).splitlines():
        if shlex.split(line)[-1] in shown:
            subprocess.run(line, shell=True, cwd=folder, check=True)
    for name in sorted(shown):
        with Image.open(Path(folder, name)) as picture:
            small = picture.convert("RGB")
            small.thumbnail((WIDTH, 10 * WIDTH), Image.Resampling.LANCZOS)
            small.quantize(COLOURS).save(HERE / name, optimize=True)
