"""Convert finished maps: other formats, compressed, in part, with fewer digits; block by block.

Nothing here computes a quantity; whoever reads a converted file learns from its attributes what it holds of which map.
"""
