"""Model, analyse and simulate overconstrained robots, some of whose motions need play in the joints.

Lengths are in metres and angles in radians; a quantity carries its unit in its name.

>>> import jointplay as jp
>>> gpr = jp.Gpr.paper()
>>> rods = gpr.inverse(azimuth_rad=0.3, tilt_rad=0.02)
>>> pose = gpr.forward(rods.rods_m, "planar")
>>> round(pose.tilt_rad, 12)
0.02
"""

from . import study
from ._analyses import (
    AugmentedMobility,
    Bounds,
    BoundsCheck,
    Comparison,
    Freedoms,
    Mobility,
    ModelCurve,
    Sensitivity,
    SeriesSummary,
    Study,
    StudySummary,
    TiltPlay,
)
from ._base import Result, Table
from ._cells import Samples
from ._errors import (
    ArgumentTypeError,
    ArrayError,
    ArrayTypeError,
    BeyondLimitsError,
    DependentCommandsError,
    DependentSidesError,
    FileError,
    GeometryError,
    InputError,
    JointLimitsError,
    JointplayError,
    NoAnswerError,
    NotAssembledError,
    NotClosedError,
    NotConvergedError,
    NotFiniteError,
    NotReachedError,
    NotRelievedError,
    OutOfRangeError,
    TiltTooLargeError,
    PlanningError,
    RobotLimitsError,
    StoppedError,
    TooLargeError,
    TurnedOverError,
    UndeterminedError,
    UnknownNameError,
)
from ._jointplay import (
    Cell,
    CellPlan,
    Forward,
    Gpr,
    Inverse,
    Mechanism,
    __version__,
    catalogue,
)
from ._mechanisms import (
    Configuration,
    Jacobian,
    JointLoad,
    LinkMotion,
    MechanismMobility,
    Motion,
    NearMobility,
    ParameterDerivatives,
    Positions,
    Rates,
    RedundantConstraint,
    Relief,
    SingularConfiguration,
    SuggestedJoint,
    Suggestion,
    Suggestions,
)
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
from ._status import Status
from ._virtualization import VirtualJoint, Virtualization

__all__ = [
    "Approximate",
    "ArgumentTypeError",
    "ArrayError",
    "ArrayTypeError",
    "AugmentedMobility",
    "BallClearance",
    "BeyondLimitsError",
    "Bounds",
    "BoundsCheck",
    "BrokenLimit",
    "BrokenLimits",
    "Cell",
    "CellPlan",
    "RedundantConstraint",
    "Comparison",
    "Configuration",
    "DependentCommandsError",
    "DependentSidesError",
    "FileError",
    "Forward",
    "ForwardMany",
    "Freedoms",
    "GeometryError",
    "Gpr",
    "InputError",
    "Inverse",
    "InverseMany",
    "JointLimitsError",
    "JointplayError",
    "Jacobian",
    "JointLoad",
    "LinkMotion",
    "Mechanism",
    "MechanismMobility",
    "Mobility",
    "ModelCurve",
    "Motion",
    "NearMobility",
    "NoAnswerError",
    "NotAssembledError",
    "NotClosedError",
    "NotConvergedError",
    "NotFiniteError",
    "NotReachedError",
    "NotRelievedError",
    "OutOfRangeError",
    "ParameterDerivatives",
    "TiltTooLargeError",
    "Picture",
    "PlanningError",
    "Platform",
    "PlatformDerivatives",
    "Positions",
    "Rates",
    "Relief",
    "Result",
    "RobotLimitsError",
    "RodDerivatives",
    "Samples",
    "Sensitivity",
    "SeriesSummary",
    "SingularConfiguration",
    "Status",
    "StoppedError",
    "Study",
    "StudySummary",
    "SuggestedJoint",
    "Suggestion",
    "Suggestions",
    "Table",
    "TiltPlay",
    "TooLargeError",
    "TurnedOverError",
    "UndeterminedError",
    "UnknownNameError",
    "VirtualJoint",
    "Virtualization",
    "__version__",
    "catalogue",
    "study",
]

for _name in __all__:
    if isinstance(globals()[_name], type):
        # Messages and pickles name the package, not its private modules.
        globals()[_name].__module__ = __name__
del _name
