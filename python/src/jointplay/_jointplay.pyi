from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Literal, TypeAlias, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._analyses import BoundsCheck, Comparison, Mobility, Sensitivity, Study, TiltPlay
from ._cells import Samples
from ._mechanisms import (
    Configuration,
    Coupling,
    Jacobian,
    MechanismMobility,
    Motion,
    ParameterDerivatives,
    Positions,
    Rates,
    Relief,
    SimulatorModel,
    SuggestedJoint,
    Suggestion,
    Suggestions,
)
from ._parts import Parts
from ._pictures import Picture
from ._poses import (
    Approximate,
    BallClearance,
    BrokenLimit,
    BrokenLimits,
    ForwardMany,
    InverseMany,
    Platform,
    PlatformDerivatives,
    RodDerivatives,
)
from ._virtualization import Virtualization

__all__ = [
    "Cell",
    "CellPlan",
    "Chunk",
    "Forward",
    "Gathering",
    "Gpr",
    "Inverse",
    "Mechanism",
    "Plan",
    "Schema",
    "__version__",
    "arrow_stream",
    "picture_as_latex",
    "picture_as_pdf",
    "picture_as_png",
    "run_command",
    "catalogue",
]

__version__: str

_Floats: TypeAlias = NDArray[np.float64]
_Vector: TypeAlias = np.ndarray[tuple[int], np.dtype[np.float64]]
_Matrix: TypeAlias = np.ndarray[tuple[int, int], np.dtype[np.float64]]
_Model: TypeAlias = Literal["planar", "radial", "polar", "offset"] | Virtualization
_Solver: TypeAlias = Literal["closed-form", "least-norm", "newton"]
_Metric: TypeAlias = Literal["paper", "radius"] | float
_Quantity: TypeAlias = Literal[
    "azimuth_rad",
    "tilt_rad",
    "torsion_rad",
    "axis_height_m",
    "origin_m",
    "normal",
    "sides_m",
    "virtual_joints",
    "displacement_m",
    "ball_displacement_m",
    "sensitivity",
    "residual_m",
    "iterations",
]
_Number: TypeAlias = float | np.floating[Any] | np.integer[Any]

@final
class Gpr:
    def __new__(
        cls,
        *,
        socket_radius_m: ArrayLike,
        rod_limits_m: ArrayLike,
        tilt_limit_rad: float,
        working_height_m: float,
        socket_angle_rad: ArrayLike | None = None,
        base_points_m: ArrayLike | None = None,
        ball_clearance_m: float | None = None,
        name: str = ...,
        check_limits: bool = True,
    ) -> Gpr: ...
    @staticmethod
    def paper() -> Gpr: ...
    @staticmethod
    def from_file(path: str | PathLike[str]) -> Gpr: ...
    @staticmethod
    def from_toml(text: str) -> Gpr: ...
    def to_fmu(
        self,
        rods_m: ArrayLike | None = None,
        *,
        virtualization: Literal["radial", "polar", "offset", "planar"] | None = None,
        fmi: Literal[2, 3] = 2,
        name: str | None = None,
        library: str | PathLike[str] | Sequence[str | PathLike[str]] | None = None,
    ) -> bytes: ...
    @property
    def name(self) -> str: ...
    @property
    def base_points_m(self) -> _Matrix: ...
    @property
    def socket_radius_m(self) -> _Vector: ...
    @property
    def socket_angle_rad(self) -> _Vector: ...
    @property
    def rod_limits_m(self) -> tuple[float, float]: ...
    @property
    def tilt_limit_rad(self) -> float: ...
    @property
    def checks_limits(self) -> bool: ...
    def without_limit_checks(self) -> Gpr: ...
    @property
    def working_height_m(self) -> float: ...
    @property
    def ball_clearance_m(self) -> float | None: ...
    def needed_clearance(
        self,
        rods_m: ArrayLike,
        virtualization: _Model | None = None,
        *,
        solver: _Solver | None = None,
        metric: _Metric | None = None,
    ) -> BallClearance: ...
    @property
    def platform(self) -> Platform: ...
    @overload
    def forward(
        self,
        rods_m: tuple[_Number, _Number, _Number] | list[float] | _Vector,
        virtualization: _Model | None = None,
        *,
        solver: _Solver | None = None,
        metric: _Metric | None = None,
        quantities: None = None,
        out: None = None,
        threads: int | None = None,
    ) -> Forward: ...
    @overload
    def forward(
        self,
        rods_m: _Matrix | list[list[float]],
        virtualization: _Model | None = None,
        *,
        solver: _Solver | None = None,
        metric: _Metric | None = None,
        quantities: _Quantity | Sequence[_Quantity] | None = None,
        out: dict[str, _Floats] | None = None,
        threads: int | None = None,
    ) -> ForwardMany: ...
    @overload
    def forward(
        self,
        rods_m: ArrayLike,
        virtualization: _Model | None = None,
        *,
        solver: _Solver | None = None,
        metric: _Metric | None = None,
        quantities: _Quantity | Sequence[_Quantity] | None = None,
        out: dict[str, _Floats] | None = None,
        threads: int | None = None,
    ) -> Any: ...
    # NumPy accepts numbers as arrays without axes; here two numbers are one tilt.
    @overload
    def inverse(  # type: ignore[overload-overlap]
        self,
        azimuth_rad: _Number,
        tilt_rad: _Number,
        height_m: _Number | None = None,
        *,
        out: None = None,
        threads: int | None = None,
    ) -> Inverse: ...
    @overload
    def inverse(
        self,
        azimuth_rad: ArrayLike,
        tilt_rad: ArrayLike,
        height_m: ArrayLike | None = None,
        *,
        out: _Floats | None = None,
        threads: int | None = None,
    ) -> InverseMany: ...
    def inverse_for_center(
        self,
        azimuth_rad: float,
        tilt_rad: float,
        center_height_m: float,
        virtualization: _Model | None = None,
        *,
        solver: _Solver | None = None,
        metric: _Metric | None = None,
    ) -> Forward: ...
    def approximate(
        self, azimuth_rad: float, tilt_rad: float, height_m: float | None = None
    ) -> Approximate: ...
    def plane_tilt(self, rods_m: ArrayLike) -> tuple[float, float]: ...
    def rod_derivatives(
        self, azimuth_rad: float, tilt_rad: float, height_m: float | None = None
    ) -> RodDerivatives: ...
    def platform_derivatives(
        self,
        rods_m: ArrayLike,
        virtualization: _Model | None = None,
        *,
        solver: _Solver | None = None,
        metric: _Metric | None = None,
    ) -> PlatformDerivatives: ...
    @overload
    def broken_limits(
        self,
        rods_m: tuple[_Number, _Number, _Number] | list[float] | _Vector,
        tilt_rad: _Number | None = None,
    ) -> list[BrokenLimit]: ...
    @overload
    def broken_limits(
        self, rods_m: _Matrix | list[list[float]], tilt_rad: ArrayLike | None = None
    ) -> BrokenLimits: ...
    @overload
    def broken_limits(self, rods_m: ArrayLike, tilt_rad: ArrayLike | None = None) -> Any: ...
    def mobility(
        self, rods_m: ArrayLike | None = None, virtualization: _Model | None = None
    ) -> Mobility: ...
    def sensitivity(
        self,
        rods_m: ArrayLike,
        virtualization: _Model | None = None,
        *,
        solver: _Solver | None = None,
        metric: _Metric | None = None,
    ) -> Sensitivity: ...
    def tilt_play(
        self,
        azimuth_rad: float,
        tilt_rad: float,
        height_m: float | None = None,
        virtualization: _Model | None = None,
        *,
        solver: _Solver | None = None,
        metric: _Metric | None = None,
    ) -> TiltPlay: ...
    def compare(
        self,
        tilt_rad: ArrayLike,
        azimuth_rad: float = 0.0,
        height_m: float | None = None,
        *,
        virtualizations: Sequence[_Model] | None = None,
        solver: _Solver | None = None,
        metric: _Metric | None = None,
    ) -> Comparison: ...
    def _simulate(
        self,
        virtualization: _Model | None,
        azimuth_rad: ArrayLike | None,
        tilt_rad: ArrayLike | None,
        height_m: float | None,
        serpentine: bool,
        solver: _Solver | None,
        metric: _Metric | None,
    ) -> Study: ...
    def _check_bounds(
        self,
        virtualization: _Model | None,
        azimuth_rad: ArrayLike | None,
        tilt_rad: ArrayLike | None,
        height_m: float | None,
        solver: _Solver | None,
        metric: _Metric | None,
    ) -> BoundsCheck: ...
    def __copy__(self) -> Gpr: ...
    def __deepcopy__(self, _memo: object) -> Gpr: ...
    def __getnewargs_ex__(self) -> tuple[tuple[()], dict[str, Any]]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Forward:
    @property
    def rods_m(self) -> _Vector: ...
    @property
    def sides_m(self) -> _Vector: ...
    @property
    def azimuth_rad(self) -> float: ...
    @property
    def tilt_rad(self) -> float: ...
    @property
    def torsion_rad(self) -> float: ...
    @property
    def axis_height_m(self) -> float: ...
    @property
    def origin_m(self) -> _Vector: ...
    @property
    def center_shift_m(self) -> _Vector: ...
    @property
    def normal(self) -> _Vector: ...
    @property
    def base_from_platform(self) -> _Matrix: ...
    @property
    def virtual_joints(self) -> _Vector: ...
    @property
    def virtual_joint_names(self) -> tuple[str, ...]: ...
    @property
    def virtualization(self) -> str: ...
    @property
    def solver(self) -> _Solver: ...
    @property
    def characteristic_length_m(self) -> float: ...
    @property
    def iterations(self) -> int: ...
    @property
    def residual_m(self) -> float: ...
    def __copy__(self) -> Forward: ...
    def __deepcopy__(self, _memo: object) -> Forward: ...
    def __eq__(self, other: object, /) -> bool: ...
    @staticmethod
    def _from_parts(parts: tuple[Any, ...]) -> Forward: ...

@final
class Inverse:
    def __new__(cls, rods_m: Sequence[float]) -> Inverse: ...
    @property
    def rods_m(self) -> _Vector: ...
    def __copy__(self) -> Inverse: ...
    def __deepcopy__(self, _memo: object) -> Inverse: ...
    def __getnewargs__(self) -> tuple[list[float]]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Mechanism:
    @staticmethod
    def from_file(
        path: str | PathLike[str],
        *,
        parameters: dict[str, float] | None = None,
        loops: str | PathLike[str] | None = None,
        units: Literal["m", "mm", "um", "in"] | None = None,
    ) -> Mechanism: ...
    @staticmethod
    def from_toml(text: str, *, parameters: dict[str, float] | None = None) -> Mechanism: ...
    @staticmethod
    def from_gpr(
        gpr: Gpr,
        virtualization: Literal["radial", "polar", "planar"] | None = None,
    ) -> Mechanism: ...
    @staticmethod
    def from_catalogue(name: str, *, parameters: dict[str, float] | None = None) -> Mechanism: ...
    def to_gpr(self, tilt_limit_rad: float) -> Gpr: ...
    @property
    def name(self) -> str: ...
    @property
    def links(self) -> tuple[str, ...]: ...
    @property
    def joints(self) -> tuple[str, ...]: ...
    @property
    def couplings(self) -> tuple[Coupling, ...]: ...
    @property
    def frames(self) -> tuple[str, ...]: ...
    @property
    def coordinate_names(self) -> tuple[str, ...]: ...
    @property
    def coordinate_units(self) -> tuple[str, ...]: ...
    @property
    def virtual_joint_names(self) -> tuple[str, ...]: ...
    @property
    def virtual_joint_units(self) -> tuple[str, ...]: ...
    @property
    def actuated(self) -> tuple[str, ...]: ...
    @property
    def parameters(self) -> dict[str, float]: ...
    @property
    def ignored(self) -> tuple[str, ...]: ...
    @property
    def joint_freedoms(self) -> int: ...
    @property
    def loops(self) -> int: ...
    def draw(
        self,
        at: dict[str, float] | Configuration | Relief | ArrayLike | None = None,
        *,
        ghost: dict[str, float] | Configuration | Relief | ArrayLike | None = None,
        exaggerate: float | None = None,
        view_rad: tuple[float, float] | None = None,
        title: str | None = None,
        width_px: float = 720.0,
        labels: Literal["auto", "joints", "links", "all", "none"] | dict[str, str] | None = None,
        text_scale: float = 1.0,
        font: str | None = None,
    ) -> Picture: ...
    def assemble(
        self, at: dict[str, float] | None = None, *, tolerance: float | None = None
    ) -> Configuration: ...
    def branches(
        self, at: dict[str, float] | None = None, *, starts: int | None = None
    ) -> list[Configuration]: ...
    def mobility(
        self, at: dict[str, float] | None = None, *, tolerance: float | None = None
    ) -> MechanismMobility: ...
    def drive(
        self,
        drives: Mapping[str, ArrayLike],
        *,
        steps: int | None = None,
        free: Sequence[str] | None = None,
    ) -> Motion: ...
    def read_drive_table(
        self, path: str | PathLike[str]
    ) -> dict[str, NDArray[np.float64]]: ...
    def suggest(
        self,
        commands: Sequence[dict[str, float]],
        *,
        limit: int | None = None,
        joints: int | None = None,
        symmetric: bool = False,
        rank: Literal["norm", "largest", "stiffness"] = "norm",
        linear_stiffness: float | None = None,
        angular_stiffness: float | None = None,
    ) -> Suggestions: ...
    def with_virtual_joints(self, suggestion: Suggestion | Sequence[SuggestedJoint]) -> Mechanism: ...
    def relieve(self, at: dict[str, float]) -> Relief: ...
    def positions(
        self,
        commanded: Mapping[str, ArrayLike],
        *,
        solver: Literal["least-norm", "newton"] = "least-norm",
        check_limits: bool = True,
        independent: bool = False,
        threads: int | None = None,
    ) -> Positions: ...
    def parameter_derivatives(
        self,
        parameters: Sequence[str] | None = None,
        at: Mapping[str, float] | None = None,
        *,
        commanded: Sequence[str] | None = None,
    ) -> ParameterDerivatives: ...
    def jacobian(
        self,
        name: str,
        at: dict[str, float] | None = None,
        *,
        commanded: Sequence[str] | None = None,
        velocities: dict[str, float] | None = None,
    ) -> Jacobian: ...
    def velocities(
        self,
        velocities: dict[str, float],
        at: dict[str, float] | None = None,
        *,
        commanded: Sequence[str] | None = None,
    ) -> Rates: ...
    def accelerations(
        self,
        accelerations: dict[str, float],
        velocities: dict[str, float] | None = None,
        at: dict[str, float] | None = None,
        *,
        commanded: Sequence[str] | None = None,
    ) -> Rates: ...
    def link_poses(
        self, coordinates: ArrayLike, name: str, *, exaggerate: float = 1.0
    ) -> NDArray[np.float64]: ...
    def to_model(
        self,
        format: Literal["mjcf", "modelica", "sdf", "urdf"],
        at: dict[str, float] | None = None,
    ) -> SimulatorModel: ...
    def to_fmu(
        self,
        at: dict[str, float] | None = None,
        *,
        fmi: Literal[2, 3] = 2,
        name: str | None = None,
        library: str | PathLike[str] | Sequence[str | PathLike[str]] | None = None,
    ) -> bytes: ...
    def _gltf(
        self,
        coordinates: ArrayLike,
        times_s: ArrayLike | None,
        duration_s: float,
        exaggerate: float,
        tolerance_um: float,
        parts: bytes | None = None,
        table: Sequence[tuple[str, str]] | None = None,
        table_file: tuple[str, str] | None = None,
        parts_up: str | None = None,
    ) -> tuple[bytes, list[str]]: ...
    def __copy__(self) -> Mechanism: ...
    def __deepcopy__(self, _memo: object) -> Mechanism: ...
    @staticmethod
    def _again(
        text: str,
        parameters: Sequence[tuple[str, float]],
        closing: str | None,
        units: str | None,
    ) -> Mechanism: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Cell:
    example_program: str
    @staticmethod
    def from_file(path: str | PathLike[str]) -> Cell: ...
    @staticmethod
    def from_toml(text: str, *, folder: str | PathLike[str] | None = None) -> Cell: ...
    @staticmethod
    def example() -> Cell: ...
    @property
    def name(self) -> str: ...
    @property
    def text(self) -> str: ...
    @property
    def stations(self) -> tuple[str, ...]: ...
    @property
    def effectors(self) -> tuple[str, ...]: ...
    @property
    def axes(self) -> tuple[str, ...]: ...
    @property
    def axis_units(self) -> tuple[str, ...]: ...
    def with_station(
        self,
        name: str,
        *,
        position_m: Sequence[float] | NDArray[np.float64] | None = None,
        heading_rad: float | None = None,
        tilt_rad: Sequence[float] | NDArray[np.float64] | None = None,
    ) -> Cell: ...
    def plan(
        self,
        program: str | PathLike[str],
        *,
        parameters: Mapping[str, float | str] | None = None,
        threads: int | None = None,
    ) -> CellPlan: ...
    @staticmethod
    def _again(text: str, folder: str | PathLike[str] | None, label: str) -> Cell: ...

@final
class CellPlan:
    @property
    def duration_s(self) -> float: ...
    @property
    def passed(self) -> bool: ...
    @property
    def violations(self) -> int: ...
    @property
    def min_distance_m(self) -> float | None: ...
    def report(self, *, remedies: bool = False) -> dict[str, Any]: ...
    def samples(self, rate_hz: float = 100.0) -> Samples: ...
    def table(
        self,
        columns: Sequence[str] | None = None,
        *,
        rate_hz: float = 100.0,
        from_s: float | None = None,
        to_s: float | None = None,
    ) -> dict[str, NDArray[Any]]: ...
    def link_poses(
        self,
        name: str,
        *,
        rate_hz: float = 100.0,
        from_s: float | None = None,
        to_s: float | None = None,
    ) -> NDArray[np.float64]: ...
    def gltf(self, *, rate_hz: float = 60.0, despite_errors: bool = False) -> bytes: ...
    def controller_text(
        self,
        dialect: str | PathLike[str] | None = None,
        *,
        rate_hz: float = 100.0,
        despite_errors: bool = False,
    ) -> str: ...

@final
class Schema:
    def __arrow_c_schema__(self) -> object: ...

@final
class Chunk:
    def __len__(self) -> int: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...

@final
class Gathering:
    def head(self) -> bytes: ...
    def next(self) -> tuple[str, str]: ...
    def add(self, record: bytes, table: bytes) -> bytes: ...
    def finish(self) -> bytes: ...

@final
class Plan:
    @staticmethod
    def from_file(path: str | PathLike[str]) -> Plan: ...
    @staticmethod
    def from_toml(text: str, *, folder: str | PathLike[str] | None = None) -> Plan: ...
    @staticmethod
    def example(
        name: Literal["center-shift", "play-over-the-workspace", "slider-crank", "station-positions", "tolerances"] = "center-shift",
    ) -> Plan: ...
    @property
    def name(self) -> str: ...
    @property
    def text(self) -> str: ...
    @property
    def samples(self) -> int: ...
    @property
    def chunks(self) -> int: ...
    @property
    def digest(self) -> str: ...
    @property
    def columns(self) -> tuple[str, ...]: ...
    @property
    def units(self) -> dict[str, str]: ...
    @property
    def schema(self) -> Schema: ...
    def chunk(self, number: int, *, threads: int | None = None) -> Chunk: ...
    def parts(
        self,
        location: str | PathLike[str],
        *,
        filesystem: Any = None,
        storage_options: Mapping[str, Any] | None = None,
        format: Literal["parquet", "csv"] = "parquet",
        threads: int | None = None,
    ) -> Parts: ...
    def _part_names(self, part: int, format: str) -> tuple[str, str]: ...
    def _part_files(self, part: int, format: str, threads: int | None) -> tuple[bytes, bytes]: ...
    def _manifest(self, format: str) -> tuple[str, bytes]: ...
    def _check_manifest(self, contents: bytes, format: str) -> None: ...
    def _done(self, names: set[str], format: str) -> set[int]: ...
    def _status(self, done: set[int]) -> dict[str, Any]: ...
    def _summary(self, records: Sequence[bytes], threads: int | None) -> dict[str, Any]: ...
    def _gathering(self, format: str) -> Gathering: ...
    @staticmethod
    def _again(text: str, files: dict[str, bytes], label: str) -> Plan: ...
    def __dask_tokenize__(self) -> str: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

def catalogue() -> dict[str, str]: ...
def run_command(arguments: Sequence[str], /) -> int: ...
def picture_as_png(svg: str, width_px: int) -> bytes: ...
def picture_as_pdf(svg: str) -> bytes: ...
def picture_as_latex(svg: str, pdf_name: str, own_texts: Sequence[str]) -> tuple[str, bytes]: ...
def arrow_stream(columns: Sequence[tuple[str, NDArray[Any]]]) -> object: ...
