"""Functions of whole designs and of maps: coupler curves, cognates, balancing, sextics, designs in whole numbers.

Public as `fastlink.planar`, `fastlink.minkowski`, `fastlink.focal` and `fastlink.hart`.
"""
