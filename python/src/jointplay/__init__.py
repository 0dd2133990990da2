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
    RedundantConstraint,
    Configuration,
    LinkMotion,
    MechanismMobility,
    Motion,
    NearMobility,
    Positions,
    Relief,
    SingularConfiguration,
    SuggestedJoint,
    Suggestion,
    Suggestions,
)
from ._poses import (
    Approximate,
    BrokenLimit,
    BrokenLimits,
    ForwardMany,
    InverseMany,
    Platform,
)
from ._status import Status
from ._virtualization import VirtualJoint, Virtualization

__all__ = [
    "Approximate",
    "ArgumentTypeError",
    "ArrayError",
    "ArrayTypeError",
    "AugmentedMobility",
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
    "TiltTooLargeError",
    "PlanningError",
    "Platform",
    "Positions",
    "Relief",
    "Result",
    "RobotLimitsError",
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
