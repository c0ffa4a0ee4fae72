# Written by `python -m tests.support.stub`; do not edit.
# ruff: noqa: UP013

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, TypedDict, Unpack, overload

import xarray as xr
from distributed import Client
from numpy.typing import ArrayLike

from fastlink import focal as focal
from fastlink import hart as hart
from fastlink import minkowski as minkowski
from fastlink import planar as planar
from fastlink._text import __version__ as __version__
from fastlink.app.accuracy import accuracy as accuracy
from fastlink.app.explain import explain as explain
from fastlink.app.report import QuantityList
from fastlink.app.study import run as run
from fastlink.app.tolerance import tolerance as tolerance
from fastlink.design.best import best as best
from fastlink.design.search import join as join
from fastlink.design.search import search as search
from fastlink.engine.extend import Extension
from fastlink.engine.extend import extend as extend
from fastlink.engine.function import Function
from fastlink.errors import InputError as InputError
from fastlink.errors import InputWarning as InputWarning
from fastlink.io.convert import convert as convert
from fastlink.io.reader import check as check
from fastlink.maps import open as open
from fastlink.mechanisms import mechanism as mechanism
from fastlink.mechanisms.linkage import linkage as linkage
from fastlink.mechanisms.listing import mechanisms as mechanisms
from fastlink.pictures.designs import plot as plot
from fastlink.pictures.draw import draw as draw
from fastlink.pictures.explore import explore as explore
from fastlink.space.design_space import DesignSpace as DesignSpace
from fastlink.space.design_space import Links
from fastlink.space.design_space import round_bar as round_bar
from fastlink.space.tables import table as table
from fastlink.synthesis.found import synthesise as synthesise
from fastlink.typing import (
    FocalDriver,
    FocalInput,
    FocalQuantity,
    FocalResult,
    HartDriver,
    HartInput,
    HartQuantity,
    HartResult,
    MechanismName,
    Minkowski4rDriver,
    Minkowski4rInput,
    Minkowski4rQuantity,
    Minkowski4rResult,
    Planar4rDriver,
    Planar4rInput,
    Planar4rQuantity,
    Planar4rResult,
    SliderCrankDriver,
    SliderCrankInput,
    SliderCrankQuantity,
    SliderCrankResult,
)

__all__ = [
    "DesignSpace",
    "InputError",
    "InputWarning",
    "__version__",
    "accuracy",
    "best",
    "check",
    "convert",
    "draw",
    "evaluate",
    "explain",
    "explore",
    "extend",
    "focal",
    "function",
    "grid",
    "hart",
    "join",
    "latin_hypercube",
    "linkage",
    "mechanism",
    "mechanisms",
    "minkowski",
    "open",
    "planar",
    "plot",
    "quantities",
    "round_bar",
    "run",
    "search",
    "sobol",
    "sweep",
    "synthesise",
    "table",
    "tolerance",
]

_InUnits = TypedDict("_InUnits", {
    "a1_mm": Any, "a2_mm": Any, "a3_mm": Any, "a4_mm": Any, "omega1_rpm": Any, "P_u_mm": Any, "P_v_mm": Any,
    "m1_g": Any, "I1_kg_mm2": Any, "G1_u_mm": Any, "G1_v_mm": Any, "m2_g": Any, "I2_kg_mm2": Any, "G2_u_mm":
    Any, "G2_v_mm": Any, "m3_g": Any, "I3_kg_mm2": Any, "G3_u_mm": Any, "G3_v_mm": Any, "FP_x_kN": Any,
    "FP_y_kN": Any, "T_load_Nmm": Any, "M_x_mm": Any, "M_y_mm": Any, "counterweight1_mass_g": Any,
    "counterweight1_radius_mm": Any, "counterweight1_direction_deg": Any, "counterweight3_mass_g": Any,
    "counterweight3_radius_mm": Any, "counterweight3_direction_deg": Any, "density_g_cm3": Any, "radius_mm":
    Any, "arc_start_deg": Any, "arc_end_deg": Any, "joint_omega_1_rpm": Any, "joint_omega_2_rpm": Any,
    "joint_omega_3_rpm": Any, "joint_omega_4_rpm": Any, "a_mm": Any, "b_mm": Any, "g_mm": Any, "h_mm": Any,
    "x_mm": Any, "y_mm": Any, "c_mm": Any, "d_mm": Any, "omega_rpm": Any, "s_mm": Any, "m_mm": Any, "n_mm":
    Any, "r_mm": Any, "l_mm": Any, "e_mm": Any, "F_load_kN": Any
}, total=False)  # fmt: skip
_Planar4rInputs = TypedDict("_Planar4rInputs", {
    "a1": Any, "a2": Any, "a3": Any, "a4": Any, "omega1": Any, "P_u": Any, "P_v": Any, "m1": Any, "I1": Any,
    "G1_u": Any, "G1_v": Any, "m2": Any, "I2": Any, "G2_u": Any, "G2_v": Any, "m3": Any, "I3": Any, "G3_u":
    Any, "G3_v": Any, "gravity_x": Any, "gravity_y": Any, "FP_x": Any, "FP_y": Any, "T_load": Any,
    "T_load_linear": Any, "T_load_quadratic": Any, "M_x": Any, "M_y": Any, "counterweight1_mass": Any,
    "counterweight1_radius": Any, "counterweight1_direction": Any, "counterweight3_mass": Any,
    "counterweight3_radius": Any, "counterweight3_direction": Any, "alpha1": Any, "density": Any, "radius":
    Any, "arc_start": Any, "arc_end": Any, "theta1": Any, "joint_omega_1": Any, "joint_angle_1": Any,
    "joint_omega_2": Any, "joint_angle_2": Any, "joint_omega_3": Any, "joint_angle_3": Any, "joint_omega_4":
    Any, "joint_angle_4": Any, "a1_mm": Any, "a2_mm": Any, "a3_mm": Any, "a4_mm": Any, "omega1_rpm": Any,
    "P_u_mm": Any, "P_v_mm": Any, "m1_g": Any, "I1_kg_mm2": Any, "G1_u_mm": Any, "G1_v_mm": Any, "m2_g": Any,
    "I2_kg_mm2": Any, "G2_u_mm": Any, "G2_v_mm": Any, "m3_g": Any, "I3_kg_mm2": Any, "G3_u_mm": Any,
    "G3_v_mm": Any, "FP_x_kN": Any, "FP_y_kN": Any, "T_load_Nmm": Any, "M_x_mm": Any, "M_y_mm": Any,
    "counterweight1_mass_g": Any, "counterweight1_radius_mm": Any, "counterweight1_direction_deg": Any,
    "counterweight3_mass_g": Any, "counterweight3_radius_mm": Any, "counterweight3_direction_deg": Any,
    "density_g_cm3": Any, "radius_mm": Any, "arc_start_deg": Any, "arc_end_deg": Any, "theta1_deg": Any,
    "joint_omega_1_rpm": Any, "joint_angle_1_deg": Any, "joint_omega_2_rpm": Any, "joint_angle_2_deg": Any,
    "joint_omega_3_rpm": Any, "joint_angle_3_deg": Any, "joint_omega_4_rpm": Any, "joint_angle_4_deg": Any
}, total=False)  # fmt: skip
_Planar4rPositions = TypedDict("_Planar4rPositions", {
    "theta1": Any, "joint_angle_1": Any, "joint_angle_2": Any, "joint_angle_3": Any, "joint_angle_4": Any,
    "theta1_deg": Any, "joint_angle_1_deg": Any, "joint_angle_2_deg": Any, "joint_angle_3_deg": Any,
    "joint_angle_4_deg": Any
}, total=False)  # fmt: skip
_Minkowski4rInputs = TypedDict("_Minkowski4rInputs", {
    "a": Any, "b": Any, "g": Any, "h": Any, "x": Any, "y": Any, "tolerance": Any, "theta": Any, "a_mm": Any,
    "b_mm": Any, "g_mm": Any, "h_mm": Any, "x_mm": Any, "y_mm": Any
}, total=False)  # fmt: skip
_Minkowski4rPositions = TypedDict("_Minkowski4rPositions", {
    "theta": Any
}, total=False)  # fmt: skip
_FocalInputs = TypedDict("_FocalInputs", {
    "a": Any, "b": Any, "c": Any, "d": Any, "rho": Any, "completion": Any, "omega": Any, "s": Any, "lambda_":
    Any, "arc_start": Any, "arc_end": Any, "phi": Any, "sigma": Any, "a_mm": Any, "b_mm": Any, "c_mm": Any,
    "d_mm": Any, "omega_rpm": Any, "s_mm": Any, "arc_start_deg": Any, "arc_end_deg": Any, "phi_deg": Any,
    "sigma_deg": Any
}, total=False)  # fmt: skip
_FocalPositions = TypedDict("_FocalPositions", {
    "phi": Any, "sigma": Any, "phi_deg": Any, "sigma_deg": Any
}, total=False)  # fmt: skip
_HartInputs = TypedDict("_HartInputs", {
    "m": Any, "n": Any, "d": Any, "kappa": Any, "arc_start": Any, "arc_end": Any, "phi": Any, "F_y": Any,
    "m_mm": Any, "n_mm": Any, "d_mm": Any, "arc_start_deg": Any, "arc_end_deg": Any, "phi_deg": Any, "F_y_mm":
    Any
}, total=False)  # fmt: skip
_HartPositions = TypedDict("_HartPositions", {
    "phi": Any, "F_y": Any, "phi_deg": Any, "F_y_mm": Any
}, total=False)  # fmt: skip
_SliderCrankInputs = TypedDict("_SliderCrankInputs", {
    "r": Any, "l": Any, "e": Any, "omega": Any, "m1": Any, "I1": Any, "G1_u": Any, "G1_v": Any, "m2": Any,
    "I2": Any, "G2_u": Any, "G2_v": Any, "m3": Any, "F_load": Any, "density": Any, "radius": Any, "arc_start":
    Any, "arc_end": Any, "theta": Any, "r_mm": Any, "l_mm": Any, "e_mm": Any, "omega_rpm": Any, "m1_g": Any,
    "I1_kg_mm2": Any, "G1_u_mm": Any, "G1_v_mm": Any, "m2_g": Any, "I2_kg_mm2": Any, "G2_u_mm": Any,
    "G2_v_mm": Any, "m3_g": Any, "F_load_kN": Any, "density_g_cm3": Any, "radius_mm": Any, "arc_start_deg":
    Any, "arc_end_deg": Any, "theta_deg": Any
}, total=False)  # fmt: skip
_SliderCrankPositions = TypedDict("_SliderCrankPositions", {
    "theta": Any, "theta_deg": Any
}, total=False)  # fmt: skip

def quantities(
    mechanism: MechanismName | str | Extension | None = ...,
    internal: bool = ...,
    input: str | None = ...,
    *,
    find: str | None = ...,
) -> QuantityList: ...
@overload
def evaluate(
    mechanism: Literal["planar_4r"],
    quantities: Iterable[Planar4rQuantity] | Iterable[str],
    *,
    branch: Any = ...,
    links: Links | None = ...,
    input: Planar4rDriver | None = ...,
    solver: Literal["eliminated", "dense"] = ...,
    allow_invalid: bool = ...,
    **inputs: Unpack[_Planar4rInputs],
) -> dict[str, Any]: ...
@overload
def evaluate(
    mechanism: Literal["minkowski_4r"],
    quantities: Iterable[Minkowski4rQuantity] | Iterable[str],
    *,
    branch: Any = ...,
    links: Links | None = ...,
    input: Minkowski4rDriver | None = ...,
    solver: Literal["eliminated"] = ...,
    allow_invalid: bool = ...,
    **inputs: Unpack[_Minkowski4rInputs],
) -> dict[str, Any]: ...
@overload
def evaluate(
    mechanism: Literal["focal"],
    quantities: Iterable[FocalQuantity] | Iterable[str],
    *,
    branch: Any = ...,
    links: Links | None = ...,
    input: FocalDriver | None = ...,
    solver: Literal["eliminated"] = ...,
    allow_invalid: bool = ...,
    **inputs: Unpack[_FocalInputs],
) -> dict[str, Any]: ...
@overload
def evaluate(
    mechanism: Literal["hart"],
    quantities: Iterable[HartQuantity] | Iterable[str],
    *,
    branch: Any = ...,
    links: Links | None = ...,
    input: HartDriver | None = ...,
    solver: Literal["eliminated"] = ...,
    allow_invalid: bool = ...,
    **inputs: Unpack[_HartInputs],
) -> dict[str, Any]: ...
@overload
def evaluate(
    mechanism: Literal["slider_crank"],
    quantities: Iterable[SliderCrankQuantity] | Iterable[str],
    *,
    branch: Any = ...,
    links: Links | None = ...,
    input: SliderCrankDriver | None = ...,
    solver: Literal["eliminated"] = ...,
    allow_invalid: bool = ...,
    **inputs: Unpack[_SliderCrankInputs],
) -> dict[str, Any]: ...
@overload
def evaluate(
    mechanism: Extension,
    quantities: Iterable[str],
    *,
    branch: Any = ...,
    links: Links | None = ...,
    input: str | None = ...,
    solver: str = ...,
    allow_invalid: bool = ...,
    **inputs: Any,
) -> dict[str, Any]: ...
@overload
def function(
    mechanism: Literal["planar_4r"],
    inputs: Sequence[Planar4rInput] | Sequence[str],
    quantities: Sequence[Planar4rResult] | Sequence[str],
    *,
    links: Links | None = ...,
    input: Planar4rDriver | None = ...,
    angles: int | ArrayLike | None = ...,
    branch: int | Sequence[int] = ...,
    solver: Literal["eliminated", "dense"] = ...,
    extrema: Literal["refined", "sampled"] | None = ...,
    backend: Literal["llvm", "numba"] | None = ...,
    **fixed: Unpack[_Planar4rInputs],
) -> Function: ...
@overload
def function(
    mechanism: Literal["minkowski_4r"],
    inputs: Sequence[Minkowski4rInput] | Sequence[str],
    quantities: Sequence[Minkowski4rResult] | Sequence[str],
    *,
    links: Links | None = ...,
    input: Minkowski4rDriver | None = ...,
    angles: int | ArrayLike | None = ...,
    branch: int | Sequence[int] = ...,
    solver: Literal["eliminated"] = ...,
    extrema: Literal["refined", "sampled"] | None = ...,
    backend: Literal["llvm", "numba"] | None = ...,
    **fixed: Unpack[_Minkowski4rInputs],
) -> Function: ...
@overload
def function(
    mechanism: Literal["focal"],
    inputs: Sequence[FocalInput] | Sequence[str],
    quantities: Sequence[FocalResult] | Sequence[str],
    *,
    links: Links | None = ...,
    input: FocalDriver | None = ...,
    angles: int | ArrayLike | None = ...,
    branch: int | Sequence[int] = ...,
    solver: Literal["eliminated"] = ...,
    extrema: Literal["refined", "sampled"] | None = ...,
    backend: Literal["llvm", "numba"] | None = ...,
    **fixed: Unpack[_FocalInputs],
) -> Function: ...
@overload
def function(
    mechanism: Literal["hart"],
    inputs: Sequence[HartInput] | Sequence[str],
    quantities: Sequence[HartResult] | Sequence[str],
    *,
    links: Links | None = ...,
    input: HartDriver | None = ...,
    angles: int | ArrayLike | None = ...,
    branch: int | Sequence[int] = ...,
    solver: Literal["eliminated"] = ...,
    extrema: Literal["refined", "sampled"] | None = ...,
    backend: Literal["llvm", "numba"] | None = ...,
    **fixed: Unpack[_HartInputs],
) -> Function: ...
@overload
def function(
    mechanism: Literal["slider_crank"],
    inputs: Sequence[SliderCrankInput] | Sequence[str],
    quantities: Sequence[SliderCrankResult] | Sequence[str],
    *,
    links: Links | None = ...,
    input: SliderCrankDriver | None = ...,
    angles: int | ArrayLike | None = ...,
    branch: int | Sequence[int] = ...,
    solver: Literal["eliminated"] = ...,
    extrema: Literal["refined", "sampled"] | None = ...,
    backend: Literal["llvm", "numba"] | None = ...,
    **fixed: Unpack[_SliderCrankInputs],
) -> Function: ...
@overload
def function(
    mechanism: Extension,
    inputs: Sequence[str],
    quantities: Sequence[str],
    *,
    links: Links | None = ...,
    input: str | None = ...,
    angles: int | ArrayLike | None = ...,
    branch: int | Sequence[int] = ...,
    solver: str = ...,
    extrema: str | None = ...,
    backend: str | None = ...,
    **fixed: Any,
) -> Function: ...
@overload
def sweep(
    mechanism: Literal["planar_4r"],
    space: DesignSpace | Mapping[str, Any] | str | Path | Any,
    quantities: Sequence[Planar4rResult] | Sequence[str],
    *,
    links: Links | None = ...,
    input: Planar4rDriver | None = ...,
    angles: int | ArrayLike | None = ...,
    branch: int | Sequence[int] = ...,
    solver: Literal["eliminated", "dense"] = ...,
    extrema: Literal["refined", "sampled"] | None = ...,
    verify: int | None = ...,
    to: str | Path | None = ...,
    overwrite: bool = ...,
    restart: bool = ...,
    part: tuple[int, int] | str | None = ...,
    layout: str = ...,
    threads: int | None = ...,
    client: Client | None = ...,
    progress: bool | None = ...,
    allow_invalid: bool = ...,
    attrs: Mapping[str, Any] | None = ...,
    block: int | None = ...,
    backend: Literal["llvm", "numba"] | None = ...,
    **positions: Unpack[_Planar4rPositions],
) -> xr.Dataset: ...
@overload
def sweep(
    mechanism: Literal["minkowski_4r"],
    space: DesignSpace | Mapping[str, Any] | str | Path | Any,
    quantities: Sequence[Minkowski4rResult] | Sequence[str],
    *,
    links: Links | None = ...,
    input: Minkowski4rDriver | None = ...,
    angles: int | ArrayLike | None = ...,
    branch: int | Sequence[int] = ...,
    solver: Literal["eliminated"] = ...,
    extrema: Literal["refined", "sampled"] | None = ...,
    verify: int | None = ...,
    to: str | Path | None = ...,
    overwrite: bool = ...,
    restart: bool = ...,
    part: tuple[int, int] | str | None = ...,
    layout: str = ...,
    threads: int | None = ...,
    client: Client | None = ...,
    progress: bool | None = ...,
    allow_invalid: bool = ...,
    attrs: Mapping[str, Any] | None = ...,
    block: int | None = ...,
    backend: Literal["llvm", "numba"] | None = ...,
    **positions: Unpack[_Minkowski4rPositions],
) -> xr.Dataset: ...
@overload
def sweep(
    mechanism: Literal["focal"],
    space: DesignSpace | Mapping[str, Any] | str | Path | Any,
    quantities: Sequence[FocalResult] | Sequence[str],
    *,
    links: Links | None = ...,
    input: FocalDriver | None = ...,
    angles: int | ArrayLike | None = ...,
    branch: int | Sequence[int] = ...,
    solver: Literal["eliminated"] = ...,
    extrema: Literal["refined", "sampled"] | None = ...,
    verify: int | None = ...,
    to: str | Path | None = ...,
    overwrite: bool = ...,
    restart: bool = ...,
    part: tuple[int, int] | str | None = ...,
    layout: str = ...,
    threads: int | None = ...,
    client: Client | None = ...,
    progress: bool | None = ...,
    allow_invalid: bool = ...,
    attrs: Mapping[str, Any] | None = ...,
    block: int | None = ...,
    backend: Literal["llvm", "numba"] | None = ...,
    **positions: Unpack[_FocalPositions],
) -> xr.Dataset: ...
@overload
def sweep(
    mechanism: Literal["hart"],
    space: DesignSpace | Mapping[str, Any] | str | Path | Any,
    quantities: Sequence[HartResult] | Sequence[str],
    *,
    links: Links | None = ...,
    input: HartDriver | None = ...,
    angles: int | ArrayLike | None = ...,
    branch: int | Sequence[int] = ...,
    solver: Literal["eliminated"] = ...,
    extrema: Literal["refined", "sampled"] | None = ...,
    verify: int | None = ...,
    to: str | Path | None = ...,
    overwrite: bool = ...,
    restart: bool = ...,
    part: tuple[int, int] | str | None = ...,
    layout: str = ...,
    threads: int | None = ...,
    client: Client | None = ...,
    progress: bool | None = ...,
    allow_invalid: bool = ...,
    attrs: Mapping[str, Any] | None = ...,
    block: int | None = ...,
    backend: Literal["llvm", "numba"] | None = ...,
    **positions: Unpack[_HartPositions],
) -> xr.Dataset: ...
@overload
def sweep(
    mechanism: Literal["slider_crank"],
    space: DesignSpace | Mapping[str, Any] | str | Path | Any,
    quantities: Sequence[SliderCrankResult] | Sequence[str],
    *,
    links: Links | None = ...,
    input: SliderCrankDriver | None = ...,
    angles: int | ArrayLike | None = ...,
    branch: int | Sequence[int] = ...,
    solver: Literal["eliminated"] = ...,
    extrema: Literal["refined", "sampled"] | None = ...,
    verify: int | None = ...,
    to: str | Path | None = ...,
    overwrite: bool = ...,
    restart: bool = ...,
    part: tuple[int, int] | str | None = ...,
    layout: str = ...,
    threads: int | None = ...,
    client: Client | None = ...,
    progress: bool | None = ...,
    allow_invalid: bool = ...,
    attrs: Mapping[str, Any] | None = ...,
    block: int | None = ...,
    backend: Literal["llvm", "numba"] | None = ...,
    **positions: Unpack[_SliderCrankPositions],
) -> xr.Dataset: ...
@overload
def sweep(
    mechanism: Extension,
    space: DesignSpace | Mapping[str, Any] | str | Path | Any,
    quantities: Sequence[str],
    *,
    links: Links | None = ...,
    input: str | None = ...,
    angles: int | ArrayLike | None = ...,
    branch: int | Sequence[int] = ...,
    solver: str = ...,
    extrema: str | None = ...,
    verify: int | None = ...,
    to: str | Path | None = ...,
    overwrite: bool = ...,
    restart: bool = ...,
    part: tuple[int, int] | str | None = ...,
    layout: str = ...,
    threads: int | None = ...,
    client: Client | None = ...,
    progress: bool | None = ...,
    allow_invalid: bool = ...,
    attrs: Mapping[str, Any] | None = ...,
    block: int | None = ...,
    backend: str | None = ...,
    **positions: int | ArrayLike | None,
) -> xr.Dataset: ...
def grid(
    axes: Mapping[str, ArrayLike] | None = ...,
    /,
    *,
    a1: ArrayLike = ...,
    a2: ArrayLike = ...,
    a3: ArrayLike = ...,
    a4: ArrayLike = ...,
    omega1: ArrayLike = ...,
    P_u: ArrayLike = ...,
    P_v: ArrayLike = ...,
    m1: ArrayLike = ...,
    I1: ArrayLike = ...,
    G1_u: ArrayLike = ...,
    G1_v: ArrayLike = ...,
    m2: ArrayLike = ...,
    I2: ArrayLike = ...,
    G2_u: ArrayLike = ...,
    G2_v: ArrayLike = ...,
    m3: ArrayLike = ...,
    I3: ArrayLike = ...,
    G3_u: ArrayLike = ...,
    G3_v: ArrayLike = ...,
    gravity_x: ArrayLike = ...,
    gravity_y: ArrayLike = ...,
    FP_x: ArrayLike = ...,
    FP_y: ArrayLike = ...,
    T_load: ArrayLike = ...,
    T_load_linear: ArrayLike = ...,
    T_load_quadratic: ArrayLike = ...,
    M_x: ArrayLike = ...,
    M_y: ArrayLike = ...,
    counterweight1_mass: ArrayLike = ...,
    counterweight1_radius: ArrayLike = ...,
    counterweight1_direction: ArrayLike = ...,
    counterweight3_mass: ArrayLike = ...,
    counterweight3_radius: ArrayLike = ...,
    counterweight3_direction: ArrayLike = ...,
    alpha1: ArrayLike = ...,
    density: ArrayLike = ...,
    radius: ArrayLike = ...,
    arc_start: ArrayLike = ...,
    arc_end: ArrayLike = ...,
    joint_omega_1: ArrayLike = ...,
    joint_omega_2: ArrayLike = ...,
    joint_omega_3: ArrayLike = ...,
    joint_omega_4: ArrayLike = ...,
    a: ArrayLike = ...,
    b: ArrayLike = ...,
    g: ArrayLike = ...,
    h: ArrayLike = ...,
    x: ArrayLike = ...,
    y: ArrayLike = ...,
    tolerance: ArrayLike = ...,
    c: ArrayLike = ...,
    d: ArrayLike = ...,
    rho: ArrayLike = ...,
    completion: ArrayLike = ...,
    omega: ArrayLike = ...,
    s: ArrayLike = ...,
    lambda_: ArrayLike = ...,
    m: ArrayLike = ...,
    n: ArrayLike = ...,
    kappa: ArrayLike = ...,
    r: ArrayLike = ...,
    l: ArrayLike = ...,
    e: ArrayLike = ...,
    F_load: ArrayLike = ...,
    **more: Unpack[_InUnits],
) -> DesignSpace: ...
def latin_hypercube(
    n: int,
    ranges: Mapping[str, ArrayLike] | None = ...,
    *,
    seed: int = ...,
    a1: ArrayLike = ...,
    a2: ArrayLike = ...,
    a3: ArrayLike = ...,
    a4: ArrayLike = ...,
    omega1: ArrayLike = ...,
    P_u: ArrayLike = ...,
    P_v: ArrayLike = ...,
    m1: ArrayLike = ...,
    I1: ArrayLike = ...,
    G1_u: ArrayLike = ...,
    G1_v: ArrayLike = ...,
    m2: ArrayLike = ...,
    I2: ArrayLike = ...,
    G2_u: ArrayLike = ...,
    G2_v: ArrayLike = ...,
    m3: ArrayLike = ...,
    I3: ArrayLike = ...,
    G3_u: ArrayLike = ...,
    G3_v: ArrayLike = ...,
    gravity_x: ArrayLike = ...,
    gravity_y: ArrayLike = ...,
    FP_x: ArrayLike = ...,
    FP_y: ArrayLike = ...,
    T_load: ArrayLike = ...,
    T_load_linear: ArrayLike = ...,
    T_load_quadratic: ArrayLike = ...,
    M_x: ArrayLike = ...,
    M_y: ArrayLike = ...,
    counterweight1_mass: ArrayLike = ...,
    counterweight1_radius: ArrayLike = ...,
    counterweight1_direction: ArrayLike = ...,
    counterweight3_mass: ArrayLike = ...,
    counterweight3_radius: ArrayLike = ...,
    counterweight3_direction: ArrayLike = ...,
    alpha1: ArrayLike = ...,
    density: ArrayLike = ...,
    radius: ArrayLike = ...,
    arc_start: ArrayLike = ...,
    arc_end: ArrayLike = ...,
    joint_omega_1: ArrayLike = ...,
    joint_omega_2: ArrayLike = ...,
    joint_omega_3: ArrayLike = ...,
    joint_omega_4: ArrayLike = ...,
    a: ArrayLike = ...,
    b: ArrayLike = ...,
    g: ArrayLike = ...,
    h: ArrayLike = ...,
    x: ArrayLike = ...,
    y: ArrayLike = ...,
    tolerance: ArrayLike = ...,
    c: ArrayLike = ...,
    d: ArrayLike = ...,
    rho: ArrayLike = ...,
    completion: ArrayLike = ...,
    omega: ArrayLike = ...,
    s: ArrayLike = ...,
    lambda_: ArrayLike = ...,
    m: ArrayLike = ...,
    kappa: ArrayLike = ...,
    r: ArrayLike = ...,
    l: ArrayLike = ...,
    e: ArrayLike = ...,
    F_load: ArrayLike = ...,
    **more: Unpack[_InUnits],
) -> DesignSpace: ...
def sobol(
    n: int,
    ranges: Mapping[str, ArrayLike] | None = ...,
    *,
    seed: int = ...,
    a1: ArrayLike = ...,
    a2: ArrayLike = ...,
    a3: ArrayLike = ...,
    a4: ArrayLike = ...,
    omega1: ArrayLike = ...,
    P_u: ArrayLike = ...,
    P_v: ArrayLike = ...,
    m1: ArrayLike = ...,
    I1: ArrayLike = ...,
    G1_u: ArrayLike = ...,
    G1_v: ArrayLike = ...,
    m2: ArrayLike = ...,
    I2: ArrayLike = ...,
    G2_u: ArrayLike = ...,
    G2_v: ArrayLike = ...,
    m3: ArrayLike = ...,
    I3: ArrayLike = ...,
    G3_u: ArrayLike = ...,
    G3_v: ArrayLike = ...,
    gravity_x: ArrayLike = ...,
    gravity_y: ArrayLike = ...,
    FP_x: ArrayLike = ...,
    FP_y: ArrayLike = ...,
    T_load: ArrayLike = ...,
    T_load_linear: ArrayLike = ...,
    T_load_quadratic: ArrayLike = ...,
    M_x: ArrayLike = ...,
    M_y: ArrayLike = ...,
    counterweight1_mass: ArrayLike = ...,
    counterweight1_radius: ArrayLike = ...,
    counterweight1_direction: ArrayLike = ...,
    counterweight3_mass: ArrayLike = ...,
    counterweight3_radius: ArrayLike = ...,
    counterweight3_direction: ArrayLike = ...,
    alpha1: ArrayLike = ...,
    density: ArrayLike = ...,
    radius: ArrayLike = ...,
    arc_start: ArrayLike = ...,
    arc_end: ArrayLike = ...,
    joint_omega_1: ArrayLike = ...,
    joint_omega_2: ArrayLike = ...,
    joint_omega_3: ArrayLike = ...,
    joint_omega_4: ArrayLike = ...,
    a: ArrayLike = ...,
    b: ArrayLike = ...,
    g: ArrayLike = ...,
    h: ArrayLike = ...,
    x: ArrayLike = ...,
    y: ArrayLike = ...,
    tolerance: ArrayLike = ...,
    c: ArrayLike = ...,
    d: ArrayLike = ...,
    rho: ArrayLike = ...,
    completion: ArrayLike = ...,
    omega: ArrayLike = ...,
    s: ArrayLike = ...,
    lambda_: ArrayLike = ...,
    m: ArrayLike = ...,
    kappa: ArrayLike = ...,
    r: ArrayLike = ...,
    l: ArrayLike = ...,
    e: ArrayLike = ...,
    F_load: ArrayLike = ...,
    **more: Unpack[_InUnits],
) -> DesignSpace: ...
