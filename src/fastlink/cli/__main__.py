"""Run the command line by ``python -m fastlink.cli``."""

from fastlink.cli import main

main()
