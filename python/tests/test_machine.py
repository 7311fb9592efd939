"""Scenes built by calls: the same documents as problem files, and faults that name the call."""

from __future__ import annotations

import copy
import json
import math
import os
import pickle
import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from flexbody import Machine, Problem, ProblemError
from flexbody.parts import (
    Joint,
    beam,
    beam_material,
    case_loads,
    damping,
    functions,
    inertia,
    joints,
    loads,
    meshes,
    place,
    quantities,
    sections,
    shapes,
    structure_sections,
    support,
    terminal_event,
    turn,
    turning,
    varying_forces,
)
from scenes import PROBLEMS

DATA = Path(__file__).parent / "data"


def chain(count: int) -> Machine:
    machine = Machine("chain", gravity=[0, 0, -9.81])
    y = np.array([0, 1, 0])
    bars: list[Any] = []
    for i in range(1, count + 1):
        before = bars[-1] if bars else None
        at = before.point("right") if before else np.zeros(3)
        bar = machine.add_body(
            f"bar {i}",
            shape=shapes.box(size=(0.5, 0.04, 0.02)),
            mass=0.3,
            points={"left": [-0.25, 0, 0], "right": np.array([0.25, 0, 0])},
            place=place(put="left", at=at),
        )
        hinge = machine.add_joint(f"hinge {i}", joints.revolute(between=[bar, before or "ground"], at=at, axis=y))
        machine.add_load(f"damper {i}", loads.damping(joint=hinge, coefficient=0.02))
        bars.append(bar)
    machine.set_simulation(duration=0.6)
    end = quantities.position(body=bars[-1], point="right", direction=[0, 0, -1])
    depth = machine.add_function("depth", functions.final(end))
    mass = machine.add_function("mass", functions.mass)
    machine.add_variable("mass", paths=[bar.path("mass") for bar in bars], lower=0.1, upper=0.5)
    machine.maximise(depth)
    machine.add_constraint("light", function=mass, upper=1.4)
    return machine


HOLY = {
    name: round(length / 100, 9)
    for name, length in dict(
        a=38, b=41.5, c=39.3, d=40.1, e=55.8, f=39.4, g=36.7, h=65.7, i=49, j=50, k=61.9, l=7.8, m=15
    ).items()
}


def circles(p: NDArray[Any], r: float, q: NDArray[Any], s: float, side: int) -> NDArray[Any]:
    """The point at the distance r from p and s from q, on one side of the way from p to q."""
    way = q - p
    distance = float(np.linalg.norm(way))
    along = (r**2 - s**2 + distance**2) / (2 * distance)
    across = side * math.sqrt(r**2 - along**2)
    end: NDArray[Any] = p + (along * way + across * np.array([-way[1], way[0]])) / distance
    return end


def rounded(values: Any) -> Any:
    return np.round(values, 9) + 0.0


def jansen() -> Machine:
    r = HOLY
    points = {"centre": np.zeros(2), "pin": np.array([r["m"], 0]), "hip": np.array([-r["a"], -r["l"]])}
    for name, first, r1, second, r2, side in [
        ("top", "pin", "j", "hip", "b", -1),
        ("ankle", "pin", "k", "hip", "c", 1),
        ("knee", "hip", "d", "top", "e", 1),
        ("shin", "knee", "f", "ankle", "g", -1),
        ("foot", "shin", "h", "ankle", "i", -1),
    ]:
        points[name] = circles(points[first], r[r1], points[second], r[r2], side)

    machine = Machine(
        "jansen leg",
        description="Theo Jansen's leg for one turn of its crank. Lengths are his numbers in centimetres.",
    )
    hip = [*points["hip"], 0]
    z = [0, 0, 1]
    bars = {"m": ("centre", "pin", [0, 0, 0]), "j": ("pin", "top", "m.end"), "k": ("pin", "ankle", "m.end"),
            "c": ("hip", "ankle", hip), "f": ("knee", "shin", "bde.knee")}  # fmt: skip
    plates = {"bde": ("hip", "top", "knee", hip), "ghi": ("shin", "ankle", "foot", "f.end")}

    def turned(first: str, second: str) -> dict[str, Any]:
        """Keys of a place whose x axis runs from one point to another."""
        x, y = points[second] - points[first]
        angle = rounded(math.atan2(y, x))
        return {"turn": turn(axis=z, angle=angle)} if angle else {}

    for name, (start, end, at) in bars.items():
        half = r[name] / 2
        machine.add_body(
            name,
            shape=shapes.rod(length=r[name], radius=0.01),
            density=700,
            points={"start": [-half, 0, 0], "end": [half, 0, 0]},
            place=place(put="start", at=at, **turned(start, end)),
        )
    for name, (*corners, at) in plates.items():
        way = points[corners[1]] - points[corners[0]]
        axes = np.array([way, [-way[1], way[0]]]) / np.linalg.norm(way)
        local = np.array([axes @ (points[corner] - points[corners[0]]) for corner in corners])
        centre = local.mean(axis=0)
        moments = 2 / 12 * (local - centre).T @ (local - centre)
        machine.add_body(
            name,
            mass=2,
            centre_of_mass=rounded([*centre, 0]),
            inertia=inertia(
                xx=rounded(moments[1, 1]), yy=rounded(moments[0, 0]), zz=rounded(np.trace(moments)),
                xy=rounded(-moments[0, 1]),
            ),  # fmt: skip
            points={corner: rounded([*point, 0]) for corner, point in zip(corners, local, strict=True)},
            place=place(put=corners[0], at=at, **turned(*corners[:2])),
        )
    for name, first, second, at in [
        ("crank", "m", "ground", "m.start"),
        ("top", "j", "bde", "bde.top"),
        ("pin j", "j", "m", "m.end"),
        ("pin k", "k", "m", "m.end"),
        ("hip", "bde", "ground", "bde.hip"),
        ("hip c", "c", "ground", "c.start"),
        ("ankle", "k", "c", "c.end"),
        ("heel", "ghi", "c", "c.end"),
        ("knee", "f", "bde", "bde.knee"),
        ("shin", "ghi", "f", "f.end"),
    ]:
        machine.add_joint(name, joints.revolute(between=[first, second], at=at, axis=z))
    machine.add_drive("motor", joint="crank", turn=turning.rate(rounded(2 * np.pi)))
    machine.set_simulation(duration=1)
    height = quantities.position(body="ghi", point="foot", direction=[0, 1, 0])
    lift = machine.add_function("lift", functions.ks(rho=200, of=height))
    moment = quantities.joint_moment(joint="crank", direction=z)
    torque = machine.add_function("torque", functions.ks(rho=2, of=moment))
    machine.add_variable("crank", path=machine.path("bodies", "m", "points", "end", 0), lower=0.06, upper=0.085)
    machine.minimise(torque)
    machine.add_constraint("step", function=lift, lower=-0.85)
    return machine


@pytest.mark.parametrize(("build", "name"), [(lambda: chain(4), "chain"), (jansen, "jansen_leg")])
def test_loops_write_the_hand_written_file(build: Callable[[], Machine], name: str) -> None:
    expected = json.loads((DATA / f"{name}.json").read_text(encoding="utf-8"))
    machine = build()
    assert machine.to_dict() == expected
    assert json.loads(machine.to_json()) == expected


@pytest.mark.parametrize("build", [lambda: chain(4), lambda: chain(12), jansen])
def test_the_command_runs_what_python_builds(build: Callable[[], Machine], optimize: str, tmp_path: Path) -> None:
    path = tmp_path / "scene.json"
    build().to_file(path)
    run = subprocess.run([optimize, "simulate", path], capture_output=True, encoding="utf-8")
    assert run.returncode == 0, run.stderr
    assert [entry.name for entry in tmp_path.iterdir()] == ["scene.json"]


@pytest.mark.parametrize("build", [lambda: chain(4), jansen])
def test_problems_of_python_scenes(build: Callable[[], Machine], tmp_path: Path) -> None:
    machine = build()
    assert isinstance(machine.problem(), Problem)
    assert isinstance(machine.problem(directory=tmp_path, set={"/simulation/duration": 0.1}), Problem)


def test_structures(optimize: str, tmp_path: Path) -> None:
    machine = Machine("cantilever")
    steel = machine.add_material("steel", young=2.1e11, poisson=0.3, density=7800, yield_stress=2.5e8)
    section = structure_sections.rectangle(width=0.05, height=0.02)
    mesh = meshes.straight_beam(from_=[0, 0, 0], to=[1, 0, 0], orientation=[0, 1, 0], elements=4)
    machine.add_structure(
        "beam", mesh=mesh, material=steel, section=section, supports={"wall": support(nodes="start")}
    )
    tip = machine.add_load_case("tip", {"push": case_loads.point(nodes="end", force=[0, 0, -100])})
    machine.add_function("sag", functions.displacement(case=tip, nodes="end", direction=[0, 0, -1]))
    assert machine.to_dict()["structures"]["beam"]["mesh"]["straight_beam"]["from"] == [0, 0, 0]
    machine.to_file(tmp_path / "cantilever.json")
    run = subprocess.run([optimize, "simulate", tmp_path / "cantilever.json"], capture_output=True, encoding="utf-8")
    assert run.returncode == 0, run.stderr


def test_a_mesh_of_gmsh() -> None:
    """Files are relative to the directory of the problem."""
    machine = Machine("bracket")
    steel = machine.add_material("steel", young=2.1e11, poisson=0.3, density=7800)
    machine.add_structure(
        "bracket", mesh=meshes.gmsh(file="bracket.msh", unit="mm"), material=steel, thickness=0.004,
        supports={"bolts": support(nodes="bolts")},
    )  # fmt: skip
    pull = machine.add_load_case("pull", {"pin": case_loads.edge(edges="bore", force=[1000, 0, 0])})
    machine.add_function("moves", functions.displacement(case=pull, nodes="bore", direction=[1, 0, 0]))
    machine.add_variable("thickness", path="/structures/bracket/thickness", lower=0.001, upper=0.01)
    problem = machine.problem(directory=PROBLEMS)
    assert 0 < problem.values()[0] < 1e-3


def test_frequencies_about_rest() -> None:
    machine = Machine("pendulum", analysis="rest", gravity=[0, -9.81, 0])
    rod = machine.add_body("rod", shape=shapes.rod(length=1), mass=2, points={"pin": [-0.5, 0, 0]}, place=place(put="pin"))
    machine.add_joint("pin", joints.revolute(between=[rod, "ground"], at=[0, 0, 0], axis=[0, 0, 1]))
    machine.add_function("frequency", functions.frequency(mode=1))
    machine.add_variable("gravity", path="/gravity/1", lower=-20, upper=-1)
    problem = machine.problem()
    frequency = problem.values()[0]
    assert frequency == pytest.approx(math.sqrt(1.5 * 9.81) / (2 * math.pi), rel=1e-3)
    assert problem.gradients()[0] == pytest.approx([-frequency / 2 / 9.81], rel=1e-9)


def pendulum() -> Machine:
    machine = Machine("pendulum")
    arm = machine.add_body("arm", shape=shapes.rod(length=1), mass=2, points={"pin": [-0.5, 0, 0], "tip": [0.5, 0, 0]})
    machine.add_body(
        "whip",
        beam=beam(length=1, section=sections.tube(radius=0.01, wall=0.001), material=beam_material(young=7e10, density=2700)),
        place=place(at=arm.point("tip")),
    )  # fmt: skip
    machine.add_joint("pin", joints.revolute(between=[arm, "ground"], at="arm.pin", axis=[0, 0, 1]))
    machine.add_joint("grip", joints.weld(between=["whip", arm], at="arm.tip"))
    machine.set_simulation(duration=0.1)
    machine.add_function("speed", functions.final(quantities.speed(body=arm)))
    machine.add_variable("mass", path=arm.path("mass"), lower=1, upper=4)
    return machine


def test_the_scene_of_the_wrong_calls_is_right() -> None:
    pendulum().problem()


Wrong = Callable[[Machine], object]
revolute = joints.revolute
speed = quantities.speed

# What the call makes of the scene, and what the user reads. Every text names the call and the line of the call.
WRONG: list[tuple[Wrong, str, str]] = [
    # Refused at the call.
    (lambda m: m.add_body("arm", mass=1),
     'there is a body "arm" already, made by add_body("arm", …) at HERE', 'in add_body("arm", …)'),
    (lambda m: m.add_body("bob", mass=math.nan),
     "mass is nan, expected a finite number", 'in add_body("bob", …)'),
    (lambda m: m.add_body("bob", points={"tip": np.array([0, np.inf, 0])}),
     'points["tip"][1] is inf, expected a finite number', 'in add_body("bob", …)'),
    (lambda m: m.add_body("bob", mas=1),
     'add_body(…) has no argument "mas"; did you mean "mass"?', "in add_body(…)"),
    (lambda m: m.add_joint("hinge", joints.revolut(at="arm.pin")),
     'joints has no kind "revolut"; did you mean "revolute"?', "in joints.revolut"),
    (lambda m: m.add_joint("hinge", revolute(between=["arm", "ground"], at=[0, 0, 0])),
     'joints.revolute(…) needs "axis"', "in joints.revolute(…)"),
    (lambda m: m.add_body("bob", shape=shapes.box([1, 1, 1])),
     "shapes.box(…) takes its arguments by name, as in shapes.box(size=…)", "in shapes.box(…)"),
    (lambda m: m.add_body("bob", mass=1 + 2j),
     "mass is of type complex, expected a number, text, list, mapping or another part of a scene",
     'in add_body("bob", …)'),
    (lambda m: m.add_body("bob", points={"tip": [0, None, 0]}),
     'points["tip"][1] is None, expected a number', 'in add_body("bob", …)'),
    (lambda m: m.add_body(7, mass=1),
     "the name of a body is of type int, expected text (str)", "in add_body(7, …)"),
    (lambda m: m.add_variable("size", path=m.path("bodies", "arm", "shape", "rod", "lenght"), lower=0),
     '/bodies/arm/shape/rod has no "lenght" yet; did you mean "length"?',
     'in path("bodies", "arm", "shape", "rod", "lenght")'),
    (lambda m: m.add_variable("g", path=m.path("gravity", 1)),
     'the machine has no "gravity" yet; it has "version"', 'in path("gravity", 1)'),
    # Found in the whole scene.
    (lambda m: m.add_joint("hinge", revolute(between=["amr", "ground"], at=[0, 0, 0], axis=[0, 0, 1])),
     'found "amr", expected the name of a body; did you mean "arm"?', 'made by add_joint("hinge", …)'),
    (lambda m: m.add_joint("hinge", revolute(between=["arm", "ground"], at=[0, 0, 0], axis=[0, 1])),
     "found a list of 2, expected a list of 3 numbers", 'made by add_joint("hinge", …)'),
    (lambda m: m.add_joint("hinge", revolute(between=["arm", "ground"], at="arm.tpi", axis=[0, 0, 1])),
     'found "arm.tpi", expected the name of a point of the body; did you mean "arm.tip"?', 'made by add_joint("hinge", …)'),
    (lambda m: m.add_joint("hinge", Joint({"hinge": {"between": ["arm", "ground"]}})),
     'found the key "hinge", expected one of', 'made by add_joint("hinge", …)'),
    (lambda m: m.add_body("bob", shape=shapes.sphere(radius=0.1), mass=-1),
     "found -1, expected a number of at least 0 [kg]", 'made by add_body("bob", …)'),
    (lambda m: m.add_body("bob", shape=shapes.sphere(radius="10 cm"), mass=1),
     'found "10 cm", expected a number above 0 [m]', 'made by add_body("bob", …)'),
    (lambda m: m.add_body("bob", shape=shapes.sphere(radius=0.1)),
     "mass", 'made by add_body("bob", …)'),
    (lambda m: m.add_variable("mass of the arm", path="/bodies/arm/mas", lower=1, upper=2),
     "found /bodies/arm/mas, which does not exist, expected the path of a physical number; "
     "did you mean /bodies/arm/mass?", 'made by add_variable("mass of the arm", …)'),
    (lambda m: m.add_variable("length", path="/bodies/arm/shape/rod/length", lower=2, upper=3),
     "found the lower bound 2, expected at most the start 1 m, the value of /bodies/arm/shape/rod/length", 'made by add_variable("length", …)'),
    (lambda m: m.add_constraint("slow", function="sped", upper=1),
     'found "sped", expected the name of a function; did you mean "speed"?', 'made by add_constraint("slow", …)'),
    (lambda m: m.add_drive("motor", joint="pni", turn=turning.rate(1)),
     'found "pni", expected', 'made by add_drive("motor", …)'),
    (lambda m: m.add_load("push", loads.force(body="arm", direction=[1, 0, 0], magnitude="5 N")),
     'found "5 N", expected', 'made by add_load("push", …)'),
    (lambda m: m.set_simulation(duration=0),
     "found 0, expected a number above 0 [s]", "made by set_simulation(…)"),
    (lambda m: m.maximise("sped"),
     'found "sped", expected the name of a function; did you mean "speed"?', "made by maximise(…)"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "text", "made_by"), WRONG)
def test_wrong_calls_read_well(call: Wrong, text: str, made_by: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(Path(__file__).parent)
    machine = pendulum()
    with pytest.raises((TypeError, ValueError, AttributeError)) as info:
        call(machine)
        machine.problem()
    message = str(info.value)
    print(message)
    assert re.sub(r" at test_machine.py:\d+", " at HERE", text) in re.sub(r" at test_machine.py:\d+", " at HERE", message)
    assert f"{made_by} at test_machine.py:{call.__code__.co_firstlineno}" in message
    if isinstance(info.value, ProblemError):
        assert all("made by" in fault.message for fault in info.value.faults)


def test_a_fault_names_the_part_and_what_it_was_given_to(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(Path(__file__).parent)
    machine = pendulum()
    at = place(
        put="tpi",
        at=[0, 0, 0],
    )
    machine.add_body("bob", shape=shapes.sphere(radius=0.1), mass=1, place=at)
    with pytest.raises(ProblemError, match=r"made by place\(…\) at test_machine.py:\d+, in add_body\(\"bob\", …\) at test_"):
        machine.problem()


def test_all_faults_name_their_calls() -> None:
    machine = pendulum()
    for i in range(5):
        machine.add_load(f"push {i}", loads.force(body="arm", direction=[1, 0], magnitude=1))
    with pytest.raises(ProblemError) as info:
        machine.problem()
    assert len(info.value.faults) == 5
    for i, fault in enumerate(info.value.faults):
        assert f'made by add_load("push {i}", …)' in fault.message
        assert fault.message in str(info.value)


def test_numbers_and_arrays() -> None:
    machine = Machine(
        "numbers", gravity=np.array([0, -1.62, 0], dtype=np.float32), input_tolerance=np.float64(1e-6), start="given"
    )
    machine.add_body("a", shape=shapes.point, mass=np.int64(3), points={"p": (0, np.float64(1), 2)})
    machine.set_simulation(duration=np.array(2.0), steps=np.int32(10))
    document = machine.to_dict()
    assert document["gravity"] == [0, float(np.float32(-1.62)), 0]
    assert document["bodies"]["a"] == {"shape": "point", "mass": 3, "points": {"p": [0, 1, 2]}}
    assert document["simulation"] == {"duration": 2.0, "steps": 10}
    assert type(document["simulation"]["steps"]) is int
    assert list(document) == ["version", "name", "gravity", "input_tolerance", "bodies", "start", "simulation"]


def test_later_changes_of_what_was_given_do_not_matter() -> None:
    machine = Machine("copies")
    size = [1.0, 1.0, 1.0]
    box = shapes.box(size=size)
    machine.add_body("a", shape=box, mass=1)
    size[0] = 2
    box["box"]["size"][1] = 3
    machine.to_dict()["bodies"]["a"]["mass"] = 4
    assert machine.to_dict()["bodies"]["a"] == {"shape": {"box": {"size": [1, 1, 1]}}, "mass": 1}


def test_paths() -> None:
    machine = Machine("paths", gravity=[0, -9.81, 0])
    body = machine.add_body("a/b~c", shape=shapes.box(size=[1, 2, 3]), mass=1)
    assert body == "a/b~c" and isinstance(body, str)
    assert body.path("shape", "box", "size", 0) == "/bodies/a~1b~0c/shape/box/size/0"
    assert machine.path("gravity", 1) == "/gravity/1"
    with pytest.raises(ValueError, match="has 3 entries, counted from 0, no entry 3"):
        body.path("shape", "box", "size", 3)
    with pytest.raises(ValueError, match='/bodies/a~1b~0c/mass is 1 and has no "kg"'):
        body.path("mass", "kg")
    assert body.point("tip") == "a/b~c.tip"


def test_set_again_replaces() -> None:
    machine = pendulum()
    machine.minimise("speed")
    machine.maximise("speed")
    machine.set_simulation(duration=2, until=terminal_event(measure=quantities.speed(body="arm"), reaches=1))
    assert machine.to_dict()["objective"] == {"maximise": "speed"}
    assert machine.to_dict()["simulation"]["duration"] == 2


def test_parts_are_dictionaries() -> None:
    part = loads.force(body="a", direction=[1, 0, 0], magnitude=varying_forces.harmonic(amplitude=1, frequency=2))
    document = {"force": {"body": "a", "direction": [1, 0, 0], "magnitude": {"harmonic": {"amplitude": 1, "frequency": 2}}}}
    assert part == document
    assert json.loads(json.dumps(part)) == document
    for copied in (copy.deepcopy(part), pickle.loads(pickle.dumps(part))):
        assert copied == part and copied.call == part.call
    assert damping() == {}


def test_copies_do_not_share_their_document() -> None:
    machine = pendulum()
    before = machine.to_dict()
    for copied in (copy.copy(machine), copy.deepcopy(machine), pickle.loads(pickle.dumps(machine))):
        assert copied.to_dict() == before
        copied.add_function("mass", functions.mass)
        copied.set_simulation(duration=3)
        assert machine.to_dict() == before
        with pytest.raises(ValueError, match='there is a body "arm" already, made by add_body'):
            copied.add_body("arm", mass=1)


def test_files_are_whole_or_not_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    machine = pendulum()
    path = tmp_path / "pendulum.json"
    machine.to_file(path)
    before = path.read_text(encoding="utf-8")
    assert json.loads(before) == machine.to_dict()
    assert max(map(len, before.splitlines())) < 130

    def broken(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(os, "replace", broken)
    machine.add_function("mass", functions.mass)
    with pytest.raises(OSError, match="disk full"):
        machine.to_file(path)
    assert path.read_text(encoding="utf-8") == before
    assert [entry.name for entry in tmp_path.iterdir()] == ["pendulum.json"]


def test_representation() -> None:
    assert repr(pendulum()) == "<Machine 'pendulum': 2 bodies, 2 joints, 1 functions, 1 variables>"
    assert repr(Machine("new")) == "<Machine 'new': empty>"


def test_parameters_and_expressions() -> None:
    """The length of a link carries its ends: a variable of the parameter moves them all."""
    machine = Machine("link", gravity=[0, -9.81, 0])
    length = machine.add_parameter("L", 0.8)
    machine.add_parameter("half", "= L/2")
    body = machine.add_body(
        "link",
        shape=shapes.box(size=["= L", 0.1, 0.1]),
        mass="= 3*L",
        points={"pin": ["= -half", 0, 0], "tip": ["= half", 0, 0]},
        place=place(put="pin", at=[0, 0, 0]),
    )
    machine.add_joint("hinge", joints.revolute(between=[body, "ground"], at=body.point("pin"), axis=[0, 0, 1]))
    machine.set_simulation(duration="= 1/4")
    machine.add_function("mass", functions.mass)
    machine.add_function("tip", functions.final(quantities.position(body=body, point="tip", direction=[1, 0, 0])))
    machine.add_variable("length", path=length.path(), lower=0.5, upper=1)
    problem = machine.problem()
    assert problem.variables.units == ("m",)
    assert problem.values(functions=["mass"])[0] == pytest.approx(2.4)
    assert problem.gradients(functions=["mass"])[0, 0] == pytest.approx(3.0)
    assert problem.check().passed
    machine.add_body("faulty", shape=shapes.sphere(radius="= LL"), mass=1)
    with pytest.raises(ProblemError, match='found the name "LL".*\n.*add_body'):
        machine.problem()
