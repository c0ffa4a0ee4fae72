"""Small study files that the tests of studies share."""

from pathlib import Path

GOOD = """
mechanism = "planar_4r"
quantities = ["omega4_max", "theta4"]
[design]
a1 = 0.4
a2 = {linspace = [1.0, 1.4, 3]}
a3 = {values = [0.8, 0.7]}
a4 = 1
omega1 = 25.0
[cycle]
theta1 = 8
"""
BARE = 'mechanism = "planar_4r"\nquantities = ["theta4"]\n'
LENGTHS = "a1 = 0.4\na2 = 1.2\na3 = 0.8\na4 = 1.0\n"


def written(text, name="study.toml"):
    path = Path(name)
    path.write_text(text, encoding="utf-8")
    return path
