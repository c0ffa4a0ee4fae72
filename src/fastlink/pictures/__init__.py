"""Pictures: of maps, of designs against each other, of linkages, and the page that explores a map.

`maps`, `designs`, `draw` and `explore` are the doors, which need no matplotlib to be imported; the others draw.
"""
