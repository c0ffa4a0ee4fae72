"""Dimensional synthesis: from a task to all linkages that do it, or to the best.

A linkage that is found is a row of a labelled dataset along ``design``, see `fastlink.synthesise`: the lengths ``a1``
to ``a4``, the coupler point ``P_u``, ``P_v`` along and across AB, the fixed pivot ``O_x``, ``O_y`` and the direction
``ground_angle`` of OD in the frame of the task, the ``branch``, and the crank angles ``theta1`` at the points of the
task, from the ground link. Inside, many of them are one `fastlink.synthesis.found.Linkages`.
"""
