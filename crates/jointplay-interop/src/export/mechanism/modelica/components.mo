  connector RealInput = input Real "Input, as that of Modelica.Blocks.Interfaces";
  record Orientation "Orientation of a frame"
    Real R[3, 3] "Axes of the frame as columns, in the base frame";
    function equalityConstraint "Rotation between two frames where it is small"
      input Orientation axes_1 "First orientation";
      input Orientation axes_2 "Second orientation";
      output Real residue[3] "Rotation vector";
    algorithm
      residue := (cross(axes_1.R[:, 1], axes_2.R[:, 1]) + cross(axes_1.R[:, 2], axes_2.R[:, 2]) + cross(axes_1.R[:, 3], axes_2.R[:, 3]))/2;
    end equalityConstraint;
  end Orientation;
  connector Frame "Frame of a link"
    Real r[3](each unit = "m") "Origin, in the base frame";
    Orientation axes "Orientation";
    flow Real f[3](each unit = "N") "Force, in the base frame";
    flow Real t[3](each unit = "N.m") "Moment about the origin, in the base frame";
  end Frame;
  connector Flange "Coordinate of a joint"
    Real q "Coordinate (m or rad)";
    flow Real effort "Force along a slide or moment about an axis (N or N.m)";
  end Flange;
  function rotation "Rotation matrix of an angle about an axis"
    input Real n[3] "Axis, of length 1";
    input Real angle "Angle (rad)";
    output Real R[3, 3] "Rotation matrix";
  algorithm
    R := outerProduct(n, n) + (identity(3) - outerProduct(n, n))*cos(angle) + skew(n)*sin(angle);
    annotation(Inline = true);
  end rotation;
  model Base "Fixed link"
    Frame frame "Frame of the link";
  equation
    Connections.root(frame.axes);
    frame.r = zeros(3);
    frame.axes.R = identity(3);
  end Base;
  model Link "Link without mass"
    Frame frame "Frame of the link";
  equation
    frame.f = zeros(3);
    frame.t = zeros(3);
  end Link;
  model Rigid "Fixed displacement from a to b"
    parameter Real r[3](each unit = "m") = zeros(3) "Origin of b, in a";
    parameter Real R[3, 3] = identity(3) "Axes of b as columns, in a";
    Frame a "First frame";
    Frame b "Second frame";
  equation
    Connections.branch(a.axes, b.axes);
    b.r = a.r + a.axes.R*r;
    b.axes.R = a.axes.R*R;
    a.f + b.f = zeros(3);
    a.t + b.t + cross(b.r - a.r, b.f) = zeros(3);
  end Rigid;
  partial model Joint "Motion between two fixed displacements"
    parameter Real r_before[3](each unit = "m") = zeros(3) "Origin of the moving frame at zero, in a";
    parameter Real R_before[3, 3] = identity(3) "Axes of the moving frame at zero as columns, in a";
    parameter Real r_after[3](each unit = "m") = zeros(3) "Origin of b, in the moving frame";
    parameter Real R_after[3, 3] = identity(3) "Axes of b as columns, in the moving frame";
    Frame a "First frame";
    Frame b "Second frame";
  protected
    Real R[3, 3] "Axes of the moving frame at zero as columns, in the base frame";
    Real R_moved[3, 3] "Axes of the moving frame as columns, in the base frame";
    Real center[3](each unit = "m") "Origin of the moving frame at zero, in the base frame";
  equation
    Connections.branch(a.axes, b.axes);
    R = a.axes.R*R_before;
    center = a.r + a.axes.R*r_before;
    b.axes.R = R_moved*R_after;
    a.f + b.f = zeros(3);
    a.t + b.t + cross(b.r - a.r, b.f) = zeros(3);
  end Joint;
  partial model Axis "Turn about an axis and travel along it by one coordinate"
    extends Joint;
    parameter Real n[3] = {0, 0, 1} "Axis, in the moving frame";
    parameter Real p[3](each unit = "m") = zeros(3) "Point of the axis, in the moving frame at zero";
    parameter Real turn "Turn for a unit of the coordinate";
    parameter Real travel "Travel for a unit of the coordinate";
    Flange flange "Coordinate";
    Real q "Coordinate (m or rad)";
    Real effort "Force or moment that the links exert along the coordinate (N or N.m)";
  protected
    Real axis[3] "Axis, in the base frame";
    Real point[3](each unit = "m") "Point of the axis, in the base frame";
  equation
    axis = R*n;
    point = center + R*p;
    R_moved = R*rotation(n, turn*q);
    b.r = point + travel*q*axis + R_moved*(r_after - p);
    effort = turn*(axis*(b.t + cross(b.r - point, b.f))) + travel*(axis*b.f);
    flange.q = q;
  end Axis;
  partial model Passive "Coordinate with a damper and a spring"
    extends Axis;
    parameter Real damping "Damping (N.s/m or N.m.s/rad)";
    parameter Real stiffness = 0 "Stiffness of a spring that is at rest at zero (N/m or N.m/rad)";
  equation
    damping*der(q) = effort + flange.effort - stiffness*q;
  end Passive;
  partial model Driven "Coordinate that follows an input"
    extends Axis;
    RealInput u "Coordinate (m or rad)";
  equation
    q = u;
  end Driven;
  model Turn "Turn about an axis"
    extends Passive(turn = 1, travel = 0);
  end Turn;
  model Slide "Slide along an axis"
    extends Passive(turn = 0, travel = 1);
  end Slide;
  model Screw "Turn about an axis with a travel along it"
    extends Passive(turn = 1);
  end Screw;
  model DrivenTurn "Turn about an axis that follows an input"
    extends Driven(turn = 1, travel = 0);
  end DrivenTurn;
  model DrivenSlide "Slide along an axis that follows an input"
    extends Driven(turn = 0, travel = 1);
  end DrivenSlide;
  model DrivenScrew "Turn about an axis with a travel along it that follows an input"
    extends Driven(turn = 1);
  end DrivenScrew;
  model Ball "Rotation about a point, with a damper"
    extends Joint;
    parameter Real damping(unit = "N.m.s/rad") "Damping";
    Real Q[4] "Unit quaternion w, x, y, z";
  protected
    Real v[3] "Vector part";
    Real w[3](each unit = "rad/s") "Angular velocity, in the moving frame at zero";
  equation
    v = Q[2:4];
    R_moved = R*(identity(3) + 2/(Q*Q)*(Q[1]*skew(v) + skew(v)*skew(v)));
    b.r = center + R_moved*r_after;
    damping*w = transpose(R)*(b.t + cross(b.r - center, b.f));
    der(Q[1]) = -0.5*(w*v) + (1 - Q*Q)*Q[1];
    der(Q[2:4]) = 0.5*(Q[1]*w + cross(w, v)) + (1 - Q*Q)*v;
  end Ball;
  partial model Closure "Stiff connection of two frames that closes a loop"
    parameter Real r_a[3](each unit = "m") = zeros(3) "Point of a";
    parameter Real r_b[3](each unit = "m") = zeros(3) "Point of b, which coincides with that of a";
    parameter Real stiffness(unit = "N/m") "Stiffness";
    Frame a "First frame";
    Frame b "Second frame";
    Real gap[3](each unit = "m") "Distance of the points, in the base frame";
  equation
    gap = b.r + b.axes.R*r_b - a.r - a.axes.R*r_a;
    b.f = stiffness*gap;
    a.f + b.f = zeros(3);
    a.t + b.t + cross(b.r - a.r, b.f) = zeros(3);
  end Closure;
  model ClosureOfPoints "Stiff connection of two points"
    extends Closure;
  equation
    b.t = cross(b.axes.R*r_b, b.f);
  end ClosureOfPoints;
  model ClosureOfFrames "Stiff connection of two frames"
    extends Closure;
    parameter Real R_a[3, 3] = identity(3) "Axes as columns, in a";
    parameter Real R_b[3, 3] = identity(3) "Axes as columns, in b, which coincide with those in a";
    parameter Real angular_stiffness(unit = "N.m/rad") "Stiffness against rotation";
    Real angle[3](each unit = "rad") "Rotation between the frames where it is small, in the base frame";
  protected
    Real A[3, 3] "Axes in a as columns, in the base frame";
    Real B[3, 3] "Axes in b as columns, in the base frame";
  equation
    A = a.axes.R*R_a;
    B = b.axes.R*R_b;
    angle = (cross(A[:, 1], B[:, 1]) + cross(A[:, 2], B[:, 2]) + cross(A[:, 3], B[:, 3]))/2;
    b.t = angular_stiffness*angle + cross(b.axes.R*r_b, b.f);
  end ClosureOfFrames;
  model Coupling "Stiff relation: the follower is offset + ratio*others"
    parameter Integer count = 1 "Number of other coordinates";
    parameter Real ratio[count] "Ratios";
    parameter Real offset = 0 "Value of the follower with the others at zero (m or rad)";
    parameter Real stiffness "Stiffness (N/m or N.m/rad)";
    Flange follower "Coordinate that follows";
    Flange others[count] "Other coordinates";
    Real gap "Deviation of the follower (m or rad)";
  equation
    gap = follower.q - offset - ratio*others.q;
    follower.effort = stiffness*gap;
    others.effort = -stiffness*gap*ratio;
  end Coupling;
  model Hold "Stiff hold of a coordinate at a value"
    parameter Real offset = 0 "Value (m or rad)";
    parameter Real stiffness "Stiffness (N/m or N.m/rad)";
    Flange follower "Coordinate";
  equation
    follower.effort = stiffness*(follower.q - offset);
  end Hold;
