"""The parts of a scene, with their keys, units and descriptions.

Made by `optimize schema | python generate.py -` from the schema of problem files: do not edit.

Functions make parts: `place(put="pin", at=[0, 0, 0])`. Where there is a choice of kinds, a collection has a function for
each: `joints.revolute(…)`, `shapes.box(…)`. Units are SI, angles are in radians. Lists of numbers may be arrays of NumPy.
A part is a dictionary of its keys, as in the problem file.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, Literal, TypeAlias, Union

from ._part import (
    BodyName,
    Document,
    Integer,
    Kinds,
    Matrix,
    Name,
    Part,
    Real,
    Vector,
    checked,
    keys,
    made,
    made_of,
)

__all__ = [
    "Body",
    "Shape",
    "Inertia",
    "Beam",
    "Section",
    "BeamMaterial",
    "BeamFrame",
    "BeamModes",
    "BendingFunctions",
    "BeamStrain",
    "Damping",
    "Deformation",
    "Elements",
    "Structure",
    "Mesh",
    "Member",
    "LengthUnit",
    "ShellElement",
    "Thickness",
    "VariedThickness",
    "Per",
    "Direction",
    "StructureSection",
    "VariedSection",
    "Set",
    "Support",
    "HeldMotion",
    "NodeMass",
    "Stiffener",
    "ElementFrame",
    "ElementBasis",
    "ElementInertia",
    "HeldPlace",
    "Modal",
    "Source",
    "Units",
    "InterfaceNodes",
    "ModalFrame",
    "ModalDamping",
    "Surface",
    "BodyPoint",
    "Between",
    "Place",
    "Point",
    "Location",
    "Turns",
    "Turn",
    "InDegrees",
    "BodyVelocity",
    "Analysis",
    "StartOfMotion",
    "Joint",
    "JointPlace",
    "PointPair",
    "Axis",
    "BodyAxis",
    "JointStart",
    "TurnStart",
    "SlideStart",
    "Ends",
    "Load",
    "Axes",
    "ForceInTime",
    "VaryingForce",
    "Interpolation",
    "TorqueInTime",
    "VaryingTorque",
    "ForceTable",
    "Motion",
    "BushingStiffness",
    "BushingDamping",
    "BushingAxes",
    "BearingFriction",
    "Wheel",
    "Surface2",
    "ContactFriction",
    "Stribeck",
    "CablePoint",
    "CableLength",
    "Sliding",
    "PressureInTime",
    "VaryingPressure",
    "LineForceInTime",
    "VaryingLineForce",
    "Reference",
    "Following",
    "EffortInTime",
    "VaryingEffort",
    "Feedback",
    "Balanced",
    "Motor",
    "Curve",
    "Drive",
    "Turning",
    "Coupling",
    "Term",
    "JointMotion",
    "Profile",
    "TerminalEvent",
    "Quantity",
    "EnergyKind",
    "PowerOf",
    "CountedFrom",
    "ReactionAxes",
    "Gate",
    "SectionPlace",
    "SectionComponent",
    "SectionPlaces",
    "Sign",
    "Bound",
    "Method",
    "FirstSteps",
    "LinearSolver",
    "When",
    "At",
    "CaseLoad",
    "Strains",
    "Unknowns",
    "Function",
    "During",
    "WindowEnds",
    "Edge",
    "Reach",
    "AtEvent",
    "Over",
    "Within",
    "Series",
    "DataFile",
    "MeasuredNumber",
    "Variance",
    "Barrier",
    "StressAggregate",
    "StressPer",
    "WhichCases",
    "AllCases",
    "CaseCombination",
    "Extreme",
    "WhichFunction",
    "ExpressionOfFunctions",
    "OptimisationMethod",
    "View",
    "JointDefaults",
    "body",
    "shapes",
    "inertia",
    "beam",
    "sections",
    "beam_material",
    "beam_modes",
    "damping",
    "deformation",
    "elements",
    "structure",
    "meshes",
    "member",
    "varied_thickness",
    "structure_sections",
    "varied_section",
    "sets",
    "support",
    "node_mass",
    "stiffener",
    "element_frames",
    "element_bases",
    "held_places",
    "modal",
    "sources",
    "units",
    "modal_frames",
    "modal_damping",
    "surface",
    "between",
    "place",
    "turn",
    "body_velocity",
    "joints",
    "point_pair",
    "body_axis",
    "joint_start",
    "turn_start",
    "slide_start",
    "loads",
    "varying_forces",
    "varying_torques",
    "force_table",
    "bushing_stiffnesses",
    "bushing_dampings",
    "bearing_friction",
    "wheel",
    "surface2s",
    "contact_friction",
    "stribeck",
    "cable_point",
    "sliding",
    "varying_pressures",
    "varying_line_forces",
    "followings",
    "varying_efforts",
    "feedback",
    "balanced",
    "motor",
    "curve",
    "drive",
    "turning",
    "couplings",
    "term",
    "joint_motions",
    "profile",
    "terminal_event",
    "quantities",
    "power_ofs",
    "gate",
    "methods",
    "at",
    "case_loads",
    "functions",
    "window_ends",
    "reach",
    "at_event",
    "within",
    "series",
    "data_file",
    "measured_number",
    "barrier",
    "case_combinations",
    "expression_of_functions",
    "joint_defaults",
    "MachineKeys",
]


class Body(Part):
    """A body: a shape with its mass or density, or an explicit mass, centre of mass and inertia, or a beam or a body
    of files with elastic coordinates. Made by `body`.
    """

    __slots__ = ()


class Shape(Part):
    """A homogeneous solid, centred at the origin of the body's axes. Made by `shapes`."""

    __slots__ = ()


class Inertia(Part):
    """Entries of the symmetric inertia matrix about the centre of mass in body axes. The entry xy is minus the
    integral of x y over the mass. Made by `inertia`.
    """

    __slots__ = ()


class Beam(Part):
    """A straight uniform beam with elastic coordinates. Its axes: origin at its start, x along it. Made by `beam`."""

    __slots__ = ()


class Section(Part):
    """A cross section by its sizes, or by given stiffnesses `G`. In structures axis 2 lies in the plane of beam and
    orientation, and axis 3 is normal to both; in the axes of a moving beam axis 2 is z and axis 3 is y. Made by
    `sections`.
    """

    __slots__ = ()


class BeamMaterial(Part):
    """An isotropic material. Made by `beam_material`."""

    __slots__ = ()


class BeamModes(Part):
    """How many functions a beam has of each kind. Made by `beam_modes`."""

    __slots__ = ()


class Damping(Part):
    """Damping of the elastic coordinates: a part of critical damping for each mode of the body while its axes are
    held, plus α M + β K. Made by `damping`.
    """

    __slots__ = ()


class Deformation(Part):
    """Elastic coordinates at the start, in the order bending along y, along z, torsion, stretch. Made by
    `deformation`.
    """

    __slots__ = ()


class Elements(Part):
    """Shells or beams that move: a structure in the axes of the body, in which it deforms. Made by `elements`."""

    __slots__ = ()


class Structure(Part):
    """A structure: a mesh, of what it is made, and how it is supported. Made by `structure`."""

    __slots__ = ()


class Mesh(Part):
    """A generator of a mesh. x runs along the first direction of a panel, y along the second. A panel names its
    edges x0, x1, y0, y1, its corners x0y0 … x1y1, and all. A line of beams names its ends start and end, and all.
    Made by `meshes`.
    """

    __slots__ = ()


class Member(Part):
    """A member of a frame. Made by `member`."""

    __slots__ = ()


class VariedThickness(Part):
    """Thickness by elements, bands, patches or groups. A variable whose path ends at `value` stands for one variable
    each. Made by `varied_thickness`.
    """

    __slots__ = ()


class StructureSection(Part):
    """A cross section by its sizes, or by given stiffnesses `G`. In structures axis 2 lies in the plane of beam and
    orientation, and axis 3 is normal to both; in the axes of a moving beam axis 2 is z and axis 3 is y. Made by
    `structure_sections`.
    """

    __slots__ = ()


class VariedSection(Part):
    """Cross sections by elements or groups. A variable whose path goes through `value` stands for one variable each.
    Made by `varied_section`.
    """

    __slots__ = ()


class Set(Part):
    """A set of nodes or elements, in the directions ξ and η of a panel, which run from 0 to 1; a line of beams has
    the first only. Made by `sets`.
    """

    __slots__ = ()


class Support(Part):
    """A support: what the nodes of some sets cannot do, in ground axes. Made by `support`."""

    __slots__ = ()


class NodeMass(Part):
    """A non-structural mass at each node of a set. Made by `node_mass`."""

    __slots__ = ()


class Stiffener(Part):
    """Beams along the line of nodes of a panel between its elements that is nearest to a place, of the material of
    the structure. Axis 2 of their section is along the normal of the surface. Made by `stiffener`.
    """

    __slots__ = ()


class ElementFrame(Part):
    """What holds the axes of shells. It only says from where deformations count; forces and stresses do not depend
    on it as long as rotations are small. Made by `element_frames`.
    """

    __slots__ = ()


class ElementBasis(Part):
    """Which coordinates shells have. Made by `element_bases`."""

    __slots__ = ()


class HeldPlace(Part):
    """Where something holds on to shells. Made by `held_places`."""

    __slots__ = ()


class Modal(Part):
    """A body by the matrices or by the modes that another code has written. Its axes are those of the files. Its
    strain energy is quadratic: rotation does not stiffen it. Made by `modal`.
    """

    __slots__ = ()


class Source(Part):
    """Where the numbers of a body are. Made by `sources`."""

    __slots__ = ()


class Units(Part):
    """Units of the files of a body in SI units. Made by `units`."""

    __slots__ = ()


class ModalFrame(Part):
    """What holds the axes of a body of matrices. Made by `modal_frames`."""

    __slots__ = ()


class ModalDamping(Part):
    """Damping of the elastic coordinates in addition to that of the file. Made by `modal_damping`."""

    __slots__ = ()


class Surface(Part):
    """A homogeneous solid inside a closed surface of triangles. Its axes are those of the file. Made by `surface`."""

    __slots__ = ()


class Between(Part):
    """A point on the line through two named points of the same body. Made by `between`."""

    __slots__ = ()


class Place(Part):
    """Placement of a body: `put` this point of the body `at` that place, with this `turn`. Made by `place`."""

    __slots__ = ()


class Turn(Part):
    """A rotation in one of its forms: an axis with an angle, an axis of the ground with an angle, a sequence of
    angles about the body's own axes, a quaternion, or a matrix. Made by `turn`.
    """

    __slots__ = ()


class BodyVelocity(Part):
    """Velocity of one body at the start. Made by `body_velocity`."""

    __slots__ = ()


class Joint(Part):
    """A joint between two bodies, or a body and "ground". Made by `joints`."""

    __slots__ = ()


class PointPair(Part):
    """One point on each body of a joint. Made by `point_pair`."""

    __slots__ = ()


class BodyAxis(Part):
    """An axis fixed in a body. Made by `body_axis`."""

    __slots__ = ()


class JointStart(Part):
    """Initial position and rate of the motion of a joint. Made by `joint_start`."""

    __slots__ = ()


class TurnStart(Part):
    """Initial angle and rate. Made by `turn_start`."""

    __slots__ = ()


class SlideStart(Part):
    """Initial displacement and rate. Made by `slide_start`."""

    __slots__ = ()


class Load(Part):
    """A force, torque, spring, damper, bushing, friction, drag, stop, contact, cable or controller. Made by `loads`."""

    __slots__ = ()


class VaryingForce(Part):
    """Function of time: a force. Made by `varying_forces`."""

    __slots__ = ()


class VaryingTorque(Part):
    """Function of time: a torque. Made by `varying_torques`."""

    __slots__ = ()


class ForceTable(Part):
    """Forces or torques over a stretch, an angle or a rate. It goes on straight beyond both ends. Made by
    `force_table`.
    """

    __slots__ = ()


class BushingStiffness(Part):
    """Stiffness of a bushing. Made by `bushing_stiffnesses`."""

    __slots__ = ()


class BushingDamping(Part):
    """Damping of a bushing. Made by `bushing_dampings`."""

    __slots__ = ()


class BearingFriction(Part):
    """Friction of a bearing or guide: μ ρ N tanh(ω / w) against the rate ω of the turn about e3 or of the slide
    along it, with N = √(f² + n²) − n by the force f of the bushing across e3. Made by `bearing_friction`.
    """

    __slots__ = ()


class Wheel(Part):
    """A wheel: a torus. Made by `wheel`."""

    __slots__ = ()


class Surface2(Part):
    """Surface of a contact. Directions are in ground axes at the start and fixed in the body. Made by `surface2s`."""

    __slots__ = ()


class ContactFriction(Part):
    """Friction of a contact. Made by `contact_friction`."""

    __slots__ = ()


class Stribeck(Part):
    """Friction that falls from a static to a sliding coefficient: μ + (μ_s − μ) exp(−v_t²/v_s²). Made by `stribeck`."""

    __slots__ = ()


class CablePoint(Part):
    """A point of a cable. Made by `cable_point`."""

    __slots__ = ()


class Sliding(Part):
    """Function of time: a displacement. Made by `sliding`."""

    __slots__ = ()


class VaryingPressure(Part):
    """Function of time: a pressure. Made by `varying_pressures`."""

    __slots__ = ()


class VaryingLineForce(Part):
    """Function of time: a force per length. Made by `varying_line_forces`."""

    __slots__ = ()


class Following(Part):
    """Function of time: an angle, displacement or distance. Made by `followings`."""

    __slots__ = ()


class VaryingEffort(Part):
    """Function of time: a force or torque. Made by `varying_efforts`."""

    __slots__ = ()


class Feedback(Part):
    """Feedback of another joint. Made by `feedback`."""

    __slots__ = ()


class Balanced(Part):
    """A mass whose weight is balanced. Made by `balanced`."""

    __slots__ = ()


class Motor(Part):
    """A motor behind a gear. A limit z of a demand u leaves u (1 + (u/z)⁸)^(−1/8), which is off by less than 0.1 %
    up to half of the limit. Made by `motor`.
    """

    __slots__ = ()


class Curve(Part):
    """Torque of a motor by its speed: between −A (1 + ω/W) and A (1 − ω/W). Made by `curve`."""

    __slots__ = ()


class Drive(Part):
    """Prescribed motion of a joint about its axis, along it, or both. It is the motion of the first body relative to
    the second (ground counts as the second), from the placement. Made by `drive`.
    """

    __slots__ = ()


class Turning(Part):
    """Function of time: an angle. Made by `turning`."""

    __slots__ = ()


class Coupling(Part):
    """A linear relation between the motions of joints, over any number of turns: gears, a rack, a screw, a belt, or
    any other. It holds as the bodies are placed. Made by `couplings`.
    """

    __slots__ = ()


class Term(Part):
    """A motion of a joint with its factor. Made by `term`."""

    __slots__ = ()


class JointMotion(Part):
    """A motion of a joint: that of its first body against the second (ground counts as the second). Made by
    `joint_motions`.
    """

    __slots__ = ()


class Profile(Part):
    """A function that is twice continuously differentiable, level at both ends and constant beyond. Made by
    `profile`.
    """

    __slots__ = ()


class TerminalEvent(Part):
    """An event that ends the run. Made by `terminal_event`."""

    __slots__ = ()


class Quantity(Part):
    """A quantity at an instant. Made by `quantities`."""

    __slots__ = ()


class PowerOf(Part):
    """What gives or takes power: a load, or the drive of a joint. Made by `power_ofs`."""

    __slots__ = ()


class Gate(Part):
    """A smooth gate on a rotation: the range counts only while the rotation is above (or below) a limit. Give `body`
    and `axis`, or `joint`; and one of `above` and `below`. Made by `gate`.
    """

    __slots__ = ()


class Method(Part):
    """An integration method. Made by `methods`."""

    __slots__ = ()


class At(Part):
    """A time of the motion. Made by `at`."""

    __slots__ = ()


class CaseLoad(Part):
    """A load of a load case. Sets have the name of their structure before a dot, or their own if there is one
    structure. Made by `case_loads`.
    """

    __slots__ = ()


class Function(Part):
    """A function of interest: a quantity at an instant, reduced over the run, or a clearance. Made by `functions`."""

    __slots__ = ()


class WindowEnds(Part):
    """The ends of a window. Made by `window_ends`."""

    __slots__ = ()


class Reach(Part):
    """A quantity reaches a value: give one of `reaches`, `rises_to` and `falls_to`. Made by `reach`."""

    __slots__ = ()


class AtEvent(Part):
    """An event of the file. A window ends just before it or starts just after it, and a value is that just before
    it. Made by `at_event`.
    """

    __slots__ = ()


class Within(Part):
    """A quantity and a window of time. Made by `within`."""

    __slots__ = ()


class Series(Part):
    """A quantity measured at several times. Give "table" or "file". Made by `series`."""

    __slots__ = ()


class DataFile(Part):
    """A file of values separated by commas. Made by `data_file`."""

    __slots__ = ()


class MeasuredNumber(Part):
    """A measured value of a function. Made by `measured_number`."""

    __slots__ = ()


class Barrier(Part):
    """A barrier across the direction of flight. Made by `barrier`."""

    __slots__ = ()


class CaseCombination(Part):
    """What is taken of the values f_c of a function in several cases, with weights w_c. Made by `case_combinations`."""

    __slots__ = ()


class ExpressionOfFunctions(Part):
    """An expression of functions. Made by `expression_of_functions`."""

    __slots__ = ()


class JointDefaults(Part):
    """Keys of joints. Made by `joint_defaults`."""

    __slots__ = ()


BeamFrame: TypeAlias = Literal["chord", "clamped"]
"""What holds the axes of a beam."""

BendingFunctions: TypeAlias = Literal["polynomial", "sine"]
"""Functions of bending."""

BeamStrain: TypeAlias = Literal["von_karman", "linear"]
"""Strain of the line of centres."""

LengthUnit: TypeAlias = Literal["m", "cm", "mm", "inch"]
"""A unit of length."""

ShellElement: TypeAlias = Literal["mitc9", "mitc4"]
"""Elements of shells."""

Thickness: TypeAlias = Union[Real, VariedThickness]
"""Thickness of shells."""

Per: TypeAlias = Literal["element", "band", "patch", "group"]
"""What shares a value."""

Direction: TypeAlias = Literal["x", "y"]
"""A direction of a panel."""

HeldMotion: TypeAlias = Literal["x", "y", "z", "rx", "ry", "rz"]
"""What a support holds."""

ElementInertia: TypeAlias = Literal["full", "paper"]
"""Which inertia shells have."""

InterfaceNodes: TypeAlias = Union[Integer, Vector]
"""Nodes of an interface."""

BodyPoint: TypeAlias = Union[Vector, Between]
"""A named point of a body."""

Point: TypeAlias = Union[str, Vector]
"""A point of a body."""

Location: TypeAlias = Union[str, Vector]
"""A place in space."""

Turns: TypeAlias = Union[Turn, Sequence[Turn]]
"""One rotation or several."""

InDegrees: TypeAlias = Union[Real, Vector]
"""One angle or three, in degrees."""

Analysis: TypeAlias = Literal["motion", "rest", "modes"]
"""What is computed of a machine."""

StartOfMotion: TypeAlias = Literal["given", "equilibrium"]
"""Deformations of flexible bodies at the start."""

JointPlace: TypeAlias = Union[str, Vector, PointPair]
"""Position of a joint at the start."""

Axis: TypeAlias = Union[Vector, BodyAxis]
"""Direction of a joint's axis."""

Ends: TypeAlias = Union[Matrix, PointPair]
"""Ends of a rod or spring."""

Axes: TypeAlias = Literal["ground", "body"]
"""Axes in which a direction is fixed."""

ForceInTime: TypeAlias = Union[Real, VaryingForce]
"""Magnitude of a force."""

Interpolation: TypeAlias = Literal["linear", "monotone", "spline"]
"""Interpolation between the values of a table."""

TorqueInTime: TypeAlias = Union[Real, VaryingTorque]
"""Magnitude of a torque."""

Motion: TypeAlias = Literal["turn", "slide"]
"""A degree of freedom of a joint."""

BushingAxes: TypeAlias = Literal["first", "second"]
"""A body of a joint."""

CableLength: TypeAlias = Union[Real, Sliding]
"""Length of a cable."""

PressureInTime: TypeAlias = Union[Real, VaryingPressure]
"""Magnitude of a pressure."""

LineForceInTime: TypeAlias = Union[Real, VaryingLineForce]
"""Magnitude of a force per length."""

Reference: TypeAlias = Union[Real, Following]
"""What a coordinate follows."""

EffortInTime: TypeAlias = Union[Real, VaryingEffort]
"""Magnitude of a force or torque."""

EnergyKind: TypeAlias = Literal["kinetic", "potential", "total"]
"""Kind of energy."""

CountedFrom: TypeAlias = Literal["axes", "placement"]
"""Zero of a rotation."""

ReactionAxes: TypeAlias = Literal["ground", "joint"]
"""Axes of the direction of a reaction."""

SectionPlace: TypeAlias = Union[str, Real]
"""A section of a beam."""

SectionComponent: TypeAlias = Literal["axial", "shear_y", "shear_z", "torsion", "bending_y", "bending_z"]
"""A force or moment in a section, by the beam's axes."""

SectionPlaces: TypeAlias = Union[Integer, Sequence[SectionPlace]]
"""Several sections of a beam."""

Sign: TypeAlias = Literal["positive", "negative", "both"]
"""Sign of the values of which the largest counts."""

Bound: TypeAlias = Literal["below", "above"]
"""A side of the true maximum."""

FirstSteps: TypeAlias = Literal["radau", "rising_order"]
"""Method of the first steps of a multistep formula."""

LinearSolver: TypeAlias = Literal["direct", "krylov"]
"""How linear systems are solved."""

When: TypeAlias = Union[TerminalEvent, At]
"""When an event comes."""

Strains: TypeAlias = Literal["linear", "von_karman"]
"""Strains of structures."""

Unknowns: TypeAlias = Literal["five", "six"]
"""Unknowns of a node on a smooth surface."""

During: TypeAlias = Union[Vector, WindowEnds]
"""A window of time: `[start, end]`, or `{"from": …, "to": …}`."""

Edge: TypeAlias = Union[Real, Reach, AtEvent]
"""A time, the first time at which a quantity reaches a value, or an event that changes the machine."""

Over: TypeAlias = Union[Within, Quantity]
"""A quantity, over the whole run or a window of time: the quantity alone, or with `during`."""

Variance: TypeAlias = Literal["given", "estimated"]
"""The scale of the covariance of fitted numbers."""

StressAggregate: TypeAlias = Literal["ks", "induced_exponential"]
"""A smooth aggregate of stress ratios."""

StressPer: TypeAlias = Literal["thickness"]
"""What has an aggregate of its own."""

AllCases: TypeAlias = Literal["all"]
"""All cases."""

WhichCases: TypeAlias = Union[AllCases, Sequence[str], Mapping[str, Real]]
"""The cases of a function over cases."""

Extreme: TypeAlias = Literal["largest", "smallest"]
"""A largest or smallest value."""

WhichFunction: TypeAlias = Union[str, ExpressionOfFunctions]
"""A function: its name, or an expression of functions."""

OptimisationMethod: TypeAlias = Literal["interior_point", "trust_region", "least_squares", "auto"]
"""An optimisation algorithm."""

View: TypeAlias = Literal["xy", "xz", "yz", "yx", "zx", "zy"]
"""Plane of the view: first axis to the right, second up."""


@checked
def body(
    *,
    description: str | None = None,
    shape: Shape | Literal["point"] | None = None,
    density: Real | None = None,
    mass: Real | None = None,
    centre_of_mass: Vector | None = None,
    inertia: Inertia | None = None,
    beam: Beam | None = None,
    elements: Elements | None = None,
    modal: Modal | None = None,
    mass_properties: Surface | None = None,
    points: Mapping[str, BodyPoint] | None = None,
    place: Place | None = None,
    velocity: BodyVelocity | None = None,
) -> Body:
    """A body: a shape with its mass or density, or an explicit mass, centre of mass and inertia, or a beam or a body
    of files with elastic coordinates.

    Parameters
    ----------
    description : text, optional
        Remark for readers of the file.
    shape : one of `shapes` or "point", optional
        A homogeneous solid, centred at the origin of the body's axes; it gives the inertia.
    density : number above 0 [kg/m³], optional
        Density of the shape, instead of a mass.
    mass : number at least 0 [kg], optional
        Mass. A body of mass 0 needs joints that, with the inertia of other bodies, determine its motion.
    centre_of_mass : numbers, shape (3,) [m], optional
        Centre of mass of a body without a shape, from the origin of the body's axes; default 0.
    inertia : `inertia(…)`, optional
        Inertia of a body without a shape; 0 by default if its mass is 0.
    beam : `beam(…)`, optional
        A beam with elastic coordinates, instead of all above.
    elements : `elements(…)`, optional
        Shells with elastic coordinates at all their nodes, instead of all above.
    modal : `modal(…)`, optional
        A body with elastic coordinates from files of other codes, instead of all above.
    mass_properties : `surface(…)`, optional
        Mass, centre of mass and inertia of a solid from its surface, instead of all above.
    points : numbers, shape (3,) [m] or `between(…)` by name, optional
        Named points in body axes from their origin (the centre of the shape, the start of a beam).
    place : `place(…)`, optional
        Placement at the start; by default its axes are those of ground.
    velocity : `body_velocity(…)`, optional
        Its velocity at the start, instead of that of the assembly.
    """
    return made(Body, "body", locals())


@checked
def inertia(
    *,
    xx: Real,
    yy: Real,
    zz: Real,
    xy: Real | None = None,
    xz: Real | None = None,
    yz: Real | None = None,
) -> Inertia:
    """Entries of the symmetric inertia matrix about the centre of mass in body axes. The entry xy is minus the
    integral of x y over the mass.

    Parameters
    ----------
    xx : number at least 0 [kg m²]
        Moment about x.
    yy : number at least 0 [kg m²]
        Moment about y.
    zz : number at least 0 [kg m²]
        Moment about z.
    xy : number [kg m²], optional
        Entry xy, default 0.
    xz : number [kg m²], optional
        Entry xz, default 0.
    yz : number [kg m²], optional
        Entry yz, default 0.
    """
    return made(Inertia, "inertia", locals())


@checked
def beam(
    *,
    length: Real,
    section: Section,
    material: BeamMaterial | None = None,
    frame: BeamFrame | None = None,
    modes: BeamModes | None = None,
    functions: BendingFunctions | None = None,
    strain: BeamStrain | None = None,
    shear: bool | None = None,
    damping: Damping | None = None,
    stations: Mapping[str, Real] | None = None,
    start: Deformation | None = None,
) -> Beam:
    """A straight uniform beam with elastic coordinates. Its axes: origin at its start, x along it.

    Parameters
    ----------
    length : number above 0 [m]
        Length along x.
    section : one of `sections`
        Cross section.
    material : `beam_material(…)`, optional
        Material; given stiffnesses need none, but for stresses.
    frame : "chord" or "clamped", optional
        What holds the axes, default "chord".
        "chord": x runs through both ends, and the start does not turn about it.
        "clamped": The section at the start.
    modes : `beam_modes(…)`, optional
        How many functions of each kind.
    functions : "polynomial" or "sine", optional
        Functions of bending, default "polynomial".
        "polynomial": Polynomials.
        "sine": Sines, the modes of a beam on hinges. They have no companions, so the strain must be linear.
    strain : "von_karman" or "linear", optional
        Strain of the line of centres, default "von_karman".
        "von_karman": u' + ½ v'² + ½ w'²: the beam stiffens when it is stretched.
        "linear": u': it does not.
    shear : bool, optional
        Whether sections shear, default true. Given stiffnesses shear if they have ga_y and ga_z.
    damping : `damping(…)`, optional
        Damping, default none.
    stations : number by name, optional
        Named points on the line of centres, as fractions of the length; "start" and "end" are there anyway.
    start : `deformation(…)`, optional
        Deformation at the start, default none.
    """
    return made(Beam, "beam", locals())


@checked
def beam_material(*, young: Real, poisson: Real | None = None, density: Real | None = None) -> BeamMaterial:
    """An isotropic material.

    Parameters
    ----------
    young : number above 0 [Pa]
        Young's modulus.
    poisson : number above -1 and at most 0.5, optional
        Poisson's ratio, default 0.3.
    density : number above 0 [kg/m³], optional
        Density. Given masses per length need none.
    """
    return made(BeamMaterial, "beam_material", locals())


@checked
def beam_modes(
    *,
    bending_y: Integer | None = None,
    bending_z: Integer | None = None,
    torsion: Integer | None = None,
    stretch: Integer | None = None,
) -> BeamModes:
    """How many functions a beam has of each kind.

    Parameters
    ----------
    bending_y : integer from 0 to 12, optional
        Bending along y, default 4.
    bending_z : integer from 0 to 12, optional
        Bending along z, default 4.
    torsion : integer from 0 to 12, optional
        Torsion, default 2.
    stretch : integer from 0 to 25, optional
        Stretch, default twice the larger number of bending and one: a bent beam then shortens without strain. 2
        if the strain is linear.
    """
    return made(BeamModes, "beam_modes", locals())


@checked
def damping(
    *,
    ratio: Real | None = None,
    torsion_ratio: Real | None = None,
    stretch_ratio: Real | None = None,
    mass: Real | None = None,
    stiffness: Real | None = None,
) -> Damping:
    """Damping of the elastic coordinates: a part of critical damping for each mode of the body while its axes are
    held, plus α M + β K.

    Parameters
    ----------
    ratio : number at least 0, optional
        Part of critical damping of all modes, default 0.
    torsion_ratio : number at least 0, optional
        That of torsion, default `ratio`.
    stretch_ratio : number at least 0, optional
        That of stretch, default `ratio`.
    mass : number at least 0 [1/s], optional
        α, of the mass, default 0.
    stiffness : number at least 0 [s], optional
        β, of the stiffness, default 0.
    """
    return made(Damping, "damping", locals())


@checked
def deformation(*, coordinates: Vector | None = None, rates: Vector | None = None) -> Deformation:
    """Elastic coordinates at the start, in the order bending along y, along z, torsion, stretch.

    Parameters
    ----------
    coordinates : numbers, shape (n,) [m], optional
        The coordinates, default 0.
    rates : numbers, shape (n,) [m/s], optional
        Their rates, default 0.
    """
    return made(Deformation, "deformation", locals())


@checked
def elements(
    *,
    structure: Structure,
    frame: ElementFrame,
    stiffeners: Mapping[str, Stiffener] | None = None,
    basis: ElementBasis | Literal["full", "rigid"] | None = None,
    inertia: ElementInertia | None = None,
    points: Mapping[str, HeldPlace] | None = None,
) -> Elements:
    """Shells or beams that move: a structure in the axes of the body, in which it deforms.

    Parameters
    ----------
    structure : `structure(…)`
        Mesh, material, thickness or sections, masses at nodes, damping.
    frame : one of `element_frames`
        What holds the axes.
    stiffeners : `stiffener(…)` by name, optional
        Beams along lines of nodes of shells, by name.
    basis : one of `element_bases` or "full" or "rigid", optional
        Which coordinates the body has, default all of its nodes.
    inertia : "full" or "paper", optional
        Which inertia the body has, default that of the deformed body.
        "full": That of the deformed body, with all Coriolis and centrifugal forces.
        "paper": That of Kennedy & Boopathy (2016), equations 13 and 14, which leaves out products of places and
            deformations and depends on the velocity of the observer. It is here for comparison.
    points : one of `held_places` by name, optional
        Nodes and edges by the names that joints, loads and functions use as points of the body.
    """
    return made(Elements, "elements", locals())


@checked
def structure(
    *,
    mesh: Mesh,
    material: str,
    description: str | None = None,
    element: ShellElement | None = None,
    at: Vector | None = None,
    thickness: Thickness | None = None,
    section: StructureSection | None = None,
    sections: VariedSection | None = None,
    surface_mass: Real | None = None,
    line_mass: Real | None = None,
    offset: Vector | None = None,
    sets: Mapping[str, Set] | None = None,
    supports: Mapping[str, Support] | None = None,
    masses: Mapping[str, NodeMass] | None = None,
    damping: Damping | None = None,
) -> Structure:
    """A structure: a mesh, of what it is made, and how it is supported.

    Parameters
    ----------
    mesh : one of `meshes`
        The mesh, by a generator or from a file.
    material : text
        Name of the material.
    description : text, optional
        Remark for readers of the file.
    element : "mitc9" or "mitc4", optional
        The element of shells, default mitc9. Numbers of elements count these.
        "mitc9": Nine nodes: MITC9 of Bucalem and Bathe (1993).
        "mitc4": Four nodes: MITC4 of Dvorkin and Bathe (1984). Each costs less, and more of them are needed.
    at : numbers, shape (3,) [m], optional
        Origin of the mesh, default [0, 0, 0].
    thickness : number above 0 [m] or `varied_thickness(…)`, optional
        Thickness of shells: one number, or one of its own for each element, band, patch or group.
        number above 0 [m]: One for all.
        `varied_thickness(…)`: Several.
    section : one of `structure_sections`, optional
        Cross section of all beams.
    sections : `varied_section(…)`, optional
        Cross sections by elements or groups, instead of `section`.
    surface_mass : number at least 0 [kg/m²], optional
        Non-structural mass per area of shells, default 0.
    line_mass : number at least 0 [kg/m], optional
        Non-structural mass per length of beams, default 0.
    offset : numbers, shape (2,) [m], optional
        Offset of the centre of the section from the nodes of beams, along its axes 2 and 3, default 0.
    sets : one of `sets` by name, optional
        Sets of nodes or elements by name, besides those that the generator names.
    supports : `support(…)` by name, optional
        Supports by name.
    masses : `node_mass(…)` by name, optional
        Masses at nodes, by name.
    damping : `damping(…)`, optional
        Damping, which only a motion has: a structure that does not move has none.
    """
    return made(Structure, "structure", locals())


@checked
def member(*, between: Sequence[str], orientation: Vector, elements: Integer) -> Member:
    """A member of a frame.

    Parameters
    ----------
    between : list of 2 texts
        Names of the points that it joins.
    orientation : numbers, shape (3,)
        A vector in the plane of the member and axis 2 of its section.
    elements : integer from 1 to 1000000
        Number of elements.
    """
    return made(Member, "member", locals())


@checked
def varied_thickness(
    *,
    per: Per,
    along: Direction | None = None,
    bands: Integer | None = None,
    patches: Vector | None = None,
    groups: Sequence[str] | None = None,
    value: Real | None = None,
    values: Vector | None = None,
) -> VariedThickness:
    """Thickness by elements, bands, patches or groups. A variable whose path ends at `value` stands for one variable
    each.

    Parameters
    ----------
    per : "element" or "band" or "patch" or "group"
        What has a thickness of its own.
        "element": Each element has its own.
        "band": Each band across a panel has its own.
        "patch": Each patch of a panel has its own.
        "group": Each named set of elements has its own.
    along : "x" or "y", optional
        Of bands: the direction in which they follow each other, default y.
        "x": The first.
        "y": The second.
    bands : integer from 1 to 100000, optional
        Of bands: how many, default as many as elements.
    patches : integers, shape (2,) at least 1, optional
        Of patches: how many along x and y.
    groups : list of texts, optional
        Of groups: their names, which are sets of faces.
    value : number above 0 [m], optional
        The value of all.
    values : numbers, shape (n,) above 0 [m], optional
        The value of each, instead of `value`: patches and elements row by row along x.
    """
    return made(VariedThickness, "varied_thickness", locals())


@checked
def varied_section(
    *,
    per: Per,
    groups: Sequence[str] | None = None,
    value: StructureSection | None = None,
    values: Sequence[StructureSection] | None = None,
) -> VariedSection:
    """Cross sections by elements or groups. A variable whose path goes through `value` stands for one variable each.

    Parameters
    ----------
    per : "element" or "band" or "patch" or "group"
        What has a section of its own: element or group.
        "element": Each element has its own.
        "band": Each band across a panel has its own.
        "patch": Each patch of a panel has its own.
        "group": Each named set of elements has its own.
    groups : list of texts, optional
        Of groups: their names, which are sets of beams.
    value : one of `structure_sections`, optional
        The section of all.
    values : list of one of `structure_sections`, optional
        The section of each, instead of `value`.
    """
    return made(VariedSection, "varied_section", locals())


@checked
def support(*, nodes: str | Sequence[str], held: Sequence[HeldMotion] | None = None) -> Support:
    """A support: what the nodes of some sets cannot do, in ground axes.

    Parameters
    ----------
    nodes : text or list of texts
        The set of nodes, or a list of sets.
    held : list of "x" or "y" or "z" or "rx" or "ry" or "rz", optional
        What is held: displacements x, y, z and rotations rx, ry, rz; default all of them.
    """
    return made(Support, "support", locals())


@checked
def node_mass(*, nodes: str, mass: Real, inertia: Vector | None = None) -> NodeMass:
    """A non-structural mass at each node of a set.

    Parameters
    ----------
    nodes : text
        Name of the set of nodes.
    mass : number at least 0 [kg]
        Mass at each node.
    inertia : numbers, shape (6,) [kg m²], optional
        Its inertia about the node, xx, yy, zz, xy, yz, zx in ground axes; default none.
    """
    return made(NodeMass, "node_mass", locals())


@checked
def stiffener(
    *,
    along: Direction,
    at: Real,
    section: StructureSection,
    offset: Vector | None = None,
    line_mass: Real | None = None,
) -> Stiffener:
    """Beams along the line of nodes of a panel between its elements that is nearest to a place, of the material of
    the structure. Axis 2 of their section is along the normal of the surface.

    Parameters
    ----------
    along : "x" or "y"
        The direction of the panel along which the line runs.
        "x": The first.
        "y": The second.
    at : number from 0 to 1
        Its place in the other direction, from 0 to 1.
    section : one of `structure_sections`
        Cross section.
    offset : numbers, shape (2,) [m], optional
        Offset of the centre of the section from the nodes, along its axes 2 and 3, default 0.
    line_mass : number at least 0 [kg/m], optional
        Non-structural mass per length, default 0.
    """
    return made(Stiffener, "stiffener", locals())


@checked
def modal(
    *,
    source: Source,
    interfaces: Mapping[str, InterfaceNodes] | None = None,
    frame: ModalFrame | None = None,
    modes: Integer | None = None,
    young_factor: Real | None = None,
    density_factor: Real | None = None,
    scale: Real | None = None,
    damping: ModalDamping | None = None,
    start: Deformation | None = None,
) -> Modal:
    """A body by the matrices or by the modes that another code has written. Its axes are those of the files. Its
    strain energy is quadratic: rotation does not stiffen it.

    Parameters
    ----------
    source : one of `sources`
        The files. Paths are relative to the directory of the problem file.
    interfaces : integer at least 0 or integers, shape (n,) at least 0 by name, optional
        Nodes that joints, loads and functions hold, by name; each name is a point of the body. Those of
        "standard_input" are in its file.
    frame : one of `modal_frames`, optional
        What holds the axes of a body of matrices; default: clamped at the first interface.
    modes : integer from 0 to 200, optional
        Fixed-interface modes of a body of matrices, default 10.
    young_factor : number above 0, optional
        Factor of the stiffness matrix, default 1.
    density_factor : number above 0, optional
        Factor of the mass matrix, default 1.
    scale : number above 0, optional
        Factor of all lengths, those of sections included, default 1: a similar body of the same material.
    damping : `modal_damping(…)`, optional
        Damping, default none.
    start : `deformation(…)`, optional
        Elastic coordinates at the start, by ascending frequency, default 0.
    """
    return made(Modal, "modal", locals())


@checked
def units(*, length: Real | None = None, mass: Real | None = None, time: Real | None = None) -> Units:
    """Units of the files of a body in SI units.

    Parameters
    ----------
    length : number above 0 [m], optional
        Unit of length in metres, default 1 (millimetres: 0.001).
    mass : number above 0 [kg], optional
        Unit of mass in kilograms, default 1 (tonnes: 1000).
    time : number above 0 [s], optional
        Unit of time in seconds, default 1.
    """
    return made(Units, "units", locals())


@checked
def modal_damping(
    *,
    ratio: Real | None = None,
    mass: Real | None = None,
    stiffness: Real | None = None,
) -> ModalDamping:
    """Damping of the elastic coordinates in addition to that of the file.

    Parameters
    ----------
    ratio : number at least 0, optional
        Part of critical damping of all modes, default 0.
    mass : number at least 0 [1/s], optional
        α of α M + β K, default 0.
    stiffness : number at least 0 [s], optional
        β of α M + β K, default 0.
    """
    return made(ModalDamping, "modal_damping", locals())


@checked
def surface(*, stl: str, density: Real, unit: LengthUnit | None = None) -> Surface:
    """A homogeneous solid inside a closed surface of triangles. Its axes are those of the file.

    Parameters
    ----------
    stl : text
        Path of an STL file, relative to the directory of the problem file.
    density : number above 0 [kg/m³]
        Density.
    unit : "m" or "cm" or "mm" or "inch", optional
        Unit of the coordinates of the file, default "m".
        "m": Metres.
        "cm": Centimetres.
        "mm": Millimetres.
        "inch": Inches.
    """
    return made(Surface, "surface", locals())


@checked
def between(*, between: Sequence[str], fraction: Real) -> Between:
    """A point on the line through two named points of the same body.

    Parameters
    ----------
    between : list of 2 texts
        Names of both points.
    fraction : number
        Where it is: 0 at the first, 1 at the second; other numbers are on the line beyond them.
    """
    return made(Between, "between", locals())


@checked
def place(
    *,
    put: Point | None = None,
    at: Location | None = None,
    turn: Turns | None = None,
    relative_to: str | None = None,
) -> Place:
    """Placement of a body: `put` this point of the body `at` that place, with this `turn`.

    Parameters
    ----------
    put : text or numbers, shape (3,) [m], optional
        Point of this body, by name or in body axes; default the origin of its axes.
        text: Name of one of the body's points.
        numbers, shape (3,) [m]: Coordinates in body axes from their origin.
    at : text or numbers, shape (3,) [m], optional
        Place of that point: `"body.point"`, `"body"` for the origin of its axes, or ground coordinates; default
        the origin.
        text: `"body.point"`, or `"body"` for the origin of its axes.
        numbers, shape (3,) [m]: Ground coordinates.
    turn : `turn(…)` or list of `turn(…)`, optional
        Rotation from the axes of ground (or of `relative_to`) to those of the body, or a list of rotations about
        the fixed ground axes, applied in order; default none.
        `turn(…)`: One rotation.
        list of `turn(…)`: Several, applied in order.
    relative_to : text, optional
        Body from whose axes the turn starts; default ground.
    """
    return made(Place, "place", locals())


@checked
def turn(
    *,
    axis: Vector | None = None,
    angle: Real | None = None,
    degrees: InDegrees | None = None,
    x: Real | None = None,
    y: Real | None = None,
    z: Real | None = None,
    sequence: str | None = None,
    angles: Vector | None = None,
    quaternion: Vector | None = None,
    matrix: Matrix | None = None,
) -> Turn:
    """A rotation in one of its forms: an axis with an angle, an axis of the ground with an angle, a sequence of
    angles about the body's own axes, a quaternion, or a matrix.

    Parameters
    ----------
    axis : numbers, shape (3,), optional
        Axis of any length but zero, with `angle` or `degrees`.
    angle : number [rad], optional
        Angle by the right-hand rule.
    degrees : number [°] or numbers, shape (3,) [°], optional
        The angle in degrees instead, or with `sequence` its three angles.
        number [°]: One.
        numbers, shape (3,) [°]: Three.
    x : number [°], optional
        Rotation about x.
    y : number [°], optional
        Rotation about y.
    z : number [°], optional
        Rotation about z.
    sequence : text, optional
        Three of x, y and z: rotations about these axes of the body, each as those before it have turned them;
        "zyx" are yaw, pitch and roll. With `angles` or `degrees`.
    angles : numbers, shape (3,) [rad], optional
        Angles of `sequence` in radians.
    quaternion : numbers, shape (4,), optional
        Unit quaternion w, x, y, z: cos(angle/2), then the unit axis times sin(angle/2). It is normalised.
    matrix : numbers, shape (3, 3), optional
        Rows of the rotation matrix; its columns are the axes of the turned body.
    """
    return made(Turn, "turn", locals())


@checked
def body_velocity(*, linear: Vector | None = None, angular: Vector | None = None) -> BodyVelocity:
    """Velocity of one body at the start.

    Parameters
    ----------
    linear : numbers, shape (3,) [m/s], optional
        Velocity of the centre of mass (of a beam's start) in ground axes, default 0.
    angular : numbers, shape (3,) [rad/s], optional
        Angular velocity in ground axes, default 0.
    """
    return made(BodyVelocity, "body_velocity", locals())


@checked
def point_pair(*, a: Point, b: Point) -> PointPair:
    """One point on each body of a joint.

    Parameters
    ----------
    a : text or numbers, shape (3,) [m]
        Point of the first body, by name or in its axes (ground coordinates if it is ground).
        text: Name of one of the body's points.
        numbers, shape (3,) [m]: Coordinates in body axes from their origin.
    b : text or numbers, shape (3,) [m]
        Point of the second body, by name or in its axes (ground coordinates if it is ground).
        text: Name of one of the body's points.
        numbers, shape (3,) [m]: Coordinates in body axes from their origin.
    """
    return made(PointPair, "point_pair", locals())


@checked
def body_axis(*, body: str, axis: Vector) -> BodyAxis:
    """An axis fixed in a body.

    Parameters
    ----------
    body : text
        The body.
    axis : numbers, shape (3,)
        Direction in its axes.
    """
    return made(BodyAxis, "body_axis", locals())


@checked
def joint_start(*, turn: TurnStart | None = None, slide: SlideStart | None = None) -> JointStart:
    """Initial position and rate of the motion of a joint.

    Parameters
    ----------
    turn : `turn_start(…)`, optional
        Rotation about the axis.
    slide : `slide_start(…)`, optional
        Displacement along the axis.
    """
    return made(JointStart, "joint_start", locals())


@checked
def turn_start(
    *,
    angle: Real | None = None,
    rate: Real | None = None,
    degrees: Real | None = None,
    degrees_per_second: Real | None = None,
) -> TurnStart:
    """Initial angle and rate.

    Parameters
    ----------
    angle : number [rad], optional
        Angle of the first body relative to the second, from the placement; default 0.
    rate : number [rad/s], optional
        Its rate, default that of the bodies' velocities.
    degrees : number [°], optional
        The angle in degrees, instead of `angle`.
    degrees_per_second : number [°/s], optional
        The rate in degrees per second, instead of `rate`.
    """
    return made(TurnStart, "turn_start", locals())


@checked
def slide_start(*, displacement: Real | None = None, rate: Real | None = None) -> SlideStart:
    """Initial displacement and rate.

    Parameters
    ----------
    displacement : number [m], optional
        Displacement of the first body relative to the second, from the placement; default 0.
    rate : number [m/s], optional
        Its rate, default that of the bodies' velocities.
    """
    return made(SlideStart, "slide_start", locals())


@checked
def force_table(*, places: Vector, forces: Vector, interpolation: Interpolation | None = None) -> ForceTable:
    """Forces or torques over a stretch, an angle or a rate. It goes on straight beyond both ends.

    Parameters
    ----------
    places : numbers, shape (n,) [m, rad, m/s or rad/s]
        Stretches, angles or rates, increasing.
    forces : numbers, shape (n,) [N or N m]
        Force or torque at each.
    interpolation : "linear" or "monotone" or "spline", optional
        Interpolation between the forces, default monotone.
        "linear": Straight lines. Those of a motion are rounded at their ends, so accelerations stay finite.
        "monotone": Smooth without overshoot.
        "spline": As smooth as the values. It may overshoot.
    """
    return made(ForceTable, "force_table", locals())


@checked
def bearing_friction(
    *,
    coefficient: Real,
    width: Real,
    load_width: Real,
    motion: Motion | None = None,
    radius: Real | None = None,
) -> BearingFriction:
    """Friction of a bearing or guide: μ ρ N tanh(ω / w) against the rate ω of the turn about e3 or of the slide
    along it, with N = √(f² + n²) − n by the force f of the bushing across e3.

    Parameters
    ----------
    coefficient : number at least 0
        Coefficient of friction μ.
    width : number above 0 [rad/s or m/s]
        Rate w, at which 76 % of the friction acts.
    load_width : number above 0 [N]
        Force n, well above which N is the force across; it makes N smooth where the force vanishes.
    motion : "turn" or "slide", optional
        The motion with friction: `turn` (default) or `slide`.
        "turn": Rotation about its axis.
        "slide": Displacement along its axis.
    radius : number above 0 [m], optional
        Radius ρ of the bearing; not of a guide that slides.
    """
    return made(BearingFriction, "bearing_friction", locals())


@checked
def wheel(*, axis: Vector, radius: Real) -> Wheel:
    """A wheel: a torus.

    Parameters
    ----------
    axis : numbers, shape (3,)
        Its axis, of any length but zero, in ground axes at the start and fixed in the body.
    radius : number above 0 [m]
        Radius of the circle; that of the whole wheel is larger by the `radius` of the contact.
    """
    return made(Wheel, "wheel", locals())


@checked
def contact_friction(*, coefficient: Real, width: Real, stribeck: Stribeck | None = None) -> ContactFriction:
    """Friction of a contact.

    Parameters
    ----------
    coefficient : number at least 0
        Coefficient of friction μ.
    width : number above 0 [m/s]
        Tangential velocity w at which 71 % of it acts. Below it the contact creeps instead of sticking. A smaller
        width is sharper and needs finer steps.
    stribeck : `stribeck(…)`, optional
        Friction that is larger at slow slip, default none.
    """
    return made(ContactFriction, "contact_friction", locals())


@checked
def stribeck(*, coefficient: Real, speed: Real) -> Stribeck:
    """Friction that falls from a static to a sliding coefficient: μ + (μ_s − μ) exp(−v_t²/v_s²).

    Parameters
    ----------
    coefficient : number at least 0
        Coefficient μ_s without slip.
    speed : number above 0 [m/s]
        Velocity v_s at which 63 % of the difference is gone. It should be several times the `width` of the
        friction.
    """
    return made(Stribeck, "stribeck", locals())


@checked
def cable_point(*, body: str, point: Point | None = None) -> CablePoint:
    """A point of a cable.

    Parameters
    ----------
    body : text
        Its body, which may be "ground".
    point : text or numbers, shape (3,) [m], optional
        The point, by name or in body axes (ground coordinates if it is ground); default the centre of mass.
        text: Name of one of the body's points.
        numbers, shape (3,) [m]: Coordinates in body axes from their origin.
    """
    return made(CablePoint, "cable_point", locals())


@checked
def feedback(
    *,
    joint: str,
    motion: Motion | None = None,
    reference: Reference | None = None,
    proportional: Real | None = None,
    derivative: Real | None = None,
) -> Feedback:
    """Feedback of another joint.

    Parameters
    ----------
    joint : text
        Name of a revolute, prismatic, cylindrical or planar joint.
    motion : "turn" or "slide", optional
        Motion of a cylindrical joint, default rotation.
        "turn": Rotation about its axis.
        "slide": Displacement along its axis.
    reference : number [m or rad] or one of `followings`, optional
        Reference of its angle or displacement, default 0.
        number [m or rad]: The same at all times.
        one of `followings`: A function of time.
    proportional : number [N/m, N/rad, N m/m, N m/rad], optional
        Effort per error of this joint, default 0.
    derivative : number [N s/m, N s/rad, N m s/m, N m s/rad], optional
        Effort per rate of this error, default 0.
    """
    return made(Feedback, "feedback", locals())


@checked
def balanced(*, body: str, mass: Real, point: Point | None = None) -> Balanced:
    """A mass whose weight is balanced.

    Parameters
    ----------
    body : text
        The body that has it.
    mass : number at least 0 [kg]
        The mass that the controller reckons with.
    point : text or numbers, shape (3,) [m], optional
        Where it is, by name or in body axes; default as of a force.
        text: Name of one of the body's points.
        numbers, shape (3,) [m]: Coordinates in body axes from their origin.
    """
    return made(Balanced, "balanced", locals())


@checked
def motor(
    *,
    gear_ratio: Real | None = None,
    rotor_inertia: Real | None = None,
    torque: Real | None = None,
    curve: Curve | None = None,
    power: Real | None = None,
    lag: Real | None = None,
) -> Motor:
    """A motor behind a gear. A limit z of a demand u leaves u (1 + (u/z)⁸)^(−1/8), which is off by less than 0.1 %
    up to half of the limit.

    Parameters
    ----------
    gear_ratio : number above 0 [rad/m or 1], optional
        Turns of the motor for one of the joint, default 1; of a slide or distance the angle of the motor for a
        metre, 1 of a linear motor.
    rotor_inertia : number at least 0 [kg m² (kg of a linear motor)], optional
        Inertia of what turns with the motor, default none. Through the gear the joint feels its product with the
        square of `gear_ratio`; that the motor also turns with the body on which it sits is left out.
    torque : number above 0 [N m], optional
        Largest torque of the motor (force of a linear motor), as by its current; default none.
    curve : `curve(…)`, optional
        Torque by speed, as by the voltage of a motor of direct current; default none.
    power : number above 0 [W], optional
        Largest power, default none.
    lag : number above 0 [s], optional
        Time constant with which the torque follows what is demanded, a lag of first order; default none.
    """
    return made(Motor, "motor", locals())


@checked
def curve(*, stall_torque: Real, no_load_speed: Real) -> Curve:
    """Torque of a motor by its speed: between −A (1 + ω/W) and A (1 − ω/W).

    Parameters
    ----------
    stall_torque : number above 0 [N m]
        Torque A of the motor at speed zero.
    no_load_speed : number above 0 [rad/s]
        Speed W of the motor at which it has no torque.
    """
    return made(Curve, "curve", locals())


@checked
def drive(*, joint: str, turn: Turning | None = None, slide: Sliding | None = None) -> Drive:
    """Prescribed motion of a joint about its axis, along it, or both. It is the motion of the first body relative to
    the second (ground counts as the second), from the placement.

    Parameters
    ----------
    joint : text
        Name of a revolute, planar, prismatic or cylindrical joint.
    turn : one of `turning`, optional
        Angle about the axis as a function of time.
    slide : one of `sliding`, optional
        Displacement along the axis as a function of time.
    """
    return made(Drive, "drive", locals())


@checked
def term(*, joint: str, turn: Real | None = None, slide: Real | None = None) -> Term:
    """A motion of a joint with its factor.

    Parameters
    ----------
    joint : text
        Name of a revolute, planar, prismatic or cylindrical joint. Its motion is that of its first body against
        the second (ground counts as the second).
    turn : number [that of the terms per rad], optional
        Factor of the angle about the axis.
    slide : number [that of the terms per m], optional
        Factor of the displacement along the axis, instead of `turn`.
    """
    return made(Term, "term", locals())


@checked
def profile(*, at: Vector, values: Vector, interpolation: Interpolation | None = None) -> Profile:
    """A function that is twice continuously differentiable, level at both ends and constant beyond.

    Parameters
    ----------
    at : numbers, shape (n,) [m or rad]
        Values of the motion of the cam, ascending.
    values : numbers, shape (n,) [m or rad]
        The motion of the follower at each.
    interpolation : "linear" or "monotone" or "spline", optional
        Interpolation between them, default spline.
        "linear": Straight lines. Those of a motion are rounded at their ends, so accelerations stay finite.
        "monotone": Smooth without overshoot.
        "spline": As smooth as the values. It may overshoot.
    """
    return made(Profile, "profile", locals())


@checked
def terminal_event(*, measure: Quantity, reaches: Real) -> TerminalEvent:
    """An event that ends the run.

    Parameters
    ----------
    measure : one of `quantities`
        The quantity.
    reaches : number [that of the quantity]
        The value that it reaches.
    """
    return made(TerminalEvent, "terminal_event", locals())


@checked
def gate(
    *,
    width: Real,
    body: str | None = None,
    axis: Vector | None = None,
    relative_to: str | None = None,
    from_: CountedFrom | None = None,
    joint: str | None = None,
    above: Real | None = None,
    below: Real | None = None,
) -> Gate:
    """A smooth gate on a rotation: the range counts only while the rotation is above (or below) a limit. Give `body`
    and `axis`, or `joint`; and one of `above` and `below`.

    Parameters
    ----------
    width : number above 0 [rad]
        Width of the transition.
    body : text, optional
        The body of the rotation.
    axis : numbers, shape (3,), optional
        Axis of the rotation in ground axes as the bodies are placed, of any length but zero.
    relative_to : text, optional
        The body that the rotation is relative to, default "ground".
    from_ : "axes" or "placement", optional
        Zero of the rotation, default "axes".
        "axes": The axes of the body are parallel to those of the other body, or of ground.
        "placement": The bodies are as placed.
    joint : text, optional
        Name of a revolute, planar or cylindrical joint whose angle is used instead of the rotation of a body.
    above : number [rad], optional
        The gate is open above this rotation.
    below : number [rad], optional
        The gate is open below this rotation.
    """
    return made(Gate, "gate", locals())


@checked
def at(*, time: Real) -> At:
    """A time of the motion.

    Parameters
    ----------
    time : number above 0 [s]
        Time since the start of the motion.
    """
    return made(At, "at", locals())


@checked
def window_ends(*, from_: Edge | None = None, to: Edge | None = None) -> WindowEnds:
    """The ends of a window.

    Parameters
    ----------
    from_ : number [s] or `reach(…)` or `at_event(…)`, optional
        Its start, default the start of the motion.
        number [s]: A time.
        `reach(…)`: The first time at which a quantity reaches a value.
        `at_event(…)`: When an event comes.
    to : number [s] or `reach(…)` or `at_event(…)`, optional
        Its end, default the end of the motion.
        number [s]: A time.
        `reach(…)`: The first time at which a quantity reaches a value.
        `at_event(…)`: When an event comes.
    """
    return made(WindowEnds, "window_ends", locals())


@checked
def reach(
    *,
    when: Quantity,
    reaches: Real | None = None,
    rises_to: Real | None = None,
    falls_to: Real | None = None,
) -> Reach:
    """A quantity reaches a value: give one of `reaches`, `rises_to` and `falls_to`.

    Parameters
    ----------
    when : one of `quantities`
        The quantity.
    reaches : number [that of the quantity], optional
        The value, which the quantity must cross upwards or downwards.
    rises_to : number [that of the quantity], optional
        The value, which the quantity must cross upwards.
    falls_to : number [that of the quantity], optional
        The value, which the quantity must cross downwards.
    """
    return made(Reach, "reach", locals())


@checked
def at_event(*, event: str) -> AtEvent:
    """An event of the file. A window ends just before it or starts just after it, and a value is that just before
    it.

    Parameters
    ----------
    event : text
        Its name.
    """
    return made(AtEvent, "at_event", locals())


@checked
def within(*, of: Quantity, during: During | None = None) -> Within:
    """A quantity and a window of time.

    Parameters
    ----------
    of : one of `quantities`
        The quantity.
    during : numbers, shape (2,) [s] or `window_ends(…)`, optional
        The window, default the whole run.
        numbers, shape (2,) [s]: Start and end.
        `window_ends(…)`: Each end by itself.
    """
    return made(Within, "within", locals())


@checked
def series(
    *,
    of: Quantity,
    table: Matrix | None = None,
    file: DataFile | None = None,
    standard_deviation: Real | None = None,
    scale: Real | None = None,
    offset: Real | None = None,
) -> Series:
    """A quantity measured at several times. Give "table" or "file".

    Parameters
    ----------
    of : one of `quantities`
        The quantity.
    table : list of numbers, shape (n,), optional
        Rows [time, value] or [time, value, standard deviation], in the order of time.
    file : `data_file(…)`, optional
        A file of values separated by commas, whose first line names its columns.
    standard_deviation : number above 0 [that of the quantity], optional
        Standard deviation of every value that has none of its own, in the unit of the quantity; default 1 of it.
    scale : number, optional
        What one unit of the values and standard deviations of table or file is in the SI unit of the quantity,
        default 1: 0.017453292519943295 for degrees.
    offset : number [s], optional
        The datum of the time t belongs to the time t + offset of the motion, default 0.
    """
    return made(Series, "series", locals())


@checked
def data_file(
    *,
    path: str,
    time: str | None = None,
    value: str | None = None,
    standard_deviation: str | None = None,
    weight: str | None = None,
) -> DataFile:
    """A file of values separated by commas.

    Parameters
    ----------
    path : text
        Its path, relative to the directory of the problem file.
    time : text, optional
        Name of the column of the times, default "time".
    value : text, optional
        Name of the column of the values, default "value".
    standard_deviation : text, optional
        Name of a column of standard deviations; default "standard_deviation" if there is one.
    weight : text, optional
        Name of a column of weights: the squares of the residuals are multiplied by them; default "weight" if
        there is one and no standard deviations.
    """
    return made(DataFile, "data_file", locals())


@checked
def measured_number(*, function: str, value: Real, standard_deviation: Real | None = None) -> MeasuredNumber:
    """A measured value of a function.

    Parameters
    ----------
    function : text
        Name of the function.
    value : number [that of the function]
        The measured value.
    standard_deviation : number above 0 [that of the function], optional
        Its standard deviation, default 1 in the unit of the function.
    """
    return made(MeasuredNumber, "measured_number", locals())


@checked
def barrier(*, distance: Real, top: Real) -> Barrier:
    """A barrier across the direction of flight.

    Parameters
    ----------
    distance : number [m]
        Position along the direction of flight, from the origin.
    top : number [m]
        Height of its top above the origin.
    """
    return made(Barrier, "barrier", locals())


@checked
def expression_of_functions(*, expression: str) -> ExpressionOfFunctions:
    """An expression of functions.

    Parameters
    ----------
    expression : text
        Of functions and parameters by name, as that of a function.
    """
    return made(ExpressionOfFunctions, "expression_of_functions", locals())


@checked
def joint_defaults(
    *,
    between: Sequence[str] | None = None,
    at: JointPlace | None = None,
    axis: Axis | None = None,
    cross: Axis | None = None,
    start: JointStart | None = None,
    length: Real | None = None,
) -> JointDefaults:
    """Keys of joints.

    Parameters
    ----------
    between : list of 2 texts, optional
        The two bodies; one of them may be "ground".
    at : text or numbers, shape (3,) [m] or `point_pair(…)`, optional
        Position of the joint at the start.
        text: `"body.point"`, or `"body"` for the origin of its axes.
        numbers, shape (3,) [m]: Ground coordinates.
        `point_pair(…)`: One point on each body; assembly brings them together.
    axis : numbers, shape (3,) or `body_axis(…)`, optional
        The joint's axis at the start, of any length but zero.
        numbers, shape (3,): In ground axes.
        `body_axis(…)`: In the axes of a body.
    cross : numbers, shape (3,) or `body_axis(…)`, optional
        Axis of the second body of a universal joint at the start.
        numbers, shape (3,): In ground axes.
        `body_axis(…)`: In the axes of a body.
    start : `joint_start(…)`, optional
        Initial position and rate of its motion.
    length : number above 0 [m], optional
        Length of a rod.
    """
    return made(JointDefaults, "joint_defaults", locals())


class shapes(Kinds):
    """A homogeneous solid, centred at the origin of the body's axes."""

    point: Final[Literal["point"]] = "point"
    """A mass without extent and rotation. Ball joints and rods act at its position."""

    @staticmethod
    @checked
    def box(*, size: Vector) -> Shape:
        """A box with edges along the body's axes.

        Parameters
        ----------
        size : numbers, shape (3,) above 0 [m]
            Edges along x, y and z.
        """
        return made(Shape, "shapes.box", locals())

    @staticmethod
    @checked
    def cylinder(*, radius: Real, length: Real) -> Shape:
        """A cylinder about the body's z axis.

        Parameters
        ----------
        radius : number above 0 [m]
            Radius.
        length : number above 0 [m]
            Length along z.
        """
        return made(Shape, "shapes.cylinder", locals())

    @staticmethod
    @checked
    def sphere(*, radius: Real) -> Shape:
        """A sphere.

        Parameters
        ----------
        radius : number above 0 [m]
            Radius.
        """
        return made(Shape, "shapes.sphere", locals())

    @staticmethod
    @checked
    def rod(*, length: Real, radius: Real | None = None) -> Shape:
        """A rod along the body's x axis.

        Parameters
        ----------
        length : number above 0 [m]
            Length along x.
        radius : number at least 0 [m], optional
            Radius; a rod without one (the default) has no inertia about its own axis.
        """
        return made(Shape, "shapes.rod", locals())


class sections(Kinds):
    """A cross section by its sizes, or by given stiffnesses `G`. In structures axis 2 lies in the plane of beam and
    orientation, and axis 3 is normal to both; in the axes of a moving beam axis 2 is z and axis 3 is y.
    """

    @staticmethod
    @checked
    def rectangle(*, width: Real, height: Real) -> Section:
        """A rectangle.

        Parameters
        ----------
        width : number above 0 [m]
            Size along axis 2; z of a moving beam.
        height : number above 0 [m]
            Size along axis 3; y of a moving beam.
        """
        return made(Section, "sections.rectangle", locals())

    @staticmethod
    @checked
    def tube(*, radius: Real, wall: Real) -> Section:
        """A round tube; a solid bar if the wall is the radius.

        Parameters
        ----------
        radius : number above 0 [m]
            Outer radius.
        wall : number above 0 [m]
            Thickness of the wall, not above the radius.
        """
        return made(Section, "sections.tube", locals())

    @staticmethod
    @checked
    def i(*, width: Real, height: Real, flange: Real, web: Real) -> Section:
        """An I of thin walls, the web along axis 3; y of a moving beam.

        Parameters
        ----------
        width : number above 0 [m]
            Width of the flanges.
        height : number above 0 [m]
            Whole height.
        flange : number above 0 [m]
            Thickness of a flange, not above half the height.
        web : number above 0 [m]
            Thickness of the web, not above the width.
        """
        return made(Section, "sections.i", locals())

    @staticmethod
    @checked
    def given(
        *,
        ea: Real,
        mass_per_length: Real,
        ei_y: Real | None = None,
        ei_z: Real | None = None,
        gj: Real | None = None,
        ga_y: Real | None = None,
        ga_z: Real | None = None,
        inertia_y: Real | None = None,
        inertia_z: Real | None = None,
    ) -> Section:
        """Given stiffnesses and masses; such a beam has no stresses.

        Parameters
        ----------
        ea : number above 0 [N]
            EA.
        mass_per_length : number above 0 [kg/m]
            Mass per length ρA.
        ei_y : number above 0 [N m²], optional
            Stiffness of bending along y: EI about z. Needed if there are such functions.
        ei_z : number above 0 [N m²], optional
            Stiffness of bending along z: EI about y. Needed if there are such functions.
        gj : number above 0 [N m²], optional
            GJ. Needed if there are functions of torsion.
        ga_y : number above 0 [N], optional
            Shear stiffness along y with its factor; default: no shear.
        ga_z : number above 0 [N], optional
            Shear stiffness along z with its factor; default: no shear.
        inertia_y : number at least 0 [kg m], optional
            Inertia per length of sections that turn with bending along y, ∫ρ y² dA; default 0.
        inertia_z : number at least 0 [kg m], optional
            Inertia per length of sections that turn with bending along z, ∫ρ z² dA; default 0.
        """
        return made(Section, "sections.given", locals())


class meshes(Kinds):
    """A generator of a mesh. x runs along the first direction of a panel, y along the second. A panel names its
    edges x0, x1, y0, y1, its corners x0y0 … x1y1, and all. A line of beams names its ends start and end, and all.
    """

    @staticmethod
    @checked
    def plate(*, length: Real, width: Real, elements: Vector) -> Mesh:
        """A rectangular plate in the plane z = 0, from the origin to (length, width).

        Parameters
        ----------
        length : number above 0 [m]
            Length along x.
        width : number above 0 [m]
            Width along y.
        elements : integers, shape (2,) at least 1
            Numbers of elements along x and y.
        """
        return made(Mesh, "meshes.plate", locals())

    @staticmethod
    @checked
    def panel(*, points: Matrix, elements: Vector) -> Mesh:
        """A panel through control points: 4 corners (bilinear), or 9 points (biquadratic), row by row along x.

        Parameters
        ----------
        points : numbers, shape (n, 3) [m]
            The points.
        elements : integers, shape (2,) at least 1
            Numbers of elements along x and y.
        """
        return made(Mesh, "meshes.panel", locals())

    @staticmethod
    @checked
    def curved_panel(*, radius: Real, length: Real, angles: Vector, elements: Vector) -> Mesh:
        """A piece of a cylinder about the z axis: x along the arc, y along the axis. Normals point outwards.

        Parameters
        ----------
        radius : number above 0 [m]
            Radius.
        length : number above 0 [m]
            Length along the axis.
        angles : numbers, shape (2,) [rad]
            Angles from the x axis where the arc begins and ends.
        elements : integers, shape (2,) at least 1
            Numbers of elements along the arc and the axis.
        """
        return made(Mesh, "meshes.curved_panel", locals())

    @staticmethod
    @checked
    def cylinder(*, radius: Real, length: Real, elements: Vector) -> Mesh:
        """A whole cylinder about the z axis; its ends are the edges y0 and y1.

        Parameters
        ----------
        radius : number above 0 [m]
            Radius.
        length : number above 0 [m]
            Length along the axis.
        elements : integers, shape (2,) at least 1
            Numbers of elements around (at least 3) and along the axis.
        """
        return made(Mesh, "meshes.cylinder", locals())

    @staticmethod
    @checked
    def straight_beam(*, from_: Vector, to: Vector, orientation: Vector, elements: Integer) -> Mesh:
        """A straight line of beams.

        Parameters
        ----------
        from_ : numbers, shape (3,) [m]
            Where it starts.
        to : numbers, shape (3,) [m]
            Where it ends.
        orientation : numbers, shape (3,)
            A vector in the plane of the beam and axis 2 of its section.
        elements : integer from 1 to 1000000
            Number of elements.
        """
        return made(Mesh, "meshes.straight_beam", locals())

    @staticmethod
    @checked
    def curved_beam(*, radius: Real, angles: Vector, elements: Integer) -> Mesh:
        """An arc of beams in the plane z = 0 about the origin. Axis 2 of the section is the z axis.

        Parameters
        ----------
        radius : number above 0 [m]
            Radius.
        angles : numbers, shape (2,) [rad]
            Angles from the x axis where the arc begins and ends.
        elements : integer from 1 to 1000000
            Number of elements.
        """
        return made(Mesh, "meshes.curved_beam", locals())

    @staticmethod
    @checked
    def frame(*, points: Mapping[str, Vector], members: Mapping[str, Member]) -> Mesh:
        """A frame of straight members that are joined rigidly at points. A point is the set of nodes of its name, a
        member the set of beams of its name.

        Parameters
        ----------
        points : numbers, shape (3,) [m] by name
            The points by name.
        members : `member(…)` by name
            The members by name.
        """
        return made(Mesh, "meshes.frame", locals())

    @staticmethod
    @checked
    def gmsh(*, file: str, unit: LengthUnit | None = None, orientation: Vector | None = None) -> Mesh:
        """A mesh from a file of Gmsh.

        Parameters
        ----------
        file : text
            The file; its path is relative to the problem file.
        unit : "m" or "cm" or "mm" or "inch", optional
            Unit of its coordinates, default m.
            "m": Metres.
            "cm": Centimetres.
            "mm": Millimetres.
            "inch": Inches.
        orientation : numbers, shape (3,), optional
            Of beams: a vector in the plane of each and axis 2 of its section.
        """
        return made(Mesh, "meshes.gmsh", locals())


class structure_sections(Kinds):
    """A cross section by its sizes, or by given stiffnesses `G`. In structures axis 2 lies in the plane of beam and
    orientation, and axis 3 is normal to both; in the axes of a moving beam axis 2 is z and axis 3 is y.
    """

    @staticmethod
    @checked
    def rectangle(*, width: Real, height: Real) -> StructureSection:
        """A rectangle.

        Parameters
        ----------
        width : number above 0 [m]
            Size along axis 2; z of a moving beam.
        height : number above 0 [m]
            Size along axis 3; y of a moving beam.
        """
        return made(StructureSection, "structure_sections.rectangle", locals())

    @staticmethod
    @checked
    def tube(*, radius: Real, wall: Real) -> StructureSection:
        """A round tube; a solid bar if the wall is the radius.

        Parameters
        ----------
        radius : number above 0 [m]
            Outer radius.
        wall : number above 0 [m]
            Thickness of the wall, not above the radius.
        """
        return made(StructureSection, "structure_sections.tube", locals())

    @staticmethod
    @checked
    def i(*, width: Real, height: Real, flange: Real, web: Real) -> StructureSection:
        """An I of thin walls, the web along axis 3; y of a moving beam.

        Parameters
        ----------
        width : number above 0 [m]
            Width of the flanges.
        height : number above 0 [m]
            Whole height.
        flange : number above 0 [m]
            Thickness of a flange, not above half the height.
        web : number above 0 [m]
            Thickness of the web, not above the width.
        """
        return made(StructureSection, "structure_sections.i", locals())

    @staticmethod
    @checked
    def given(
        *,
        axial_and_shear: Vector,
        torsion_and_bending: Vector,
        mass: Real,
        inertia: Vector,
    ) -> StructureSection:
        """Given stiffnesses and masses; such a beam has no stresses.

        Parameters
        ----------
        axial_and_shear : numbers, shape (3,) above 0 [N]
            EA and the shear stiffnesses GA2 and GA3 with their factors.
        torsion_and_bending : numbers, shape (3,) above 0 [N m²]
            GJ, EI2 (of bending along axis 3) and EI3 (of bending along axis 2).
        mass : number at least 0 [kg/m]
            Mass per length ρA.
        inertia : numbers, shape (2,) at least 0 [kg m]
            Moments of the mass per length, ρI2 and ρI3.
        """
        return made(StructureSection, "structure_sections.given", locals())


class sets(Kinds):
    """A set of nodes or elements, in the directions ξ and η of a panel, which run from 0 to 1; a line of beams has
    the first only.
    """

    @staticmethod
    @checked
    def node(*, at: Vector) -> Set:
        """The node nearest to (ξ, η).

        Parameters
        ----------
        at : numbers, shape (2,) at least 0
            ξ and η.
        """
        return made(Set, "sets.node", locals())

    @staticmethod
    @checked
    def elements(*, from_: Vector, to: Vector) -> Set:
        """The elements whose middles lie between two corners.

        Parameters
        ----------
        from_ : numbers, shape (2,) at least 0
            Smallest ξ and η.
        to : numbers, shape (2,) at least 0
            Largest ξ and η.
        """
        return made(Set, "sets.elements", locals())


class element_frames(Kinds):
    """What holds the axes of shells. It only says from where deformations count; forces and stresses do not depend
    on it as long as rotations are small.
    """

    @staticmethod
    @checked
    def chord(value: Sequence[str], /) -> ElementFrame:
        """Three sets of one node: the first does not move, the second moves along the axis of the mesh that is nearest
        to the line from the first, the third does not move along the axis that is nearest to the normal of their
        plane.

        Parameters
        ----------
        value : list of 3 texts
        """
        return made_of(ElementFrame, "element_frames.chord", value)

    @staticmethod
    @checked
    def clamped(value: str, /) -> ElementFrame:
        """A set of nodes that do not move, or the name of an edge.

        Parameters
        ----------
        value : text
        """
        return made_of(ElementFrame, "element_frames.clamped", value)


class element_bases(Kinds):
    """Which coordinates shells have."""

    full: Final[Literal["full"]] = "full"
    """Displacements and rotations of all nodes."""

    rigid: Final[Literal["rigid"]] = "rigid"
    """None: the body is rigid."""

    @staticmethod
    @checked
    def reduced(
        *,
        interfaces: Sequence[str] | None = None,
        modes: Integer | None = None,
        highest_frequency: Real | None = None,
        companions: bool | None = None,
        deflection: Real | None = None,
        tolerance: Real | None = None,
    ) -> ElementBasis:
        """Factors of the vectors of a reduced basis, which is that of the design in the file.

        Parameters
        ----------
        interfaces : list of texts, optional
            Points that get boundary modes, as joints and loads hold them; default: all points.
        modes : integer from 0 to 200, optional
            Number of fixed-interface modes, default 6.
        highest_frequency : number above 0 [Hz], optional
            All fixed-interface modes up to this frequency, instead of a number.
        companions : bool, optional
            Whether the basis has the membrane displacements that bending needs, default true. Without them bent
            shells lock.
        deflection : number from 0 to 0.2, optional
            Deflection up to which shells are solved for with von Karman's strains, as a part of the body's size;
            default 0, no such solutions.
        tolerance : number above 0 and at most 1, optional
            Part of the amplitude of the first below which companions and static solutions are left out, default 1e-4.
        """
        return made(ElementBasis, "element_bases.reduced", locals())


class held_places(Kinds):
    """Where something holds on to shells."""

    @staticmethod
    @checked
    def node(value: str, /) -> HeldPlace:
        """A set of one node.

        Parameters
        ----------
        value : text
        """
        return made_of(HeldPlace, "held_places.node", value)

    @staticmethod
    @checked
    def edge(value: str, /) -> HeldPlace:
        """An edge, as `rigid` if a weld holds it, else as `mean`.

        Parameters
        ----------
        value : text
        """
        return made_of(HeldPlace, "held_places.edge", value)

    @staticmethod
    @checked
    def rigid(value: str, /) -> HeldPlace:
        """An edge all of whose nodes follow: it moves as a rigid body.

        Parameters
        ----------
        value : text
        """
        return made_of(HeldPlace, "held_places.rigid", value)

    @staticmethod
    @checked
    def mean(value: str, /) -> HeldPlace:
        """An edge whose average follows: its mean place, and the rotation that fits its displacements best.

        Parameters
        ----------
        value : text
        """
        return made_of(HeldPlace, "held_places.mean", value)


class sources(Kinds):
    """Where the numbers of a body are."""

    @staticmethod
    @checked
    def matrix_market(*, nodes: str, stiffness: str, mass: str, units: Units | None = None) -> Source:
        """Stiffness and mass matrix in the coordinate format of Matrix Market.

        Parameters
        ----------
        nodes : text
            Table of the nodes: number, x, y, z, and the components of its unknowns if they are not the same at all
            nodes (such as 123456).
        stiffness : text
            Stiffness matrix.
        mass : text
            Mass matrix.
        units : `units(…)`, optional
            Units of the files, default SI.
        """
        return made(Source, "sources.matrix_market", locals())

    @staticmethod
    @checked
    def dmig(
        *,
        nodes: str,
        file: str,
        stiffness: str | None = None,
        mass: str | None = None,
        units: Units | None = None,
    ) -> Source:
        """Stiffness and mass matrix as DMIG text (a punch file of Nastran).

        Parameters
        ----------
        nodes : text
            Table of the nodes: number, x, y, z.
        file : text
            The file with both matrices.
        stiffness : text, optional
            Name of the stiffness matrix, default "KAAX".
        mass : text, optional
            Name of the mass matrix, default "MAAX".
        units : `units(…)`, optional
            Units of the files, default SI.
        """
        return made(Source, "sources.dmig", locals())

    @staticmethod
    @checked
    def standard_input(value: str, /) -> Source:
        """Modes, integrals of inertia, stiffness and points in a JSON file: standard input data.

        Parameters
        ----------
        value : text
        """
        return made_of(Source, "sources.standard_input", value)


class modal_frames(Kinds):
    """What holds the axes of a body of matrices."""

    @staticmethod
    @checked
    def clamped(value: str, /) -> ModalFrame:
        """They move and turn with this interface.

        Parameters
        ----------
        value : text
        """
        return made_of(ModalFrame, "modal_frames.clamped", value)

    @staticmethod
    @checked
    def chord(value: Sequence[str], /) -> ModalFrame:
        """They move with the first interface, a line of them runs through the second, and the third, if there is one, or
        else the rotation of the first says how they turn about this line.

        Parameters
        ----------
        value : list of texts
        """
        return made_of(ModalFrame, "modal_frames.chord", value)


class joints(Kinds):
    """A joint between two bodies, or a body and "ground"."""

    @staticmethod
    @checked
    def spherical(*, between: Sequence[str], at: JointPlace) -> Joint:
        """A ball joint: the points coincide.

        Parameters
        ----------
        between : list of 2 texts
            The two bodies; one of them may be "ground".
        at : text or numbers, shape (3,) [m] or `point_pair(…)`
            Position of the joint at the start.
            text: `"body.point"`, or `"body"` for the origin of its axes.
            numbers, shape (3,) [m]: Ground coordinates.
            `point_pair(…)`: One point on each body; assembly brings them together.
        """
        return made(Joint, "joints.spherical", locals())

    @staticmethod
    @checked
    def revolute(*, between: Sequence[str], at: JointPlace, axis: Axis, start: JointStart | None = None) -> Joint:
        """A hinge: the points coincide and the bodies turn about the axis.

        Parameters
        ----------
        between : list of 2 texts
            The two bodies; one of them may be "ground".
        at : text or numbers, shape (3,) [m] or `point_pair(…)`
            Position of the joint at the start.
            text: `"body.point"`, or `"body"` for the origin of its axes.
            numbers, shape (3,) [m]: Ground coordinates.
            `point_pair(…)`: One point on each body; assembly brings them together.
        axis : numbers, shape (3,) or `body_axis(…)`
            The joint's axis at the start, of any length but zero.
            numbers, shape (3,): In ground axes.
            `body_axis(…)`: In the axes of a body.
        start : `joint_start(…)`, optional
            Initial position and rate of its motion, default those of the bodies as placed.
        """
        return made(Joint, "joints.revolute", locals())

    @staticmethod
    @checked
    def prismatic(*, between: Sequence[str], at: JointPlace, axis: Axis, start: JointStart | None = None) -> Joint:
        """A slider: the second body moves along the axis of the first without turning.

        Parameters
        ----------
        between : list of 2 texts
            The two bodies; one of them may be "ground".
        at : text or numbers, shape (3,) [m] or `point_pair(…)`
            Position of the joint at the start.
            text: `"body.point"`, or `"body"` for the origin of its axes.
            numbers, shape (3,) [m]: Ground coordinates.
            `point_pair(…)`: One point on each body; assembly brings them together.
        axis : numbers, shape (3,) or `body_axis(…)`
            The joint's axis at the start, of any length but zero.
            numbers, shape (3,): In ground axes.
            `body_axis(…)`: In the axes of a body.
        start : `joint_start(…)`, optional
            Initial position and rate of its motion, default those of the bodies as placed.
        """
        return made(Joint, "joints.prismatic", locals())

    @staticmethod
    @checked
    def planar(*, between: Sequence[str], at: JointPlace, axis: Axis, start: JointStart | None = None) -> Joint:
        """The second body moves in the plane through the first body's point across its axis and turns about the axis.

        Parameters
        ----------
        between : list of 2 texts
            The two bodies; one of them may be "ground".
        at : text or numbers, shape (3,) [m] or `point_pair(…)`
            Position of the joint at the start.
            text: `"body.point"`, or `"body"` for the origin of its axes.
            numbers, shape (3,) [m]: Ground coordinates.
            `point_pair(…)`: One point on each body; assembly brings them together.
        axis : numbers, shape (3,) or `body_axis(…)`
            The joint's axis at the start, of any length but zero.
            numbers, shape (3,): In ground axes.
            `body_axis(…)`: In the axes of a body.
        start : `joint_start(…)`, optional
            Initial position and rate of its motion, default those of the bodies as placed.
        """
        return made(Joint, "joints.planar", locals())

    @staticmethod
    @checked
    def cylindrical(*, between: Sequence[str], at: JointPlace, axis: Axis, start: JointStart | None = None) -> Joint:
        """The bodies slide along the axis and turn about it.

        Parameters
        ----------
        between : list of 2 texts
            The two bodies; one of them may be "ground".
        at : text or numbers, shape (3,) [m] or `point_pair(…)`
            Position of the joint at the start.
            text: `"body.point"`, or `"body"` for the origin of its axes.
            numbers, shape (3,) [m]: Ground coordinates.
            `point_pair(…)`: One point on each body; assembly brings them together.
        axis : numbers, shape (3,) or `body_axis(…)`
            The joint's axis at the start, of any length but zero.
            numbers, shape (3,): In ground axes.
            `body_axis(…)`: In the axes of a body.
        start : `joint_start(…)`, optional
            Initial position and rate of its motion, default those of the bodies as placed.
        """
        return made(Joint, "joints.cylindrical", locals())

    @staticmethod
    @checked
    def universal(*, between: Sequence[str], at: JointPlace, axis: Axis, cross: Axis) -> Joint:
        """A universal (Cardan) joint: the points coincide. The bodies turn about an axis of the first and a cross axis
        of the second, which stay perpendicular.

        Parameters
        ----------
        between : list of 2 texts
            The two bodies; one of them may be "ground".
        at : text or numbers, shape (3,) [m] or `point_pair(…)`
            Position of the joint at the start.
            text: `"body.point"`, or `"body"` for the origin of its axes.
            numbers, shape (3,) [m]: Ground coordinates.
            `point_pair(…)`: One point on each body; assembly brings them together.
        axis : numbers, shape (3,) or `body_axis(…)`
            Axis of the first body at the start, of any length but zero.
            numbers, shape (3,): In ground axes.
            `body_axis(…)`: In the axes of a body.
        cross : numbers, shape (3,) or `body_axis(…)`
            Axis of the second body at the start, perpendicular to the first.
            numbers, shape (3,): In ground axes.
            `body_axis(…)`: In the axes of a body.
        """
        return made(Joint, "joints.universal", locals())

    @staticmethod
    @checked
    def rod(*, between: Sequence[str], at: Ends, length: Real | None = None) -> Joint:
        """A rod without mass: two points keep their distance.

        Parameters
        ----------
        between : list of 2 texts
            The two bodies; one of them may be "ground".
        at : numbers, shape (2, 3) [m] or `point_pair(…)`
            Its ends.
            numbers, shape (2, 3) [m]: Ground coordinates of both at the start, in the order of the bodies.
            `point_pair(…)`: One point on each body.
        length : number above 0 [m], optional
            Length, default the distance of its ends in the placement.
        """
        return made(Joint, "joints.rod", locals())

    @staticmethod
    @checked
    def weld(*, between: Sequence[str], at: JointPlace) -> Joint:
        """A weld: the bodies move as one.

        Parameters
        ----------
        between : list of 2 texts
            The two bodies; one of them may be "ground".
        at : text or numbers, shape (3,) [m] or `point_pair(…)`
            Position of the joint at the start.
            text: `"body.point"`, or `"body"` for the origin of its axes.
            numbers, shape (3,) [m]: Ground coordinates.
            `point_pair(…)`: One point on each body; assembly brings them together.
        """
        return made(Joint, "joints.weld", locals())

    @staticmethod
    @checked
    def free(*, between: Sequence[str], at: JointPlace, axis: Axis | None = None, cross: Axis | None = None) -> Joint:
        """No constraint: the place and axes of a bushing.

        Parameters
        ----------
        between : list of 2 texts
            The two bodies; one of them may be "ground".
        at : text or numbers, shape (3,) [m] or `point_pair(…)`
            Position at the start.
            text: `"body.point"`, or `"body"` for the origin of its axes.
            numbers, shape (3,) [m]: Ground coordinates.
            `point_pair(…)`: One point on each body; assembly brings them together.
        axis : numbers, shape (3,) or `body_axis(…)`, optional
            Its third axis e3 at the start, of any length but zero; default [0, 0, 1].
            numbers, shape (3,): In ground axes.
            `body_axis(…)`: In the axes of a body.
        cross : numbers, shape (3,) or `body_axis(…)`, optional
            Its first axis e1 at the start, of any length but zero, across `axis`; default the projection of the
            ground axis that is farthest from that.
            numbers, shape (3,): In ground axes.
            `body_axis(…)`: In the axes of a body.
        """
        return made(Joint, "joints.free", locals())


class loads(Kinds):
    """A force, torque, spring, damper, bushing, friction, drag, stop, contact, cable or controller."""

    @staticmethod
    @checked
    def force(
        *,
        body: str,
        direction: Vector,
        magnitude: ForceInTime,
        point: Point | None = None,
        at: Vector | None = None,
        axes: Axes | None = None,
    ) -> Load:
        """A force at a point of a body.

        Parameters
        ----------
        body : text
            The body.
        direction : numbers, shape (3,)
            Direction, of any length but zero.
        magnitude : number [N] or one of `varying_forces`
            Magnitude: a number, or a function of time.
            number [N]: The same at all times.
            one of `varying_forces`: A function of time.
        point : text or numbers, shape (3,) [m], optional
            Point of application, by name or in body axes; default the centre of mass, of a beam its middle; bodies of
            `elements` and `modal` ones need one.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        at : numbers, shape (3,) [m], optional
            Point of application in ground coordinates at the start, instead of `point`.
        axes : "ground" or "body", optional
            Axes in which the direction is given and fixed, default ground.
            "ground": Ground axes.
            "body": Axes of the loaded body.
        """
        return made(Load, "loads.force", locals())

    @staticmethod
    @checked
    def torque(
        *,
        body: str,
        direction: Vector,
        magnitude: TorqueInTime,
        point: Point | None = None,
        axes: Axes | None = None,
    ) -> Load:
        """A torque on a body.

        Parameters
        ----------
        body : text
            The body.
        direction : numbers, shape (3,)
            Direction, of any length but zero.
        magnitude : number [N m] or one of `varying_torques`
            Magnitude: a number, or a function of time.
            number [N m]: The same at all times.
            one of `varying_torques`: A function of time.
        point : text or numbers, shape (3,) [m], optional
            Of a beam: the point whose section it turns, by name or in body axes.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        axes : "ground" or "body", optional
            Axes in which the direction is given and fixed, default ground.
            "ground": Ground axes.
            "body": Axes of the loaded body.
        """
        return made(Load, "loads.torque", locals())

    @staticmethod
    @checked
    def spring(
        *,
        between: Sequence[str],
        at: Ends,
        rest_length: Real,
        stiffness: Real | None = None,
        cubic: Real | None = None,
        damping: Real | None = None,
        table: ForceTable | None = None,
        damping_table: ForceTable | None = None,
    ) -> Load:
        """A spring with a damper between points of two bodies. The tension is k x + k3 x³ + c l̇ and that of tables,
        with x = l − l0.

        Parameters
        ----------
        between : list of 2 texts
            The two bodies; one of them may be "ground".
        at : numbers, shape (2, 3) [m] or `point_pair(…)`
            Its ends.
            numbers, shape (2, 3) [m]: Ground coordinates of both at the start, in the order of the bodies.
            `point_pair(…)`: One point on each body.
        rest_length : number at least 0 [m]
            Length at zero force.
        stiffness : number at least 0 [N/m], optional
            Stiffness k, default 0 with a table.
        cubic : number [N/m³], optional
            Cubic stiffness k3, default 0.
        damping : number at least 0 [N s/m], optional
            Damping c, default 0.
        table : `force_table(…)`, optional
            Tension over the stretch x, besides that of the stiffness; default none.
        damping_table : `force_table(…)`, optional
            Tension over the rate l̇, besides that of the damping; default none.
        """
        return made(Load, "loads.spring", locals())

    @staticmethod
    @checked
    def torsion_spring(
        *,
        joint: str,
        rest_angle: Real | None = None,
        stiffness: Real | None = None,
        cubic: Real | None = None,
        damping: Real | None = None,
        table: ForceTable | None = None,
        damping_table: ForceTable | None = None,
    ) -> Load:
        """A spring with a damper about the axis of a revolute or planar joint.

        Parameters
        ----------
        joint : text
            Name of a revolute, planar or cylindrical joint.
        rest_angle : number [rad], optional
            Angle at zero torque: of the first body relative to the second (ground counts as the second) about the
            axis, from the placement; default 0.
        stiffness : number at least 0 [N m/rad], optional
            Stiffness, default 0 with a table.
        cubic : number [N m/rad³], optional
            Cubic stiffness k3 of the torque k x + k3 x³, default 0.
        damping : number at least 0 [N m s/rad], optional
            Damping, default 0.
        table : `force_table(…)`, optional
            Torque over the angle from rest, besides that of the stiffness; default none.
        damping_table : `force_table(…)`, optional
            Torque over the rate of the angle, besides that of the damping; default none.
        """
        return made(Load, "loads.torsion_spring", locals())

    @staticmethod
    @checked
    def damping(
        *,
        joint: str,
        motion: Motion | None = None,
        coefficient: Real | None = None,
        table: ForceTable | None = None,
    ) -> Load:
        """Viscous damping in a joint.

        Parameters
        ----------
        joint : text
            Name of a revolute, prismatic, cylindrical, planar, spherical or universal joint.
        motion : "turn" or "slide", optional
            Motion of a cylindrical joint, default rotation.
            "turn": Rotation about its axis.
            "slide": Displacement along its axis.
        coefficient : number at least 0 [N s/m or N m s/rad], optional
            Force or torque per unit of rate, default 0 with a table.
        table : `force_table(…)`, optional
            Force or torque over the rate, besides that of the coefficient; default none. Not of a spherical or
            universal joint.
        """
        return made(Load, "loads.damping", locals())

    @staticmethod
    @checked
    def bushing(
        *,
        joint: str,
        stiffness: BushingStiffness,
        damping: BushingDamping | None = None,
        axes: BushingAxes | None = None,
        friction: BearingFriction | None = None,
    ) -> Load:
        """Linear elastic forces and torques of all relative motion in a joint, with damping.

        Parameters
        ----------
        joint : text
            Name of a joint: a free one, or one that leaves some of the motion, such as a spherical or universal
            joint.
        stiffness : one of `bushing_stiffnesses`
            K.
        damping : one of `bushing_dampings`, optional
            C, default zero.
        axes : "first" or "second", optional
            The body of the joint with which e1, e2, e3 turn: `first` or `second` of its `between`. The force acts at
            the joint's point on the other. Default: ground if a `free` joint has it and the bushing neither resists
            the turn about e3 nor has friction against a slide, as a bearing of a shaft; else the body that is not
            ground, or the first.
            "first": The first of `between`.
            "second": The second.
        friction : `bearing_friction(…)`, optional
            Friction of a bearing or guide by the force of the bushing across e3, default none.
        """
        return made(Load, "loads.bushing", locals())

    @staticmethod
    @checked
    def friction(*, joint: str, size: Real, width: Real, motion: Motion | None = None) -> Load:
        """Coulomb friction in a joint: size times tanh(rate / width).

        Parameters
        ----------
        joint : text
            Name of a revolute, prismatic, cylindrical or planar joint.
        size : number at least 0 [N or N m]
            Force or torque at rates well above the width.
        width : number above 0 [m/s or rad/s]
            Rate at which 76 % of it acts. A smaller width is sharper and needs finer steps.
        motion : "turn" or "slide", optional
            Motion of a cylindrical joint, default rotation.
            "turn": Rotation about its axis.
            "slide": Displacement along its axis.
        """
        return made(Load, "loads.friction", locals())

    @staticmethod
    @checked
    def drag(
        *,
        body: str,
        coefficient: Real,
        point: Point | None = None,
        faces: str | None = None,
        normal_coefficient: Real | None = None,
        normal: Vector | None = None,
        width: Real | None = None,
    ) -> Load:
        """Quadratic drag on a point of a body: c |u|² u / √(|u|² + w²) against its velocity u.

        Parameters
        ----------
        body : text
            The body.
        coefficient : number at least 0 [N s²/m² or N s²/m⁴]
            Half the density times the drag coefficient times the area: force against the velocity by the square of
            the speed; for shells without the area.
        point : text or numbers, shape (3,) [m], optional
            Where it acts, by name or in body axes; default as of a force.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        faces : text, optional
            Name of the set of shells on which it acts, of a body of elements. The coefficients are then those of an
            area.
        normal_coefficient : number at least 0 [N s²/m² or N s²/m⁴], optional
            The same of the force along the normal of a plate or wing at the angle α, by the square of the speed times
            sin α, default 0. Its part across the velocity is lift.
        normal : numbers, shape (3,), optional
            Normal of the plate, in ground axes at the start and fixed in the body. Shells have theirs.
        width : number above 0 [m/s], optional
            Speed w below which the drag goes smoothly to zero, default 0.001 m/s. Above it the drag is off by ½
            w²/u².
        """
        return made(Load, "loads.drag", locals())

    @staticmethod
    @checked
    def stop(
        *,
        stiffness: Real,
        width: Real,
        joint: str | None = None,
        motion: Motion | None = None,
        between: Sequence[str] | None = None,
        at: Ends | None = None,
        lower: Real | None = None,
        upper: Real | None = None,
        dissipation: Real | None = None,
        exponent: Real | None = None,
    ) -> Load:
        """Stops of a joint or of the distance of two points, which press back smoothly.

        Parameters
        ----------
        stiffness : number above 0 [N/m or N m/rad]
            Stiffness k: force or torque per penetration, to the power of the exponent if there is one.
        width : number above 0 [m or rad]
            Width w of the onset, from w/2 before the limit to w/2 behind it. A smaller width is sharper and needs
            finer steps.
        joint : text, optional
            Name of a revolute, prismatic, cylindrical or planar joint.
        motion : "turn" or "slide", optional
            Motion of a cylindrical joint, default rotation.
            "turn": Rotation about its axis.
            "slide": Displacement along its axis.
        between : list of 2 texts, optional
            Two bodies whose points are stopped; one of them may be "ground".
        at : numbers, shape (2, 3) [m] or `point_pair(…)`, optional
            Their points.
            numbers, shape (2, 3) [m]: Ground coordinates of both at the start, in the order of the bodies.
            `point_pair(…)`: One point on each body.
        lower : number [m or rad], optional
            The angle, displacement or distance may not fall below this. An angle or displacement is that of the first
            body relative to the second (ground counts as the second), from the placement.
        upper : number [m or rad], optional
            It may not rise above this.
        dissipation : number at least 0 [s/m or s/rad], optional
            Dissipation c: at small speeds v of impact the rebound has 1 − c v of it; default 0.
        exponent : number at least 1, optional
            Exponent n of the penetration, default 1. A rubber buffer has 1.5 to 3.
        """
        return made(Load, "loads.stop", locals())

    @staticmethod
    @checked
    def contact(
        *,
        between: Sequence[str],
        at: Ends,
        surface: Surface2,
        radius: Real | None = None,
        wheel: Wheel | None = None,
        half: Vector | None = None,
        spheres: Integer | None = None,
        materials: Sequence[str] | None = None,
        stiffness: Real | None = None,
        dissipation: Real | None = None,
        width: Real | None = None,
        exponent: Real | None = None,
        friction: ContactFriction | None = None,
    ) -> Load:
        """A contact of a sphere, point, wheel or capsule of a body with a surface, with friction.

        Parameters
        ----------
        between : list of 2 texts
            The body with the sphere or point, and the body with the surface, which may be "ground".
        at : numbers, shape (2, 3) [m] or `point_pair(…)`
            Centre of the sphere on the first; on the second a point of the plane, or the centre of its surface.
            numbers, shape (2, 3) [m]: Ground coordinates of both at the start, in the order of the bodies.
            `point_pair(…)`: One point on each body.
        surface : one of `surface2s`
            Surface of the second body.
        radius : number at least 0 [m], optional
            Radius of the sphere, default 0: a point.
        wheel : `wheel(…)`, optional
            Of a wheel on a plane or height field: the circle of the centres, about `at`, of the spheres that are its
            tyre.
        half : numbers, shape (3,) [m], optional
            Of a capsule: from its centre `at` to the centre of the sphere at one end, in ground axes at the start and
            fixed in the body. Planes and height fields are touched by spheres along its axis; spheres, capsules and
            boxes where the axis is nearest.
        spheres : integer from 2 to 1000, optional
            How many equal spheres along the axis of a capsule touch a plane or height field; n of them have 2/n of
            the stiffness each. Default 2 on a plane, its ends; on a height field so many that they are no further
            apart than the radius.
        materials : list of 2 texts, optional
            Names of the materials of the first body and of the second at the contact, in place of the stiffness: that
            of Hertz, for spheres on planes and spheres.
        stiffness : number above 0 [N/m], optional
            Stiffness k: force per penetration, to the power of the exponent if there is one.
        dissipation : number at least 0 [s/m], optional
            Dissipation c: at small speeds v of impact the rebound has 1 − c v of it; default 0.
        width : number above 0 [m], optional
            Width w of the onset, from w/2 before touching to w/2 behind it. A smaller width is sharper and needs
            finer steps. Needed with a stiffness; with materials the default is 1e-5 of the radius of Hertz.
        exponent : number at least 1, optional
            Exponent n of the penetration, default 1, or 1.5 of Hertz with materials.
        friction : `contact_friction(…)`, optional
            Friction, default none.
        """
        return made(Load, "loads.contact", locals())

    @staticmethod
    @checked
    def cable(
        *,
        points: Sequence[CablePoint],
        length: CableLength,
        stiffness: Real,
        width: Real,
        dissipation: Real | None = None,
    ) -> Load:
        """A cable over frictionless pulleys, or a winch. It pulls and never presses.

        Parameters
        ----------
        points : list of `cable_point(…)`
            Its points in order: two ends with pulleys between them.
        length : number above 0 [m] or one of `sliding`
            Length L0 at which it is just slack: a number, or a function of time that a winch follows.
            number above 0 [m]: The same at all times.
            one of `sliding`: A function of time.
        stiffness : number above 0 [N/m]
            Stiffness k of the whole cable: force per stretch.
        width : number above 0 [m]
            Width w of the onset, from w/2 before the cable is taut to w/2 behind it. A smaller width is sharper and
            needs finer steps.
        dissipation : number at least 0 [s/m], optional
            Dissipation c: the tension grows by ³⁄₂ c times the rate of the stretch; default 0.
        """
        return made(Load, "loads.cable", locals())

    @staticmethod
    @checked
    def pressure(*, body: str, faces: str, pressure: PressureInTime) -> Load:
        """A pressure on shells of a body of `elements`, along the normals of the deformed surface.

        Parameters
        ----------
        body : text
            The body.
        faces : text
            Name of the set of faces.
        pressure : number [Pa] or one of `varying_pressures`
            Pressure, positive along the normal of the shells: a number, or a function of time.
            number [Pa]: The same at all times.
            one of `varying_pressures`: A function of time.
        """
        return made(Load, "loads.pressure", locals())

    @staticmethod
    @checked
    def area(
        *,
        body: str,
        faces: str,
        direction: Vector,
        magnitude: PressureInTime,
        axes: Axes | None = None,
    ) -> Load:
        """A force per area on shells of a body of `elements`, in a fixed direction.

        Parameters
        ----------
        body : text
            The body.
        faces : text
            Name of the set of faces.
        direction : numbers, shape (3,)
            Direction, of any length but zero.
        magnitude : number [Pa] or one of `varying_pressures`
            Force per area of the undeformed shells: a number, or a function of time.
            number [Pa]: The same at all times.
            one of `varying_pressures`: A function of time.
        axes : "ground" or "body", optional
            Axes in which the direction is given and fixed, default ground.
            "ground": Ground axes.
            "body": Axes of the loaded body.
        """
        return made(Load, "loads.area", locals())

    @staticmethod
    @checked
    def edge(
        *,
        body: str,
        edges: str,
        direction: Vector,
        magnitude: LineForceInTime,
        axes: Axes | None = None,
    ) -> Load:
        """A force per length on edges of shells of a body of `elements`, in a fixed direction.

        Parameters
        ----------
        body : text
            The body.
        edges : text
            Name of the set of edges.
        direction : numbers, shape (3,)
            Direction, of any length but zero.
        magnitude : number [N/m] or one of `varying_line_forces`
            Force per length of the undeformed edges: a number, or a function of time.
            number [N/m]: The same at all times.
            one of `varying_line_forces`: A function of time.
        axes : "ground" or "body", optional
            Axes in which the direction is given and fixed, default ground.
            "ground": Ground axes.
            "body": Axes of the loaded body.
        """
        return made(Load, "loads.edge", locals())

    @staticmethod
    @checked
    def line(
        *,
        body: str,
        beams: str,
        direction: Vector,
        magnitude: LineForceInTime,
        axes: Axes | None = None,
    ) -> Load:
        """A force per length on beams of a body of `elements`, in a fixed direction.

        Parameters
        ----------
        body : text
            The body.
        beams : text
            Name of the set of beams.
        direction : numbers, shape (3,)
            Direction, of any length but zero.
        magnitude : number [N/m] or one of `varying_line_forces`
            Force per length of the undeformed beams: a number, or a function of time.
            number [N/m]: The same at all times.
            one of `varying_line_forces`: A function of time.
        axes : "ground" or "body", optional
            Axes in which the direction is given and fixed, default ground.
            "ground": Ground axes.
            "body": Axes of the loaded body.
        """
        return made(Load, "loads.line", locals())

    @staticmethod
    @checked
    def controller(
        *,
        joint: str | None = None,
        motion: Motion | None = None,
        between: Sequence[str] | None = None,
        at: Ends | None = None,
        reference: Reference | None = None,
        proportional: Real | None = None,
        derivative: Real | None = None,
        integral: Real | None = None,
        anti_windup: Real | None = None,
        feed_forward: EffortInTime | None = None,
        feedback: Sequence[Feedback] | None = None,
        gravity_compensation: Sequence[Balanced] | None = None,
        motor: Motor | None = None,
    ) -> Load:
        """A controller with its motor, which makes a joint or a distance follow a reference.

        Parameters
        ----------
        joint : text, optional
            Name of a revolute, prismatic, cylindrical or planar joint. Its angle or displacement is that of the first
            body relative to the second (ground counts as the second), from the placement.
        motion : "turn" or "slide", optional
            Motion of a cylindrical joint, default rotation.
            "turn": Rotation about its axis.
            "slide": Displacement along its axis.
        between : list of 2 texts, optional
            Two bodies, the distance of whose points is controlled; one of them may be "ground".
        at : numbers, shape (2, 3) [m] or `point_pair(…)`, optional
            Their points.
            numbers, shape (2, 3) [m]: Ground coordinates of both at the start, in the order of the bodies.
            `point_pair(…)`: One point on each body.
        reference : number [m or rad] or one of `followings`, optional
            What the coordinate follows, default 0: a number, or a function of time. The error e is the reference
            minus the coordinate.
            number [m or rad]: The same at all times.
            one of `followings`: A function of time.
        proportional : number [N/m or N m/rad], optional
            Gain p of the error, default 0.
        derivative : number [N s/m or N m s/rad], optional
            Gain d of the rate of the error, default 0.
        integral : number [N/(m s) or N m/(rad s)], optional
            Gain k of the integral of the error, which is a state; default none.
        anti_windup : number above 0 [s], optional
            Time in which the integral follows the limits of the motor, so that it does not wind up; default none.
        feed_forward : number [N or N m] or one of `varying_efforts`, optional
            Effort that is added, default 0: a number, or a function of time.
            number [N or N m]: The same at all times.
            one of `varying_efforts`: A function of time.
        feedback : list of `feedback(…)`, optional
            Feedback of other joints: with p and d, a row of the matrix of a state feedback.
        gravity_compensation : list of `balanced(…)`, optional
            Masses whose weight the effort balances where they are. They move with the first body of the joint.
        motor : `motor(…)`, optional
            The motor, default without limits.
        """
        return made(Load, "loads.controller", locals())


class varying_forces(Kinds):
    """Function of time: a force."""

    @staticmethod
    @checked
    def harmonic(*, amplitude: Real, frequency: Real, phase: Real | None = None) -> VaryingForce:
        """amplitude · sin(2π frequency t + phase).

        Parameters
        ----------
        amplitude : number [N]
            Amplitude.
        frequency : number [Hz]
            Frequency.
        phase : number [rad], optional
            Phase at t = 0, default 0.
        """
        return made(VaryingForce, "varying_forces.harmonic", locals())

    @staticmethod
    @checked
    def table(*, times: Vector, values: Vector, interpolation: Interpolation | None = None) -> VaryingForce:
        """Interpolation between values, constant beyond both ends.

        Parameters
        ----------
        times : numbers, shape (n,) [s]
            Instants, increasing.
        values : numbers, shape (n,) [N]
            Value at each instant.
        interpolation : "linear" or "monotone" or "spline", optional
            Interpolation between the values, default monotone.
            "linear": Straight lines. Those of a motion are rounded at their ends, so accelerations stay finite.
            "monotone": Smooth without overshoot.
            "spline": As smooth as the values. It may overshoot.
        """
        return made(VaryingForce, "varying_forces.table", locals())


class varying_torques(Kinds):
    """Function of time: a torque."""

    @staticmethod
    @checked
    def harmonic(*, amplitude: Real, frequency: Real, phase: Real | None = None) -> VaryingTorque:
        """amplitude · sin(2π frequency t + phase).

        Parameters
        ----------
        amplitude : number [N m]
            Amplitude.
        frequency : number [Hz]
            Frequency.
        phase : number [rad], optional
            Phase at t = 0, default 0.
        """
        return made(VaryingTorque, "varying_torques.harmonic", locals())

    @staticmethod
    @checked
    def table(*, times: Vector, values: Vector, interpolation: Interpolation | None = None) -> VaryingTorque:
        """Interpolation between values, constant beyond both ends.

        Parameters
        ----------
        times : numbers, shape (n,) [s]
            Instants, increasing.
        values : numbers, shape (n,) [N m]
            Value at each instant.
        interpolation : "linear" or "monotone" or "spline", optional
            Interpolation between the values, default monotone.
            "linear": Straight lines. Those of a motion are rounded at their ends, so accelerations stay finite.
            "monotone": Smooth without overshoot.
            "spline": As smooth as the values. It may overshoot.
        """
        return made(VaryingTorque, "varying_torques.table", locals())


class bushing_stiffnesses(Kinds):
    """Stiffness of a bushing."""

    @staticmethod
    @checked
    def diagonal(value: Vector, /) -> BushingStiffness:
        """Its diagonal: three numbers of displacements along e1, e2, e3 and three of rotations about them.

        Parameters
        ----------
        value : numbers, shape (6,) [N/m, N m/rad]
        """
        return made_of(BushingStiffness, "bushing_stiffnesses.diagonal", value)

    @staticmethod
    @checked
    def rows(value: Matrix, /) -> BushingStiffness:
        """Its rows; symmetric.

        Parameters
        ----------
        value : numbers, shape (6, 6) [N/m, N, N m/rad]
        """
        return made_of(BushingStiffness, "bushing_stiffnesses.rows", value)


class bushing_dampings(Kinds):
    """Damping of a bushing."""

    @staticmethod
    @checked
    def diagonal(value: Vector, /) -> BushingDamping:
        """Its diagonal: three numbers of displacements along e1, e2, e3 and three of rotations about them.

        Parameters
        ----------
        value : numbers, shape (6,) [N s/m, N m s/rad]
        """
        return made_of(BushingDamping, "bushing_dampings.diagonal", value)

    @staticmethod
    @checked
    def rows(value: Matrix, /) -> BushingDamping:
        """Its rows; symmetric.

        Parameters
        ----------
        value : numbers, shape (6, 6) [N s/m, N s, N m s/rad]
        """
        return made_of(BushingDamping, "bushing_dampings.rows", value)


class surface2s(Kinds):
    """Surface of a contact. Directions are in ground axes at the start and fixed in the body."""

    @staticmethod
    @checked
    def plane(*, normal: Vector) -> Surface2:
        """A plane.

        Parameters
        ----------
        normal : numbers, shape (3,)
            Normal to the free side, of any length but zero.
        """
        return made(Surface2, "surface2s.plane", locals())

    @staticmethod
    @checked
    def sphere(*, radius: Real) -> Surface2:
        """A sphere.

        Parameters
        ----------
        radius : number at least 0 [m]
            Its radius; 0 is a point.
        """
        return made(Surface2, "surface2s.sphere", locals())

    @staticmethod
    @checked
    def capsule(*, half: Vector, radius: Real) -> Surface2:
        """A cylinder with round ends.

        Parameters
        ----------
        half : numbers, shape (3,) [m]
            From its centre to the centre of the sphere at one end.
        radius : number above 0 [m]
            Its radius.
        """
        return made(Surface2, "surface2s.capsule", locals())

    @staticmethod
    @checked
    def box(*, size: Vector, radius: Real | None = None) -> Surface2:
        """A box along the axes of its body, those of ground if it is ground's.

        Parameters
        ----------
        size : numbers, shape (3,) above 0 [m]
            Its edges.
        radius : number at least 0 [m], optional
            Radius of its edges, default 0: sharp ones. It is within `size`.
        """
        return made(Surface2, "surface2s.box", locals())

    @staticmethod
    @checked
    def height_field(
        *,
        normal: Vector,
        direction: Vector,
        along: Vector,
        heights: Matrix,
        across: Vector | None = None,
    ) -> Surface2:
        """Heights over a plane: a natural bicubic spline through the points of a grid, which goes on straight beyond its
        edges. `at` is the origin of the grid.

        Parameters
        ----------
        normal : numbers, shape (3,)
            Direction of the heights, to the free side, of any length but zero.
        direction : numbers, shape (3,)
            Direction of `along`; what it has along `normal` is left out. The places `across` are along `normal` ×
            `direction`.
        along : numbers, shape (n,) [m]
            Places of the columns of points, from `at`; they increase.
        heights : list of numbers, shape (n,) [m]
            Heights: of each place across, a row of those along.
        across : numbers, shape (n,) [m], optional
            Places of the rows; default one row, which is the same everywhere across.
        """
        return made(Surface2, "surface2s.height_field", locals())


class sliding(Kinds):
    """Function of time: a displacement."""

    @staticmethod
    @checked
    def rate(value: Real, /) -> Sliding:
        """Constant rate, starting at zero.

        Parameters
        ----------
        value : number [m/s]
        """
        return made_of(Sliding, "sliding.rate", value)

    @staticmethod
    @checked
    def polynomial(value: Vector, /) -> Sliding:
        """Coefficients c0, c1, c2, … of c0 + c1 t + c2 t² + …

        Parameters
        ----------
        value : numbers, shape (n,) [m, m/s, m/s², …]
        """
        return made_of(Sliding, "sliding.polynomial", value)

    @staticmethod
    @checked
    def harmonic(*, amplitude: Real, frequency: Real, phase: Real | None = None, mean: Real | None = None) -> Sliding:
        """mean + amplitude · sin(2π frequency t + phase).

        Parameters
        ----------
        amplitude : number [m]
            Amplitude.
        frequency : number [Hz]
            Frequency.
        phase : number [rad], optional
            Phase at t = 0, default 0.
        mean : number [m], optional
            Mean, default 0.
        """
        return made(Sliding, "sliding.harmonic", locals())

    @staticmethod
    @checked
    def table(*, times: Vector, values: Vector, interpolation: Interpolation | None = None) -> Sliding:
        """Interpolation with continuous acceleration. It is at rest at both ends and constant beyond.

        Parameters
        ----------
        times : numbers, shape (n,) [s]
            Instants, increasing.
        values : numbers, shape (n,) [m]
            Value at each instant.
        interpolation : "linear" or "monotone" or "spline", optional
            Interpolation between the values, default monotone.
            "linear": Straight lines. Those of a motion are rounded at their ends, so accelerations stay finite.
            "monotone": Smooth without overshoot.
            "spline": As smooth as the values. It may overshoot.
        """
        return made(Sliding, "sliding.table", locals())

    @staticmethod
    @checked
    def s_curve(
        *,
        to: Real,
        speed: Real,
        acceleration: Real,
        from_: Real | None = None,
        start: Real | None = None,
    ) -> Sliding:
        """A way from one value to another within a speed and an acceleration, at rest before and after it. Its jerk is
        continuous.

        Parameters
        ----------
        to : number [m]
            Value behind it, another one.
        speed : number above 0 [m/s]
            Largest speed. A short way does not reach it.
        acceleration : number above 0 [m/s²]
            Largest acceleration.
        from_ : number [m], optional
            Value before it, default 0.
        start : number [s], optional
            Instant at which it starts, default 0.
        """
        return made(Sliding, "sliding.s_curve", locals())


class varying_pressures(Kinds):
    """Function of time: a pressure."""

    @staticmethod
    @checked
    def harmonic(*, amplitude: Real, frequency: Real, phase: Real | None = None) -> VaryingPressure:
        """amplitude · sin(2π frequency t + phase).

        Parameters
        ----------
        amplitude : number [Pa]
            Amplitude.
        frequency : number [Hz]
            Frequency.
        phase : number [rad], optional
            Phase at t = 0, default 0.
        """
        return made(VaryingPressure, "varying_pressures.harmonic", locals())

    @staticmethod
    @checked
    def table(*, times: Vector, values: Vector, interpolation: Interpolation | None = None) -> VaryingPressure:
        """Interpolation between values, constant beyond both ends.

        Parameters
        ----------
        times : numbers, shape (n,) [s]
            Instants, increasing.
        values : numbers, shape (n,) [Pa]
            Value at each instant.
        interpolation : "linear" or "monotone" or "spline", optional
            Interpolation between the values, default monotone.
            "linear": Straight lines. Those of a motion are rounded at their ends, so accelerations stay finite.
            "monotone": Smooth without overshoot.
            "spline": As smooth as the values. It may overshoot.
        """
        return made(VaryingPressure, "varying_pressures.table", locals())


class varying_line_forces(Kinds):
    """Function of time: a force per length."""

    @staticmethod
    @checked
    def harmonic(*, amplitude: Real, frequency: Real, phase: Real | None = None) -> VaryingLineForce:
        """amplitude · sin(2π frequency t + phase).

        Parameters
        ----------
        amplitude : number [N/m]
            Amplitude.
        frequency : number [Hz]
            Frequency.
        phase : number [rad], optional
            Phase at t = 0, default 0.
        """
        return made(VaryingLineForce, "varying_line_forces.harmonic", locals())

    @staticmethod
    @checked
    def table(*, times: Vector, values: Vector, interpolation: Interpolation | None = None) -> VaryingLineForce:
        """Interpolation between values, constant beyond both ends.

        Parameters
        ----------
        times : numbers, shape (n,) [s]
            Instants, increasing.
        values : numbers, shape (n,) [N/m]
            Value at each instant.
        interpolation : "linear" or "monotone" or "spline", optional
            Interpolation between the values, default monotone.
            "linear": Straight lines. Those of a motion are rounded at their ends, so accelerations stay finite.
            "monotone": Smooth without overshoot.
            "spline": As smooth as the values. It may overshoot.
        """
        return made(VaryingLineForce, "varying_line_forces.table", locals())


class followings(Kinds):
    """Function of time: an angle, displacement or distance."""

    @staticmethod
    @checked
    def rate(value: Real, /) -> Following:
        """Constant rate, starting at zero.

        Parameters
        ----------
        value : number [m/s or rad/s]
        """
        return made_of(Following, "followings.rate", value)

    @staticmethod
    @checked
    def polynomial(value: Vector, /) -> Following:
        """Coefficients c0, c1, c2, … of c0 + c1 t + c2 t² + …

        Parameters
        ----------
        value : numbers, shape (n,) [m, m/s, m/s², … or rad, rad/s, rad/s², …]
        """
        return made_of(Following, "followings.polynomial", value)

    @staticmethod
    @checked
    def harmonic(
        *,
        amplitude: Real,
        frequency: Real,
        phase: Real | None = None,
        mean: Real | None = None,
    ) -> Following:
        """mean + amplitude · sin(2π frequency t + phase).

        Parameters
        ----------
        amplitude : number [m or rad]
            Amplitude.
        frequency : number [Hz]
            Frequency.
        phase : number [rad], optional
            Phase at t = 0, default 0.
        mean : number [m or rad], optional
            Mean, default 0.
        """
        return made(Following, "followings.harmonic", locals())

    @staticmethod
    @checked
    def table(*, times: Vector, values: Vector, interpolation: Interpolation | None = None) -> Following:
        """Interpolation with continuous acceleration. It is at rest at both ends and constant beyond.

        Parameters
        ----------
        times : numbers, shape (n,) [s]
            Instants, increasing.
        values : numbers, shape (n,) [m or rad]
            Value at each instant.
        interpolation : "linear" or "monotone" or "spline", optional
            Interpolation between the values, default monotone.
            "linear": Straight lines. Those of a motion are rounded at their ends, so accelerations stay finite.
            "monotone": Smooth without overshoot.
            "spline": As smooth as the values. It may overshoot.
        """
        return made(Following, "followings.table", locals())

    @staticmethod
    @checked
    def s_curve(
        *,
        to: Real,
        speed: Real,
        acceleration: Real,
        from_: Real | None = None,
        start: Real | None = None,
    ) -> Following:
        """A way from one value to another within a speed and an acceleration, at rest before and after it. Its jerk is
        continuous.

        Parameters
        ----------
        to : number [m or rad]
            Value behind it, another one.
        speed : number above 0 [m/s or rad/s]
            Largest speed. A short way does not reach it.
        acceleration : number above 0 [m/s² or rad/s²]
            Largest acceleration.
        from_ : number [m or rad], optional
            Value before it, default 0.
        start : number [s], optional
            Instant at which it starts, default 0.
        """
        return made(Following, "followings.s_curve", locals())


class varying_efforts(Kinds):
    """Function of time: a force or torque."""

    @staticmethod
    @checked
    def harmonic(*, amplitude: Real, frequency: Real, phase: Real | None = None) -> VaryingEffort:
        """amplitude · sin(2π frequency t + phase).

        Parameters
        ----------
        amplitude : number [N or N m]
            Amplitude.
        frequency : number [Hz]
            Frequency.
        phase : number [rad], optional
            Phase at t = 0, default 0.
        """
        return made(VaryingEffort, "varying_efforts.harmonic", locals())

    @staticmethod
    @checked
    def table(*, times: Vector, values: Vector, interpolation: Interpolation | None = None) -> VaryingEffort:
        """Interpolation between values, constant beyond both ends.

        Parameters
        ----------
        times : numbers, shape (n,) [s]
            Instants, increasing.
        values : numbers, shape (n,) [N or N m]
            Value at each instant.
        interpolation : "linear" or "monotone" or "spline", optional
            Interpolation between the values, default monotone.
            "linear": Straight lines. Those of a motion are rounded at their ends, so accelerations stay finite.
            "monotone": Smooth without overshoot.
            "spline": As smooth as the values. It may overshoot.
        """
        return made(VaryingEffort, "varying_efforts.table", locals())


class turning(Kinds):
    """Function of time: an angle."""

    @staticmethod
    @checked
    def rate(value: Real, /) -> Turning:
        """Constant rate, starting at zero.

        Parameters
        ----------
        value : number [rad/s]
        """
        return made_of(Turning, "turning.rate", value)

    @staticmethod
    @checked
    def polynomial(value: Vector, /) -> Turning:
        """Coefficients c0, c1, c2, … of c0 + c1 t + c2 t² + …

        Parameters
        ----------
        value : numbers, shape (n,) [rad, rad/s, rad/s², …]
        """
        return made_of(Turning, "turning.polynomial", value)

    @staticmethod
    @checked
    def harmonic(*, amplitude: Real, frequency: Real, phase: Real | None = None, mean: Real | None = None) -> Turning:
        """mean + amplitude · sin(2π frequency t + phase).

        Parameters
        ----------
        amplitude : number [rad]
            Amplitude.
        frequency : number [Hz]
            Frequency.
        phase : number [rad], optional
            Phase at t = 0, default 0.
        mean : number [rad], optional
            Mean, default 0.
        """
        return made(Turning, "turning.harmonic", locals())

    @staticmethod
    @checked
    def table(*, times: Vector, values: Vector, interpolation: Interpolation | None = None) -> Turning:
        """Interpolation with continuous acceleration. It is at rest at both ends and constant beyond.

        Parameters
        ----------
        times : numbers, shape (n,) [s]
            Instants, increasing.
        values : numbers, shape (n,) [rad]
            Value at each instant.
        interpolation : "linear" or "monotone" or "spline", optional
            Interpolation between the values, default monotone.
            "linear": Straight lines. Those of a motion are rounded at their ends, so accelerations stay finite.
            "monotone": Smooth without overshoot.
            "spline": As smooth as the values. It may overshoot.
        """
        return made(Turning, "turning.table", locals())

    @staticmethod
    @checked
    def s_curve(
        *,
        to: Real,
        speed: Real,
        acceleration: Real,
        from_: Real | None = None,
        start: Real | None = None,
    ) -> Turning:
        """A way from one value to another within a speed and an acceleration, at rest before and after it. Its jerk is
        continuous.

        Parameters
        ----------
        to : number [rad]
            Value behind it, another one.
        speed : number above 0 [rad/s]
            Largest speed. A short way does not reach it.
        acceleration : number above 0 [rad/s²]
            Largest acceleration.
        from_ : number [rad], optional
            Value before it, default 0.
        start : number [s], optional
            Instant at which it starts, default 0.
        """
        return made(Turning, "turning.s_curve", locals())


class couplings(Kinds):
    """A linear relation between the motions of joints, over any number of turns: gears, a rack, a screw, a belt, or
    any other. It holds as the bodies are placed.
    """

    @staticmethod
    @checked
    def gear(
        *,
        gears: Sequence[str],
        carrier: str | None = None,
        teeth: Vector | None = None,
        radii: Vector | None = None,
        ratio: Real | None = None,
        inner: bool | None = None,
    ) -> Coupling:
        """Two gears with parallel axes.

        Parameters
        ----------
        gears : list of 2 texts
            The two bodies.
        carrier : text, optional
            The body that holds the axes, or "ground"; default the one to which both are hinged.
        teeth : numbers, shape (2,) above 0, optional
            Numbers of teeth.
        radii : numbers, shape (2,) above 0 [m], optional
            Pitch radii, instead of `teeth`.
        ratio : number above 0, optional
            Turns of the first gear for one of the second, instead of `teeth`.
        inner : bool, optional
            Whether one of them has inner teeth, so that both turn the same way, default false.
        """
        return made(Coupling, "couplings.gear", locals())

    @staticmethod
    @checked
    def bevel(
        *,
        gears: Sequence[str],
        at: Location,
        carrier: str | None = None,
        teeth: Vector | None = None,
        ratio: Real | None = None,
    ) -> Coupling:
        """Two gears whose axes meet.

        Parameters
        ----------
        gears : list of 2 texts
            The two bodies.
        at : text or numbers, shape (3,) [m]
            A place in the placement at which the teeth meet, in the plane of both axes. Its distances from them are
            the radii.
            text: `"body.point"`, or `"body"` for the origin of its axes.
            numbers, shape (3,) [m]: Ground coordinates.
        carrier : text, optional
            The body that holds the axes, or "ground"; default the one to which both are hinged.
        teeth : numbers, shape (2,) above 0, optional
            Numbers of teeth, instead of these radii.
        ratio : number above 0, optional
            Turns of the first gear for one of the second, instead of these radii.
        """
        return made(Coupling, "couplings.bevel", locals())

    @staticmethod
    @checked
    def rack_and_pinion(
        *,
        rack: str,
        pinion: str,
        at: Location,
        carrier: str | None = None,
        radius: Real | None = None,
    ) -> Coupling:
        """A rack that a pinion drives.

        Parameters
        ----------
        rack : text
            The body that slides.
        pinion : text
            The gear.
        at : text or numbers, shape (3,) [m]
            A place in the placement at which the teeth meet: the point of the rack's pitch line that is nearest to
            the axis.
            text: `"body.point"`, or `"body"` for the origin of its axes.
            numbers, shape (3,) [m]: Ground coordinates.
        carrier : text, optional
            The body on which they move, or "ground"; default the one to which both are joined.
        radius : number above 0 [m], optional
            Pitch radius, default the distance of `at` from the axis.
        """
        return made(Coupling, "couplings.rack_and_pinion", locals())

    @staticmethod
    @checked
    def screw(*, joint: str, lead: Real) -> Coupling:
        """A screw: a cylindrical joint that moves by its lead in a turn.

        Parameters
        ----------
        joint : text
            Name of the cylindrical joint.
        lead : number [m]
            Displacement in a turn; negative of a left-hand thread.
        """
        return made(Coupling, "couplings.screw", locals())

    @staticmethod
    @checked
    def belt(
        *,
        pulleys: Sequence[str],
        carrier: str | None = None,
        radii: Vector | None = None,
        teeth: Vector | None = None,
        ratio: Real | None = None,
        crossed: bool | None = None,
    ) -> Coupling:
        """A belt or chain, or a rope without slip, about two pulleys with parallel axes.

        Parameters
        ----------
        pulleys : list of 2 texts
            The two bodies.
        carrier : text, optional
            The body that holds the axes, or "ground"; default the one to which both are hinged.
        radii : numbers, shape (2,) above 0 [m], optional
            Radii.
        teeth : numbers, shape (2,) above 0, optional
            Numbers of teeth, instead of `radii`.
        ratio : number above 0, optional
            Turns of the first pulley for one of the second, instead of `radii`.
        crossed : bool, optional
            Whether the belt crosses, so that the pulleys turn in opposite directions, default false.
        """
        return made(Coupling, "couplings.belt", locals())

    @staticmethod
    @checked
    def relation(*, terms: Sequence[Term], constant: Real | None = None) -> Coupling:
        """Σ factor · motion = constant.

        Parameters
        ----------
        terms : list of `term(…)`
            The motions. The factor of the last is not zero in any design.
        constant : number [that of the terms], optional
            The constant, with motions counted from the placement as functions measure them; default its value at the
            start.
        """
        return made(Coupling, "couplings.relation", locals())

    @staticmethod
    @checked
    def cam(*, cam: JointMotion, follower: JointMotion, profile: Profile) -> Coupling:
        """A motion that is a function of another.

        Parameters
        ----------
        cam : one of `joint_motions`
            The motion on which the profile depends.
        follower : one of `joint_motions`
            The motion that follows it.
        profile : `profile(…)`
            The motion of the follower by that of the cam.
        """
        return made(Coupling, "couplings.cam", locals())


class joint_motions(Kinds):
    """A motion of a joint: that of its first body against the second (ground counts as the second)."""

    @staticmethod
    @checked
    def turn(value: str, /) -> JointMotion:
        """The angle of this revolute, planar or cylindrical joint.

        Parameters
        ----------
        value : text
        """
        return made_of(JointMotion, "joint_motions.turn", value)

    @staticmethod
    @checked
    def slide(value: str, /) -> JointMotion:
        """The displacement of this prismatic or cylindrical joint.

        Parameters
        ----------
        value : text
        """
        return made_of(JointMotion, "joint_motions.slide", value)


class quantities(Kinds):
    """A quantity at an instant."""

    @staticmethod
    @checked
    def position(*, body: str, direction: Vector, point: Point | None = None) -> Quantity:
        """Component of a point's position [m].

        Parameters
        ----------
        body : text
            The body.
        direction : numbers, shape (3,)
            Direction in ground axes. It is not normalised; a unit vector gives a component.
        point : text or numbers, shape (3,) [m], optional
            Its point, by name or in body axes; default the centre of mass.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        """
        return made(Quantity, "quantities.position", locals())

    @staticmethod
    @checked
    def velocity(*, body: str, direction: Vector, point: Point | None = None) -> Quantity:
        """Component of a point's velocity [m/s].

        Parameters
        ----------
        body : text
            The body.
        direction : numbers, shape (3,)
            Direction in ground axes. It is not normalised; a unit vector gives a component.
        point : text or numbers, shape (3,) [m], optional
            Its point, by name or in body axes; default the centre of mass.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        """
        return made(Quantity, "quantities.velocity", locals())

    @staticmethod
    @checked
    def acceleration(*, body: str, direction: Vector, point: Point | None = None) -> Quantity:
        """Component of a point's acceleration [m/s²].

        Parameters
        ----------
        body : text
            The body.
        direction : numbers, shape (3,)
            Direction in ground axes. It is not normalised; a unit vector gives a component.
        point : text or numbers, shape (3,) [m], optional
            Its point, by name or in body axes; default the centre of mass.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        """
        return made(Quantity, "quantities.acceleration", locals())

    @staticmethod
    @checked
    def speed(*, body: str, point: Point | None = None) -> Quantity:
        """Speed of a point [m/s].

        Parameters
        ----------
        body : text
            The body.
        point : text or numbers, shape (3,) [m], optional
            Its point, by name or in body axes; default the centre of mass.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        """
        return made(Quantity, "quantities.speed", locals())

    @staticmethod
    @checked
    def speed_squared(*, body: str, point: Point | None = None) -> Quantity:
        """Square of the speed of a point [m²/s²], which is smooth at rest too.

        Parameters
        ----------
        body : text
            The body.
        point : text or numbers, shape (3,) [m], optional
            Its point, by name or in body axes; default the centre of mass.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        """
        return made(Quantity, "quantities.speed_squared", locals())

    @staticmethod
    @checked
    def angular_velocity(*, body: str, direction: Vector) -> Quantity:
        """Component of the angular velocity of a body [rad/s]; of a beam, that of its frame.

        Parameters
        ----------
        body : text
            The body.
        direction : numbers, shape (3,)
            Direction in ground axes. It is not normalised; a unit vector gives a component.
        """
        return made(Quantity, "quantities.angular_velocity", locals())

    @staticmethod
    @checked
    def momentum(*, direction: Vector) -> Quantity:
        """Component of the linear momentum of the whole scene [kg m/s].

        Parameters
        ----------
        direction : numbers, shape (3,)
            Direction in ground axes. It is not normalised; a unit vector gives a component.
        """
        return made(Quantity, "quantities.momentum", locals())

    @staticmethod
    @checked
    def angular_momentum(*, direction: Vector, about: Vector | None = None) -> Quantity:
        """Component of the angular momentum of the whole scene about a fixed point [kg m²/s].

        Parameters
        ----------
        direction : numbers, shape (3,)
            Direction in ground axes. It is not normalised; a unit vector gives a component.
        about : numbers, shape (3,) [m], optional
            The fixed point that it is about, default the origin.
        """
        return made(Quantity, "quantities.angular_momentum", locals())

    @staticmethod
    @checked
    def energy(value: EnergyKind, /) -> Quantity:
        """Energy of the whole scene [J].

        Parameters
        ----------
        value : "kinetic" or "potential" or "total"
            Kind of energy.
            "kinetic": Kinetic energy.
            "potential": Potential energy, zero with the centre of mass at the origin.
            "total": Their sum.
        """
        return made_of(Quantity, "quantities.energy", value)

    @staticmethod
    @checked
    def jerk(*, body: str, direction: Vector, point: Point | None = None) -> Quantity:
        """Component of the rate of change of a point's acceleration [m/s³].

        Parameters
        ----------
        body : text
            The body.
        direction : numbers, shape (3,)
            Direction in ground axes. It is not normalised; a unit vector gives a component.
        point : text or numbers, shape (3,) [m], optional
            Its point, by name or in body axes; default the centre of mass.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        """
        return made(Quantity, "quantities.jerk", locals())

    @staticmethod
    @checked
    def sensor_acceleration(*, body: str, direction: Vector, point: Point | None = None) -> Quantity:
        """Component of a point's acceleration in the axes of its body [m/s²], as a sensor on it measures but for
        gravity.

        Parameters
        ----------
        body : text
            The body.
        direction : numbers, shape (3,)
            Direction in ground axes. It is not normalised; a unit vector gives a component.
        point : text or numbers, shape (3,) [m], optional
            Its point, by name or in body axes; default the centre of mass.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        """
        return made(Quantity, "quantities.sensor_acceleration", locals())

    @staticmethod
    @checked
    def relative_position(
        *,
        body: str,
        relative_to: str,
        direction: Vector,
        point: Point | None = None,
        from_: Point | None = None,
    ) -> Quantity:
        """Component of a point's position as seen from another body [m].

        Parameters
        ----------
        body : text
            The body that is seen.
        relative_to : text
            The body that sees it, or "ground".
        direction : numbers, shape (3,)
            Direction in the axes of the body that sees. It is not normalised; a unit vector gives a component.
        point : text or numbers, shape (3,) [m], optional
            Its point, by name or in body axes; default the centre of mass.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        from_ : text or numbers, shape (3,) [m], optional
            The point of that body from which it is seen, by name or in its axes; default its centre of mass, on
            ground the origin.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        """
        return made(Quantity, "quantities.relative_position", locals())

    @staticmethod
    @checked
    def relative_velocity(
        *,
        body: str,
        relative_to: str,
        direction: Vector,
        point: Point | None = None,
        from_: Point | None = None,
    ) -> Quantity:
        """Component of a point's velocity as seen from another body [m/s].

        Parameters
        ----------
        body : text
            The body that is seen.
        relative_to : text
            The body that sees it, or "ground".
        direction : numbers, shape (3,)
            Direction in the axes of the body that sees. It is not normalised; a unit vector gives a component.
        point : text or numbers, shape (3,) [m], optional
            Its point, by name or in body axes; default the centre of mass.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        from_ : text or numbers, shape (3,) [m], optional
            The point of that body from which it is seen, by name or in its axes; default its centre of mass, on
            ground the origin.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        """
        return made(Quantity, "quantities.relative_velocity", locals())

    @staticmethod
    @checked
    def distance(*, body: str, relative_to: str, point: Point | None = None, from_: Point | None = None) -> Quantity:
        """Distance of points of two bodies [m].

        Parameters
        ----------
        body : text
            The first body.
        relative_to : text
            The other body, or "ground".
        point : text or numbers, shape (3,) [m], optional
            Its point, by name or in body axes; default the centre of mass.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        from_ : text or numbers, shape (3,) [m], optional
            Its point, by name or in its axes; default its centre of mass, on ground the origin.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        """
        return made(Quantity, "quantities.distance", locals())

    @staticmethod
    @checked
    def power(value: PowerOf, /) -> Quantity:
        """Power of a load or drive [W]; its integral is the work.

        Parameters
        ----------
        value : one of `power_ofs`
            What gives or takes power: a load, or the drive of a joint.
        """
        return made_of(Quantity, "quantities.power", value)

    @staticmethod
    @checked
    def angle_rate(*, joint: str) -> Quantity:
        """Rate of the angle of a joint [rad/s].

        Parameters
        ----------
        joint : text
            Name of a revolute, planar or cylindrical joint. The angle is that of its first body relative to the
            second (ground counts as the second) about the axis, from the placement.
        """
        return made(Quantity, "quantities.angle_rate", locals())

    @staticmethod
    @checked
    def slide_rate(*, joint: str) -> Quantity:
        """Rate of the displacement of a joint along its axis [m/s].

        Parameters
        ----------
        joint : text
            Name of a prismatic or cylindrical joint. The displacement is that of its first body against the second
            (ground counts as the second) along the axis, from the placement.
        """
        return made(Quantity, "quantities.slide_rate", locals())

    @staticmethod
    @checked
    def sum(value: Sequence[Quantity], /) -> Quantity:
        """Sum of quantities of one unit.

        Parameters
        ----------
        value : list of one of `quantities`
        """
        return made_of(Quantity, "quantities.sum", value)

    @staticmethod
    @checked
    def difference(value: Sequence[Quantity], /) -> Quantity:
        """The first quantity minus the second, of one unit.

        Parameters
        ----------
        value : list of 2 one of `quantities`
        """
        return made_of(Quantity, "quantities.difference", value)

    @staticmethod
    @checked
    def product(value: Sequence[Quantity], /) -> Quantity:
        """Product of quantities.

        Parameters
        ----------
        value : list of one of `quantities`
        """
        return made_of(Quantity, "quantities.product", value)

    @staticmethod
    @checked
    def quotient(value: Sequence[Quantity], /) -> Quantity:
        """The first quantity by the second.

        Parameters
        ----------
        value : list of 2 one of `quantities`
        """
        return made_of(Quantity, "quantities.quotient", value)

    @staticmethod
    @checked
    def square(value: Quantity, /) -> Quantity:
        """Square of a quantity.

        Parameters
        ----------
        value : one of `quantities`
            A quantity at an instant.
        """
        return made_of(Quantity, "quantities.square", value)

    @staticmethod
    @checked
    def absolute(*, of: Quantity, width: Real) -> Quantity:
        """Absolute value of a quantity, smooth at zero.

        Parameters
        ----------
        of : one of `quantities`
            The quantity x.
        width : number above 0 [unit of the quantity]
            Width w of the rounded corner at zero: √(x² + w²) − w, at most w below |x|.
        """
        return made(Quantity, "quantities.absolute", locals())

    @staticmethod
    @checked
    def rate(value: Quantity, /) -> Quantity:
        """Rate of change of a quantity in time, by polynomials between the samples.

        Parameters
        ----------
        value : one of `quantities`
            A quantity at an instant.
        """
        return made_of(Quantity, "quantities.rate", value)

    @staticmethod
    @checked
    def rotation(
        *,
        body: str,
        axis: Vector,
        relative_to: str | None = None,
        from_: CountedFrom | None = None,
    ) -> Quantity:
        """Rotation of a body about an axis [rad], counted over whole turns.

        Parameters
        ----------
        body : text
            The body.
        axis : numbers, shape (3,)
            Axis in ground axes as the bodies are placed, of any length but zero. It is fixed in the body that the
            rotation is relative to.
        relative_to : text, optional
            The body that the rotation is relative to, default "ground".
        from_ : "axes" or "placement", optional
            Zero of the rotation, default "axes".
            "axes": The axes of the body are parallel to those of the other body, or of ground.
            "placement": The bodies are as placed.
        """
        return made(Quantity, "quantities.rotation", locals())

    @staticmethod
    @checked
    def angle(*, joint: str) -> Quantity:
        """Angle of a joint [rad] as in drives and torsion springs, counted over whole turns.

        Parameters
        ----------
        joint : text
            Name of a revolute, planar or cylindrical joint. The angle is that of its first body relative to the
            second (ground counts as the second) about the axis, from the placement.
        """
        return made(Quantity, "quantities.angle", locals())

    @staticmethod
    @checked
    def slide(*, joint: str) -> Quantity:
        """Displacement of a joint along its axis [m].

        Parameters
        ----------
        joint : text
            Name of a prismatic or cylindrical joint. The displacement is that of its first body against the second
            (ground counts as the second) along the axis, from the placement.
        """
        return made(Quantity, "quantities.slide", locals())

    @staticmethod
    @checked
    def joint_force(
        *,
        joint: str,
        direction: Vector,
        on: str | None = None,
        axes: ReactionAxes | None = None,
    ) -> Quantity:
        """Component of the force by which a joint acts on a body [N].

        Parameters
        ----------
        joint : text
            The joint.
        direction : numbers, shape (3,)
            Direction, used as it is given: a unit vector gives a component.
        on : text, optional
            The body that it acts on, one of the two or "ground"; default the first that is not ground. A moment is
            about the joint's point on this body.
        axes : "ground" or "joint", optional
            Axes of the direction, default "ground".
            "ground": Those of ground.
            "joint": e1, e2, e3 of the joint on its first body (the one that is not ground); e3 is the joint's axis.
        """
        return made(Quantity, "quantities.joint_force", locals())

    @staticmethod
    @checked
    def joint_moment(
        *,
        joint: str,
        direction: Vector,
        on: str | None = None,
        axes: ReactionAxes | None = None,
    ) -> Quantity:
        """Component of the moment by which a joint acts on a body [N m], that of its drive included.

        Parameters
        ----------
        joint : text
            The joint.
        direction : numbers, shape (3,)
            Direction, used as it is given: a unit vector gives a component.
        on : text, optional
            The body that it acts on, one of the two or "ground"; default the first that is not ground. A moment is
            about the joint's point on this body.
        axes : "ground" or "joint", optional
            Axes of the direction, default "ground".
            "ground": Those of ground.
            "joint": e1, e2, e3 of the joint on its first body (the one that is not ground); e3 is the joint's axis.
        """
        return made(Quantity, "quantities.joint_moment", locals())

    @staticmethod
    @checked
    def coupling_reaction(*, coupling: str, on: str | None = None, motion: Motion | None = None) -> Quantity:
        """Torque of a coupling on one of its wheels about its axis [N m], or force on its rack along the slide [N]; of a
        screw or relation on the first body of a joint (the one that is not ground).

        Parameters
        ----------
        coupling : text
            Name of the coupling.
        on : text, optional
            One of its wheels, its rack, or a joint of a screw or relation; default the first.
        motion : "turn" or "slide", optional
            The motion of a joint, default its first in the coupling.
            "turn": Rotation about its axis.
            "slide": Displacement along its axis.
        """
        return made(Quantity, "quantities.coupling_reaction", locals())

    @staticmethod
    @checked
    def spring_length(*, load: str) -> Quantity:
        """Distance of the points of a spring [m].

        Parameters
        ----------
        load : text
            Name of the load.
        """
        return made(Quantity, "quantities.spring_length", locals())

    @staticmethod
    @checked
    def spring_force(*, load: str) -> Quantity:
        """Force by which a spring pulls its points together [N], damping included.

        Parameters
        ----------
        load : text
            Name of the load.
        """
        return made(Quantity, "quantities.spring_force", locals())

    @staticmethod
    @checked
    def spring_torque(*, load: str) -> Quantity:
        """Torque by which a torsion spring turns its joint back [N m], damping included.

        Parameters
        ----------
        load : text
            Name of the load.
        """
        return made(Quantity, "quantities.spring_torque", locals())

    @staticmethod
    @checked
    def frequency(*, mode: Integer) -> Quantity:
        """A natural frequency of the machine about its state at the instant, drives held [Hz].

        Parameters
        ----------
        mode : integer from 1 to 150
            Number of the damped mode from 1, by its rate |s|. Motions that do not oscillate, being free or damped
            beyond ζ = 1, are not counted.
        """
        return made(Quantity, "quantities.frequency", locals())

    @staticmethod
    @checked
    def damping_ratio(*, mode: Integer) -> Quantity:
        """The damping ratio of such a vibration.

        Parameters
        ----------
        mode : integer from 1 to 150
            Number of the damped mode from 1, by its rate |s|. Motions that do not oscillate, being free or damped
            beyond ζ = 1, are not counted.
        """
        return made(Quantity, "quantities.damping_ratio", locals())

    @staticmethod
    @checked
    def contact_force(*, load: str) -> Quantity:
        """Normal force of a stop or contact [N], or the torque of a stop of an angle [N m]; never negative.

        Parameters
        ----------
        load : text
            Name of the load.
        """
        return made(Quantity, "quantities.contact_force", locals())

    @staticmethod
    @checked
    def contact_friction(*, load: str) -> Quantity:
        """Size of the friction of a contact [N].

        Parameters
        ----------
        load : text
            Name of the load.
        """
        return made(Quantity, "quantities.contact_friction", locals())

    @staticmethod
    @checked
    def slip_power(*, load: str) -> Quantity:
        """Power that the friction of a contact takes [W]; never negative.

        Parameters
        ----------
        load : text
            Name of the load.
        """
        return made(Quantity, "quantities.slip_power", locals())

    @staticmethod
    @checked
    def penetration(*, load: str) -> Quantity:
        """How deep a stop or contact is entered [m or rad]; negative before it, to the nearer limit.

        Parameters
        ----------
        load : text
            Name of the load.
        """
        return made(Quantity, "quantities.penetration", locals())

    @staticmethod
    @checked
    def effort(*, load: str) -> Quantity:
        """Force [N] or torque [N m] of a controller; positive where it increases its coordinate.

        Parameters
        ----------
        load : text
            Name of the load.
        """
        return made(Quantity, "quantities.effort", locals())

    @staticmethod
    @checked
    def tracking_error(*, load: str) -> Quantity:
        """What the coordinate of a controller lacks to its reference [m or rad].

        Parameters
        ----------
        load : text
            Name of the load.
        """
        return made(Quantity, "quantities.tracking_error", locals())

    @staticmethod
    @checked
    def range(
        *,
        body: str,
        point: Point | None = None,
        direction: Vector | None = None,
        ground: Real | None = None,
        gate: Gate | None = None,
    ) -> Quantity:
        """Range of a projectile that is released at this instant [m].

        Parameters
        ----------
        body : text
            The body that is thrown.
        point : text or numbers, shape (3,) [m], optional
            Its point that flies, by name or in body axes; default the centre of mass.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        direction : numbers, shape (3,), optional
            Horizontal direction of the throw in ground axes, default [1, 0, 0].
        ground : number [m], optional
            Height of the ground where the projectile lands, default 0.
        gate : `gate(…)`, optional
            Gate that excludes later turns of a sling from the range.
        """
        return made(Quantity, "quantities.range", locals())

    @staticmethod
    @checked
    def von_mises(*, body: str, rho: Real | None = None, elements: str | None = None) -> Quantity:
        """Von Mises stress by yield stress of a body of shells, aggregated over both faces of their Gauss points.

        Parameters
        ----------
        body : text
            The body.
        rho : number above 0, optional
            Aggregation parameter over the points; larger is closer to the maximum.
        elements : text, optional
            Name of a set of elements of its structure, default all.
        """
        return made(Quantity, "quantities.von_mises", locals())

    @staticmethod
    @checked
    def elastic_displacement(*, body: str, point: Point, direction: Vector) -> Quantity:
        """Displacement of a point of a beam or of shells from where it is in the undeformed body [m].

        Parameters
        ----------
        body : text
            The beam.
        point : text or numbers, shape (3,) [m]
            Its point, by name or in body axes.
            text: Name of one of the body's points.
            numbers, shape (3,) [m]: Coordinates in body axes from their origin.
        direction : numbers, shape (3,)
            Direction in body axes, used as it is given: a unit vector gives a component.
        """
        return made(Quantity, "quantities.elastic_displacement", locals())

    @staticmethod
    @checked
    def strain_energy(*, body: str) -> Quantity:
        """Strain energy of a beam or of shells [J].

        Parameters
        ----------
        body : text
            The beam.
        """
        return made(Quantity, "quantities.strain_energy", locals())

    @staticmethod
    @checked
    def section_force(
        *,
        body: str,
        station: SectionPlace,
        component: SectionComponent,
        beams: str | None = None,
    ) -> Quantity:
        """Force [N] or moment [N m] in a section of a beam.

        Parameters
        ----------
        body : text
            The beam, or a body of elements that has beams.
        station : text or number at least 0
            Where the section is.
            text: Name of a station, "start" or "end".
            number at least 0: Fraction of the length.
        component : "axial" or "shear_y" or "shear_z" or "torsion" or "bending_y" or "bending_z"
            Which of its forces and moments.
            "axial": Axial force, positive in tension.
            "shear_y": Shear force along y.
            "shear_z": Shear force along z.
            "torsion": Torsion moment.
            "bending_y": Bending moment about y.
            "bending_z": Bending moment about z.
        beams : text, optional
            Of a body of elements: the name of a set of its beams, or of a stiffener; default all its beams.
        """
        return made(Quantity, "quantities.section_force", locals())

    @staticmethod
    @checked
    def fibre_stress(*, body: str, station: SectionPlace, fibre: Vector, beams: str | None = None) -> Quantity:
        """Stress of bending and stretch along a fibre of a beam [Pa].

        Parameters
        ----------
        body : text
            The beam, or a body of elements that has beams.
        station : text or number at least 0
            Where the section is.
            text: Name of a station, "start" or "end".
            number at least 0: Fraction of the length.
        fibre : numbers, shape (2,)
            Where the fibre is in it along y and z, in parts of half the section's size: [1, 0] is outermost along y.
        beams : text, optional
            Of a body of elements: the name of a set of its beams, or of a stiffener; default all its beams.
        """
        return made(Quantity, "quantities.fibre_stress", locals())

    @staticmethod
    @checked
    def largest_section_force(
        *,
        body: str,
        stations: SectionPlaces,
        component: SectionComponent,
        beams: str | None = None,
        sign: Sign | None = None,
        rho: Real | None = None,
        bound: Bound | None = None,
    ) -> Quantity:
        """Largest force [N] or moment [N m] of several sections of a beam, by a smooth maximum.

        Parameters
        ----------
        body : text
            The beam, or a body of elements that has beams.
        stations : integer at least 0 or list of text or number at least 0
            Where the sections are: a list of stations or fractions of the length, or a number of sections at equal
            distances.
            integer at least 0: So many at equal distances from start to end.
            list of text or number at least 0: These.
        component : "axial" or "shear_y" or "shear_z" or "torsion" or "bending_y" or "bending_z"
            Which of their forces and moments.
            "axial": Axial force, positive in tension.
            "shear_y": Shear force along y.
            "shear_z": Shear force along z.
            "torsion": Torsion moment.
            "bending_y": Bending moment about y.
            "bending_z": Bending moment about z.
        beams : text, optional
            Of a body of elements: the name of a set of its beams, or of a stiffener; default all its beams.
        sign : "positive" or "negative" or "both", optional
            Sign of the values, default "positive".
            "positive": The values.
            "negative": Their negatives.
            "both": Both, so the size counts.
        rho : number above 0 [1/unit of the quantity], optional
            Aggregation parameter over the sections; larger is closer to the largest. That of a `ks` over time, if it
            shall be one function of both.
        bound : "below" or "above", optional
            "below" (default): never above the largest. "above": never below it.
            "below": Never above it.
            "above": Never below it.
        """
        return made(Quantity, "quantities.largest_section_force", locals())

    @staticmethod
    @checked
    def largest_fibre_stress(
        *,
        body: str,
        stations: SectionPlaces,
        beams: str | None = None,
        fibres: Matrix | None = None,
        sign: Sign | None = None,
        rho: Real | None = None,
        bound: Bound | None = None,
    ) -> Quantity:
        """Largest stress of bending and stretch of several sections and fibres of a beam, by a smooth maximum [Pa].

        Parameters
        ----------
        body : text
            The beam, or a body of elements that has beams.
        stations : integer at least 0 or list of text or number at least 0
            Where the sections are: a list of stations or fractions of the length, or a number of sections at equal
            distances.
            integer at least 0: So many at equal distances from start to end.
            list of text or number at least 0: These.
        beams : text, optional
            Of a body of elements: the name of a set of its beams, or of a stiffener; default all its beams.
        fibres : numbers, shape (n, 2), optional
            Where the fibres are along y and z, in parts of half the section's size; default the four corners.
        sign : "positive" or "negative" or "both", optional
            Sign of the values, default "positive": tension.
            "positive": The values.
            "negative": Their negatives.
            "both": Both, so the size counts.
        rho : number above 0 [1/Pa], optional
            Aggregation parameter over sections and fibres; larger is closer to the largest. That of a `ks` over time,
            if it shall be one function of both.
        bound : "below" or "above", optional
            "below" (default): never above the largest. "above": never below it.
            "below": Never above it.
            "above": Never below it.
        """
        return made(Quantity, "quantities.largest_fibre_stress", locals())


class power_ofs(Kinds):
    """What gives or takes power: a load, or the drive of a joint."""

    @staticmethod
    @checked
    def load(value: str, /) -> PowerOf:
        """Name of a force, torque, spring, damper or friction. Positive where it gives energy to the bodies.

        Parameters
        ----------
        value : text
        """
        return made_of(PowerOf, "power_ofs.load", value)

    @staticmethod
    @checked
    def drive(value: str, /) -> PowerOf:
        """Name of a drive. Positive where it gives energy to the machine.

        Parameters
        ----------
        value : text
        """
        return made_of(PowerOf, "power_ofs.drive", value)


class methods(Kinds):
    """An integration method."""

    dop853: Final[Literal["dop853"]] = "dop853"
    """Explicit Runge-Kutta method of order 8 with projection onto the joints, for scenes that are not stiff."""

    @staticmethod
    @checked
    def radau(*, stages: Integer) -> Method:
        """Implicit Runge-Kutta method Radau IIA, for stiff scenes.

        Parameters
        ----------
        stages : integer from 2 to 3
            Number of stages: 2 (order 3) or 3 (order 5).
        """
        return made(Method, "methods.radau", locals())

    @staticmethod
    @checked
    def bdf(*, order: Integer, start: FirstSteps | None = None) -> Method:
        """Backward differentiation formula.

        Parameters
        ----------
        order : integer from 1 to 6
            Order, 1 to 6.
        start : "radau" or "rising_order", optional
            Method of the first steps, default radau.
            "radau": Radau IIA, which keeps the order.
            "rising_order": Formulas of rising order, which limit the order to 2.
        """
        return made(Method, "methods.bdf", locals())

    @staticmethod
    @checked
    def generalised_alpha(*, radius: Real) -> Method:
        """Generalised-alpha method.

        Parameters
        ----------
        radius : number from 0.5 to 0.9
            Spectral radius at infinite frequency.
        """
        return made(Method, "methods.generalised_alpha", locals())


class case_loads(Kinds):
    """A load of a load case. Sets have the name of their structure before a dot, or their own if there is one
    structure.
    """

    @staticmethod
    @checked
    def point(*, nodes: str, force: Vector | None = None, moment: Vector | None = None) -> CaseLoad:
        """A force and a moment on each node of a set.

        Parameters
        ----------
        nodes : text
            Name of the set of nodes.
        force : numbers, shape (3,) [N], optional
            Force on each node, default none.
        moment : numbers, shape (3,) [N m], optional
            Moment on each node, default none.
        """
        return made(CaseLoad, "case_loads.point", locals())

    @staticmethod
    @checked
    def edge(*, edges: str, force: Vector) -> CaseLoad:
        """A force per length on an edge.

        Parameters
        ----------
        edges : text
            Name of the set of edges.
        force : numbers, shape (3,) [N/m]
            Force per length.
        """
        return made(CaseLoad, "case_loads.edge", locals())

    @staticmethod
    @checked
    def line(*, beams: str, force: Vector) -> CaseLoad:
        """A force per length on beams.

        Parameters
        ----------
        beams : text
            Name of the set of beams.
        force : numbers, shape (3,) [N/m]
            Force per length.
        """
        return made(CaseLoad, "case_loads.line", locals())

    @staticmethod
    @checked
    def pressure(*, faces: str, pressure: Real) -> CaseLoad:
        """A pressure on shells, positive along their normals.

        Parameters
        ----------
        faces : text
            Name of the set of faces.
        pressure : number [Pa]
            The pressure.
        """
        return made(CaseLoad, "case_loads.pressure", locals())

    @staticmethod
    @checked
    def area(*, faces: str, force: Vector) -> CaseLoad:
        """A force per area on shells, in a fixed direction.

        Parameters
        ----------
        faces : text
            Name of the set of faces.
        force : numbers, shape (3,) [Pa]
            Force per area.
        """
        return made(CaseLoad, "case_loads.area", locals())

    @staticmethod
    @checked
    def gravity(*, acceleration: Vector) -> CaseLoad:
        """Weight.

        Parameters
        ----------
        acceleration : numbers, shape (3,) [m/s²]
            Acceleration.
        """
        return made(CaseLoad, "case_loads.gravity", locals())


class functions(Kinds):
    """A function of interest: a quantity at an instant, reduced over the run, or a clearance."""

    duration: Final[Literal["duration"]] = "duration"
    """Duration of the run; with `until`, the time of the event [s]."""

    mass: Final[Literal["mass"]] = "mass"
    """Mass of all bodies, or of all structures [kg]."""

    @staticmethod
    @checked
    def ks(
        *,
        of: Quantity,
        rho: Real | None = None,
        bound: Bound | None = None,
        during: During | None = None,
    ) -> Function:
        """Kreisselmeier–Steinhauser function, a smooth bound of the maximum over the run.

        Parameters
        ----------
        of : one of `quantities`
            The quantity.
        rho : number above 0 [1/unit of the quantity], optional
            Aggregation parameter in 1/unit of the quantity; larger is closer to the maximum.
        bound : "below" or "above", optional
            "below" (default): never above the true maximum. "above": never below it, as an upper limit needs.
            "below": Never above it.
            "above": Never below it.
        during : numbers, shape (2,) [s] or `window_ends(…)`, optional
            The window of time, default the whole run.
            numbers, shape (2,) [s]: Start and end.
            `window_ends(…)`: Each end by itself.
        """
        return made(Function, "functions.ks", locals())

    @staticmethod
    @checked
    def induced_exponential(*, of: Quantity, rho: Real | None = None, during: During | None = None) -> Function:
        """Induced exponential, a smooth mean near the maximum over the run.

        Parameters
        ----------
        of : one of `quantities`
            The quantity.
        rho : number above 0 [1/unit of the quantity], optional
            Aggregation parameter in 1/unit of the quantity; larger is closer to the maximum.
        during : numbers, shape (2,) [s] or `window_ends(…)`, optional
            The window of time, default the whole run.
            numbers, shape (2,) [s]: Start and end.
            `window_ends(…)`: Each end by itself.
        """
        return made(Function, "functions.induced_exponential", locals())

    @staticmethod
    @checked
    def integral(value: Over, /) -> Function:
        """Integral over the run, or over a window of time.

        Parameters
        ----------
        value : `within(…)` or one of `quantities`
            A quantity, over the whole run or a window of time: the quantity alone, or with `during`.
            `within(…)`: With a window.
            one of `quantities`: Over the whole run.
        """
        return made_of(Function, "functions.integral", value)

    @staticmethod
    @checked
    def final(value: Over, /) -> Function:
        """Value at the end of the run, or of a window of time.

        Parameters
        ----------
        value : `within(…)` or one of `quantities`
            A quantity, over the whole run or a window of time: the quantity alone, or with `during`.
            `within(…)`: With a window.
            one of `quantities`: Over the whole run.
        """
        return made_of(Function, "functions.final", value)

    @staticmethod
    @checked
    def mean(value: Over, /) -> Function:
        """Mean over the run, or over a window of time.

        Parameters
        ----------
        value : `within(…)` or one of `quantities`
            A quantity, over the whole run or a window of time: the quantity alone, or with `during`.
            `within(…)`: With a window.
            one of `quantities`: Over the whole run.
        """
        return made_of(Function, "functions.mean", value)

    @staticmethod
    @checked
    def mean_square(value: Over, /) -> Function:
        """Mean of the square over the run, or over a window of time.

        Parameters
        ----------
        value : `within(…)` or one of `quantities`
            A quantity, over the whole run or a window of time: the quantity alone, or with `during`.
            `within(…)`: With a window.
            one of `quantities`: Over the whole run.
        """
        return made_of(Function, "functions.mean_square", value)

    @staticmethod
    @checked
    def mean_absolute(*, width: Real, of: Quantity, during: During | None = None) -> Function:
        """Smooth mean of the absolute value over the run, or over a window of time.

        Parameters
        ----------
        width : number above 0 [unit of the quantity]
            Width w of the rounded corner at zero: √(x² + w²) − w instead of |x|, at most w below it.
        of : one of `quantities`
            The quantity.
        during : numbers, shape (2,) [s] or `window_ends(…)`, optional
            The window, default the whole run.
            numbers, shape (2,) [s]: Start and end.
            `window_ends(…)`: Each end by itself.
        """
        return made(Function, "functions.mean_absolute", locals())

    @staticmethod
    @checked
    def fatigue_damage(*, slope: Real, strength: Real, of: Quantity, during: During | None = None) -> Function:
        """Damage by Basquin's law and the crossings of a stress about zero: one at the end of life.

        Parameters
        ----------
        slope : number from 2 to 50
            Slope m of Basquin's law N = (strength/amplitude)^m: about 3 for welds, 5 to 15 for machined steel.
        strength : number above 0 [unit of the quantity]
            Amplitude that one cycle endures: the fatigue strength coefficient, or the amplitude endured N times times
            N^(1/m).
        of : one of `quantities`
            The stress, or another quantity whose cycles do damage.
        during : numbers, shape (2,) [s] or `window_ends(…)`, optional
            The window, default the whole run.
            numbers, shape (2,) [s]: Start and end.
            `window_ends(…)`: Each end by itself.
        """
        return made(Function, "functions.fatigue_damage", locals())

    @staticmethod
    @checked
    def value(*, at: Edge, of: Quantity) -> Function:
        """Value at a time, or where a quantity first reaches a value.

        Parameters
        ----------
        at : number [s] or `reach(…)` or `at_event(…)`
            The time, the first time at which a quantity reaches a value, or an event.
            number [s]: A time.
            `reach(…)`: The first time at which a quantity reaches a value.
            `at_event(…)`: When an event comes.
        of : one of `quantities`
            The quantity.
        """
        return made(Function, "functions.value", locals())

    @staticmethod
    @checked
    def misfit(
        *,
        series: Mapping[str, Series] | None = None,
        numbers: Sequence[MeasuredNumber] | None = None,
        variance: Variance | None = None,
    ) -> Function:
        """Mean square of the distances of quantities from measured values, each divided by its standard deviation.

        Parameters
        ----------
        series : `series(…)` by name, optional
            Of a motion: quantities measured at several times, by name.
        numbers : list of `measured_number(…)`, optional
            Of structures: measured values of other functions.
        variance : "given" or "estimated", optional
            Where the covariance of fitted numbers gets its scale from; default "given" if all data have standard
            deviations, else "estimated".
            "given": The standard deviations of the data are right.
            "estimated": Only their ratios are: the size follows from the residuals.
        """
        return made(Function, "functions.misfit", locals())

    @staticmethod
    @checked
    def clearance(*, release: str, barrier: Barrier) -> Function:
        """Height of a flight path above the top of a barrier [m].

        Parameters
        ----------
        release : text
            Name of the range function with the release: the final state of a `final` one, the weighted mean state of
            a `ks` or an `induced_exponential` one.
        barrier : `barrier(…)`
            The barrier.
        """
        return made(Function, "functions.clearance", locals())

    @staticmethod
    @checked
    def event_time(value: str, /) -> Function:
        """Time at which an event of the file comes [s], by its name.

        Parameters
        ----------
        value : text
        """
        return made_of(Function, "functions.event_time", value)

    @staticmethod
    @checked
    def centre_of_mass(*, direction: Vector) -> Function:
        """Coordinate of the centre of mass of all structures [m].

        Parameters
        ----------
        direction : numbers, shape (3,)
            Direction, used as it is given.
        """
        return made(Function, "functions.centre_of_mass", locals())

    @staticmethod
    @checked
    def moment_of_inertia(*, axis: Vector, other: Vector | None = None) -> Function:
        """Moment of inertia of all structures about an axis through their centre of mass [kg m²].

        Parameters
        ----------
        axis : numbers, shape (3,)
            Direction of the axis, used as it is given.
        other : numbers, shape (3,), optional
            A second axis, for a product of inertia; default the first.
        """
        return made(Function, "functions.moment_of_inertia", locals())

    @staticmethod
    @checked
    def strain_energy(*, case: str) -> Function:
        """Strain energy of a load case [J].

        Parameters
        ----------
        case : text
            Name of the load case.
        """
        return made(Function, "functions.strain_energy", locals())

    @staticmethod
    @checked
    def compliance(*, case: str) -> Function:
        """Work of the loads of a case in its displacements [J].

        Parameters
        ----------
        case : text
            Name of the load case.
        """
        return made(Function, "functions.compliance", locals())

    @staticmethod
    @checked
    def displacement(*, case: str, nodes: str, direction: Vector) -> Function:
        """Mean displacement of a set of nodes [m].

        Parameters
        ----------
        case : text
            Name of the load case.
        nodes : text
            Name of the set of nodes.
        direction : numbers, shape (3,)
            Direction, used as it is given.
        """
        return made(Function, "functions.displacement", locals())

    @staticmethod
    @checked
    def reaction(*, case: str, nodes: str, direction: Vector) -> Function:
        """Force of the supports on a set of nodes [N].

        Parameters
        ----------
        case : text
            Name of the load case.
        nodes : text
            Name of the set of nodes.
        direction : numbers, shape (3,)
            Direction, used as it is given.
        """
        return made(Function, "functions.reaction", locals())

    @staticmethod
    @checked
    def reaction_moment(*, case: str, nodes: str, axis: Vector, about: Vector | None = None) -> Function:
        """Moment of the supports on a set of nodes [N m].

        Parameters
        ----------
        case : text
            Name of the load case.
        nodes : text
            Name of the set of nodes.
        axis : numbers, shape (3,)
            Direction of the axis, used as it is given.
        about : numbers, shape (3,) [m], optional
            A point of the axis, default the origin.
        """
        return made(Function, "functions.reaction_moment", locals())

    @staticmethod
    @checked
    def von_mises(
        *,
        rho: Real | None = None,
        aggregate: StressAggregate | None = None,
        cases: Sequence[str] | None = None,
        elements: str | None = None,
        per: StressPer | None = None,
    ) -> Function:
        """Aggregate of von Mises stress by yield stress.

        Parameters
        ----------
        rho : number above 0, optional
            Aggregation parameter; larger is closer to the maximum.
        aggregate : "ks" or "induced_exponential", optional
            Which aggregate, default ks.
            "ks": Kreisselmeier-Steinhauser: never below the largest ratio.
            "induced_exponential": Induced exponential: never above it.
        cases : list of texts, optional
            Names of the load cases, default all.
        elements : text, optional
            Name of the set of elements, default all.
        per : "thickness", optional
            "thickness": an aggregate for each thickness of the structures; a constraint then limits each.
            "thickness": All elements of one thickness: of an element, band, patch or group that the file names so, or
                of a structure.
        """
        return made(Function, "functions.von_mises", locals())

    @staticmethod
    @checked
    def frequency(*, mode: Integer, damped: bool | None = None, follow: bool | None = None) -> Function:
        """A natural frequency [Hz].

        Parameters
        ----------
        mode : integer from 1 to 150
            Number of the mode from 1, rigid motions left out. Two equal frequencies have no derivatives.
        damped : bool, optional
            Whether the frequency is that of the damped oscillation of a machine, |Im s| / 2π, numbered as
            "damping_ratio" does. Default: the natural frequency without damping. In steady rotation all frequencies
            are damped ones.
        follow : bool, optional
            Whether the mode is followed by its shape while the design changes: "mode" is its number at the start of
            the file. Default: modes are counted by frequency at each design.
        """
        return made(Function, "functions.frequency", locals())

    @staticmethod
    @checked
    def lowest_frequency(*, rho: Real | None = None) -> Function:
        """Smooth lower bound of the natural frequencies [Hz].

        Parameters
        ----------
        rho : number above 0 [s], optional
            Aggregation parameter; larger is closer to the lowest frequency.
        """
        return made(Function, "functions.lowest_frequency", locals())

    @staticmethod
    @checked
    def over_cases(
        *,
        function: str,
        by: CaseCombination | Literal["sum", "mean", "deviation"],
        cases: WhichCases | None = None,
    ) -> Function:
        """Sum, mean, deviation or extreme of the values of a function in several cases.

        Parameters
        ----------
        function : text
            Name of a function of the machine, which has a value in each case.
        by : one of `case_combinations` or "sum" or "mean" or "deviation"
            What is taken of the values.
        cases : "all" or list of texts or number by name, optional
            "all" (default), a list of names, or the weight of each case by its name.
            "all": "all".
            list of texts: Some, by name, with equal weights.
            number by name: Weights by name.
        """
        return made(Function, "functions.over_cases", locals())

    @staticmethod
    @checked
    def damping_ratio(*, mode: Integer, follow: bool | None = None) -> Function:
        """Damping ratio of a mode of a machine: 0 without damping, 1 where no oscillation is left, below 0 if it grows.

        Parameters
        ----------
        mode : integer from 1 to 150
            Number of the damped mode from 1, by its rate |s|: that of "frequency" with "damped". Motions that do not
            oscillate, being free or damped beyond ζ = 1, are not counted.
        follow : bool, optional
            Whether the mode is followed by its shape while the design changes: "mode" is its number at the start of
            the file. Default: modes are counted by |s| at each design.
        """
        return made(Function, "functions.damping_ratio", locals())

    @staticmethod
    @checked
    def critical_speed(*, number: Integer) -> Function:
        """Critical speed of a machine that turns [rad/s]: there a whirl turns with it, without damping.

        Parameters
        ----------
        number : integer from 1 to 50
            Its number from 1, the lowest first. The two planes of a round shaft count as one.
        """
        return made(Function, "functions.critical_speed", locals())

    @staticmethod
    @checked
    def expression(value: str, /) -> Function:
        """An expression of other functions and of parameters, such as `2*mass + work/duration`. Names that are no words
        stand between single quotes or backquotes.

        Parameters
        ----------
        value : text
        """
        return made_of(Function, "functions.expression", value)


class case_combinations(Kinds):
    """What is taken of the values f_c of a function in several cases, with weights w_c."""

    sum: Final[Literal["sum"]] = "sum"
    """Their sum Σ w_c f_c. A weight may be negative: 1 and −1 give a difference of two cases."""

    mean: Final[Literal["mean"]] = "mean"
    """Their mean m = Σ w_c f_c / Σ w_c."""

    deviation: Final[Literal["deviation"]] = "deviation"
    """Their standard deviation √(Σ w_c (f_c − m)² / Σ w_c). It has no derivative where all are equal."""

    @staticmethod
    @checked
    def ks(*, rho: Real | None = None, of: Extreme | None = None) -> CaseCombination:
        """A smooth bound of the largest or the smallest, without weights.

        Parameters
        ----------
        rho : number above 0 [1/unit of the function], optional
            Aggregation parameter in 1/unit of the function; larger is closer to the largest. Default: chosen at the
            start.
        of : "largest" or "smallest", optional
            The largest value (default), or the smallest, which is bounded from below.
            "largest": The largest.
            "smallest": The smallest.
        """
        return made(CaseCombination, "case_combinations.ks", locals())


class MachineKeys(Document):
    """A multibody scene in motion, or structures under load cases; what is asked of them and what may be designed.
    Units are SI, angles are in radians; the keys of bodies, joints, loads, drives, couplings, structures,
    materials, load cases, functions, variables and constraints are their names.
    """

    _order = (
        "$schema",
        "version",
        "name",
        "description",
        "gravity",
        "input_tolerance",
        "parameters",
        "bodies",
        "analysis",
        "modes",
        "turning",
        "start",
        "initial_velocity",
        "joints",
        "loads",
        "drives",
        "couplings",
        "simulation",
        "events",
        "structures",
        "materials",
        "load_cases",
        "statics",
        "cases",
        "functions",
        "variables",
        "objective",
        "constraints",
        "optimiser",
        "plot",
        "parts",
        "use",
        "defaults",
    )

    @checked
    def __init__(
        self,
        name: str,
        *,
        schema: str | None = None,
        description: str | None = None,
        gravity: Vector | None = None,
        input_tolerance: Real | None = None,
        analysis: Analysis | None = None,
        start: StartOfMotion | None = None,
    ) -> None:
        """A problem file with this name.

        Parameters
        ----------
        name : text
            Name of the problem and of its results.
        schema : text, optional
            Address of this schema, for editors.
        description : text, optional
            Description of the problem.
        gravity : numbers, shape (3,) [m/s²], optional
            Gravitational acceleration in ground axes, default [0, −9.81, 0].
        input_tolerance : number from 1e-13 to 0.001, optional
            How well rounded numbers fit: joints of loops may miss each other by this part of the size of their loop
            and by this angle [rad], and an inertia may miss that of a solid by this part. What is left out is said.
            Default 1e-5.
        analysis : "motion" or "rest" or "modes", optional
            What is computed of a machine of bodies: its motion (default), where it rests under gravity and loads, or
            its modes about that rest. Structures are always at rest.
            "motion": Its motion over time.
            "rest": Where it rests: without velocity and acceleration, drives and loads held as they are at t = 0.
            "modes": Its vibrations about rest, or about steady rotation: frequencies, damping ratios and shapes.
        start : "given" or "equilibrium", optional
            Deformations of flexible bodies at the start, default "given".
            "given": Those that the bodies give, else none.
            "equilibrium": Those at which elastic coordinates neither move nor accelerate: static equilibrium under
                gravity, loads and the inertia of the motions that the joints allow.
        """
        self._begin(locals())

    @checked
    def add_parameter(self, name: str, loads: Real) -> Name:
        """Adds a parameter.

        Numbers by name that expressions use: "= L/2" stands for a number anywhere in the file. Expressions have + − *
        / ^, parentheses, pi, deg (a degree in radians), sin, cos, tan, asin, acos, atan, atan2, sqrt, exp, log, and
        these names. A parameter may be an expression of others, and a design variable.

        Parameters
        ----------
        name : text
            Its name among the `parameters`.
        loads : number [that of the numbers it gives]
        """
        return Name(name, self._add("parameters", "parameter", name, loads))

    @checked
    def add_body(
        self,
        name: str,
        *,
        description: str | None = None,
        shape: Shape | Literal["point"] | None = None,
        density: Real | None = None,
        mass: Real | None = None,
        centre_of_mass: Vector | None = None,
        inertia: Inertia | None = None,
        beam: Beam | None = None,
        elements: Elements | None = None,
        modal: Modal | None = None,
        mass_properties: Surface | None = None,
        points: Mapping[str, BodyPoint] | None = None,
        place: Place | None = None,
        velocity: BodyVelocity | None = None,
    ) -> BodyName:
        """Adds a body.

        A body: a shape with its mass or density, or an explicit mass, centre of mass and inertia, or a beam or a body
        of files with elastic coordinates.

        Parameters
        ----------
        name : text
            Its name among the `bodies`.
        description : text, optional
            Remark for readers of the file.
        shape : one of `shapes` or "point", optional
            A homogeneous solid, centred at the origin of the body's axes; it gives the inertia.
        density : number above 0 [kg/m³], optional
            Density of the shape, instead of a mass.
        mass : number at least 0 [kg], optional
            Mass. A body of mass 0 needs joints that, with the inertia of other bodies, determine its motion.
        centre_of_mass : numbers, shape (3,) [m], optional
            Centre of mass of a body without a shape, from the origin of the body's axes; default 0.
        inertia : `inertia(…)`, optional
            Inertia of a body without a shape; 0 by default if its mass is 0.
        beam : `beam(…)`, optional
            A beam with elastic coordinates, instead of all above.
        elements : `elements(…)`, optional
            Shells with elastic coordinates at all their nodes, instead of all above.
        modal : `modal(…)`, optional
            A body with elastic coordinates from files of other codes, instead of all above.
        mass_properties : `surface(…)`, optional
            Mass, centre of mass and inertia of a solid from its surface, instead of all above.
        points : numbers, shape (3,) [m] or `between(…)` by name, optional
            Named points in body axes from their origin (the centre of the shape, the start of a beam).
        place : `place(…)`, optional
            Placement at the start; by default its axes are those of ground.
        velocity : `body_velocity(…)`, optional
            Its velocity at the start, instead of that of the assembly.
        """
        return BodyName(name, self._add("bodies", "body", name, keys(locals(), "name")))

    @checked
    def set_modes(self, *, count: Integer | None = None, speeds: Vector | None = None) -> None:
        """Which modes are told and drawn, with "analysis": "modes".

        A second call replaces what the first has set.

        Parameters
        ----------
        count : integer from 1 to 150, optional
            Number of modes, the lowest first, default 6.
        speeds : numbers, shape (n,) [rad/s], optional
            Speeds of rotation of a Campbell diagram.
        """
        self._set("modes", "set_modes", locals())

    @checked
    def set_turning(self, *, axis: Vector, speed: Real, at: Vector | None = None) -> None:
        """Steady rotation of the machine, with "analysis": "modes".

        A second call replaces what the first has set.

        Parameters
        ----------
        axis : numbers, shape (3,)
            Direction of the axis, of any length; the machine turns about it by the right hand.
        speed : number at least 0 [rad/s]
            Speed of rotation.
        at : numbers, shape (3,) [m], optional
            A point of the axis, default the origin.
        """
        self._set("turning", "set_turning", locals())

    @checked
    def set_initial_velocity(
        self,
        *,
        linear: Vector | None = None,
        angular: Vector | None = None,
        about: Vector | None = None,
    ) -> None:
        """Velocity of the whole assembly at the start, default at rest.

        A second call replaces what the first has set.

        Parameters
        ----------
        linear : numbers, shape (3,) [m/s], optional
            Velocity of the point `about` in ground axes, default 0.
        angular : numbers, shape (3,) [rad/s], optional
            Angular velocity in ground axes, default 0.
        about : numbers, shape (3,) [m], optional
            Point of the axis of rotation in ground coordinates, default the origin.
        """
        self._set("initial_velocity", "set_initial_velocity", locals())

    @checked
    def add_joint(self, name: str, kind: Joint) -> Name:
        """Adds a joint.

        A joint between two bodies, or a body and "ground".

        Parameters
        ----------
        name : text
            Its name among the `joints`.
        kind : one of `joints`
            A joint between two bodies, or a body and "ground".
        """
        return Name(name, self._add("joints", "joint", name, kind))

    @checked
    def add_load(self, name: str, kind: Load) -> Name:
        """Adds a load.

        A force, torque, spring, damper, bushing, friction, drag, stop, contact, cable or controller.

        Parameters
        ----------
        name : text
            Its name among the `loads`.
        kind : one of `loads`
            A force, torque, spring, damper, bushing, friction, drag, stop, contact, cable or controller.
        """
        return Name(name, self._add("loads", "load", name, kind))

    @checked
    def add_drive(self, name: str, *, joint: str, turn: Turning | None = None, slide: Sliding | None = None) -> Name:
        """Adds a drive.

        Prescribed motion of a joint about its axis, along it, or both. It is the motion of the first body relative to
        the second (ground counts as the second), from the placement.

        Parameters
        ----------
        name : text
            Its name among the `drives`.
        joint : text
            Name of a revolute, planar, prismatic or cylindrical joint.
        turn : one of `turning`, optional
            Angle about the axis as a function of time.
        slide : one of `sliding`, optional
            Displacement along the axis as a function of time.
        """
        return Name(name, self._add("drives", "drive", name, keys(locals(), "name")))

    @checked
    def add_coupling(self, name: str, kind: Coupling) -> Name:
        """Adds a coupling.

        A linear relation between the motions of joints, over any number of turns: gears, a rack, a screw, a belt, or
        any other. It holds as the bodies are placed.

        Parameters
        ----------
        name : text
            Its name among the `couplings`.
        kind : one of `couplings`
            A linear relation between the motions of joints, over any number of turns: gears, a rack, a screw, a belt,
            or any other. It holds as the bodies are placed.
        """
        return Name(name, self._add("couplings", "coupling", name, kind))

    @checked
    def set_simulation(
        self,
        *,
        duration: Real,
        until: TerminalEvent | None = None,
        steps: Integer | None = None,
        tolerance: Real | None = None,
        samples: Integer | None = None,
        seconds: Real | None = None,
        method: Method | Literal["dop853"] | None = None,
        linear_solver: LinearSolver | None = None,
    ) -> None:
        """Duration and accuracy of the simulation.

        A second call replaces what the first has set.

        Parameters
        ----------
        duration : number above 0 [s]
            Simulated time; with `until`, the longest time to wait for the event.
        until : `terminal_event(…)`, optional
            Event that ends the run: a quantity reaches a value for the first time. Default none.
        steps : integer from 1 to 10000000, optional
            Number of equal time steps, instead of a tolerance.
        tolerance : number from 1e-14 to 0.1, optional
            Tolerance of the error per step, relative to the lengths and speeds of the scene. Default 1e-9 if the
            number of steps is not given, 1e-6 with elastic bodies, 1e-5 with finite elements of all nodes.
        samples : integer from 1 to 10000000, optional
            Number of equal intervals at whose ends the motion is sampled, for functions of the whole motion and for
            figures. Default: the ends of the steps if their number is given, else 1000.
        seconds : number above 0, optional
            Longest wall time of one simulation [s], default none. The number of steps is limited, too.
        method : one of `methods` or "dop853", optional
            Integration method. Default: chosen for the scene, dop853 unless it is stiff, else radau.
        linear_solver : "direct" or "krylov", optional
            How the linear systems of bodies of finite elements are solved, default direct.
            "direct": By factors, which are kept from step to step while they converge.
            "krylov": By FGMRES, a Krylov method, with kept factors as preconditioner, for bdf and generalised_alpha.
        """
        self._set("simulation", "set_simulation", locals())

    @checked
    def add_event(
        self,
        name: str,
        *,
        when: When,
        description: str | None = None,
        off: Sequence[str] | None = None,
        on: Sequence[str] | None = None,
    ) -> Name:
        """Adds a event.

        An event that changes the machine. The bodies keep their positions; their velocities jump as by the impulses
        of the joints that close, and the motion goes on.

        Parameters
        ----------
        name : text
            Its name among the `events`.
        when : `terminal_event(…)` or `at(…)`
            When it comes, after the event before it.
            `terminal_event(…)`: A quantity reaches a value.
            `at(…)`: At a time.
        description : text, optional
            Remark for readers of the file.
        off : list of texts, optional
            Names of joints, loads and drives that go off. A joint opens with its drives and the loads that act
            through it.
        on : list of texts, optional
            Names of joints, loads and drives that go on. They are off before, from the start or by an event. A joint
            closes where its bodies are then: its frame on its second body becomes that on its first one, and a rod
            keeps the distance of its ends. A drive goes on from where its joint is then.
        """
        return Name(name, self._add("events", "event", name, keys(locals(), "name")))

    @checked
    def add_structure(
        self,
        name: str,
        *,
        mesh: Mesh,
        material: str,
        description: str | None = None,
        element: ShellElement | None = None,
        at: Vector | None = None,
        thickness: Thickness | None = None,
        section: StructureSection | None = None,
        sections: VariedSection | None = None,
        surface_mass: Real | None = None,
        line_mass: Real | None = None,
        offset: Vector | None = None,
        sets: Mapping[str, Set] | None = None,
        supports: Mapping[str, Support] | None = None,
        masses: Mapping[str, NodeMass] | None = None,
        damping: Damping | None = None,
    ) -> Name:
        """Adds a structure.

        A structure: a mesh, of what it is made, and how it is supported.

        Parameters
        ----------
        name : text
            Its name among the `structures`.
        mesh : one of `meshes`
            The mesh, by a generator or from a file.
        material : text
            Name of the material.
        description : text, optional
            Remark for readers of the file.
        element : "mitc9" or "mitc4", optional
            The element of shells, default mitc9. Numbers of elements count these.
            "mitc9": Nine nodes: MITC9 of Bucalem and Bathe (1993).
            "mitc4": Four nodes: MITC4 of Dvorkin and Bathe (1984). Each costs less, and more of them are needed.
        at : numbers, shape (3,) [m], optional
            Origin of the mesh, default [0, 0, 0].
        thickness : number above 0 [m] or `varied_thickness(…)`, optional
            Thickness of shells: one number, or one of its own for each element, band, patch or group.
            number above 0 [m]: One for all.
            `varied_thickness(…)`: Several.
        section : one of `structure_sections`, optional
            Cross section of all beams.
        sections : `varied_section(…)`, optional
            Cross sections by elements or groups, instead of `section`.
        surface_mass : number at least 0 [kg/m²], optional
            Non-structural mass per area of shells, default 0.
        line_mass : number at least 0 [kg/m], optional
            Non-structural mass per length of beams, default 0.
        offset : numbers, shape (2,) [m], optional
            Offset of the centre of the section from the nodes of beams, along its axes 2 and 3, default 0.
        sets : one of `sets` by name, optional
            Sets of nodes or elements by name, besides those that the generator names.
        supports : `support(…)` by name, optional
            Supports by name.
        masses : `node_mass(…)` by name, optional
            Masses at nodes, by name.
        damping : `damping(…)`, optional
            Damping, which only a motion has: a structure that does not move has none.
        """
        return Name(name, self._add("structures", "structure", name, keys(locals(), "name")))

    @checked
    def add_material(
        self,
        name: str,
        *,
        young: Real,
        poisson: Real,
        density: Real | None = None,
        yield_stress: Real | None = None,
    ) -> Name:
        """Adds a material.

        An isotropic material.

        Parameters
        ----------
        name : text
            Its name among the `materials`.
        young : number above 0 [Pa]
            Young's modulus.
        poisson : number above -1 and at most 0.5
            Poisson's ratio.
        density : number at least 0 [kg/m³], optional
            Density; needed for masses, weight and frequencies.
        yield_stress : number above 0 [Pa], optional
            Yield stress that stresses are compared with; needed for stress functions.
        """
        return Name(name, self._add("materials", "material", name, keys(locals(), "name")))

    @checked
    def add_load_case(self, name: str, loads: Mapping[str, CaseLoad]) -> Name:
        """Adds a load case.

        Load cases by name: the loads of each, by name.

        Parameters
        ----------
        name : text
            Its name among the `load_cases`.
        loads : one of `case_loads` by name
        """
        return Name(name, self._add("load_cases", "load_case", name, loads))

    @checked
    def set_statics(self, *, strains: Strains | None = None, node_unknowns: Unknowns | None = None) -> None:
        """How structures are analysed.

        A second call replaces what the first has set.

        Parameters
        ----------
        strains : "linear" or "von_karman", optional
            The strains, default linear.
            "linear": Linear in the displacements.
            "von_karman": With von Karman's terms: membrane forces of moderate rotations.
        node_unknowns : "five" or "six", optional
            Unknowns of a node on a smooth surface, default five.
            "five": Three displacements and two rotations.
            "six": Also the rotation about the normal, with a small drilling stiffness.
        """
        self._set("statics", "set_statics", locals())

    @checked
    def add_case(
        self,
        name: str,
        *,
        analysis: Analysis | None = None,
        set: Mapping[str, object] | None = None,
    ) -> Name:
        """Adds a case.

        An analysis of the machine of the file with some values replaced.

        Parameters
        ----------
        name : text
            Its name among the `cases`.
        analysis : "motion" or "rest" or "modes", optional
            What is computed, default what the file says.
            "motion": Its motion over time.
            "rest": Where it rests: without velocity and acceleration, drives and loads held as they are at t = 0.
            "modes": Its vibrations about rest, or about steady rotation: frequencies, damping ratios and shapes.
        set : any values by name, optional
            Values that replace those of the file, by their JSON Pointer: {"/loads/wind/force/magnitude": 12}. The
            number of a design variable cannot be replaced.
        """
        return Name(name, self._add("cases", "case", name, keys(locals(), "name")))

    @checked
    def add_function(self, name: str, kind: Function | Literal["duration", "mass"]) -> Name:
        """Adds a function.

        A function of interest: a quantity at an instant, reduced over the run, or a clearance.

        Parameters
        ----------
        name : text
            Its name among the `functions`.
        kind : one of `functions` or "duration" or "mass"
            A function of interest: a quantity at an instant, reduced over the run, or a clearance.
        """
        return Name(name, self._add("functions", "function", name, kind))

    @checked
    def add_variable(
        self,
        name: str,
        *,
        description: str | None = None,
        path: str | None = None,
        paths: Sequence[str] | None = None,
        lower: Real | None = None,
        upper: Real | None = None,
        scale: Real | None = None,
    ) -> Name:
        """Adds a variable.

        A design variable: one or several physical numbers of this file that share a value. It starts at the value in
        the file.

        Parameters
        ----------
        name : text
            Its name among the `variables`.
        description : text, optional
            Remark for readers of the file.
        path : text, optional
            JSON Pointer to the number, such as /bodies/arm/mass; or to a list, each number of which becomes a
            variable `name[0]`, `name[1]`, … with these bounds.
        paths : list of texts, optional
            JSON Pointers to several numbers with one value, instead of `path`.
        lower : number, optional
            Smallest value, in the number's own unit; default none.
        upper : number, optional
            Largest value, in the number's own unit; default none.
        scale : number above 0, optional
            Typical change, by which the optimiser scales the variable. Default: half the distance of the bounds, but
            at most 1000 max(|start|, 1); without bounds |start|, or 1 if that is zero.
        """
        return Name(name, self._add("variables", "variable", name, keys(locals(), "name")))

    @checked
    def minimise(self, value: WhichFunction, /) -> None:
        """The function to minimise: its name, or an expression.

        A second call replaces what the first has set.

        Parameters
        ----------
        value : text or `expression_of_functions(…)`
            A function: its name, or an expression of functions.
            text: Name of a function.
            `expression_of_functions(…)`: An expression in this place.
        """
        self._set("objective", "minimise", {"minimise": value})

    @checked
    def maximise(self, value: WhichFunction, /) -> None:
        """The function to maximise: its name, or an expression.

        A second call replaces what the first has set.

        Parameters
        ----------
        value : text or `expression_of_functions(…)`
            A function: its name, or an expression of functions.
            text: Name of a function.
            `expression_of_functions(…)`: An expression in this place.
        """
        self._set("objective", "maximise", {"maximise": value})

    @checked
    def add_constraint(
        self,
        name: str,
        *,
        function: WhichFunction,
        description: str | None = None,
        lower: Real | None = None,
        upper: Real | None = None,
    ) -> Name:
        """Adds a constraint.

        Bounds on a function. Equal bounds make an equality.

        Parameters
        ----------
        name : text
            Its name among the `constraints`.
        function : text or `expression_of_functions(…)`
            The function: its name, or an expression.
            text: Name of a function.
            `expression_of_functions(…)`: An expression in this place.
        description : text, optional
            Remark for readers of the file.
        lower : number, optional
            Smallest value, default none.
        upper : number, optional
            Largest value, default none.
        """
        return Name(name, self._add("constraints", "constraint", name, keys(locals(), "name")))

    @checked
    def set_optimiser(
        self,
        *,
        method: OptimisationMethod | None = None,
        tolerance: Real | None = None,
        iterations: Integer | None = None,
        constraint_tolerance: Real | None = None,
        evaluations: Integer | None = None,
        seconds: Real | None = None,
        unbounded_below: Real | None = None,
    ) -> None:
        """Settings of the optimiser.

        A second call replaces what the first has set.

        Parameters
        ----------
        method : "interior_point" or "trust_region" or "least_squares" or "auto", optional
            Algorithm, default interior point; least squares where the objective is a misfit to minimise.
            "interior_point": Primal-dual interior point with a filter line search.
            "trust_region": Trust-region sequential quadratic programming: fewest simulations for few variables.
            "least_squares": Trust region on the residuals of a misfit, by Gauss and Newton. It is the default where
                the objective is a misfit.
            "auto": Interior point; if it does not converge, trust region from its best point.
        tolerance : number above 0, optional
            The optimiser stops at this scaled residual of the optimality conditions.
        iterations : integer at least 1, optional
            Largest number of iterations.
        constraint_tolerance : number above 0, optional
            Largest violation of a constraint at an optimum, in its own unit; it must also be below 1e-4 of the size
            of the constraint. Default 1e-6.
        evaluations : integer at least 1, optional
            Largest number of simulations.
        seconds : number above 0, optional
            Longest wall time of the run [s].
        unbounded_below : number below 0, optional
            The problem is unbounded if the minimised objective falls below this negative value. A maximised objective
            is compared by its negative. Default -1e20.
        """
        self._set("optimiser", "set_optimiser", locals())

    @checked
    def set_plot(
        self,
        *,
        view: View | None = None,
        snapshots: Integer | None = None,
        trace: Sequence[str] | None = None,
    ) -> None:
        """Settings of the plot of the motion.

        A second call replaces what the first has set.

        Parameters
        ----------
        view : "xy" or "xz" or "yz" or "yx" or "zx" or "zy", optional
            Plane of the view: first axis to the right, second up; default xy.
            "xy": x to the right, y up.
            "xz": x to the right, z up.
            "yz": y to the right, z up.
            "yx": y to the right, x up.
            "zx": z to the right, x up.
            "zy": z to the right, y up.
        snapshots : integer at least 2, optional
            Number of instants of the time lapse, default 12.
        trace : list of texts, optional
            Points whose paths are drawn: `"body.point"`, or `"body"` for the origin of its axes.
        """
        self._set("plot", "set_plot", locals())

    @checked
    def add_part(
        self,
        name: str,
        *,
        description: str | None = None,
        file: str | None = None,
        parameters: Mapping[str, Real] | None = None,
        bodies: Mapping[str, Body] | None = None,
        joints: Mapping[str, Joint] | None = None,
        loads: Mapping[str, Load] | None = None,
        drives: Mapping[str, Drive] | None = None,
        couplings: Mapping[str, Coupling] | None = None,
    ) -> Name:
        """Adds a part.

        A group of bodies, joints, loads, drives and couplings in axes of its own, or the file that has it.

        Parameters
        ----------
        name : text
            Its name among the `parts`.
        description : text, optional
            Remark for readers of the file.
        file : text, optional
            Path of a JSON file with the keys below, relative to the directory of the problem file; instead of them.
        parameters : number [that of the numbers it gives] by name, optional
            Numbers by name that expressions of the part use before those of the machine. A use may give others.
        bodies : `body(…)` by name, optional
            Bodies by name.
        joints : one of `joints` by name, optional
            Joints by name.
        loads : one of `loads` by name, optional
            Loads by name.
        drives : `drive(…)` by name, optional
            Drives by name.
        couplings : one of `couplings` by name, optional
            Couplings by name.
        """
        return Name(name, self._add("parts", "part", name, keys(locals(), "name")))

    @checked
    def add_use(
        self,
        name: str,
        *,
        part: str,
        description: str | None = None,
        at: Vector | None = None,
        turn: Turns | None = None,
        parameters: Mapping[str, Real] | None = None,
        connect: Mapping[str, str] | None = None,
    ) -> Name:
        """Adds a use.

        A use of a part.

        Parameters
        ----------
        name : text
            Its name among the `use`.
        part : text
            Name of the part.
        description : text, optional
            Remark for readers of the file.
        at : numbers, shape (3,) [m], optional
            Place of the origin of the part's axes, default the origin.
        turn : `turn(…)` or list of `turn(…)`, optional
            Rotation from ground axes to those of the part, or a list of rotations about ground axes, applied in
            order; default none.
            `turn(…)`: One rotation.
            list of `turn(…)`: Several, applied in order.
        parameters : number [that of the numbers it gives] by name, optional
            Parameters of the part that have other values here; expressions are of the machine's parameters.
        connect : text by name, optional
            By name in the part: the body of the machine, or "ground", that it stands for.
        """
        return Name(name, self._add("use", "use", name, keys(locals(), "name")))

    @checked
    def set_defaults(self, *, bodies: Body | None = None, joints: JointDefaults | None = None) -> None:
        """Keys that bodies and joints have unless they give their own.

        A second call replaces what the first has set.

        Parameters
        ----------
        bodies : `body(…)`, optional
            Of bodies.
        joints : `joint_defaults(…)`, optional
            Of joints; a key that a kind of joint does not have is not for it.
        """
        self._set("defaults", "set_defaults", locals())
