"""From maps to mechanisms: the best designs of a map, their refinement by derivatives, searches without a map.

`descent` knows numbers alone; what gives them is in `model`, which runs compiled functions. What may enter: whatever
looks for designs. It stands above the engine and below studies.
"""
