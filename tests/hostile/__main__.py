"""Run lines of cases as they stand: ``python -m tests.hostile "fl.grid(a1=10**400)"``."""

import os
import sys
import tempfile

from tests.hostile.campaign import namespace
from tests.hostile.judge import plain_of

with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    names = namespace()
    for line in sys.argv[1:]:
        print(plain_of(eval(line, names)))
