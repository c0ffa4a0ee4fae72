"""Stiff and extreme cases of every mechanism: tables of named cases, one runner (`extreme.runner`), one report.

``cd tests && python -m extreme`` prints the report: by case what came out and the worst error.
"""
