"""Functions of whole designs and of maps, such as coupler curves and cognates.

Public as `fastlink.planar`, `fastlink.minkowski`, `fastlink.focal` and `fastlink.hart`.
"""
