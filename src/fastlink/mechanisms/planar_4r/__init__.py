"""The Euclidean planar 4R of Hayes, Hninn and Irani."""

from fastlink.mechanisms.planar_4r import dense, design_facts, forces, links, position, rates
from fastlink.mechanisms.planar_4r.declare import planar_4r

__all__ = ["dense", "design_facts", "forces", "links", "planar_4r", "position", "rates"]

planar_4r.check()
